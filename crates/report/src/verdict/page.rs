//! The verdict as a document: outcome, table of all cases, one part per case.

use super::{Case, Report};
use crate::document::{Block, Cell, Document, Status, Table};
use crate::number::format_number;
use std::collections::BTreeMap;

pub(super) fn render(report: &Report, document: &mut Document) {
    let failed = report.cases.iter().filter(|c| !c.pass).count();
    let total = report.cases.len();
    let text = match (total, failed) {
        (0, _) => "no case was run: nothing is shown".to_owned(),
        (1, 0) => "the one case agrees within its tolerance".to_owned(),
        (_, 0) => format!("all {total} cases agree within their tolerance"),
        _ => format!("{failed} of {total} cases do not agree within their tolerance"),
    };
    document.push(Block::Verdict { status: Status::of(report.pass), text });
    if total == 0 {
        return;
    }
    let recorded = report.cases.iter().filter(|c| !c.live).count();
    if recorded > 0 {
        let text = format!(
            "{recorded} of {total} cases were compared with recorded results of the engine, because the engine did not run \
             here"
        );
        document.push(Block::Verdict { status: Status::Warning, text });
    }
    document.push(Block::heading(2, "Engines"));
    document.push(Block::Table(engines(report)));
    if failed > 0 {
        document.push(Block::heading(2, "Failed cases"));
        document.push(Block::Table(cases(report.cases.iter().filter(|c| !c.pass))));
    }
    document.push(Block::heading(2, "All cases"));
    document.push(Block::paragraph(
        "The difference is the largest over everything compared, divided by the scale of each quantity. A case passes if \
         it is at most its tolerance.",
    ));
    document.push(Block::Table(cases(report.cases.iter())));
    document.push(Block::heading(2, "Case by case"));
    for case in &report.cases {
        document.push(details(case));
    }
}

/// What is told of an engine.
#[derive(Default)]
struct Tally {
    total: usize,
    passed: usize,
    explained: usize,
    largest: f64,
}

/// One row per engine and version, in the order of their first case. Where the causes of a difference are known, the tolerance
/// is what they make: a difference about equal to it is meant. Such a case is counted, and no part of the largest ratio unless
/// it fails.
fn engines(report: &Report) -> Table {
    let mut order: Vec<(&str, &str, bool)> = Vec::new();
    let mut counts: BTreeMap<_, Tally> = BTreeMap::new();
    for case in &report.cases {
        let key = (case.engine.as_str(), case.engine_version.as_str(), case.live);
        if !counts.contains_key(&key) {
            order.push(key);
        }
        let entry = counts.entry(key).or_default();
        entry.total += 1;
        entry.passed += usize::from(case.pass);
        if case.extras.causes.is_empty() || !case.pass {
            entry.largest = larger(entry.largest, share_of_tolerance(case));
        } else {
            entry.explained += 1;
        }
    }
    let mut table = Table::new([
        "engine",
        "version",
        "|result",
        ">cases",
        ">passed",
        ">of these explained by causes",
        ">largest difference / tolerance of the others",
    ]);
    for key in order {
        let Some(Tally { total, passed, explained, largest }) = counts.get(&key) else { continue };
        table.push(vec![
            Cell::text(key.0),
            Cell::text(key.1),
            live(key.2),
            Cell::Text(total.to_string()),
            Cell::Text(passed.to_string()),
            Cell::Text(explained.to_string()),
            Cell::number(*largest),
        ]);
    }
    table
}

/// Difference over tolerance; no difference at all is zero even if the tolerance is.
fn share_of_tolerance(case: &Case) -> f64 {
    if case.max_scaled_difference == 0.0 { 0.0 } else { case.max_scaled_difference / case.tolerance }
}

/// The larger of two numbers, where NaN is larger than any: a failed comparison must show.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a >= b { a } else { b }
}

fn live(live: bool) -> Cell {
    let (status, text) = if live { (Status::Note, "live") } else { (Status::Warning, "recorded") };
    Cell::Badge { status, text: text.to_owned() }
}

fn cases<'a>(cases: impl Iterator<Item = &'a Case>) -> Table {
    let mut table = Table::new([
        "case",
        "engine",
        "quantity",
        ">largest difference",
        ">tolerance",
        "|result",
        "|outcome",
    ]);
    for case in cases {
        table.push(vec![
            Cell::text(&case.name),
            Cell::text(&case.engine),
            Cell::text(&case.quantity),
            Cell::Number { value: case.max_scaled_difference, digits: 2 },
            Cell::Number { value: case.tolerance, digits: 2 },
            live(case.live),
            Cell::badge(Status::of(case.pass)),
        ]);
    }
    table
}

fn details(case: &Case) -> Block {
    let extras = &case.extras;
    let mut blocks = Vec::new();
    if !extras.description.is_empty() {
        blocks.push(Block::paragraph(&extras.description));
    }
    let mut facts = Table::new(["", ""]);
    let mut fact = |name: &str, value: String| {
        if !value.is_empty() {
            facts.push(vec![Cell::text(name), Cell::Text(value)]);
        }
    };
    let source = if case.live { "live" } else { "recorded" };
    fact("compared with", format!("{} {} ({source})", case.engine, case.engine_version));
    fact("largest difference", format_number(case.max_scaled_difference, 3));
    fact("tolerance", format_number(case.tolerance, 3));
    fact("reason for the tolerance", case.reason.clone());
    if let Some(horizon) = &extras.horizon {
        let time = format_number(horizon.time_s, 4);
        let threshold = format_number(horizon.threshold, 2);
        let end =
            if horizon.explanation.is_empty() { String::new() } else { format!(": {}", horizon.explanation) };
        fact("agrees until", format!("step {} (t = {time} s) within {threshold}{end}", horizon.step));
    }
    blocks.push(Block::Table(facts));
    for remark in &extras.remarks {
        blocks.push(Block::Verdict { status: Status::Warning, text: remark.clone() });
    }
    if !extras.causes.is_empty() {
        blocks.push(Block::Table(causes(case)));
    }
    for figure in &extras.plots {
        blocks.push(Block::Plot {
            svg: figure.svg.clone(),
            caption: figure.caption.clone(),
            file: figure.file.clone(),
        });
    }
    blocks.extend(extras.blocks.iter().cloned());
    Block::Details {
        summary: format!("{}, {}: {}", case.name, case.engine, case.quantity),
        status: Some(Status::of(case.pass)),
        open: !case.pass,
        blocks,
    }
}

fn causes(case: &Case) -> Table {
    let mut table = Table::new(["cause of the difference", ">contribution", ">share", "how it was found"]);
    let total = case.max_scaled_difference;
    let share = |part: f64| {
        // Less than is shown is nothing: no `-0.0 %`.
        let percent = (1000.0 * part / total).round() / 10.0 + 0.0;
        Cell::Text(if percent.is_finite() { format!("{percent:.1} %") } else { "-".to_owned() })
    };
    for cause in &case.extras.causes {
        table.push(vec![
            Cell::text(&cause.cause),
            Cell::number(cause.contribution),
            share(cause.contribution),
            Cell::text(&cause.explanation),
        ]);
    }
    let rest = total - case.extras.causes.iter().map(|c| c.contribution).sum::<f64>();
    table.push(vec![Cell::text("not explained"), Cell::number(rest), share(rest)]);
    table
}

#[cfg(test)]
mod tests {
    use super::super::{Cause, Extras, Figure, Horizon};
    use super::*;

    fn sample() -> Report {
        let good = Case::judged("head-on", "position", 2e-15, 1e-12).with_engine("LAMMPS", "2024", true);
        let mut bad =
            Case::judged("oblique", "torque", 0.4, 0.1).with_engine("LIGGGHTS", "3.8", false).because("why");
        bad.extras = Extras {
            description: "Two spheres.".into(),
            causes: vec![Cause {
                cause: "torque arm".into(),
                contribution: 0.3,
                explanation: "switched".into(),
            }],
            horizon: Some(Horizon { step: 70, time_s: 0.07, threshold: 1e-9, explanation: "chaos".into() }),
            plots: vec![Figure {
                svg: "<svg/>".into(),
                caption: "torque".into(),
                file: Some("t.svg".into()),
            }],
            remarks: vec!["look here".into()],
            blocks: vec![Block::code("lammps", "run 10")],
        };
        Report::new(vec![good, bad])
    }

    #[test]
    fn the_page_says_what_failed_and_why() {
        let mut document = Document::new("Validation");
        sample().render(&mut document);
        let markdown = document.to_markdown();
        for wanted in [
            "**FAIL**: 1 of 2 cases do not agree",
            "**WARNING**: 1 of 2 cases were compared with recorded results",
            "| LIGGGHTS | 3.8 | recorded | 1 | 0 | 0 | 4 |",
            "## Failed cases",
            "| head-on | LAMMPS | position | 2.0e-15 | 1.0e-12 | live | pass |",
            "<details><summary>head-on, LAMMPS: position (pass)</summary>",
            "<details open><summary>oblique, LIGGGHTS: torque (FAIL)</summary>",
            "| torque arm | 0.300 | 75.0 % | switched |",
            "| not explained | 0.100 | 25.0 % |  |",
            "step 70 (t = 0.07000 s) within 1.0e-9: chaos",
            "![torque](<t.svg>)",
            "```lammps\nrun 10\n```",
        ] {
            assert!(markdown.contains(wanted), "{wanted}\nnot in\n{markdown}");
        }
        let html = document.to_html();
        assert_eq!(html.matches("<details open=").count(), 1);
    }

    #[test]
    fn the_largest_share_shows_what_could_not_be_compared() {
        assert!(larger(larger(1.0, f64::NAN), 2.0).is_nan());
        assert_eq!(larger(larger(1.0, 3.0), 2.0), 3.0);
        assert_eq!(share_of_tolerance(&Case::judged("a", "x", 0.0, 0.0)), 0.0);
    }

    #[test]
    fn a_green_report_has_no_failures_and_an_empty_one_fails() {
        let mut green = Document::new("V");
        Report::new(vec![sample().cases.swap_remove(0)]).render(&mut green);
        let text = green.to_markdown();
        assert!(
            text.contains("**PASS**: the one case agrees")
                && !text.contains("Failed cases")
                && !text.contains("WARNING")
        );
        let mut empty = Document::new("V");
        Report::default().render(&mut empty);
        assert!(empty.to_markdown().contains("**FAIL**: no case was run"));
    }
}
