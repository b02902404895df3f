//! Rules about the text of single files.

/// Longest Rust file, in lines.
const LONGEST: usize = 600;

/// Marks of unfinished work. Written in two parts, so that this file passes its own check.
const UNFINISHED: [&str; 7] = [
    concat!("todo", "!("),
    concat!("unimplemented", "!("),
    concat!("dbg", "!("),
    concat!("FIX", "ME"),
    concat!("XX", "X"),
    concat!("TO", "DO"),
    crate::new_law::FILL_IN,
];

/// Beginnings of paths that exist on one machine only, in two parts for the same reason.
const MACHINE_PATHS: [&str; 5] = [
    concat!("/", "home/"),
    concat!("/", "root/"),
    concat!("/", "work/"),
    concat!("/", "Users/"),
    concat!("C:", "\\Users"),
];

/// Checks one file; `path` is relative to the root.
pub(super) fn check(path: &str, bytes: &[u8]) -> Vec<String> {
    let Ok(text) = std::str::from_utf8(bytes) else {
        // Pictures and compressed files have nothing to read.
        return Vec::new();
    };
    let mut problems = Vec::new();
    for (number, line) in text.lines().enumerate().map(|(index, line)| (index + 1, line)) {
        if let Some(start) = MACHINE_PATHS.iter().find(|start| names_path(line, start)) {
            problems
                .push(format!("{path}:{number}: names a path of one machine (`{start}`); make it relative"));
        }
        if path.ends_with(".rs")
            && let Some(mark) = UNFINISHED.iter().find(|mark| line.contains(**mark))
        {
            problems.push(format!("{path}:{number}: holds `{mark}`; finish it or take it out"));
        }
    }
    if path.ends_with(".rs") {
        let lines = text.lines().count();
        if lines > LONGEST {
            problems.push(format!(
                "{path}: {lines} lines are more than {LONGEST}; move a subject to its own file"
            ));
        }
    }
    if path.ends_with("Cargo.toml") && path.contains('/') && !inherits_lints(text) {
        problems.push(format!("{path}: does not inherit the lints; add `[lints]` and `workspace = true`"));
    }
    problems
}

/// True if a path begins here, and not in the middle of a word or of an address.
fn names_path(line: &str, start: &str) -> bool {
    line.match_indices(start).any(|(at, _)| {
        line[..at]
            .chars()
            .next_back()
            .is_none_or(|before| !(before.is_alphanumeric() || "._-/~}$".contains(before)))
    })
}

fn inherits_lints(manifest: &str) -> bool {
    let mut lines = manifest.lines().map(str::trim);
    lines.any(|line| line == "[lints]") && lines.next() == Some("workspace = true")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_must_not_be() {
        let problem = |path: &str, text: &str| check(path, text.as_bytes()).join("\n");
        assert_eq!(problem("a.rs", "fn main() {}\n"), "");
        assert!(problem("a.rs", &format!("\n{}\"later\")\n", UNFINISHED[0])).starts_with("a.rs:2: holds"));
        assert_eq!(problem("a.md", &format!("{}\n", UNFINISHED[3])), "");
        assert!(problem("a.md", &format!("see {}me/x\n", MACHINE_PATHS[0])).contains("a.md:1: names a path"));
        assert_eq!(problem("a.md", &format!("https://example.org{}x\n", MACHINE_PATHS[0])), "");
        assert!(problem("a.rs", &"\n".repeat(601)).contains("601 lines"));
        assert!(problem("crates/a/Cargo.toml", "[package]\n").contains("does not inherit"));
        assert_eq!(problem("crates/a/Cargo.toml", "[lints]\nworkspace = true\n"), "");
        assert_eq!(problem("Cargo.toml", "[workspace]\n"), "");
        assert_eq!(check("a.png", &[0xff, 0xfe, 0x00]), Vec::<String>::new());
    }
}
