//! Measured impacts.

use std::path::Path;

use granule_formats::FormatError;
use granule_formats::csv::{self, Table};

/// One measured impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Tangential over normal velocity of the contact point before the impact, not negative.
    pub psi1: f64,
    /// Tangential velocity of the contact point after the impact over the normal speed before, positive in the direction of
    /// the slip before.
    pub psi2: f64,
    /// Normal restitution, if the rebound was measured.
    pub restitution: Option<f64>,
}

/// Why a table holds no impacts.
#[derive(Debug)]
pub enum DataError {
    /// The file cannot be read.
    Format(FormatError),
    /// Columns are missing, unknown, or without meaning together.
    Columns(String),
    /// A row is no impact.
    Row {
        /// Number of the row of data, from 1.
        row: usize,
        /// What is wrong.
        what: String,
    },
}

impl std::fmt::Display for DataError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Format(error) => error.fmt(f),
            Self::Columns(what) => f.write_str(what),
            Self::Row { row, what } => write!(f, "row {row} of the data: {what}"),
        }
    }
}

impl std::error::Error for DataError {}

const HELP: &str = "give psi1 and psi2, with restitution if it was measured; or normal_speed, tangential_velocity, \
    rebound_normal_speed and rebound_tangential_velocity of the centres in one unit, with radius, spin and rebound_spin if \
    the bodies spin (R times spin counts towards the tangential velocity)";

/// Reads impacts from a CSV file.
///
/// # Errors
/// The file cannot be read, or is no table of impacts.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<Impact>, DataError> {
    table(&csv::read(path).map_err(DataError::Format)?)
}

/// Impacts of a table. Columns `psi1`, `psi2` and perhaps `restitution`; or `normal_speed`, `tangential_velocity`,
/// `rebound_normal_speed` and `rebound_tangential_velocity`, with `radius`, `spin` and `rebound_spin` where bodies spin. A
/// rebound counts positive away from the other body; spins count positive where they add to the tangential velocity of the
/// contact point.
///
/// # Errors
/// Columns are missing or unknown, or a row is no impact.
pub fn table(table: &Table) -> Result<Vec<Impact>, DataError> {
    const RATIOS: [&str; 3] = ["psi1", "psi2", "restitution"];
    const VELOCITIES: [&str; 7] = [
        "normal_speed",
        "tangential_velocity",
        "rebound_normal_speed",
        "rebound_tangential_velocity",
        "radius",
        "spin",
        "rebound_spin",
    ];
    let known = |names: &[&str]| table.columns.iter().find(|column| !names.contains(&column.name.as_str()));
    let column = |name: &str| {
        table.column(name).ok_or_else(|| DataError::Columns(format!("there is no column `{name}`; {HELP}")))
    };
    let unknown = |name: &str| DataError::Columns(format!("the column `{name}` has no meaning here; {HELP}"));
    if table.column("psi1").is_some() {
        if let Some(other) = known(&RATIOS) {
            return Err(unknown(&other.name));
        }
        let (before, after) = (column("psi1")?, column("psi2")?);
        let restitution = table.column("restitution");
        return (0..before.len())
            .map(|row| impact(row, before[row], after[row], restitution.map(|values| values[row])))
            .collect();
    }
    if let Some(other) = known(&VELOCITIES) {
        return Err(unknown(&other.name));
    }
    let [normal, tangential] = [column("normal_speed")?, column("tangential_velocity")?];
    let [rebound, slip] = [column("rebound_normal_speed")?, column("rebound_tangential_velocity")?];
    let spins = match ["radius", "spin", "rebound_spin"].map(|name| table.column(name)) {
        [None, None, None] => None,
        [Some(radius), Some(before), Some(after)] => Some([radius, before, after]),
        _ => {
            return Err(DataError::Columns(
                "radius, spin and rebound_spin belong together: give all three or none".to_string(),
            ));
        }
    };
    (0..normal.len())
        .map(|row| {
            let at = |what: String| DataError::Row { row: row + 1, what };
            if normal[row] <= 0.0 {
                return Err(at(format!("the normal speed {} is not greater than 0", normal[row])));
            }
            let turn = |which: usize| spins.map_or(0.0, |spins| spins[0][row] * spins[which][row]);
            let before = (tangential[row] + turn(1)) / normal[row];
            let after = (slip[row] + turn(2)) / normal[row];
            // The direction of the slip before is positive.
            let sign = if before < 0.0 { -1.0 } else { 1.0 };
            impact(row, sign * before, sign * after, Some(rebound[row] / normal[row]))
        })
        .collect()
}

fn impact(row: usize, psi1: f64, psi2: f64, restitution: Option<f64>) -> Result<Impact, DataError> {
    let at = |what: String| DataError::Row { row: row + 1, what };
    if !(psi1.is_finite() && psi2.is_finite()) {
        return Err(at(format!("psi1 {psi1} or psi2 {psi2} is no finite number")));
    }
    if psi1 < 0.0 {
        return Err(at(format!("psi1 is {psi1}; it is not negative by definition")));
    }
    if let Some(value) = restitution.filter(|value| !(0.0..=2.0).contains(value)) {
        return Err(at(format!("a restitution of {value}: is a sign or a unit wrong?")));
    }
    Ok(Impact { psi1, psi2, restitution })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<Impact>, String> {
        table(&csv::parse(Path::new("data.csv"), text).unwrap()).map_err(|error| error.to_string())
    }

    #[test]
    fn ratios_and_velocities_are_the_same_impact() {
        let ratios = parse("psi1,psi2,restitution\n2,-0.5,0.9\n").unwrap();
        let velocities = "normal_speed,tangential_velocity,rebound_normal_speed,rebound_tangential_velocity,radius,spin,\
            rebound_spin\n0.5,-1.5,0.45,0.1,0.01,50,15\n";
        assert_eq!(ratios, [Impact { psi1: 2.0, psi2: -0.5, restitution: Some(0.9) }]);
        let found = parse(velocities).unwrap()[0];
        assert!((found.psi1 - 2.0).abs() < 1e-14 && (found.psi2 + 0.5).abs() < 1e-14, "{found:?}");
        assert!((found.restitution.unwrap() - 0.9).abs() < 1e-14);
    }

    #[test]
    fn tables_without_meaning_are_refused() {
        for (text, message) in [
            ("psi1\n1\n", "no column `psi2`"),
            ("psi1,psi2,mass\n1,1,1\n", "`mass` has no meaning"),
            ("speed\n1\n", "`speed` has no meaning"),
            ("normal_speed,tangential_velocity\n1,1\n", "no column `rebound_normal_speed`"),
            ("psi1,psi2\n-1,1\n", "row 1 of the data: psi1 is -1"),
            (
                "normal_speed,tangential_velocity,rebound_normal_speed,rebound_tangential_velocity\n1e-300,1e300,1,1\n",
                "psi1 inf or psi2",
            ),
            ("psi1,psi2,restitution\n1,1,-0.5\n", "a restitution of -0.5"),
            (
                "normal_speed,tangential_velocity,rebound_normal_speed,rebound_tangential_velocity,spin\n1,1,1,1,1\n",
                "belong together",
            ),
            (
                "normal_speed,tangential_velocity,rebound_normal_speed,rebound_tangential_velocity\n0,1,1,1\n",
                "not greater than 0",
            ),
        ] {
            assert!(parse(text).unwrap_err().contains(message), "{text}: {:?}", parse(text));
        }
    }
}
