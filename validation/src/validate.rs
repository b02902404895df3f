//! All cases, and the report.
//!
//! Two kinds of cases are run: folders with a `case.ron` ([`two_bodies`], all at once), and the
//! many-body cases of [`pile::CASES`], one after the other; a new many-body case is a function in that list.

use std::path::{Path, PathBuf};

use granule_report::verdict::{Case as Verdict, Report};
use granule_report::{Block, Cell, Document, Status, Table, format_number};
use rayon::prelude::*;

use crate::peers::{Engine, find_binary};
use crate::translate::Target;
use crate::{cases, pile, two_bodies};

/// What to validate.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the report goes, and what the engines read and write.
    pub out: PathBuf,
    /// Only the cases of these names; all if empty.
    pub only: Vec<String>,
    /// Rewrite the recorded references from the installed engines.
    pub record: bool,
}

/// Runs the cases, prints what they show, writes `report.html`, `report.md` and `report.json`, and returns the verdict.
///
/// # Errors
/// A case cannot be run at all, there is no case of the name asked for, or a report cannot be written.
pub fn validate(options: &Options) -> Result<bool, String> {
    let all = cases::all()?;
    let mut names: Vec<&str> = all.iter().map(|case| case.slug.as_str()).collect();
    names.extend(pile::CASES.iter().map(|(name, _)| *name));
    if let Some(unknown) = options.only.iter().find(|name| !names.contains(&name.as_str())) {
        return Err(format!("there is no case `{unknown}`; there are {}", names.join(", ")));
    }
    let wanted = |name: &str| options.only.is_empty() || options.only.iter().any(|only| only == name);
    let chosen: Vec<_> = all.iter().filter(|case| wanted(&case.slug)).collect();
    let notices = notices();
    for (_, line) in &notices {
        println!("{line}");
    }
    let work = options.out.join("engines");
    let outcomes: Vec<_> = chosen
        .par_iter()
        .map(|case| two_bodies::check(case, &work.join(&case.slug), options.record))
        .collect();
    let mut table = Table::new(["case", ">lammps-classic", ">lammps-granular", ">liggghts", ">physical"]);
    let (mut verdicts, mut left_out) = (Vec::new(), Vec::new());
    for (case, outcome) in chosen.iter().zip(outcomes) {
        let cell = |value: Option<f64>| match value {
            Some(value) => Cell::Number { value, digits: 2 },
            None => Cell::text("-"),
        };
        let mut row = vec![Cell::text(&case.slug)];
        row.extend(outcome.differences.iter().map(|pair| cell(pair.map(|[own, _]| own))));
        let physical = outcome.differences.iter().flatten().map(|[_, physical]| *physical);
        row.push(cell(physical.reduce(f64::max)));
        table.push(row);
        verdicts.extend(outcome.verdicts);
        left_out.extend(outcome.left_out);
    }
    if !chosen.is_empty() {
        println!("\nLargest scaled difference with the conventions of each peer, and with `physical`:\n");
        print!("{}", table.to_text());
    }
    for (name, run) in pile::CASES.iter().filter(|(name, _)| wanted(name)) {
        println!("\n{name} ...");
        let many = run(&work.join(name), options.record).unwrap_or_else(|why| {
            let mut verdict =
                Verdict::judged(*name, "could not be compared", f64::NAN, 0.0).with_engine("none", "", false);
            verdict.extras.remarks.push(why);
            vec![verdict]
        });
        for verdict in &many {
            println!(
                "{}  {} (at most {})  {}: {}",
                if verdict.pass { "pass" } else { "FAIL" },
                format_number(verdict.max_scaled_difference, 3),
                format_number(verdict.tolerance, 2),
                verdict.engine,
                verdict.name,
            );
        }
        verdicts.extend(many);
    }
    let report = Report::new(verdicts);
    write(&report, &notices, table, left_out, &options.out)?;
    println!();
    for verdict in report.cases.iter().filter(|verdict| !verdict.pass) {
        println!(
            "FAIL {}: {}, at most {}: {}",
            verdict.name,
            format_number(verdict.max_scaled_difference, 3),
            format_number(verdict.tolerance, 3),
            verdict.quantity
        );
        for remark in &verdict.extras.remarks {
            println!("     {remark}");
        }
    }
    let failed = report.cases.iter().filter(|case| !case.pass).count();
    println!("{} passed, {failed} failed; {}", report.cases.len() - failed, tally(&report));
    println!("report: {}", options.out.join("report.html").display());
    if let Some((_, line)) = notices.iter().find(|(live, _)| !live) {
        println!("{line}");
    }
    Ok(report.pass)
}

/// Comparisons and largest difference with matching conventions, target by target.
fn tally(report: &Report) -> String {
    let of = |target: Target| {
        let wanted = format!("`{}`", target.preset());
        let matching = report.cases.iter().filter(|case| case.quantity.ends_with(&wanted));
        let sizes: Vec<f64> = matching.map(|case| case.max_scaled_difference).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        format!("{} {} cases at most {largest:.1e}", target.name(), sizes.len())
    };
    Target::ALL.map(of).join(", ")
}

/// Which engines run live, said loudly where they do not.
fn notices() -> Vec<(bool, String)> {
    let state = |engine: Engine| match find_binary(engine) {
        Some(path) => (true, format!("{}: LIVE, {}", two_bodies::title(engine), path.display())),
        None => (
            false,
            format!(
                "{}: NOT INSTALLED (no `{}` in PATH). Its cases are compared with RECORDED answers; `cargo xtask validate \
                 --install` installs it",
                two_bodies::title(engine),
                engine.binary()
            ),
        ),
    };
    [Engine::Lammps, Engine::Liggghts].map(state).into()
}

fn write(
    report: &Report,
    notices: &[(bool, String)],
    table: Table,
    left_out: Vec<String>,
    folder: &Path,
) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut document = Document::new("granule against LAMMPS and LIGGGHTS");
    for (live, line) in notices {
        let status = if *live { Status::Note } else { Status::Warning };
        document.push(Block::Verdict { status, text: line.clone() });
    }
    document.push(Block::paragraph(
        "Each scene is planned by granule, and the inputs of the engines are written from that plan. A difference is the \
         Euclidean norm over the largest value of the quantity in the run of the engine (positions: over the largest \
         diameter), the largest over all compared steps and bodies. Every case is run twice: with the conventions of the \
         engine, where round-off is all that may differ, and with the conventions `physical` of granule, where the \
         difference is what the conventions make, told apart one by one.",
    ));
    if !table.rows.is_empty() {
        document.push(Block::heading(2, "Largest differences"));
        document.push(Block::paragraph(
            "With the conventions of each engine; in the last column with `physical`, the largest over the engines.",
        ));
        document.push(Block::Table(table));
    }
    report.render(&mut document);
    if !left_out.is_empty() {
        document.push(Block::heading(2, "Not compared, and why"));
        document.push(Block::List(left_out));
    }
    let json = report.to_json().map_err(|error| error.to_string())?;
    for (name, text) in
        [("report.json", json), ("report.html", document.to_html()), ("report.md", document.to_markdown())]
    {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}
