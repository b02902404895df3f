//! Where the instructions of a step go, counted by callgrind: the same on every quiet or noisy machine.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use granule_report::{Block, Cell, Document, Table};

use super::Scratch;
use super::cases::CASES;
use super::child::Job;
use super::states;

/// The cases that are counted, small ones: valgrind is fifty times slower than the processor.
const COUNTED: [&str; 3] = ["settled-10k-hooke", "settled-10k-hertz", "settled-10k-frictionless"];

/// Steps of the shorter and of the longer run; what they have in common (reading, planning, the first lists) cancels.
const STEPS: [u64; 2] = [10, 40];

/// Counts the parts of a step, prints a table, and writes `parts.md` and `parts.html` into a folder.
///
/// # Errors
/// valgrind is not installed or fails, or a file cannot be read or written.
pub fn parts(out: &Path) -> Result<(), String> {
    let scratch = Scratch::of(out)?;
    let mut columns: Vec<BTreeMap<String, f64>> = Vec::new();
    for name in COUNTED {
        let case = CASES.iter().find(|case| case.name == name).ok_or_else(|| format!("no case {name}"))?;
        let base = states::prepare(case.recipe, case.copies, &scratch.states)?;
        let scene = states::scenes().join(case.scene).join("scene.ron");
        let job = |steps| Job {
            scene: scene.clone(),
            base: base.clone(),
            copies: case.copies,
            single: false,
            cores: 1,
            warm_up: 1,
            steps,
            vtp: false,
        };
        let n = job(1).scene()?.plan()?.bodies.len() as f64;
        let [short, long] = STEPS.map(|steps| count(&scratch, &job(steps)));
        let (short, long) = (short?, long?);
        let between = |file: &String, long: &u64| {
            let spent = *long as f64 - short.get(file).copied().unwrap_or(0) as f64;
            (file.clone(), spent / (n * (STEPS[1] - STEPS[0]) as f64))
        };
        columns.push(long.iter().map(|(file, count)| between(file, count)).collect());
    }
    let document = document(&columns);
    std::fs::create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
    let text = document.to_markdown();
    println!("{text}");
    for (name, text) in [("parts.md", text), ("parts.html", document.to_html())] {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn document(columns: &[BTreeMap<String, f64>]) -> Document {
    /// Parts below this many instructions in every case are not listed one by one.
    const LEAST: f64 = 0.5;
    let mut files: Vec<&String> = columns.iter().flat_map(BTreeMap::keys).collect();
    files.sort();
    files.dedup();
    let spent = |file: &str, column: &BTreeMap<String, f64>| column.get(file).copied().unwrap_or(0.0);
    let most = |file: &str| columns.iter().map(|column| spent(file, column)).fold(0.0, f64::max);
    files.sort_by(|a, b| most(b).total_cmp(&most(a)));
    let heads: Vec<String> = COUNTED.iter().map(|name| format!(">{name}")).collect();
    let mut table = Table::new(std::iter::once("source").chain(heads.iter().map(String::as_str)));
    let row = |name: &str, values: Vec<f64>| {
        let numbers = values.into_iter().map(|value| Cell::text(format!("{value:.1}")));
        std::iter::once(Cell::text(name)).chain(numbers).collect::<Vec<_>>()
    };
    let (listed, rest): (Vec<&String>, Vec<&String>) =
        files.into_iter().partition(|file| most(file) >= LEAST);
    for file in listed {
        table.push(row(&format!("`{file}`"), columns.iter().map(|column| spent(file, column)).collect()));
    }
    let rest = |column: &BTreeMap<String, f64>| rest.iter().map(|file| spent(file, column)).sum();
    table.push(row("all others", columns.iter().map(rest).collect()));
    table.push(row("a step", columns.iter().map(|column| column.values().sum()).collect()));
    let mut document = Document { title: "Instructions of a step".into(), blocks: Vec::new() };
    document.push(Block::Paragraph(format!(
        "Instructions a body and step by source file, code that is inlined counted where it was written; what the standard \
         library does is counted where it is called from. Difference of runs of {} and {} steps under callgrind, which has \
         AVX2 but not AVX-512.",
        STEPS[0], STEPS[1]
    )));
    document.push(Block::Table(table));
    document
}

/// Instructions by source.
fn count(scratch: &Scratch, job: &Job) -> Result<BTreeMap<String, u64>, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let raw = folder.path().join("callgrind.out");
    let words = serde_json::to_string(job).map_err(|error| error.to_string())?;
    let mut valgrind = Command::new("valgrind");
    valgrind.arg("--tool=callgrind").arg(format!("--callgrind-out-file={}", raw.display()));
    finish(valgrind.arg(&scratch.program).args(["bench-ours", &words]))?;
    let listing =
        finish(Command::new("callgrind_annotate").args(["--threshold=100", "--auto=no"]).arg(&raw))?;
    Ok(by_source(&listing))
}

/// Standard output of a program that has to end well.
fn finish(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| {
        format!("{name}: {error}; counting instructions takes valgrind (on Debian: apt-get install valgrind)")
    })?;
    if !output.status.success() {
        return Err(format!(
            "{name}: {}",
            crate::peers::last_lines(&String::from_utf8_lossy(&output.stderr))
        ));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Sums the lines `   1,234 ( 5.00%)  file:function [object]` of callgrind_annotate.
fn by_source(listing: &str) -> BTreeMap<String, u64> {
    let mut sums = BTreeMap::new();
    for line in listing.lines() {
        let Some((count, place)) = line.split_once(") ").and_then(|(count, place)| {
            let digits: String = count.split_once('(')?.0.chars().filter(char::is_ascii_digit).collect();
            Some((digits.parse::<u64>().ok()?, place.trim()))
        }) else {
            continue;
        };
        if place.starts_with("PROGRAM TOTALS") {
            continue;
        }
        *sums.entry(source(place)).or_default() += count;
    }
    sums
}

/// `file:function [object]` to one of our files, or else to the crate of ours whose function it is inlined into.
fn source(place: &str) -> String {
    let place = place.split(" [").next().unwrap_or(place);
    let (file, function) = place.split_once(".rs:").map_or(("", place), |(file, function)| (file, function));
    let ours = ["crates/", "laws/"].iter().filter_map(|folder| file.rfind(folder)).min();
    if let Some(start) = ours
        && !file.starts_with("/rustc/")
        && !file.contains("/registry/")
    {
        return format!("{}.rs", &file[start..]);
    }
    match function.find("granule_").map(|start| &function[start..]) {
        Some(path) => {
            let end = path
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == ':'))
                .unwrap_or(path.len());
            let modules: Vec<&str> = path[..end].split("::").take(2).collect();
            format!("standard library in {}", modules.join("::"))
        }
        None => "system and standard library".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_go_to_the_file_that_they_were_written_in() {
        let listing = "\
611,550,545 (100.0%)  PROGRAM TOTALS
94,987,055 (15.53%)  crates/engine/src/gather.rs:granule_engine::dispatch::evaluate_avx2
 1,000 ( 0.00%)  /somewhere/crates/engine/src/gather.rs:granule_engine::dispatch::evaluate_avx2 [/x/y]
16,993,415 ( 2.78%)  /rustc/5980/library/core/src/slice/index.rs:granule_engine::dispatch::evaluate_avx2
39,652,731 ( 6.48%)  ./string/memset.S:__memset_avx2_unaligned_erms [/usr/lib/libc.so.6]
 8,145,408 ( 1.33%)  laws/tangential-spring/src/stage.rs:granule_law_api::dispatch::run_avx2
 2,520,864 ( 0.41%)  /rustc/5980/library/core/src/../../stdarch/crates/core_arch/src/x86/sse.rs:<granule_state::row::Row>::x
";
        let sums = by_source(listing);
        assert_eq!(sums["crates/engine/src/gather.rs"], 94_988_055);
        assert_eq!(sums["laws/tangential-spring/src/stage.rs"], 8_145_408);
        assert_eq!(sums["standard library in granule_engine::dispatch"], 16_993_415);
        assert_eq!(sums["standard library in granule_state::row"], 2_520_864);
        assert_eq!(sums["system and standard library"], 39_652_731);
        assert_eq!(sums.len(), 5);
    }
}
