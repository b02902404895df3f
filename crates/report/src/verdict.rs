//! The verdict of a validation: cases against other engines or exact results, as JSON for machines and as a document for
//! people.
//!
//! The JSON is `{"cases": [{"name", "engine", "engine_version", "live", "quantity", "max_scaled_difference",
//! "tolerance", "reason", "pass"}], "pass"}` and nothing else. A difference that is not finite is written as `null`,
//! because JSON has no number for it; such a case never passes.

mod page;

use crate::ReportError;
use crate::document::{Block, Document};
use serde::{Deserialize, Serialize};

/// One comparison of one quantity with one engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the case, such as `two-sphere-oblique`.
    pub name: String,
    /// What it is compared with, such as `LAMMPS`, `LIGGGHTS` or `exact`.
    pub engine: String,
    /// Its version as its banner says.
    pub engine_version: String,
    /// The engine ran now; otherwise its recorded result was used.
    pub live: bool,
    /// What is compared, such as `position, velocity, force of every step`.
    pub quantity: String,
    /// Largest difference in units of the quantity's scale. NaN if nothing could be compared.
    #[serde(with = "null_if_not_finite")]
    pub max_scaled_difference: f64,
    /// Largest difference that passes.
    pub tolerance: f64,
    /// Why the tolerance is what it is.
    pub reason: String,
    /// The outcome.
    pub pass: bool,
    /// What the page shows beyond this.
    #[serde(skip)]
    pub extras: Extras,
}

/// What the page says about a case and the JSON does not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// One sentence on what happens in the case.
    pub description: String,
    /// How much of the difference each known cause makes.
    pub causes: Vec<Cause>,
    /// Until when trajectories agree, for chaotic cases.
    pub horizon: Option<Horizon>,
    /// Figures.
    pub plots: Vec<Figure>,
    /// Remarks, one sentence each. They are shown as warnings.
    pub remarks: Vec<String>,
    /// More to show below, such as inputs and commands.
    pub blocks: Vec<Block>,
}

/// One known cause of a difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// What differs, such as `torque arm R instead of R - overlap/2`.
    pub cause: String,
    /// The scaled difference that remains if this cause alone is taken out is smaller by this much.
    pub contribution: f64,
    /// How it was found; may be empty.
    pub explanation: String,
}

/// The step up to which two trajectories agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Horizon {
    /// The last step that agrees.
    pub step: u64,
    /// Its time in seconds.
    pub time_s: f64,
    /// Scaled difference up to which it counts as agreeing.
    pub threshold: f64,
    /// What ends it; may be empty.
    pub explanation: String,
}

/// A figure of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// SVG of this crate.
    pub svg: String,
    /// Text below it.
    pub caption: String,
    /// Where it lies as a file, relative to the report.
    pub file: Option<String>,
}

/// All cases and the verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// The cases in the order of the report.
    pub cases: Vec<Case>,
    /// All cases pass, and there is at least one.
    pub pass: bool,
}

impl Case {
    /// A case judged by its numbers: it passes if the difference is at most the tolerance. NaN never passes.
    #[must_use]
    pub fn judged(
        name: impl Into<String>,
        quantity: impl Into<String>,
        difference: f64,
        tolerance: f64,
    ) -> Self {
        Self {
            name: name.into(),
            engine: String::new(),
            engine_version: String::new(),
            live: false,
            quantity: quantity.into(),
            max_scaled_difference: difference,
            tolerance,
            reason: String::new(),
            pass: difference <= tolerance && difference.is_finite(),
            extras: Extras::default(),
        }
    }

    /// The same case with its engine, the version that the engine's banner says, and whether it ran now.
    #[must_use]
    pub fn with_engine(mut self, engine: impl Into<String>, version: impl Into<String>, live: bool) -> Self {
        (self.engine, self.engine_version, self.live) = (engine.into(), version.into(), live);
        self
    }

    /// The same case with the reason for its tolerance.
    #[must_use]
    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = reason.into();
        self
    }

    /// Share of the difference that the causes account for, if there are any and there is a difference.
    #[must_use]
    pub fn explained(&self) -> Option<f64> {
        let sum: f64 = self.extras.causes.iter().map(|c| c.contribution).sum();
        let usable = !self.extras.causes.is_empty() && self.max_scaled_difference > 0.0;
        let share = sum / self.max_scaled_difference;
        (usable && share.is_finite()).then_some(share)
    }
}

impl Report {
    /// The report of these cases. No case at all is a failure: nothing was shown.
    #[must_use]
    pub fn new(cases: Vec<Case>) -> Self {
        let pass = !cases.is_empty() && cases.iter().all(|c| c.pass);
        Self { cases, pass }
    }

    /// The verdict as indented JSON, ending with a newline.
    ///
    /// # Errors
    /// A tolerance that is not finite, a case marked as passed with a difference over its tolerance or not finite, or a
    /// verdict that its cases do not bear.
    pub fn to_json(&self) -> Result<String, ReportError> {
        self.check()?;
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads a verdict.
    ///
    /// # Errors
    /// Text that is not this JSON, or that contradicts itself as told at [`Report::to_json`].
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        let report: Self = serde_json::from_str(text)?;
        report.check()?;
        Ok(report)
    }

    fn check(&self) -> Result<(), ReportError> {
        for case in &self.cases {
            let title = || format!("case `{}` ({}, {})", case.name, case.engine, case.quantity);
            if !case.tolerance.is_finite() {
                return Err(ReportError::Invalid(format!(
                    "{}: tolerance {} is not finite",
                    title(),
                    case.tolerance
                )));
            }
            let within =
                case.max_scaled_difference <= case.tolerance && case.max_scaled_difference.is_finite();
            if case.pass && !within {
                return Err(ReportError::Invalid(format!(
                    "{}: passes with a difference of {} over its tolerance of {}",
                    title(),
                    case.max_scaled_difference,
                    case.tolerance
                )));
            }
        }
        let pass = !self.cases.is_empty() && self.cases.iter().all(|c| c.pass);
        if self.pass != pass {
            return Err(ReportError::Invalid(format!(
                "the verdict is {} but the cases say {pass}",
                self.pass
            )));
        }
        Ok(())
    }

    /// Appends the verdict, the table of all cases and a part for each case to a document.
    pub fn render(&self, document: &mut Document) {
        page::render(self, document);
    }
}

/// JSON has no NaN and no infinity.
mod null_if_not_finite {
    use serde::{Deserialize as _, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { serializer.serialize_f64(*value) } else { serializer.serialize_none() }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case() -> Case {
        Case::judged("head-on", "position", 3.5e-16, 1e-12)
            .with_engine("LAMMPS", "29 Aug 2024", true)
            .because("round-off of 4000 steps")
    }

    #[test]
    fn the_json_has_exactly_the_promised_fields() {
        let mut full = case();
        full.extras.remarks.push("not in the JSON".into());
        let json = Report::new(vec![full]).to_json().unwrap();
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        let wanted = serde_json::json!({"cases": [{
            "name": "head-on", "engine": "LAMMPS", "engine_version": "29 Aug 2024", "live": true,
            "quantity": "position", "max_scaled_difference": 3.5e-16, "tolerance": 1e-12,
            "reason": "round-off of 4000 steps", "pass": true
        }], "pass": true});
        assert_eq!(value, wanted);
        let order: Vec<usize> =
            ["name", "engine", "engine_version", "live", "quantity", "max_scaled", "tolerance"]
                .iter()
                .map(|key| json.find(&format!("\"{key}")).unwrap())
                .collect();
        assert!(order.is_sorted());
        assert_eq!(Report::from_json(&json).unwrap(), Report::new(vec![case()]));
    }

    #[test]
    fn nothing_shown_and_nothing_finite_are_failures() {
        assert!(!Report::new(vec![]).pass);
        for difference in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e-12] {
            assert!(!Case::judged("a", "x", difference, 1e-12).pass, "{difference}");
        }
        assert!(Case::judged("a", "x", 1e-12, 1e-12).pass);
        let json = Report::new(vec![Case::judged("a", "x", f64::NAN, 1.0)]).to_json().unwrap();
        assert!(json.contains("\"max_scaled_difference\": null"));
        let back = Report::from_json(&json).unwrap();
        assert!(back.cases[0].max_scaled_difference.is_nan() && !back.pass);
    }

    #[test]
    fn contradictions_are_refused() {
        let message = |r: &Report| r.to_json().unwrap_err().to_string();
        let mut report = Report::new(vec![case()]);
        report.cases[0].max_scaled_difference = 1.0;
        assert!(message(&report).contains("passes with a difference of 1 over"));
        report.cases[0].pass = false;
        assert_eq!(message(&report), "the verdict is true but the cases say false");
        report.pass = false;
        assert!(report.to_json().is_ok(), "a case may fail for a reason beyond its number");
        report.cases[0].tolerance = f64::INFINITY;
        assert!(message(&report).contains("tolerance inf is not finite"));
        assert!(Report::from_json("{\"cases\": [], \"pass\": true}").is_err());
    }

    #[test]
    fn causes_add_up_to_a_share() {
        let mut case = Case::judged("a", "x", 4.0, 10.0);
        assert_eq!(case.explained(), None);
        let cause = |contribution| Cause { cause: "c".into(), contribution, explanation: String::new() };
        case.extras.causes = vec![cause(1.0), cause(2.0)];
        assert_eq!(case.explained(), Some(0.75));
        case.max_scaled_difference = 0.0;
        assert_eq!(case.explained(), None);
    }
}
