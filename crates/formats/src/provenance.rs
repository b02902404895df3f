//! Where a file comes from: written into every output.

use std::fmt;

/// Program, plan and moment behind a file.
///
/// In text it is one line, `granule 0.1.0 plan=0f3a created=1764000000`, which [`Provenance::parse`] finds again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    program_version: String,
    plan_fingerprint: String,
    created: u64,
}

impl Provenance {
    /// `created` is in seconds since 1970-01-01 UTC; the caller passes it in, so that tests and reruns can fix it.
    ///
    /// # Errors
    /// Returns what is wrong when version or fingerprint are empty, longer than 64 characters or contain anything
    /// but ASCII letters, digits and `. _ + : -`: then they need no escaping in any of the formats.
    pub fn new(
        program_version: impl Into<String>,
        plan_fingerprint: impl Into<String>,
        created: u64,
    ) -> Result<Provenance, String> {
        let (program_version, plan_fingerprint) = (program_version.into(), plan_fingerprint.into());
        for (name, value) in [("program version", &program_version), ("plan fingerprint", &plan_fingerprint)]
        {
            if !is_plain(value) {
                return Err(format!(
                    "{name} `{value}` must be 1 to 64 ASCII letters, digits or any of `. _ + : -`"
                ));
            }
        }
        Ok(Provenance { program_version, plan_fingerprint, created })
    }

    /// Version of the program that wrote the file.
    pub fn program_version(&self) -> &str {
        &self.program_version
    }

    /// Fingerprint of the plan that the program ran.
    pub fn plan_fingerprint(&self) -> &str {
        &self.plan_fingerprint
    }

    /// When the run was made, in seconds since 1970-01-01 UTC.
    pub fn created(&self) -> u64 {
        self.created
    }

    /// Finds a provenance in a line of text; `None` if there is none.
    pub fn parse(line: &str) -> Option<Provenance> {
        let mut words = line.split_whitespace().skip_while(|word| *word != "granule").skip(1);
        let version = words.next()?;
        let (mut plan, mut created) = (None, None);
        for word in words {
            match word.split_once('=') {
                Some(("plan", value)) => plan = Some(value),
                Some(("created", value)) => created = value.parse().ok(),
                _ => {}
            }
        }
        Provenance::new(version, plan?, created?).ok()
    }
}

impl fmt::Display for Provenance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "granule {} plan={} created={}", self.program_version, self.plan_fingerprint, self.created)
    }
}

fn is_plain(text: &str) -> bool {
    (1..=64).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"._+:-".contains(&b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn refuses_what_would_need_escaping() {
        for bad in ["", "a b", "<x>", "a\nb", "\"", "é", "a,b", &"x".repeat(65)] {
            assert!(Provenance::new(bad, "ok", 0).is_err(), "{bad:?}");
            assert!(Provenance::new("ok", bad, 0).is_err(), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn survives_a_line_of_text(
            version in "[0-9a-z.+-]{1,20}", plan in "[0-9a-f]{1,64}", created: u64,
            before in "[a-f# :]{0,10}", after in "( time=[0-9]{1,3})?",
        ) {
            let written = Provenance::new(version, plan, created).unwrap();
            prop_assert_eq!(Provenance::parse(&format!("{before} {written}{after}")), Some(written));
        }

        #[test]
        fn never_panics(line in ".{0,200}") {
            let _ = Provenance::parse(&line);
        }
    }
}
