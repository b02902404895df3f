//! Scenes: each bad one says what is wrong and where, each good one is planned as it says, and no text makes anything
//! panic.

use std::fs;
use std::path::{Path, PathBuf};

use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::Plan;
use granule_scene::Diagnostic;
use proptest::prelude::*;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// Name and text of all scenes of a folder, by name.
fn scenes(name: &str) -> Vec<(String, String)> {
    let mut scenes: Vec<(String, String)> = fs::read_dir(folder(name))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| {
            (path.file_stem().unwrap().to_string_lossy().into_owned(), fs::read_to_string(&path).unwrap())
        })
        .collect();
    scenes.sort();
    scenes
}

fn plan(text: &str, base: &Path) -> (Option<Plan>, Vec<Diagnostic>) {
    let registry = Registry::collect().unwrap();
    let parsed = granule_scene::parse(text);
    let mut diagnostics = parsed.diagnostics;
    let plan = parsed.scene.and_then(|scene| {
        let (plan, more) = granule_plan::build(&scene, &registry, base);
        diagnostics.extend(more);
        plan
    });
    granule_scene::tidy(&mut diagnostics);
    (plan, diagnostics)
}

/// Lines of a scene that begin with `// tag: `.
fn marked<'a>(text: &'a str, tag: &str) -> Vec<&'a str> {
    let start = format!("// {tag}: ");
    text.lines().filter_map(|line| line.strip_prefix(start.as_str())).collect()
}

fn lines(diagnostics: &[Diagnostic], text: &str) -> Vec<String> {
    diagnostics
        .iter()
        .map(|diagnostic| {
            let (line, column) = diagnostic.position(text);
            format!("{line}:{column}: {}: {}", diagnostic.severity.name(), diagnostic.message)
        })
        .collect()
}

#[test]
fn bad_scenes_say_what_is_wrong() {
    let scenes = scenes("bad");
    assert!(scenes.len() >= 30, "only {} bad scenes", scenes.len());
    let mut wrong = Vec::new();
    for (name, text) in &scenes {
        let (plan, diagnostics) = plan(text, &folder("bad"));
        let (expected, found) = (marked(text, "expect"), lines(&diagnostics, text));
        if plan.is_some() || expected.is_empty() || expected != found {
            wrong.push(format!("{name}.ron, planned: {}\n{}", plan.is_some(), found.join("\n")));
        }
        for diagnostic in &diagnostics {
            let shown = diagnostic.render(name, text);
            assert!(shown.contains(&diagnostic.message) && shown.contains('^'), "{shown}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn good_scenes_are_planned_as_they_say() {
    let scenes = scenes("good");
    assert!(scenes.len() >= 8, "only {} good scenes", scenes.len());
    let mut wrong = Vec::new();
    for (name, text) in &scenes {
        let (plan, diagnostics) = plan(text, &folder("good"));
        let (expected, found) = (marked(text, "expect"), lines(&diagnostics, text));
        let Some(plan) = plan else {
            wrong.push(format!("{name}.ron:\n{}", found.join("\n")));
            continue;
        };
        if expected != found {
            wrong.push(format!("{name}.ron:\n{}", found.join("\n")));
        }
        let explained = granule_plan::explain(&plan);
        let wanted = marked(text, "explain");
        assert!(!wanted.is_empty(), "{name}.ron states nothing about its plan");
        let missing: Vec<&str> = wanted
            .into_iter()
            .filter(|wanted| !explained.lines().any(|line| line.trim() == wanted.trim()))
            .collect();
        if !missing.is_empty() {
            wrong.push(format!("{name}.ron lacks\n{}\nin\n{explained}", missing.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn the_same_scene_has_the_same_fingerprint() {
    for (name, text) in scenes("good") {
        let print = || plan(&text, &folder("good")).0.unwrap().fingerprint;
        let first = print();
        assert_eq!(first.len(), 32, "{name}");
        assert_eq!(first, print(), "{name}");
    }
}

/// Pieces of a scene: words, numbers, texts, and single signs.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        let mut token = c.to_string();
        if c == '"' {
            for c in chars.by_ref() {
                token.push(c);
                if c == '"' {
                    break;
                }
            }
        } else if c.is_alphanumeric() {
            while let Some(c) = chars.next_if(|c| c.is_alphanumeric() || matches!(c, '_' | '.')) {
                token.push(c);
            }
        }
        tokens.push(token);
    }
    tokens
}

/// What mutations put in: values at the edge of what is allowed, brackets that do not match, names that exist elsewhere.
const SPICE: [&str; 34] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "\"",
    "'",
    "//",
    "/*",
    "*/",
    "r#\"",
    "#",
    "-",
    "inf",
    "NaN",
    "1e308",
    "-1e-300",
    "0",
    "1",
    "7",
    "65536",
    "4294967295",
    "\"1 mm\"",
    "\"glass\"",
    "()",
    "Some(1)",
    "None",
    "true",
    "ä",
    "\0",
    "radius",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn no_text_makes_anything_panic(
        scene in any::<prop::sample::Index>(),
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), 0u8..5, any::<prop::sample::Index>()),
            1..6,
        ),
    ) {
        let all: Vec<(String, String)> = scenes("good").into_iter().chain(scenes("bad")).collect();
        let (_, text) = scene.get(&all);
        let mut tokens = tokens(text);
        for (place, kind, other) in &changes {
            if tokens.is_empty() {
                break;
            }
            let at = place.index(tokens.len());
            match kind {
                0 => {
                    tokens.remove(at);
                }
                1 => tokens.insert(at, other.get(&SPICE).to_string()),
                2 => tokens[at] = other.get(&SPICE).to_string(),
                3 => {
                    let with = other.index(tokens.len());
                    tokens.swap(at, with);
                }
                _ => {
                    let copied = tokens[other.index(tokens.len())].clone();
                    tokens.insert(at, copied);
                }
            }
        }
        let mutated = tokens.concat();
        let (plan, diagnostics) = plan(&mutated, &folder("good"));
        prop_assert!(plan.is_some() || !diagnostics.is_empty(), "no plan and no reason:\n{mutated}");
        for diagnostic in &diagnostics {
            prop_assert!(diagnostic.span.end <= mutated.len());
            prop_assert!(!diagnostic.render("scene.ron", &mutated).is_empty());
        }
        if let Some(plan) = plan {
            prop_assert!(!granule_plan::explain(&plan).is_empty());
        }
    }

    #[test]
    fn neither_does_rubbish(text in "\\PC{0,200}") {
        let (plan, diagnostics) = plan(&text, Path::new("."));
        prop_assert!(plan.is_none() && !diagnostics.is_empty());
    }
}
