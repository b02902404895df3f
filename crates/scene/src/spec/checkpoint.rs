//! When the state of a run is kept.

use super::{Block, opt};

pub const CHECKPOINT: Block = Block {
    name: "Checkpoint",
    doc: "`checkpoint: (every: \"1 s\", keep: 2)`: keeps the whole state of the run in the output folder, from which `granule \
          resume` continues with the bits of a run that was never interrupted. A run that is stopped by a signal or because its \
          time is over is kept, too. `Never` keeps nothing. When a run is complete, its checkpoints are removed. Results do \
          not depend on any of this.",
    fields: &[
        opt(
            "every",
            "whole number of steps, or time such as `\"1 ms\"`",
            "no such interval",
            "Interval in simulated time.",
        ),
        opt(
            "wall",
            "time in s, greater than 0",
            "`\"10 min\"`, or no such interval if `every` is given",
            "Interval on the clock.",
        ),
        opt("keep", "whole number from 1 to 1000", "2", "How many of the last checkpoints are kept."),
    ],
};
