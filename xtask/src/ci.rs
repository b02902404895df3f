//! `cargo xtask ci`: everything that a change must pass.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::command::{Error, cargo, run};
use crate::{test, tidy, validate};

type Stage<'a> = (&'a str, Box<dyn Fn() -> Result<(), Error> + 'a>);

/// Runs all stages in turn and stops at the first that fails.
///
/// # Errors
/// That of the failing stage.
pub fn ci(root: &Path) -> Result<(), Error> {
    let cargo = |words: &[&str]| {
        let mut command = Command::new(cargo());
        command.args(words).current_dir(root);
        command
    };
    let stages: [Stage<'_>; 5] = [
        ("tidy", Box::new(|| tidy::tidy(root))),
        (
            "clippy",
            Box::new(|| {
                run(&mut cargo(&[
                    "clippy",
                    "--quiet",
                    "--workspace",
                    "--all-targets",
                    "--",
                    "-D",
                    "warnings",
                ]))
            }),
        ),
        (
            "docs",
            Box::new(|| {
                run(cargo(&["doc", "--quiet", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
            }),
        ),
        ("tests", Box::new(|| test::test(root, &test::Options { all: true, names: Vec::new() }))),
        (
            "validation",
            Box::new(|| {
                let options = validate::Options { live: true, ..validate::Options::default() };
                validate::validate(root, &options)
            }),
        ),
    ];
    let mut times = Vec::new();
    for (name, stage) in &stages {
        println!("== {name}");
        let begin = Instant::now();
        stage()?;
        times.push(format!("{name} {:.0} s", begin.elapsed().as_secs_f64()));
    }
    println!("ci: passed ({})", times.join(", "));
    Ok(())
}
