//! The laws that are linked are those that the repository holds, under names that are unique, sorted and documented.

use std::collections::BTreeSet;

use granule_law_api::{LawEntry, Registry, RegistryError};
use granule_tests as _;
use granule_tests::pages;

fn registry() -> Registry {
    Registry::collect().expect("names are unique and interface versions agree")
}

#[test]
fn folders_catalog_and_registrations_name_the_same_crates() {
    let root = xtask::files::root();
    let folders: BTreeSet<String> = xtask::files::entries(&root.join("laws"))
        .unwrap()
        .iter()
        .map(|name| name.trim_end_matches('/').to_string())
        .filter(|name| name != "catalog")
        .collect();
    let catalog = std::fs::read_to_string(root.join("laws/catalog/src/lib.rs")).unwrap();
    let linked: BTreeSet<String> = catalog
        .lines()
        .filter_map(|line| line.strip_prefix("use granule_law_")?.strip_suffix(" as _;"))
        .map(|name| name.replace('_', "-"))
        .collect();
    let registry = registry();
    let contact = registry.entries().iter().map(|law| law.crate_name);
    let registered: BTreeSet<String> = contact
        .chain(registry.substrates().iter().map(|law| law.crate_name))
        .chain(registry.collisions().iter().map(|law| law.crate_name))
        .map(|name| name.strip_prefix("granule-law-").unwrap_or(name).to_string())
        .collect();
    assert!(!folders.is_empty());
    assert_eq!(folders, linked, "folders of laws/ and lines of laws/catalog/src/lib.rs");
    assert_eq!(folders, registered, "folders of laws/ and crates that registered a law");
}

#[test]
fn laws_are_sorted_by_name() {
    let registry = registry();
    let names: Vec<&str> = registry.entries().iter().map(|law| law.info.name).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(names, sorted);
}

#[test]
fn order_of_registration_does_not_matter() {
    let registry = registry();
    let backwards = Registry::from_entries(registry.entries().iter().rev().copied()).unwrap();
    let names = |registry: &Registry| registry.entries().iter().map(|law| law.info.name).collect::<Vec<_>>();
    assert_eq!(names(&backwards), names(&registry));
}

#[test]
fn a_name_that_two_crates_register_is_refused_with_both() {
    let registry = registry();
    let first: &'static LawEntry = registry.entries()[0];
    let twin: &'static LawEntry = Box::leak(Box::new(LawEntry { crate_name: "elsewhere", ..copy(first) }));
    let error = Registry::from_entries([first, twin].into_iter()).unwrap_err();
    let RegistryError::Duplicate { name, crates } = &error else { panic!("{error}") };
    assert_eq!(name, first.info.name);
    assert!(crates.contains(&first.crate_name.to_string()) && crates.contains(&"elsewhere".to_string()));
    assert!(error.to_string().contains("registered twice"));
}

#[test]
fn a_law_of_another_interface_version_is_refused() {
    let registry = registry();
    let entry = LawEntry { api_version: granule_law_api::API_VERSION + 1, ..copy(registry.entries()[0]) };
    let error = Registry::from_entries(std::iter::once(&*Box::leak(Box::new(entry)))).unwrap_err();
    assert!(matches!(error, RegistryError::ApiVersion { .. }), "{error}");
}

#[test]
fn a_slip_of_the_pen_gets_a_suggestion() {
    let registry = registry();
    for law in registry.entries() {
        let name = law.info.name;
        let (end, lower) = (&name[..name.len() - 1], name.to_lowercase());
        for slip in [end, lower.as_str()] {
            let RegistryError::Unknown { nearest, known, .. } = registry.get(slip).unwrap_err() else {
                panic!("{slip} is no law")
            };
            assert_eq!(nearest.as_deref(), Some(name));
            assert_eq!(known.len(), registry.entries().len());
        }
    }
    let error = registry.get("zzz").unwrap_err();
    assert!(!error.to_string().contains("did you mean"), "{error}");
}

#[test]
fn substrate_laws_are_found_by_name_and_registered_once() {
    let registry = registry();
    let law = registry.substrate("StickSlip").unwrap();
    assert_eq!(law.crate_name, "granule-law-substrate");
    let RegistryError::Unknown { nearest, .. } = registry.substrate("Stickslip").unwrap_err() else {
        panic!("a slip of the pen is no law")
    };
    assert_eq!(nearest.as_deref(), Some("StickSlip"));
    let twice = Registry::from_entries(std::iter::empty()).unwrap().with_substrates([law, law].into_iter());
    assert!(matches!(twice, Err(RegistryError::Duplicate { .. })));
}

#[test]
fn pages_of_the_documentation_are_current() {
    let registry = registry();
    for (path, text) in pages::pages(&registry) {
        let file = pages::docs().join(&path);
        let found = std::fs::read_to_string(&file).unwrap_or_default();
        assert!(found == text, "docs/{} is not current; run `cargo xtask pages`", path.display());
    }
    assert!(pages::stale(&registry).unwrap().is_empty(), "docs/laws has pages of laws that do not exist");
}

fn copy(entry: &LawEntry) -> LawEntry {
    LawEntry {
        info: entry.info,
        crate_name: entry.crate_name,
        crate_version: entry.crate_version,
        api_version: entry.api_version,
        compile_f64: entry.compile_f64,
        compile_f32: entry.compile_f32,
        time_scale: entry.time_scale,
        summary: entry.summary,
        oracle: entry.oracle,
        reach: entry.reach,
        reads: entry.reads,
        dissipative: entry.dissipative,
    }
}
