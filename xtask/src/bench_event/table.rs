//! What `cargo xtask bench event` reports.

use std::fmt::Write as _;

use super::{Row, fastest};

/// Goals: bytes a sphere, and cost of a collision of 10^6 spheres over that of 10^4.
const GOALS: (f64, f64) = (400.0, 3.0);

/// What others reached: spheres, volume fraction, restitution, million collisions a second of DynamO and of EDMD.
type Reference = (f64, f64, f64, Option<f64>, Option<f64>);

/// Measured on another machine, an AMD EPYC (Zen 4) with 4 virtual cores, on 2026-11-22, one core: DynamO of 2024-06-09 and
/// the faster one of the two programs of EDMD (Smallenburg 2022). Fluids; DynamO's dilute gas has a restitution of 0.9.
const REFERENCES: [Reference; 9] = [
    (1e4, 0.3, 1.0, Some(0.10), Some(0.63)),
    (1e5, 0.3, 1.0, Some(0.06), Some(0.23)),
    (1e6, 0.3, 1.0, None, Some(0.14)),
    (1e4, 0.49, 1.0, Some(0.14), Some(1.1)),
    (1e5, 0.49, 1.0, None, Some(0.41)),
    (1e4, 0.05, 1.0, None, Some(0.54)),
    (1e5, 0.05, 1.0, None, Some(0.155)),
    (1e4, 0.05, 0.9, Some(0.06), None),
    (1e5, 0.05, 0.9, Some(0.03), None),
];

fn reference(row: &Row) -> Option<Reference> {
    REFERENCES
        .into_iter()
        .find(|known| known.0 == row.spheres.0 && known.1 == row.phi && known.2 == row.restitution)
}

/// A row of the table.
pub fn line(row: &Row) -> String {
    let mut line =
        format!("| {:.0e} | {} | {} | {:.3} |", row.spheres.0, row.phi, row.restitution, 1e-6 * row.best());
    for (_, turns) in &row.peers {
        let speed = fastest(turns);
        line.push_str(&if speed > 0.0 { format!(" {:.3} |", 1e-6 * speed) } else { " - |".into() });
    }
    let known = reference(row);
    for speed in [known.and_then(|known| known.3), known.and_then(|known| known.4)] {
        line.push_str(&speed.map_or_else(|| " - |".into(), |speed| format!(" {speed} |")));
    }
    let _ = write!(line, " {:.0} |", row.bytes);
    line
}

/// Cost of a collision at the largest over that at the smallest size, for each gas that has both.
fn growth(rows: &[Row]) -> Vec<(f64, f64, f64)> {
    let large = rows.iter().filter(|row| row.spheres.0 == 1e6);
    large
        .filter_map(|row| {
            let same = |other: &&Row| {
                other.spheres.0 == 1e4 && other.phi == row.phi && other.restitution == row.restitution
            };
            Some((row.phi, row.restitution, rows.iter().find(same)?.best() / row.best()))
        })
        .collect()
}

fn largest_bytes(rows: &[Row]) -> f64 {
    // The system counts whole pages and the program itself, which only many spheres make up for.
    let resident = rows.iter().filter(|row| row.spheres.0 >= 1e6).map(|row| row.resident);
    rows.iter().map(|row| row.bytes).chain(resident).fold(0.0, f64::max)
}

fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "not met" }
}

/// Table and goals.
pub fn text(rows: &[Row]) -> String {
    let names: Vec<&str> =
        rows.first().map(|row| row.peers.iter().map(|(name, _)| *name).collect()).unwrap_or_default();
    let mut text = String::from("| spheres | φ | e | ours [10^6/s] |");
    for name in &names {
        let _ = write!(text, " {name} |");
    }
    text.push_str(" DynamO elsewhere | EDMD elsewhere | bytes a sphere |\n|");
    text.push_str(&"---:|".repeat(7 + names.len()));
    text.push('\n');
    for row in rows {
        text.push_str(&line(row));
        text.push('\n');
    }
    text.push_str(
        "\n\"Elsewhere\" was measured on another machine; only columns before it ran in turn here.\n",
    );
    for (phi, e, ratio) in growth(rows) {
        let _ = writeln!(
            text,
            "Cost of a collision at 10^6 over 10^4, φ = {phi}, e = {e}: {ratio:.2} (goal {}: {})",
            GOALS.1,
            verdict(ratio <= GOALS.1)
        );
    }
    let bytes = largest_bytes(rows);
    let _ = writeln!(text, "Bytes a sphere: {bytes:.0} (goal {}: {})", GOALS.0, verdict(bytes <= GOALS.0));
    text
}

/// Everything measured, for programs.
pub fn json(rows: &[Row], processor: &str) -> String {
    let list =
        |numbers: &[f64]| numbers.iter().map(|number| format!("{number}")).collect::<Vec<_>>().join(", ");
    let one = |row: &Row| {
        let peers = row.peers.iter().filter(|(_, turns)| !turns.is_empty());
        let peers: Vec<String> =
            peers.map(|(name, turns)| format!("\"{name}\": [{}]", list(turns))).collect();
        let known = reference(row);
        let elsewhere: Vec<String> =
            [("DynamO", known.and_then(|known| known.3)), ("EDMD", known.and_then(|known| known.4))]
                .into_iter()
                .filter_map(|(name, speed)| Some(format!("\"{name}\": {}", speed? * 1e6)))
                .collect();
        format!(
            "    {{\"spheres\": {}, \"volume_fraction\": {}, \"restitution\": {}, \"collisions_per_second\": [{}], \
             \"bytes_per_sphere\": {}, \"resident_bytes_per_sphere\": {}, \"peers\": {{{}}}, \"elsewhere\": {{{}}}}}",
            row.spheres.1,
            row.phi,
            row.restitution,
            list(&row.ours),
            row.bytes,
            row.resident,
            peers.join(", "),
            elsewhere.join(", ")
        )
    };
    let growth: Vec<String> = growth(rows)
        .into_iter()
        .map(|(phi, e, ratio)| {
            format!("    {{\"volume_fraction\": {phi}, \"restitution\": {e}, \"cost_ratio\": {ratio:.3}}}")
        })
        .collect();
    format!(
        "{{\n  \"processor\": \"{}\",\n  \"rows\": [\n{}\n  ],\n  \"growth_10^4_to_10^6\": [\n{}\n  ],\n  \"goals\": \
         {{\"bytes_per_sphere\": {}, \"cost_ratio\": {}}}\n}}\n",
        processor.replace(['"', '\\'], " "),
        rows.iter().map(one).collect::<Vec<_>>().join(",\n"),
        growth.join(",\n"),
        GOALS.0,
        GOALS.1
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::Json;

    fn rows() -> Vec<Row> {
        let row = |n: f64, speed: f64, bytes: f64| Row {
            spheres: (n, n),
            phi: 0.3,
            restitution: 1.0,
            ours: vec![0.9 * speed, speed],
            bytes,
            resident: bytes + 10.0,
            peers: vec![("EDMD Cell", vec![2e5]), ("DynamO", Vec::new())],
        };
        vec![row(1e4, 8e5, 350.0), row(1e5, 4e5, 360.0), row(1e6, 2e5, 395.0)]
    }

    #[test]
    fn goals_are_judged_by_the_fastest_turns() {
        let text = text(&rows());
        assert!(text.contains("| 1e4 | 0.3 | 1 | 0.800 | 0.200 | - | 0.1 | 0.63 | 350 |"), "{text}");
        assert!(text.contains("φ = 0.3, e = 1: 4.00 (goal 3: not met)"), "{text}");
        assert!(text.contains("Bytes a sphere: 405 (goal 400: not met)"), "{text}");
    }

    #[test]
    fn the_json_is_json() {
        let json = Json::parse(&json(&rows(), "a \"b\"")).unwrap();
        let rows = json.get("rows").and_then(Json::list).unwrap();
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[0].get("elsewhere").unwrap().get("EDMD"), Some(&Json::Number(630_000.0)));
        let growth = json.get("growth_10^4_to_10^6").and_then(Json::list).unwrap();
        assert_eq!(growth[0].get("cost_ratio"), Some(&Json::Number(4.0)));
    }
}
