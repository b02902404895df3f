//! The block of the event-driven driver.

use super::{Block, opt};

pub const EVENT: Block = Block {
    name: "Event",
    doc: "The event-driven driver: hard bodies that fly freely and collide in an instant, by the rule `collision` of their \
          contact. Walls are fixed, move without turning, or turn in their own place.",
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
            "1e-4 of the shorter of sqrt(d/g) and d/v, where it is needed",
            "A collision less than this after the last one of one of its bodies loses no energy along the normal, so that \
             inelastic collapse ends. Also decides how bodies rest: in bounces of about this duration.",
        ),
    ],
};
