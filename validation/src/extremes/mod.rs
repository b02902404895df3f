//! The extremes of `granule selftest` beside what LAMMPS and LIGGGHTS do with them: `docs/extremes.md`.
//!
//! A [`Trial`] is an extreme in a scene that the engines can be told. What our own plan refuses (a NaN, a step without bound)
//! is told them nevertheless, by a change of their inputs after they were written.

mod judge;
mod page;
mod peers;
mod trials;
mod wild;

use std::path::Path;

use granule_extremes::{Lab, cases};

pub use peers::{Answer, Class};

use crate::peers::{Engine, Frame, InputFiles, PeerScene};

/// An extreme as the engines are told it.
pub struct Trial {
    /// Name of the extreme in `granule_extremes`.
    pub case: &'static str,
    /// Title and scenes: a scene in our format and what is changed of it for the engines.
    pub scenes: fn() -> Vec<(String, Change)>,
    /// What a right engine does.
    pub right: Right,
}

/// How a scene is changed for the engines beyond what a plan of ours may hold.
#[derive(Default)]
pub struct Change {
    /// Before the inputs are written.
    pub scene: Option<fn(&mut PeerScene)>,
    /// In the written inputs.
    pub files: Option<fn(&mut InputFiles)>,
}

/// What a right engine does.
pub enum Right {
    /// Refuses the scene, or stops with a reason.
    Refuses,
    /// Refuses the scene, or ends with nothing done.
    Ends,
    /// Says that something is wrong with it.
    Warns,
    /// Gives this end: what was found, or what is wrong with it.
    Gives(fn(&PeerScene, &[Frame]) -> Result<String, String>),
}

/// A row of the table.
pub struct Row {
    /// Name of the case.
    pub name: &'static str,
    /// What is extreme.
    pub extreme: &'static str,
    /// What must happen.
    pub expected: &'static str,
    /// What happened with us.
    pub ours: Result<String, String>,
    /// What LAMMPS and LIGGGHTS do.
    pub peers: [Answer; 2],
}

/// What is asked for on the command line.
#[derive(Default)]
pub struct Options {
    /// Only these cases.
    pub only: Vec<String>,
    /// Write `docs/extremes.md`.
    pub docs: bool,
    /// Without the cases that take long.
    pub quick: bool,
}

/// Runs all extremes, ours and the engines', and writes the table. `false` if one of ours is wrong.
///
/// # Errors
/// A name is unknown, the table cannot be written, or `docs` is asked for without both engines or all cases.
pub fn extremes(options: &Options) -> Result<bool, String> {
    if let Some(unknown) = options.only.iter().find(|name| cases().all(|case| case.name != name.as_str())) {
        return Err(format!("there is no extreme `{unknown}`"));
    }
    let engines = [Engine::Lammps, Engine::Liggghts];
    if options.docs {
        if !options.only.is_empty() || options.quick {
            return Err("the page shows all extremes: --docs goes with no name and not with --quick".into());
        }
        if let Some(missing) = engines.into_iter().find(|engine| crate::peers::find_binary(*engine).is_none())
        {
            return Err(format!("the page needs both engines, and {} is not installed", missing.name()));
        }
    }
    let lab = Lab::new().map_err(|error| error.to_string())?;
    let folder = Path::new("target/extremes");
    let mut rows = Vec::new();
    let chosen = |name: &str, slow: bool| {
        if options.only.is_empty() {
            !(slow && options.quick)
        } else {
            options.only.iter().any(|wanted| wanted == name)
        }
    };
    for case in cases().filter(|case| chosen(case.name, case.slow)) {
        let ours = (case.check)(&lab);
        let peers = engines.map(|engine| peers::answer(case.name, engine, &folder.join(case.name)));
        println!("{}", page::line(case.name, &ours, &peers));
        rows.push(Row { name: case.name, extreme: case.extreme, expected: case.expected, ours, peers });
    }
    let page = page::page(&rows);
    let path = if options.docs { Path::new("docs/extremes.md") } else { &folder.join("extremes.md") };
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(path, page))
        .map_err(|error| format!("{}: {error}", path.display()))?;
    println!("{}", path.display());
    Ok(rows.iter().all(|row| row.ours.is_ok()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ours::plan_text;
    use crate::translate::{Target, translate};

    /// A trial of a case that is gone, or one that no engine can be told, would be an empty place in the table.
    #[test]
    fn every_trial_is_of_a_case_and_can_be_told() {
        for trial in trials::all() {
            assert!(cases().any(|case| case.name == trial.case), "{}", trial.case);
            for (text, _) in (trial.scenes)() {
                let plan = plan_text(&text).unwrap_or_else(|why| panic!("{}: {why}", trial.case));
                for engine in [Engine::Lammps, Engine::Liggghts] {
                    let targets = Target::ALL.into_iter().filter(|target| target.engine() == engine);
                    let told: Vec<bool> = targets.map(|target| translate(&plan, target).is_ok()).collect();
                    assert!(told.contains(&true), "{}: {}", trial.case, engine.name());
                }
            }
        }
    }
}
