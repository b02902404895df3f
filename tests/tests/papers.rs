//! What the papers say is true: the scene of the README runs, its commands exist, and links lead somewhere.

use std::path::Path;

use granule_tests::{advance, bodies, driver_with, plan};
use xtask::files;

const PAPERS: [&str; 5] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "GLOSSARY.md"];

fn paper(name: &str) -> String {
    files::read(&files::root().join(name)).unwrap()
}

/// Blocks of code of a language.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    text.split(fence.as_str()).skip(1).filter_map(|rest| Some(rest.split_once("\n```")?.0)).collect()
}

#[test]
fn the_scene_of_the_readme_runs() {
    let readme = paper("README.md");
    let scenes = blocks(&readme, "ron");
    let [scene] = scenes[..] else { panic!("one scene, but there are {}", scenes.len()) };
    assert_eq!(scene.lines().count(), 10, "the README promises a scene of ten lines");
    let plan = plan(scene);
    assert_eq!(plan.bodies.len(), 500);
    // As the README says, and it must not take long: 0.1 ms over 50 steps.
    assert!((plan.driver.step / 2e-6 - 1.0).abs() < 1e-3, "{}", plan.driver.step);
    let mut driver = driver_with(scene, 2);
    advance(&mut driver, plan.driver.steps);
    let after = bodies(&driver);
    for body in &after {
        let [x, y, z] = body.position;
        // A bead may press into a wall by a few per cent of its radius.
        let inside = |low: f64, value: f64, high: f64| low + 0.7e-3 < value && value < high - 0.7e-3;
        assert!(inside(-8e-3, x, 8e-3) && inside(-8e-3, y, 8e-3) && inside(0.0, z, 50e-3), "{body:?}");
    }
    // The beads fill 500 * 4.2 mm^3 at about 0.6 of the volume over 256 mm^2: 14 mm, so their mean height is half of it.
    let height = after.iter().map(|body| body.position[2]).sum::<f64>() / 500.0;
    assert!((5e-3..9e-3).contains(&height), "{height}");
    // After 0.2 s they rest but for a few: falling 40 mm gives 0.9 m/s.
    let speed = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let mean = after.iter().map(|body| speed(body.velocity)).sum::<f64>() / 500.0;
    assert!(mean < 0.1, "{mean}");
}

/// Every `cargo xtask NAME` that a paper mentions is a task.
#[test]
fn tasks_that_papers_mention_exist() {
    let mut found = 0;
    for name in PAPERS {
        let text = paper(name);
        for rest in text.split("cargo xtask ").skip(1) {
            let task: String = rest.chars().take_while(|c| c.is_ascii_lowercase() || *c == '-').collect();
            assert!(xtask::TASKS.contains(&task.as_str()), "{name}: there is no `cargo xtask {task}`");
            found += 1;
        }
    }
    assert!(found > 10);
}

/// Relative links lead to files, and their anchors to headings.
#[test]
fn links_lead_somewhere() {
    let root = files::root();
    let mut pages: Vec<String> = PAPERS.map(str::to_string).to_vec();
    pages.extend(files::project(&root).unwrap().into_iter().filter(|path| {
        path.ends_with(".md") && (path.starts_with("docs/") || path.starts_with("validation/"))
    }));
    let mut found = 0;
    for page in pages {
        let text = paper(&page);
        let folder = Path::new(&page).parent().unwrap_or(Path::new(""));
        for rest in text.split("](").skip(1) {
            let Some((target, _)) = rest.split_once(')') else { continue };
            if target.contains("://") || target.contains(char::is_whitespace) {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { root.join(&page) } else { root.join(folder).join(file) };
            assert!(path.exists(), "{page}: {target} leads nowhere");
            if !anchor.is_empty() {
                let linked = files::read(&path).unwrap();
                let heading =
                    |line: &str| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
                let known = linked.lines().any(|line| line.starts_with('#') && heading(line) == anchor);
                assert!(known, "{page}: {target} has no such heading");
            }
            found += 1;
        }
    }
    assert!(found > 10);
}
