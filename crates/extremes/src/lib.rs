//! Scenes at the extremes of their parameters, each with the answer that it must give: the right one, or one clear error
//! before harm.
//!
//! [`cases()`] is the list. Tests run all of it, `granule selftest` runs it from an installed program, and
//! [the page](../../../docs/extremes.md) shows it beside what other engines do. A case fails with a reason; it never panics.
//! The laws are those that the program links.

mod cases;
mod run;
mod scene;

pub use cases::{cases, crowd, swarm};
pub use run::{Body, Lab};
pub use scene::{Ball, ball, head_on, scene};

/// One extreme.
pub struct Case {
    /// Name on the command line, unique.
    pub name: &'static str,
    /// What is extreme.
    pub extreme: &'static str,
    /// What must happen, with the accuracy that the integration allows.
    pub expected: &'static str,
    /// Takes more than about a second in a program that is built for speed.
    pub slow: bool,
    /// Runs it: what happened, with numbers.
    ///
    /// # Errors
    /// What is wrong with what happened.
    pub check: fn(&Lab) -> Result<String, String>,
}

impl Case {
    /// The case of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        cases().find(|case| case.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_texts_are_whole() {
        for (index, case) in cases().enumerate() {
            assert!(cases().take(index).all(|other| other.name != case.name), "{}", case.name);
            assert!(case.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
            for text in [case.extreme, case.expected] {
                assert!(!text.is_empty() && !text.contains(['|', '\n']), "{}: {text}", case.name);
            }
        }
        assert!(Case::named("mass-ratio").is_some() && Case::named("nothing").is_none());
    }
}
