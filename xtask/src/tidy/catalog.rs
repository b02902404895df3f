//! Folders in laws/, the catalog, registrations and pages must name the same laws.

use std::collections::BTreeSet;
use std::path::Path;

use crate::command::Error;
use crate::files;

/// Checks at the level of text, so that nothing has to be built.
pub(super) fn check(root: &Path, all: &[String]) -> Result<Vec<String>, Error> {
    let manifest = files::read(&root.join("laws/catalog/Cargo.toml"))?;
    let library = files::read(&root.join("laws/catalog/src/lib.rs"))?;
    let mut sources = Vec::new();
    for path in all.iter().filter(|path| is_law_source(path)) {
        sources.push((path.clone(), files::read(&root.join(path))?));
    }
    Ok(compare(all, &manifest, &library, &sources))
}

fn is_law_source(path: &str) -> bool {
    path.starts_with("laws/") && path.ends_with(".rs") && !path.starts_with("laws/catalog/")
}

fn compare(all: &[String], manifest: &str, library: &str, sources: &[(String, String)]) -> Vec<String> {
    let mut problems = Vec::new();
    let folders: BTreeSet<&str> = all
        .iter()
        .filter_map(|path| path.strip_prefix("laws/")?.strip_suffix("/Cargo.toml"))
        .filter(|folder| *folder != "catalog" && !folder.contains('/'))
        .collect();
    for folder in &folders {
        let dependency = format!("granule-law-{folder}.workspace = true");
        if !manifest.lines().any(|line| line.trim() == dependency) {
            problems.push(format!("laws/catalog/Cargo.toml: laws/{folder} is missing; add `{dependency}`"));
        }
        let import = format!("use granule_law_{} as _;", folder.replace('-', "_"));
        if !library.lines().any(|line| line.trim() == import) {
            problems.push(format!("laws/catalog/src/lib.rs: laws/{folder} is missing; add `{import}`"));
        }
        let start = format!("laws/{folder}/src/");
        let of_folder = sources.iter().filter(|(path, _)| path.starts_with(&start));
        let registers = |text: &str| REGISTER.iter().any(|call| text.contains(call));
        if !of_folder.into_iter().any(|(_, text)| registers(text)) {
            problems.push(format!("laws/{folder}: registers no law; call `register_law!(MyLaw);` beside it"));
        }
    }
    for line in library.lines().map(str::trim) {
        let linked = line.strip_prefix("use granule_law_").and_then(|rest| rest.strip_suffix(" as _;"));
        if let Some(linked) = linked.map(|name| name.replace('_', "-"))
            && !folders.contains(linked.as_str())
        {
            problems.push(format!(
                "laws/catalog/src/lib.rs: there is no folder laws/{linked}; take the line out"
            ));
        }
    }
    for (path, text) in sources {
        for law in registered(text) {
            if !sources.iter().any(|(_, text)| text.contains(&format!("name: \"{law}\""))) {
                problems.push(format!(
                    "{path}: registers `{law}` under another name; call type and law the same"
                ));
            }
            let page = format!("docs/laws/{law}.md");
            if !all.contains(&page) {
                problems.push(format!("{page}: is missing; run `cargo xtask pages`"));
            }
        }
    }
    problems
}

/// Calls that register a law of a contact, a surface or a collision.
const REGISTER: [&str; 3] = ["register_law!(", "register_substrate_law!(", "register_collision_law!("];

/// Types that a source file registers.
fn registered(text: &str) -> Vec<&str> {
    let calls = text.lines().filter_map(|line| {
        let line = line.trim();
        REGISTER.iter().find_map(|call| line.strip_prefix(call))
    });
    calls.filter_map(|rest| rest.strip_suffix(");")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANIFEST: &str = "granule-law-my-law.workspace = true\n";
    const LIBRARY: &str = "use granule_law_my_law as _;\n";

    fn all() -> Vec<String> {
        ["docs/laws/MyLaw.md", "laws/catalog/Cargo.toml", "laws/my-law/Cargo.toml", "laws/my-law/src/lib.rs"]
            .map(str::to_string)
            .to_vec()
    }

    fn sources(text: &str) -> Vec<(String, String)> {
        vec![("laws/my-law/src/lib.rs".to_string(), text.to_string())]
    }

    const SOURCE: &str = "name: \"MyLaw\",\nregister_law!(MyLaw);\n";

    #[test]
    fn accepts_a_law_that_is_everywhere() {
        assert_eq!(compare(&all(), MANIFEST, LIBRARY, &sources(SOURCE)), Vec::<String>::new());
    }

    #[test]
    fn names_the_place_where_a_law_is_missing() {
        let problem = |all: &[String], manifest, library, source| {
            compare(all, manifest, library, &sources(source)).join("\n")
        };
        assert!(
            problem(&all(), "", LIBRARY, SOURCE).contains("laws/catalog/Cargo.toml: laws/my-law is missing")
        );
        assert!(
            problem(&all(), MANIFEST, "", SOURCE).contains("laws/catalog/src/lib.rs: laws/my-law is missing")
        );
        assert!(problem(&all(), MANIFEST, LIBRARY, "").contains("registers no law"));
        assert!(problem(&all()[1..], MANIFEST, LIBRARY, SOURCE).contains("docs/laws/MyLaw.md: is missing"));
        assert!(
            problem(&all(), MANIFEST, LIBRARY, "register_substrate_law!(MyLaw);")
                .contains("under another name")
        );
        assert!(problem(&all(), MANIFEST, LIBRARY, "register_law!(MyLaw);").contains("under another name"));
        let two = format!("{LIBRARY}use granule_law_gone as _;\n");
        assert!(problem(&all(), MANIFEST, &two, SOURCE).contains("there is no folder laws/gone"));
    }
}
