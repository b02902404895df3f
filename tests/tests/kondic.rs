//! The table of docs/kondic.md names every row of the checklist, and what it names exists.

use granule_tests::pages;

#[test]
fn the_table_of_kondic_1999_is_complete_and_true() {
    let root = xtask::files::root();
    let text = std::fs::read_to_string(pages::docs().join("kondic.md")).unwrap();
    let mut number = 0;
    let mut missing = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("| K")) {
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
        let (file, name) = test.split_once(": ").unwrap_or_else(|| panic!("{line}"));
        let source = std::fs::read_to_string(root.join(file.trim_matches('`')))
            .unwrap_or_else(|error| panic!("{line}: {error}"));
        let function = format!("fn {}(", name.trim_matches('`'));
        let at = source.find(&function).unwrap_or_else(|| panic!("{line}: there is no such test"));
        assert!(source[..at].trim_end().ends_with("#[test]"), "{line}: it is not a test");
    }
    assert_eq!(number, 91);
    assert_eq!(missing, [90], "rows without code are stated here, too");
}
