//! `cargo xtask`: the project's tasks.

use std::process::ExitCode;

use xtask::command::Error;
use xtask::{bench, ci, figures, files, fuzz, new_law, pages, test, tidy, validate};

const USAGE: &str = "\
cargo xtask <task>

  validate [--install] [--live] [--record] [--case NAME]...
               compare scenes with LAMMPS and LIGGGHTS; report in target/validate
                 --install  install both engines first (apt-get, as root)
                 --live     fail unless both engines are installed
                 --record   rewrite the recorded references from live runs
                 --case     only this case; may be repeated
  test [--all] [NAME]...
               run the tests; --all adds the slow ones; NAME: only tests whose name contains it
  bench [CASE]... [--all] [--list] [--cores N,N] [--pairs N] [--steps N] [--single]
               measure speed, ours and the engines'; results in target/bench
                 CASE     only cases whose name contains this; without, the quick ones
                 --all    every case, the large ones too
                 --list   name the cases
                 --cores  numbers of cores (default: 1 and all)
                 --pairs  rounds of ours and each engine (default 5)
                 --single our laws in single precision
               `bench parts` counts the instructions of a step by source file (needs valgrind), `bench plugin`
               measures what it costs that laws are crates, `bench event` the collisions a second of hard spheres
                 --edmd   folder of the sources of EDMD (github.com/FSmallenburg/EDMD), which then runs in turn
                 --dynamo folder of the program dynarun (github.com/toastedcrumpets/DynamO), likewise
                 --quick  one turn, and no more than 10^5 spheres
  figures NAME [--docs]
               compute the figures of a paper as SVG and CSV with a page, in target/figures; NAME: luding, kondic, segregation
                 --docs   write them into docs/ instead
  atlas [--quick] [--docs]
               compute the stability atlas: maps of every law and integrator as SVG and JSON in target/atlas
                 --quick  the default integrator and every second row only
                 --docs   write docs/atlas.md and its pictures, too
  extremes [NAME]... [--quick] [--docs]
               run the extremes of `granule selftest`, ours and in the engines; table in target/extremes
                 NAME     only these
                 --quick  without those that take long
                 --docs   write docs/extremes.md; needs both engines
  fuzz [TARGET] [--inputs N]
               feed N (default 10^6) random inputs to each fuzz target of tests/tests/fuzz.rs, or to one
  new-law SLOT/NAME [--external DIR]
               write a new law crate: in laws/, or with --external a crate and a program of its own in DIR
  pages        rewrite the generated pages of docs/
  tidy         check the project's rules about its own files
  ci           everything that a change must pass
";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match task(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.code)
        }
    }
}

fn task(words: &[String]) -> Result<(), Error> {
    let root = files::root();
    let Some((name, rest)) = words.split_first() else {
        return Err(Error::usage(format!("which task?\n\n{USAGE}")));
    };
    let alone = || match rest.first() {
        None => Ok(()),
        Some(word) => Err(Error::usage(format!("{name} takes no words, but got `{word}`"))),
    };
    match name.as_str() {
        "validate" => validate::validate(&root, &validate::Options::parse(rest)?),
        "test" => test::test(&root, &test::Options::parse(rest)?),
        "bench" => bench::bench(&root, rest),
        "atlas" => figures::atlas(&root, rest),
        "extremes" => validate::extremes(&root, rest),
        "figures" => figures::figures(&root, rest),
        "fuzz" => fuzz::fuzz(&root, &fuzz::Options::parse(rest)?),
        "new-law" => new_law::new_law(&root, &new_law::Options::parse(rest)?),
        "pages" => alone().and_then(|()| pages::pages(&root)),
        "tidy" => alone().and_then(|()| tidy::tidy(&root)),
        "ci" => alone().and_then(|()| ci::ci(&root)),
        "help" | "--help" | "-h" => {
            println!("{USAGE}");
            Ok(())
        }
        other => Err(Error::usage(format!("there is no task `{other}`\n\n{USAGE}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_explained_and_others_are_refused() {
        for name in xtask::TASKS {
            assert!(USAGE.contains(&format!("\n  {name} ")), "{name}");
        }
        for words in [&[][..], &["figure".to_string()], &["tidy".to_string(), "now".to_string()]] {
            assert_eq!(task(words).unwrap_err().code, 2, "{words:?}");
        }
    }
}
