//! Who may import whom: the table of ARCHITECTURE.md against what cargo says.

use std::collections::BTreeSet;
use std::path::Path;

use crate::command::Error;
use crate::files;
use crate::members::{Member, members};

/// Heading of the section of ARCHITECTURE.md that holds the table.
const HEADING: &str = "## Who may import whom";
/// The only package of this project that a law may depend on, tests included.
const LAW_API: &str = "granule-law-api";

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Folder, as in `crates/units`; `laws/*` stands for every law crate.
    pub folder: String,
    /// Packages of this project that it imports.
    pub ours: BTreeSet<String>,
    /// Packages of others that it imports.
    pub others: BTreeSet<String>,
}

/// Reads the table. Columns: package, imports of ours, imports of others, and what the package knows nothing about.
///
/// # Errors
/// There is no such table, or a row has another number of columns.
pub fn table(text: &str) -> Result<Vec<Row>, Error> {
    let section = text
        .split_once(HEADING)
        .map(|(_, rest)| rest.split_once("\n## ").map_or(rest, |(section, _)| section))
        .ok_or_else(|| Error::new(format!("ARCHITECTURE.md: there is no section `{HEADING}`")))?;
    let mut rows = Vec::new();
    for line in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let [folder, ours, others, _] = cells[..] else {
            return Err(Error::new(format!("ARCHITECTURE.md: this row needs four columns: {line}")));
        };
        rows.push(Row {
            folder: folder.trim_matches('`').to_string(),
            ours: names(ours),
            others: names(others),
        });
    }
    if rows.is_empty() {
        return Err(Error::new(format!("ARCHITECTURE.md: the section `{HEADING}` holds no table")));
    }
    Ok(rows)
}

fn names(cell: &str) -> BTreeSet<String> {
    cell.split(',')
        .map(|name| name.trim().trim_matches('`'))
        .filter(|name| !matches!(*name, "" | "-"))
        .map(str::to_string)
        .collect()
}

/// Compares the table of ARCHITECTURE.md under `root` with the manifests; every difference is one message.
///
/// # Errors
/// The table or the manifests cannot be read.
pub fn check(root: &Path) -> Result<Vec<String>, Error> {
    let rows = table(&files::read(&root.join("ARCHITECTURE.md"))?)?;
    Ok(compare(&rows, &members(root)?))
}

fn compare(rows: &[Row], members: &[Member]) -> Vec<String> {
    let mut problems = Vec::new();
    let is_law = |folder: &str| folder.starts_with("laws/") && folder != "laws/catalog";
    let row_of = |folder: &str| {
        let name = if is_law(folder) { "laws/*" } else { folder };
        rows.iter().find(|row| row.folder == name)
    };
    for member in members {
        let Some(row) = row_of(&member.folder) else {
            problems.push(format!(
                "ARCHITECTURE.md: `{}` has no row under `{HEADING}`; add one that says what it may import",
                member.folder
            ));
            continue;
        };
        let imports = |ours: bool| -> BTreeSet<String> {
            let of_kind = member.dependencies.iter().filter(|import| !import.dev && import.ours == ours);
            of_kind.map(|import| shorten(&import.package, members)).collect()
        };
        for (found, allowed) in [(imports(true), &row.ours), (imports(false), &row.others)] {
            for name in found.difference(allowed) {
                problems.push(format!(
                    "{}/Cargo.toml: imports `{name}`, which its row in ARCHITECTURE.md does not allow; remove the \
                     dependency, or add it to the row and say why",
                    member.folder
                ));
            }
            for name in allowed.difference(&found) {
                problems.push(format!(
                    "ARCHITECTURE.md: the row of `{}` allows `{name}`, which it does not import; take it out",
                    row.folder
                ));
            }
        }
        problems.extend(dev_problems(member, members, is_law(&member.folder)));
    }
    let stale = rows
        .iter()
        .filter(|row| row.folder != "laws/*" && members.iter().all(|member| member.folder != row.folder));
    problems
        .extend(stale.map(|row| {
            format!("ARCHITECTURE.md: there is no package in `{}`; take its row out", row.folder)
        }));
    problems
}

/// Every law is written `laws/*` in the table, so that a new law needs no edit there.
fn shorten(package: &str, members: &[Member]) -> String {
    let law = members.iter().any(|member| {
        member.package == package && member.folder.starts_with("laws/") && member.folder != "laws/catalog"
    });
    if law { "laws/*".to_string() } else { package.to_string() }
}

/// Tests may use what the package itself may not, but never something that is built on the package, and a law's tests
/// nothing of ours but the law interface: a stranger's law has no more.
fn dev_problems(member: &Member, members: &[Member], law: bool) -> Vec<String> {
    let dev = member.dependencies.iter().filter(|import| import.dev && import.ours);
    dev.filter_map(|import| {
        if law && import.package != LAW_API {
            return Some(format!(
                "{}/Cargo.toml: the tests of a law import `{}`; they may import {LAW_API} alone",
                member.folder, import.package
            ));
        }
        builds_on(&import.package, &member.package, members).then(|| {
            format!(
                "{}/Cargo.toml: its tests import `{}`, which is built on it; move those tests to tests/",
                member.folder, import.package
            )
        })
    })
    .collect()
}

/// True if `package` imports `base`, directly or not. Cargo has made sure that there are no cycles.
fn builds_on(package: &str, base: &str, members: &[Member]) -> bool {
    package == base
        || members.iter().find(|member| member.package == package).is_some_and(|member| {
            let imports = member.dependencies.iter().filter(|import| import.ours && !import.dev);
            imports.into_iter().any(|import| builds_on(&import.package, base, members))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::members::Dependency;

    const TABLE: &str = "# x\n## Who may import whom\n| package | ours | others | knows nothing about |\n|---|---|---|---|\n\
        | `crates/a` | - | `serde` | b |\n| `crates/b` | `granule-a` | - | - |\n\
        | `laws/catalog` | `laws/*` | - | - |\n| `laws/*` | `granule-law-api` | - | - |\n\
        | `crates/law-api` | - | - | - |\n## Next\n| `crates/z` | - | - | - |\n";

    fn member(package: &str, folder: &str, imports: &[(&str, bool, bool)]) -> Member {
        let dependencies = imports.iter().map(|(package, dev, ours)| Dependency {
            package: (*package).to_string(),
            dev: *dev,
            ours: *ours,
        });
        Member {
            package: package.to_string(),
            folder: folder.to_string(),
            dependencies: dependencies.collect(),
        }
    }

    fn good() -> Vec<Member> {
        vec![
            member("granule-a", "crates/a", &[("serde", false, false), ("proptest", true, false)]),
            member("granule-b", "crates/b", &[("granule-a", false, true)]),
            member("granule-law-api", "crates/law-api", &[]),
            member("granule-laws", "laws/catalog", &[("granule-law-x", false, true)]),
            member("granule-law-x", "laws/x", &[("granule-law-api", false, true)]),
        ]
    }

    #[test]
    fn reads_the_table_of_its_section_only() {
        let rows = table(TABLE).unwrap();
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[1].ours, BTreeSet::from(["granule-a".to_string()]));
        assert!(rows[1].others.is_empty());
        assert!(table("# nothing").is_err());
        assert!(table("## Who may import whom\n").is_err());
        assert!(table("## Who may import whom\n| `a` | b |\n").is_err());
    }

    #[test]
    fn accepts_what_the_table_says() {
        assert_eq!(compare(&table(TABLE).unwrap(), &good()), Vec::<String>::new());
    }

    #[test]
    fn names_every_difference() {
        let rows = table(TABLE).unwrap();
        let with = |change: fn(&mut Vec<Member>)| {
            let mut members = good();
            change(&mut members);
            compare(&rows, &members).join("\n")
        };
        let add = |package: &str, dev| Dependency { package: package.to_string(), dev, ours: true };
        assert!(with(|m| m[1].dependencies.clear()).contains("allows `granule-a`"));
        assert!(
            with(|m| {
                m.remove(1);
            })
            .contains("no package in `crates/b`")
        );
        let mut members = good();
        members[4].dependencies.push(add("granule-a", false));
        assert!(compare(&rows, &members)[0].contains("laws/x/Cargo.toml: imports `granule-a`"));
        let mut members = good();
        members[4].dependencies.push(add("granule-b", true));
        assert!(compare(&rows, &members)[0].contains("the tests of a law import `granule-b`"));
        let mut members = good();
        members[0].dependencies.push(add("granule-b", true));
        assert!(compare(&rows, &members)[0].contains("which is built on it"));
        let mut members = good();
        members.push(member("granule-new", "crates/new", &[]));
        assert!(compare(&rows, &members)[0].contains("`crates/new` has no row"));
    }
}
