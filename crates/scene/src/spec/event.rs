//! The block of the event-driven driver.

use super::{Block, opt};

pub const EVENT: Block = Block {
    name: "Event",
    doc: "The event-driven driver: hard bodies that fly freely, or roll and slide on a substrate, and collide in an instant, \
          by the rule `collision` of their contact. Walls are fixed, move without turning, or turn in their own place.",
    fields: &[
        opt(
            "step",
            "time in s, greater than 0",
            "the shortest interval of an output, or a hundredth of the duration",
            "Interval at which the run can be looked at: steps of `run` and `every` are these. The motion does not depend on it.",
        ),
        opt(
            "contact_duration",
            "time in s, greater than 0",
            "1e-4 of the shorter of sqrt(d/g) and d/v, on a substrate 1e-2 of it, where it is needed",
            "A collision less than this after the last one of one of its bodies loses no energy along the normal, so that \
             inelastic collapse ends. Also decides how bodies rest: in bounces of about this duration.",
        ),
        opt(
            "slides",
            "`Arcs(..)` or `EffectiveRestitution`",
            "`Arcs()`",
            "What bodies on a `substrate` do between collisions. `EffectiveRestitution`: a collision ends as if its slides \
             were over at once (Kondic 1999, Eq. (68)), and bodies roll without friction: the cheapest model, good where \
             bodies slide much less far than they run between collisions.",
        ),
    ],
};

pub const ARCS: Block = Block {
    name: "Arcs",
    doc: "Hard bodies on a substrate slide after collisions until they roll, and roll until they rest, along arcs that are \
          known in closed form. Bodies never leave the surface, which may be tilted and move along x and y, but not turn; \
          walls must be upright planes.",
    fields: &[opt(
        "error",
        "length in m, greater than 0",
        "1e-3 of the smallest radius",
        "Aim for the error of a place over one piece of an arc. Where the plate accelerates or is tilted, the direction of \
         friction turns, and arcs are cut into pieces of constant friction; the error of a piece is of the third order in \
         its length. Elsewhere arcs are exact.",
    )],
};

pub const EFFECTIVE_RESTITUTION: Block =
    Block { name: "EffectiveRestitution", doc: "Slides are over at once.", fields: &[] };
