//! The table of docs/kondic.md names every row of the checklist, and what it names exists.

use granule_tests::pages;

#[test]
fn the_table_of_kondic_1999_is_complete_and_true() {
    let root = xtask::files::root();
    let text = std::fs::read_to_string(pages::docs().join("kondic.md")).unwrap();
    let mut number = 0;
    let mut missing = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("| K") && !line.starts_with("| K-")) {
        number += 1;
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [row, what, place, test] = cells[..] else { panic!("{line}") };
        assert_eq!(row, format!("K{number}"));
        assert!(!what.is_empty());
        if test == "-" {
            assert!(place.starts_with("out of scope: "), "{line}");
            missing.push(number);
            continue;
        }
        assert!(root.join(place.trim_matches('`')).is_file(), "{line}");
        assert_is_test(&root, test);
    }
    assert_eq!(number, 91);
    assert_eq!(missing, [90], "rows without code are stated here, too");
}

#[test]
fn every_erratum_of_kondic_that_changes_physics_has_its_test() {
    let root = xtask::files::root();
    let text = std::fs::read_to_string(pages::docs().join("kondic.md")).unwrap();
    let mut found = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("| K-E")) {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [row, _, tests] = cells[..] else { panic!("{line}") };
        found.push(row.trim_start_matches("K-E").parse::<u32>().unwrap());
        for test in tests.split(" and ") {
            assert_is_test(&root, test);
        }
    }
    assert_eq!(found, [1, 2, 3, 4, 5, 11, 16, 17, 18, 23, 24, 25, 26, 30, 32, 33, 34]);
}

/// "`file`: `name`" is a test.
fn assert_is_test(root: &std::path::Path, test: &str) {
    let (file, name) = test.split_once(": ").unwrap_or_else(|| panic!("{test}"));
    let source = std::fs::read_to_string(root.join(file.trim_matches('`')))
        .unwrap_or_else(|error| panic!("{test}: {error}"));
    let function = format!("fn {}(", name.trim_matches('`'));
    let at = source.find(&function).unwrap_or_else(|| panic!("{test}: there is no such test"));
    assert!(source[..at].trim_end().ends_with("#[test]"), "{test}: it is not a test");
}
