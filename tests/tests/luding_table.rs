//! docs/luding.md names files and tests that exist.

use xtask::files;

/// Cells of the rows of a table whose first cell is `L` and a number.
fn rows(text: &str) -> Vec<[String; 4]> {
    let is_row = |line: &&str| {
        line.strip_prefix("| L").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    text.lines()
        .filter(is_row)
        .map(|line| {
            let cells: Vec<String> =
                line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect();
            cells.try_into().unwrap_or_else(|cells| panic!("four cells: {cells:?}"))
        })
        .collect()
}

/// Words in backticks.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

#[test]
fn every_row_names_a_file_and_a_test_that_exist() {
    let root = files::root();
    let rows = rows(&files::read(&root.join("docs/luding.md")).unwrap());
    let names: Vec<String> = rows.iter().map(|row| row[0].clone()).collect();
    let expected: Vec<String> = (1..=77).map(|number| format!("L{number}")).collect();
    assert_eq!(names, expected);
    for [row, _, place, test] in &rows {
        if row == "L77" {
            assert!(place.starts_with("limitation"));
            continue;
        }
        let [file] = quoted(place)[..] else { panic!("{row}: one file, not `{place}`") };
        assert!(root.join(file).is_file(), "{row}: there is no {file}");
        let [test] = quoted(test)[..] else { panic!("{row}: one test, not `{test}`") };
        let (file, function) = test.split_once("::").unwrap();
        let text = files::read(&root.join(file)).unwrap_or_else(|error| panic!("{row}: {error}"));
        let (before, _) = text
            .split_once(&format!("fn {function}()"))
            .unwrap_or_else(|| panic!("{row}: {file} has no {function}"));
        // Its attributes stand right above.
        let above = before.rsplit("\n\n").next().unwrap_or_default();
        assert!(above.contains("#[test]"), "{row}: {function} is no test");
    }
}
