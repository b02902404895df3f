//! The page of the atlas.

use std::fmt::Write as _;

use granule_plan::FEWEST_STEPS;

use super::{Class, Coordination, Limit, Map, SCHEMES};

/// Maps whose pictures the page shows.
pub(super) const SHOWN: [&str; 7] = [
    "single-LinearSpringDashpot-VelocityVerlet",
    "block-LinearSpringDashpot-VelocityVerlet",
    "single-Hertz-VelocityVerlet",
    "block-Hertz-VelocityVerlet",
    "mass-stiffness-LinearSpringDashpot",
    "size-LinearSpringDashpot",
    "oblique-TangentialSpring-VelocityVerlet",
];

const HEAD: &str = "\
# Stability atlas

Where a contact is integrated rightly, and what happens where it is not: computed by `cargo xtask atlas --docs`, which also
writes all maps as SVG and JSON into target/atlas. Each cell is a run of the engine, an impact cell the worst of four runs that
touch at different parts of a step.

- **stable**: the velocity of parting is right to 5 % of the impact speed, and a packing stays at rest.
- **wrong restitution**: finite and without new energy, but off by more than that.
- **tunnelled**: the bodies have passed through each other.
- **energy gained**: by more than 1 %, or the disturbance of a packing grows.
- **not finite**: some number has overflowed.

The lines are the limits that a plan enforces: a scene whose fixed step lies left of the line that holds for it is refused, and
the message says where it lies: the map, how many steps a contact has there, and how many it needs. `step: Auto()` stays at
half of the limit or below. Right of the line nothing grows, but an impact of few steps begins and ends between them, which
costs or gives it energy once: a plan warns where that is more than 5 %.

## Coordination

A body that several contacts hold swings faster than a pair. A pair of equal bodies has w^2 = k/m12 = 2k/m. In the fastest mode of
an endless chain neighbours move against each other, w^2 = 4k/m; in that of a face-centred block, the longitudinal one at the
edge of its zone, eight of the twelve neighbours move against the body at 45 degrees, w^2 = 8 (2k/m)/2 = 8k/m. So a chain needs
sqrt(2) times and a block twice the steps of a pair. A plan does not know the packing and bounds every one of them: at most 13.5
neighbours of equal size, each counted with the mean of its direction, give w^2 <= 9.07 k/m, 6 % more steps than the block
needs (crates/plan/src/limits.rs has the proof, with friction, damping and different sizes).

Measured by bisection, to 1 %, of the step at which a disturbance of a pressed packing grows; steps in a contact of a pair:
";

/// The page.
pub(super) fn page(maps: &[Map], limits: &[Limit], needed: &[(&str, f64)]) -> String {
    let mut page = String::from(HEAD);
    // Writing to a string cannot fail.
    let _ = writeln!(
        page,
        "\n| law | integrator | damping ratio | pair, plan | chain, measured | fcc block, measured | packing, plan |\n|---|---|--:|--:|--:|--:|--:|"
    );
    for block in limits.iter().filter(|limit| limit.coordination == Coordination::Block) {
        let chain = limits.iter().find(|other| {
            other.coordination == Coordination::Chain
                && (other.law, other.scheme, other.damping) == (block.law, block.scheme, block.damping)
        });
        let chain = chain.map(|chain| format!("{:.2}", chain.measured)).unwrap_or_default();
        let _ = writeln!(
            page,
            "| {} | {} | {} | {:.2} | {chain} | {:.2} | {:.2} |",
            block.law, block.scheme, block.damping, block.pair, block.measured, block.packing
        );
    }
    let _ = writeln!(
        page,
        "\n## Accuracy\n\nFewest steps in a contact from which on the restitution is right to 5 % of the impact speed, at every damping \
         ratio up to 1, whatever the part of a step at which the contact begins ({}). A plan warns of fewer than {FEWEST_STEPS}.\n\n| law | steps |\n|---|--:|",
        SCHEMES[0]
    );
    for (law, steps) in needed {
        let _ = writeln!(page, "| {law} | {steps} |");
    }
    page.push_str("\n## Maps\n");
    for map in maps.iter().filter(|map| SHOWN.contains(&map.name.as_str())) {
        let _ = writeln!(page, "\n![{}](figures/atlas/{}.svg)", map.title, map.name);
    }
    page.push_str("\n## All maps\n\nCells of each class.\n\n| map |");
    for class in Class::ALL {
        let _ = write!(page, " {} |", class.name());
    }
    page.push_str("\n|---|--:|--:|--:|--:|--:|\n");
    for map in maps {
        let _ = write!(page, "| {} |", map.title);
        for class in Class::ALL {
            let count = map.cells.iter().flatten().filter(|other| **other == class).count();
            let _ = write!(page, " {count} |");
        }
        page.push('\n');
    }
    page
}
