//! Tables in docs/ that name files and tests name ones that exist.

use xtask::files;

/// Words in backticks.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

#[test]
fn every_promise_of_the_event_driver_names_a_file_and_a_test_that_exist() {
    let root = files::root();
    let text = files::read(&root.join("docs/events.md")).unwrap();
    let (_, promises) = text.split_once("## What it promises").unwrap();
    let (promises, _) = promises.split_once("\n## ").unwrap();
    let rows = promises.lines().filter(|line| line.contains("::"));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [_, _, place, test] = cells[..] else { panic!("four cells: {row}") };
        let [file] = quoted(place)[..] else { panic!("one file: {row}") };
        assert!(root.join(file).is_file(), "there is no {file}");
        let [test] = quoted(test)[..] else { panic!("one test: {row}") };
        let (file, function) = test.split_once("::").unwrap();
        let text = files::read(&root.join(file)).unwrap_or_else(|error| panic!("{row}: {error}"));
        let (before, _) =
            text.split_once(&format!("fn {function}(")).unwrap_or_else(|| panic!("{file} has no {function}"));
        // Its attributes stand right above.
        let above = before.rsplit("}\n\n").next().unwrap_or_default();
        assert!(above.contains("#[test]") || text.contains("proptest!"), "{function} is no test");
        count += 1;
    }
    assert!(count > 20, "{count} rows");
}
