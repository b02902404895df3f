//! What is watched during a run.

use super::{Block, opt};

pub const GUARDS: Block = Block {
    name: "Guards",
    doc: "`guards: (overlap: Stop(0.5), lost: Warn(1))`: each is `Stop(limit)`, `Warn(limit)` or `Off`. A run that stops says \
          which body, where, when, what it touches, the likely cause and a remedy, and leaves the smallest scene that it finds in \
          which the same happens, `crash.ron`. Numbers that are not finite stop a run always. Results do not depend on guards. The event-driven driver \
          has none but `lost` and `energy`.",
    fields: &[
        opt(
            "overlap",
            "`Stop(share)`, `Warn(share)` or `Off`",
            "`Stop(1)`; `Off` with `allow_overlap`",
            "Overlap over the radius of the smaller body, at every 16th step. At 1 a body covers the other one's centre, and a \
             wall the body's.",
        ),
        opt(
            "travel",
            "`Stop(share)`, `Warn(share)` or `Off`",
            "`Warn(1)`",
            "Distance that a body moves in one step over the smallest radius. Beyond 1 bodies can pass through each other \
             unseen. Candidate lists cannot grow too old: they are made anew by the distance that bodies have moved.",
        ),
        opt(
            "lost",
            "`Stop(radii)`, `Warn(radii)` or `Off`",
            "`Warn(1)`",
            "A centre that is outside of the bounds of the cell, where they are finite and not periodic, by more than so many \
             of its radii, at every 1024th step.",
        ),
        opt(
            "energy",
            "`Stop(share)`, `Warn(share)` or `Off`",
            "`Warn(0.1)` with the energy ledger, else `Off`",
            "Residual of the energy ledger over the energy turned over, at every 1024th step. Switches the ledger on.",
        ),
    ],
};
