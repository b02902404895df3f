//! The table.

use std::fmt::Write as _;

use super::{Answer, Class, Row};

const HEAD: &str = "\
# Extremes

Scenes at the extremes of their parameters: what must happen, what happens here, and what LAMMPS (29 Sep 2021, `lmp`) and
LIGGGHTS-PUBLIC (3.8.0, `liggghts`) do with the same scene, computed by `cargo xtask extremes --docs`. `granule selftest` runs
our column from an installed program, the tests run it on every change.

The engines' inputs are written from the same scene. A value that our plan refuses is written into them afterwards. A peer is
judged as we are:

- **right**: the expected answer; where the scene makes no sense, any refusal with a message.
- **warns**: a wrong answer with a warning.
- **dies**: a message and no answer, where there is one.
- **no end**: not done after forty seconds.
- **wrong silently**: a wrong answer and no word of it.
- **-**: it cannot be told the scene: hard spheres from event to event, oblique walls, or a law that it does not have.

";

/// One line of the terminal.
pub fn line(name: &str, ours: &Result<String, String>, peers: &[Answer; 2]) -> String {
    let ours = match ours {
        Ok(got) => format!("right: {got}"),
        Err(why) => format!("WRONG: {why}"),
    };
    format!("{name}\n  ours     {ours}\n  LAMMPS   {}\n  LIGGGHTS {}", told(&peers[0]), told(&peers[1]))
}

fn told(answer: &Answer) -> String {
    match (answer.class, answer.what.as_str()) {
        (Class::Missing, _) => answer.class.name().to_string(),
        (class, "") => class.name().to_string(),
        (class, what) => format!("{}: {what}", class.name()),
    }
}

/// The page.
pub fn page(rows: &[Row]) -> String {
    let mut page = String::from(HEAD);
    let count = |peer: usize, class: Class| rows.iter().filter(|row| row.peers[peer].class == class).count();
    let right = rows.iter().filter(|row| row.ours.is_ok()).count();
    // Writing to a string cannot fail.
    page.push_str("| engine | right | warns | dies | no end | wrong silently | cannot be told |\n|---|--:|--:|--:|--:|--:|--:|\n");
    let _ = writeln!(page, "| granule | {right} | 0 | 0 | 0 | {} | 0 |", rows.len() - right);
    for (peer, name) in ["LAMMPS", "LIGGGHTS"].into_iter().enumerate() {
        let classes = [Class::Right, Class::Warns, Class::Stops, Class::Hangs, Class::Wrong, Class::Untold];
        let counts: Vec<String> = classes.iter().map(|class| count(peer, *class).to_string()).collect();
        let _ = writeln!(page, "| {name} | {} |", counts.join(" | "));
    }
    page.push_str("\n| extreme | expected | granule | LAMMPS | LIGGGHTS |\n|---|---|---|---|---|\n");
    for row in rows {
        let ours = match &row.ours {
            Ok(got) => got.clone(),
            Err(why) => format!("**wrong**: {why}"),
        };
        let cells = [
            format!("`{}`: {}", row.name, row.extreme),
            row.expected.to_string(),
            ours,
            told(&row.peers[0]),
            told(&row.peers[1]),
        ];
        let cells = cells.map(|cell| cell.replace(['\n', '|'], " "));
        let _ = writeln!(page, "| {} |", cells.join(" | "));
    }
    page
}
