//! The manual of the scene format, made from the list of blocks and fields that the reader works with.

use std::fmt::Write as _;

use crate::spec::{self, Block};

/// One chapter: heading, introduction, blocks.
const CHAPTERS: &[(&str, &str, &[&Block])] = &[
    ("The file", "", &[&spec::SCENE]),
    ("Space and materials", "", &[&spec::CELL, &spec::MATERIAL_BLOCK]),
    (
        "Bodies",
        "`bodies` is a list of the following, in any order and number.",
        &[
            &spec::SPHERE,
            &spec::DISC,
            &spec::HOLLOW,
            &spec::BODY,
            &spec::LATTICE,
            &spec::FILL,
            &spec::UNIFORM,
            &spec::NORMAL,
            &spec::IMPORT,
            &spec::LAMMPS_DUMP,
        ],
    ),
    (
        "Walls",
        "`walls` maps names to the following. A motion `Table([(time, displacement), ..])` moves along straight lines \
         between its rows and rests before the first and after the last.",
        &[&spec::PLANE, &spec::BOX, &spec::CYLINDER, &spec::CONSTANT, &spec::SINUSOIDAL, &spec::ROTATION],
    ),
    ("Substrate", "", &[&spec::SUBSTRATE]),
    ("Contacts", "", &[&spec::CONTACT, &spec::CONVENTIONS]),
    (
        "Driver and run",
        "",
        &[
            &spec::TIME_STEP,
            &spec::AUTO,
            &spec::ACCURACY,
            &spec::BUDGET,
            &spec::EVENT,
            &spec::ARCS,
            &spec::RUN,
            &spec::CHECKPOINT,
            &spec::GUARDS,
        ],
    ),
    (
        "Outputs",
        "`outputs` is a list of the following. Paths must differ and stay inside the output folder.",
        &[
            &spec::SERIES_OUTPUT,
            &spec::BODIES_OUTPUT,
            &spec::DUMP_OUTPUT,
            &spec::VTK_OUTPUT,
            &spec::DATA_OUTPUT,
            &spec::CONTACTS_OUTPUT,
            &spec::LAYER_OUTPUT,
            &spec::PAIR_CORRELATION_OUTPUT,
            &spec::IMPACTS_OUTPUT,
        ],
    ),
];

const HEAD: &str = "# The scene file

A scene is a [RON](https://github.com/ron-rs/ron) text: `(version: 1, ...)`. Every field is named; unknown and repeated
fields are errors; a field without default must be given. `granule check` reports all problems of a scene at once.

Numbers are in SI units (m, kg, s, rad), or texts with a unit: `\"0.5 mm\"`, `\"1e5 N/m\"`, `\"30 deg\"`. Units are
products of `m g s N Pa J Hz rad W min h deg` with decimal prefixes and integer powers. `inf` is accepted only where this
page or the manual of a law says so; `NaN` never.

```ron
(
    version: 1,
    gravity: (0, 0, -9.81),
    materials: { \"glass\": (density: \"2500 kg/m^3\") },
    bodies: [Sphere(material: \"glass\", radius: \"1 mm\", position: (0, 0, \"5 mm\"))],
    walls: { \"floor\": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: \"glass\") },
    contacts: [
        (
            between: (\"glass\", \"glass\"),
            normal: LinearSpringDashpot(stiffness: \"1e4 N/m\", restitution: 0.9),
        ),
    ],
    run: (duration: \"100 ms\"),
    outputs: [Series(path: \"energy.csv\")],
)
```
";

/// The manual in Markdown.
pub fn manual() -> String {
    let mut out = HEAD.to_string();
    for (heading, introduction, blocks) in CHAPTERS {
        // Writing to a string cannot fail.
        let _ = write!(out, "\n## {heading}\n");
        if !introduction.is_empty() {
            let _ = write!(out, "\n{introduction}\n");
        }
        for block in *blocks {
            let _ = write!(out, "\n### {}\n\n{}\n\n", block.name, block.doc);
            out.push_str("| field | takes | default | meaning |\n|---|---|---|---|\n");
            for field in block.fields {
                let default = field.default.unwrap_or("**must be given**");
                let _ = writeln!(out, "| `{}` | {} | {default} | {} |", field.name, field.takes, field.doc);
            }
        }
    }
    out
}
