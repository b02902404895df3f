//! Conformance kit: tests that every law must pass, ours or a stranger's, in one line.
//!
//! ```ignore
//! #[test]
//! fn conforms() {
//!     granule_law_api::testing::conformance::<MyLaw>();
//! }
//! ```
//!
//! Every example of the law is run under every end of contact that it knows, in both precisions:
//!
//! | check | what it demands |
//! |---|---|
//! | `info` | names, documents, sources, forms, columns and history are complete and consistent |
//! | `finite` | finite outputs for overlaps, velocities, masses and radii from denormal to huge |
//! | `parameters` | for parameters at the corners of their ranges, alone and together: a refusal, or outputs that are numbers |
//! | `chunk` | the same bits for a contact alone, among 256 others, and in another order |
//! | `reads` | columns that the law does not declare to read do not change its outputs |
//! | `writes` | only declared columns are written, and they are overwritten |
//! | `history` | history stays as it is when no time passes |
//! | `symmetry` | mirrored and turned frames give mirrored and turned outputs; swapping i and j turns forces around |
//! | `precision` | single precision agrees with double precision |
//! | `energy` | elastic plus dissipated energy is the work done; a law that promises it never creates energy |
//! | `oracle` | duration, largest overlap, restitution and tangential velocity of single impacts |
//! | `time scale` | duration and overlap that the plan is told agree with the oracle |
//!
//! The checks of the stage as a function run under every preset of [`Conventions`].
//! Impacts are integrated under the conventions [`PHYSICAL`](crate::Conventions::PHYSICAL) in the hard limit (Luding
//! 1998, Eqs. (24) and (25)): the normal does not turn. Each result is computed with three step lengths; what is left of the
//! difference after extrapolation is the tolerance.

mod contacts;
mod drive;
mod head_on;
mod info;
mod oblique;
mod parameters;
mod pointwise;
pub mod reference;

use crate::{
    ContactEnd, ContactLaw, Conventions, DurationRule, Impact, LawEntry, NormalSummary, PairContext, Params,
    Slot, TimeScale,
};

pub use contacts::Contacts;

/// One demand that a law does not meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Name of the law.
    pub law: String,
    /// Name of the check, as in the table of this module.
    pub check: &'static str,
    /// Parameters and end of contact under which it failed; empty for checks of the law as a whole.
    pub case: String,
    /// What was found, with the values.
    pub message: String,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: check `{}`", self.law, self.check)?;
        if !self.case.is_empty() {
            write!(f, " with {}", self.case)?;
        }
        write!(f, ": {}", self.message)
    }
}

/// The impact that the kit uses: bodies of a few millimetres, as in many scenes.
pub const IMPACT: Impact = Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: 0.5 };

/// Inertia factor of the bodies in the kit's impacts: solid spheres.
pub const INERTIA_FACTOR: f64 = 0.4;

/// Stiffness of the elastic normal force that the kit puts under tangential laws \[N/m\].
pub const NORMAL_STIFFNESS: f64 = 1e5;

/// Runs every check on a law.
///
/// # Panics
/// If a check fails; the message lists all failures.
pub fn conformance<L: ContactLaw>() {
    let failures = failures(&LawEntry::of::<L>("", ""));
    assert!(
        failures.is_empty(),
        "{} of {} does not conform:\n{}",
        L::INFO.slot.name(),
        L::INFO.name,
        failures.iter().map(|failure| format!("  {failure}\n")).collect::<String>()
    );
}

/// Runs every check and returns what is not met.
pub fn failures(law: &LawEntry) -> Vec<Failure> {
    let mut report = Report { law: law.info.name.to_string(), case: String::new(), failures: Vec::new() };
    info::check(law, &mut report);
    for example in law.info.examples {
        let Ok(params) = Params::new(law.info, example) else {
            continue;
        };
        for pair in contexts(law) {
            report.case = describe(example, pair.contact_end, pair.normal);
            let case = Case { law, params: &params, pair: &pair };
            match ((law.compile_f64)(&params, &pair), (law.compile_f32)(&params, &pair)) {
                (Ok(double), Ok(single)) => {
                    pointwise::check(&case, &*double, &mut report);
                    pointwise::check(&case, &*single, &mut report);
                    pointwise::compare(&case, &*double, &*single, &mut report);
                    under_other_conventions(&case, &mut report);
                    if let Err(fault) = crate::probe::try_out(law, &params, &pair) {
                        report.fail("energy", format!("it {fault}"));
                    }
                    match law.info.slot {
                        Slot::Normal | Slot::Cohesion => head_on::check(&case, &*double, &mut report),
                        Slot::Tangential => {
                            oblique::check(&case, &*double, &mut report);
                            drive::check(&case, &*double, &mut report);
                        }
                        Slot::Rolling | Slot::Torsion | Slot::Collision => report.fail(
                            "oracle",
                            "the kit knows no single-contact problem for this slot".to_string(),
                        ),
                    }
                }
                (Err(error), _) | (_, Err(error)) => {
                    report.fail("info", format!("does not compile: {error}"))
                }
            }
        }
    }
    report.case = String::new();
    parameters::check(law, &mut report);
    report.failures
}

/// The checks of the stage as a function, under the conventions of the peers.
fn under_other_conventions(case: &Case<'_>, report: &mut Report) {
    let plain = report.case.clone();
    for (name, conventions) in Conventions::PRESETS {
        if conventions == case.pair.conventions {
            continue;
        }
        report.case = format!("{plain}, conventions {name}");
        let pair = PairContext { conventions, ..*case.pair };
        let other = Case { pair: &pair, ..*case };
        match ((case.law.compile_f64)(case.params, &pair), (case.law.compile_f32)(case.params, &pair)) {
            (Ok(double), Ok(single)) => {
                pointwise::check(&other, &*double, report);
                pointwise::check(&other, &*single, report);
            }
            (Err(error), _) | (_, Err(error)) => report.fail("info", format!("does not compile: {error}")),
        }
    }
    report.case = plain;
}

/// One example under one context.
struct Case<'a> {
    law: &'a LawEntry,
    params: &'a Params,
    pair: &'a PairContext,
}

struct Report {
    law: String,
    case: String,
    failures: Vec<Failure>,
}

impl Report {
    fn fail(&mut self, check: &'static str, message: String) {
        self.failures.push(Failure { law: self.law.clone(), check, case: self.case.clone(), message });
    }
}

/// Contexts for a law: every end of contact that it knows, and for later slots each way in which a normal law may give
/// its duration.
fn contexts(law: &LawEntry) -> Vec<PairContext> {
    let single =
        PairContext::single(IMPACT.reduced_mass, IMPACT.reduced_radius, INERTIA_FACTOR, IMPACT.normal_speed);
    let ends: &[ContactEnd] =
        if law.info.contact_ends.is_empty() { &[ContactEnd::Force] } else { law.info.contact_ends };
    let duration = normal_duration();
    let scale = TimeScale {
        duration,
        stiffness: NORMAL_STIFFNESS,
        damping: 0.0,
        overlap: IMPACT.normal_speed * duration / std::f64::consts::PI,
    };
    let rules = [DurationRule::Constant(duration), DurationRule::Oscillator(std::f64::consts::PI)];
    let mut contexts = Vec::new();
    for &contact_end in ends {
        if law.info.slot == Slot::Normal {
            contexts.push(PairContext { contact_end, ..single });
        } else {
            contexts.extend(rules.map(|duration| PairContext {
                contact_end,
                normal: Some(NormalSummary { duration, scale: Some(scale) }),
                ..single
            }));
        }
    }
    contexts
}

/// Duration of a contact under the elastic normal force \[s\].
fn normal_duration() -> f64 {
    std::f64::consts::PI * (IMPACT.reduced_mass / NORMAL_STIFFNESS).sqrt()
}

fn describe(example: &[(&str, f64)], end: ContactEnd, normal: Option<NormalSummary>) -> String {
    let values: Vec<String> = example.iter().map(|(name, value)| format!("{name} = {value:?}")).collect();
    let rule = match normal.map(|normal| normal.duration) {
        Some(rule) => format!(", normal duration {rule:?}"),
        None => String::new(),
    };
    format!("({}), contact end {end:?}{rule}", values.join(", "))
}
