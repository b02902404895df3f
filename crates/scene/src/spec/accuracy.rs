//! The blocks that ask for an accuracy or a time instead of a step.

use super::{Block, need, opt};

pub const ACCURACY: Block = Block {
    name: "Accuracy",
    doc: "`accuracy: (restitution: 1e-3)` or `accuracy: (observable: \"mean_height\", error: 0.01, table: \"trade/heap\")`: the \
          error that the scene may have. Step and integrator, with a table also stiffness and precision, are then chosen by \
          measurement and must not be given; `granule explain` says what was chosen and why, and a run reports the error \
          that it had.",
    fields: &[
        opt(
            "restitution",
            "number greater than 0",
            "no bound",
            "Largest error of the velocities after an impact, over the normal speed before it, whatever the phase of the time \
             step at which it begins. Measured for each pair of materials, head-on and oblique, at the impact speed of the \
             scene, when the scene is read.",
        ),
        opt(
            "observable",
            "`velocities`, `spins` or a column of a time series",
            "none",
            "Quantity whose error counts.",
        ),
        opt("error", "number greater than 0", "none", "Largest relative error of the observable."),
        opt(
            "table",
            "text: a folder, relative to the scene",
            "none",
            "Where `granule trade` of this scene has left its results. Needed with `observable`.",
        ),
    ],
};

pub const BUDGET: Block = Block {
    name: "Budget",
    doc: "`budget: (seconds: 60)`: how long the run may take on this machine. The most accurate setting that fits is chosen: by a \
          table if there is one, else by the error of impacts. Runs are not the same on machines of other speed.",
    fields: &[
        need(
            "seconds",
            "time in s, greater than 0",
            "Time of the clock for the whole run, outputs left out.",
        ),
        opt(
            "table",
            "text: a folder, relative to the scene",
            "impacts are measured",
            "Where `granule trade` of this scene has left its results.",
        ),
    ],
};
