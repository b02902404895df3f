//! The project obeys its own rules: who imports whom, what lies where, what a file may hold.

use xtask::files;
use xtask::members::{Member, members};

const LAW_API: &str = "granule-law-api";
const CATALOG: &str = "laws/catalog";

fn all() -> Vec<Member> {
    members(&files::root()).expect("cargo metadata reads the workspace")
}

#[test]
fn every_import_is_in_the_table_of_the_architecture() {
    let problems = xtask::directions::check(&files::root()).unwrap();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_law_imports_the_law_interface_and_nothing_else() {
    let members = all();
    let laws: Vec<&Member> = members
        .iter()
        .filter(|member| member.folder.starts_with("laws/") && member.folder != CATALOG)
        .collect();
    assert!(!laws.is_empty());
    for law in laws {
        let imports: Vec<&str> = law
            .dependencies
            .iter()
            .filter(|import| !import.dev)
            .map(|import| import.package.as_str())
            .collect();
        assert_eq!(imports, [LAW_API], "{}", law.folder);
        for import in law.dependencies.iter().filter(|import| import.ours) {
            assert_eq!(import.package, LAW_API, "{}: its tests know more than the law interface", law.folder);
        }
    }
}

/// Everything below the facade works with whatever laws are linked; only the facade and what tests the whole choose them.
#[test]
fn nothing_below_the_facade_imports_laws() {
    let members = all();
    let laws: Vec<&str> = members
        .iter()
        .filter(|member| member.folder.starts_with("laws/"))
        .map(|member| member.package.as_str())
        .collect();
    for member in members.iter().filter(|member| member.folder != CATALOG) {
        let chooses = member.folder == "crates/granule" || !member.folder.starts_with("crates/");
        for import in member.dependencies.iter().filter(|import| laws.contains(&import.package.as_str())) {
            assert!(chooses, "{} imports {}", member.folder, import.package);
            assert_eq!(
                import.package, "granule-laws",
                "{} names a law; it must go through the catalog",
                member.folder
            );
        }
    }
}

#[test]
fn every_file_obeys_the_rules() {
    let problems = xtask::tidy::problems(&files::root()).unwrap();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
