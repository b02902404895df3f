//! `granule law check`: what the laws of a scene do in a single contact, beside what was asked of them.

use std::fmt::Write as _;
use std::path::Path;

use granule::Allowance;
use granule::prelude::{ContactEnd, LawCheck};

use super::{Exit, show_load_error};
use crate::terminal::{self, HEADING, styled};
use crate::text;

/// Prints requested and realised values for each pair of materials of a scene.
pub fn check(scene: &Path, speed: Option<f64>, allowance: &Allowance) -> Exit {
    let loaded = match granule::load_within(scene, allowance) {
        Ok(loaded) => loaded,
        Err(error) => {
            show_load_error(&error);
            return Exit::Input;
        }
    };
    terminal::diagnostics(&loaded.source, &loaded.warnings);
    let checks = granule::law_check(&loaded.plan, speed);
    if checks.is_empty() {
        let why = if loaded.plan.compositions.is_empty() {
            "there are no contact laws in it"
        } else {
            "its bodies never meet at a known speed; give one with --speed"
        };
        terminal::out(&format!("{}: nothing to check: {why}\n", scene.display()));
        return Exit::Success;
    }
    terminal::out(&checks.iter().map(table).collect::<Vec<_>>().join("\n"));
    Exit::Success
}

fn table(check: &LawCheck) -> String {
    let end = match check.contact_end {
        ContactEnd::Force => "the contact ends with its force",
        ContactEnd::Overlap => "the contact ends with its overlap",
    };
    let show = |value: f64| text::number(text::rounded(value));
    let mut out = format!("{} ({})\n", styled(HEADING, &check.pair), check.laws.join(" + "));
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "  at {} m/s, reduced mass {} kg, reduced radius {} m, inertia factor {}; {end}",
        show(check.impact.normal_speed),
        show(check.impact.reduced_mass),
        show(check.impact.reduced_radius),
        show(check.inertia_factor),
    );
    let _ = writeln!(out, "  {:34}{:>14}{:>14}", "", "requested", "realised");
    let mut row = |name: &str, requested: Option<f64>, realised: Option<f64>, unit: &str| {
        let cell = |value: Option<f64>| match value {
            Some(value) if value.is_finite() => format!("{}{unit}", show(value)),
            Some(_) => "never ends".to_string(),
            None => "-".to_string(),
        };
        let _ = writeln!(out, "  {name:34}{:>14}{:>14}", cell(requested), cell(realised));
    };
    let (requested, realised) = (&check.requested, &check.realised);
    row("restitution e_n", requested.restitution, realised.restitution, "");
    row("tangential restitution e_t0", requested.tangential_restitution, realised.tangential_restitution, "");
    row("contact duration t_c", requested.duration, realised.duration, " s");
    row("maximum overlap", requested.maximum_overlap, realised.maximum_overlap, " m");
    if let Some(friction) = check.friction {
        let _ = writeln!(out, "  {:34}{:>14}{:>14}", "friction mu", show(friction), "-");
    }
    if let Some(speed) = check.requested_at {
        let _ = writeln!(out, "  The restitution is asked for at {} m/s.", show(speed));
    }
    out
}
