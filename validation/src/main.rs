//! `granule-validation validate`, `granule-validation bench` and `granule-validation extremes`; usually called by `cargo xtask`.

use std::path::PathBuf;
use std::process::ExitCode;

use granule_validation::{bench, extremes, race, soft, validate};

const USAGE: &str = "usage: granule-validation validate [--out DIR] [--case NAME]... [--record]
       granule-validation bench [CASE]... [--all] [--list] [--cores N,N..] [--pairs N] [--steps N] [--single] [--out DIR]
       granule-validation bench parts|plugin [--pairs N] [--out DIR]
       granule-validation bench accuracy [CONTEST]... [--out DIR]
       granule-validation bench soft|schemes [--out DIR]
       granule-validation extremes [NAME]... [--quick] [--docs]";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let result = match words.first().map(String::as_str) {
        Some("validate") => validate_with(&words[1..]),
        Some("bench") => bench_with(&words[1..]),
        Some("bench-ours") => bench_ours(&words[1..]),
        Some("extremes") => extremes_with(&words[1..]),
        _ => Err(USAGE.to_string()),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn validate_with(words: &[String]) -> Result<bool, String> {
    let mut options =
        validate::Options { out: PathBuf::from("target/validate"), only: Vec::new(), record: false };
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--out" => options.out = PathBuf::from(value(word, words.next())?),
            "--case" => options.only.push(value(word, words.next())?),
            "--record" => options.record = true,
            other => return Err(format!("`{other}` is not an option\n{USAGE}")),
        }
    }
    validate::validate(&options)
}

fn extremes_with(words: &[String]) -> Result<bool, String> {
    let mut options = extremes::Options::default();
    for word in words {
        match word.as_str() {
            "--docs" => options.docs = true,
            "--quick" => options.quick = true,
            option if option.starts_with('-') => return Err(format!("`{option}` is not an option\n{USAGE}")),
            name => options.only.push(name.to_string()),
        }
    }
    extremes::extremes(&options)
}

fn bench_with(words: &[String]) -> Result<bool, String> {
    let mut options = bench::Options::default();
    let mut special = None;
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--out" => options.out = PathBuf::from(value(word, words.next())?),
            "--all" => options.all = true,
            "--single" => options.single = true,
            "--list" => {
                for case in bench::CASES {
                    println!("{}{}", case.name, if case.quick { "" } else { " (--all, or by name)" });
                }
                return Ok(true);
            }
            "--cores" => {
                for count in value(word, words.next())?.split(',') {
                    options.cores.push(number(word, Some(&count.to_string()))?);
                }
            }
            "--pairs" => options.pairs = number(word, words.next())?,
            "--steps" => options.steps = Some(number(word, words.next())? as u64),
            option if option.starts_with('-') => {
                return Err(format!("`{option}` is not an option\n{USAGE}"));
            }
            "parts" | "plugin" | "accuracy" | "soft" | "schemes" => special = Some(word.as_str()),
            name => options.words.push(name.to_string()),
        }
    }
    match special {
        Some("accuracy") => {
            race::race(&race::Options { out: options.out, words: options.words }).map(|_| true)
        }
        Some("soft") => soft::soft(&options.out).map(|_| true),
        Some("schemes") => race::schemes(&options.out).map(|()| true),
        Some("parts") => bench::parts(&options.out).map(|()| true),
        Some(_) => bench::plug_in_cost(&options).map(|result| result.same_bits),
        None => bench::bench(&options).map(|_| true),
    }
}

/// One of our runs, as the benchmark asks its own program for it: a job in JSON, an answer in JSON.
fn bench_ours(words: &[String]) -> Result<bool, String> {
    let [job] = words else { return Err("bench-ours takes one job in JSON".into()) };
    let job = serde_json::from_str(job).map_err(|error| format!("the job: {error}"))?;
    let measured = bench::run(&job)?;
    println!("{}", serde_json::to_string(&measured).map_err(|error| error.to_string())?);
    Ok(true)
}

fn value(option: &str, word: Option<&String>) -> Result<String, String> {
    word.cloned().ok_or_else(|| format!("{option} needs a value\n{USAGE}"))
}

fn number(option: &str, word: Option<&String>) -> Result<usize, String> {
    let text = value(option, word)?;
    text.parse()
        .ok()
        .filter(|number| *number > 0)
        .ok_or_else(|| format!("{option} needs a whole number from 1, not `{text}`"))
}
