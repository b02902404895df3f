//! The packages of the workspace and what they depend on, from `cargo metadata`.

use std::path::Path;
use std::process::Command;

use crate::command::{Error, cargo};
use crate::json::Json;

/// One package of the workspace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Package name, as in `granule-units`.
    pub package: String,
    /// Folder relative to the root, with forward slashes, as in `crates/units`.
    pub folder: String,
    /// What it depends on.
    pub dependencies: Vec<Dependency>,
}

/// One dependency of a member.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependency {
    /// Package name.
    pub package: String,
    /// True for `[dev-dependencies]`.
    pub dev: bool,
    /// True for a package of this workspace.
    pub ours: bool,
}

/// The members of the workspace at `root`, ordered by folder. Needs neither the network nor a lock on the target folder.
///
/// # Errors
/// Cargo cannot be run, or refuses the workspace.
pub fn members(root: &Path) -> Result<Vec<Member>, Error> {
    let output = Command::new(cargo())
        .args(["metadata", "--offline", "--format-version", "1", "--no-deps"])
        .current_dir(root)
        .output()
        .map_err(|error| Error::new(format!("cannot run cargo metadata: {error}")))?;
    if !output.status.success() {
        return Err(Error::new(format!(
            "cargo metadata refuses the workspace:\n{}",
            String::from_utf8_lossy(&output.stderr)
        )));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let json = Json::parse(&text)
        .map_err(|at| Error::new(format!("cargo metadata wrote something else than JSON at byte {at}")))?;
    read(&json).ok_or_else(|| Error::new("cargo metadata wrote JSON of an unknown form"))
}

fn read(json: &Json) -> Option<Vec<Member>> {
    let root = json.get("workspace_root")?.text()?.replace('\\', "/");
    let mut members = Vec::new();
    for package in json.get("packages")?.list()? {
        let manifest = package.get("manifest_path")?.text()?.replace('\\', "/");
        let folder = manifest.strip_prefix(&root)?.strip_suffix("/Cargo.toml")?.trim_start_matches('/');
        let mut dependencies = Vec::new();
        for dependency in package.get("dependencies")?.list()? {
            dependencies.push(Dependency {
                package: dependency.get("name")?.text()?.to_string(),
                dev: dependency.get("kind").and_then(Json::text) == Some("dev"),
                ours: dependency.get("path").and_then(Json::text).is_some(),
            });
        }
        members.push(Member {
            package: package.get("name")?.text()?.to_string(),
            folder: folder.to_string(),
            dependencies,
        });
    }
    members.sort_by(|a, b| a.folder.cmp(&b.folder));
    Some(members)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_folders_and_kinds() {
        let json = Json::parse(
            r#"{"workspace_root": "/x/y", "packages": [
                {"name": "b", "manifest_path": "/x/y/crates/b/Cargo.toml", "dependencies": [
                    {"name": "a", "kind": null, "path": "/x/y/crates/a"},
                    {"name": "proptest", "kind": "dev"}]},
                {"name": "a", "manifest_path": "/x/y/crates/a/Cargo.toml", "dependencies": []}]}"#,
        )
        .unwrap();
        let members = read(&json).unwrap();
        assert_eq!(members[0].folder, "crates/a");
        assert_eq!(
            members[1].dependencies,
            [
                Dependency { package: "a".to_string(), dev: false, ours: true },
                Dependency { package: "proptest".to_string(), dev: true, ours: false }
            ]
        );
    }

    #[test]
    fn finds_this_package() {
        let members = members(&crate::files::root()).unwrap();
        assert!(members.iter().any(|member| member.package == "xtask" && member.folder == "xtask"));
    }
}
