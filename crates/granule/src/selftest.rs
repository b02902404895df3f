//! The extremes, run by an installed program.

use granule_extremes::{Lab, cases};
use granule_law_api::RegistryError;

/// What became of one extreme.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelftestResult {
    /// Name of the case.
    pub name: &'static str,
    /// What is extreme.
    pub extreme: &'static str,
    /// What must happen.
    pub expected: &'static str,
    /// What happened, or what is wrong with it.
    pub outcome: Result<String, String>,
}

/// Names of all cases, and whether they take long.
pub fn selftest_names() -> impl Iterator<Item = (&'static str, bool)> {
    cases().map(|case| (case.name, case.slow))
}

/// Runs the extremes with the laws that the program links: those of these names, or without names all that take no more than
/// about a second each. `done` is told each result at once. Unknown names are passed over; see [`selftest_names`].
///
/// # Errors
/// The laws do not fit together.
pub fn selftest(
    names: &[String],
    slow: bool,
    done: &mut dyn FnMut(SelftestResult),
) -> Result<(), RegistryError> {
    let lab = Lab::new()?;
    let chosen = |name: &str, takes_long: bool| {
        if names.is_empty() { slow || !takes_long } else { names.iter().any(|wanted| wanted == name) }
    };
    for case in cases().filter(|case| chosen(case.name, case.slow)) {
        let outcome = (case.check)(&lab);
        done(SelftestResult { name: case.name, extreme: case.extreme, expected: case.expected, outcome });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_cases_are_run_and_told() {
        let mut results = Vec::new();
        let names = ["no-bodies".to_string(), "plastic-hard".to_string()];
        selftest(&names, false, &mut |result| results.push(result)).unwrap();
        let mut found: Vec<&str> = results.iter().map(|result| result.name).collect();
        found.sort_unstable();
        assert_eq!(found, ["no-bodies", "plastic-hard"]);
        assert!(results.iter().all(|result| result.outcome.is_ok()), "{results:?}");
        assert!(selftest_names().any(|(name, slow)| name == "column-long" && slow));
    }
}
