//! The cases: one folder each, whose scene is the only description of what runs.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::ours::SceneFile;
use crate::peers::{PeerScene, Quantity};
use crate::translate::{Target, translate};

/// What `case.ron` says beside the scene.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    title: String,
    targets: Vec<Target>,
    quantities: Vec<Quantity>,
    dump_every: u64,
    tolerance: f64,
    reason: String,
}

/// One case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of its folder.
    pub slug: String,
    /// Its folder.
    pub folder: PathBuf,
    /// What happens, in one sentence.
    pub title: String,
    /// Peers to compare with.
    pub targets: Vec<Target>,
    /// What is compared.
    pub quantities: Vec<Quantity>,
    /// Steps between compared states, a divisor of the number of steps.
    pub dump_every: u64,
    /// Largest scaled difference allowed with matching conventions.
    pub tolerance: f64,
    /// Why it is that.
    pub reason: String,
}

impl Case {
    /// Its scene.
    pub fn scene(&self) -> PathBuf {
        self.folder.join("scene.ron")
    }

    /// What a target is told, with the interval of the comparison.
    ///
    /// # Errors
    /// The scene has problems, or the target does not have its laws.
    pub fn peer(&self, target: Target) -> Result<PeerScene, String> {
        let plan = SceneFile::read(&self.scene())?.plan()?;
        let mut peer = translate(&plan, target).map_err(|why| why.to_string())?;
        peer.dump_every = self.dump_every;
        peer.quantities = self.quantities.clone();
        Ok(peer)
    }

    /// The recorded answer of a target.
    pub fn record(&self, target: Target) -> PathBuf {
        self.folder.join(format!("reference-{}.json", target.name()))
    }
}

/// The folder of all cases.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases")
}

/// All cases that have a `case.ron`, ordered by name.
///
/// # Errors
/// A file cannot be read or understood; the text names it.
pub fn all() -> Result<Vec<Case>, String> {
    let root = root();
    let entries = std::fs::read_dir(&root).map_err(|error| format!("{}: {error}", root.display()))?;
    let mut cases = Vec::new();
    for entry in entries {
        let folder = entry.map_err(|error| format!("{}: {error}", root.display()))?.path();
        let path = folder.join("case.ron");
        if !path.is_file() {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let file: CaseFile = ron::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        let slug = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        cases.push(Case {
            slug,
            folder,
            title: file.title,
            targets: file.targets,
            quantities: file.quantities,
            dump_every: file.dump_every,
            tolerance: file.tolerance,
            reason: file.reason,
        });
    }
    cases.sort_by(|a, b| a.slug.cmp(&b.slug));
    Ok(cases)
}

/// The case of that name.
///
/// # Errors
/// There is none, or the cases cannot be read.
pub fn find(slug: &str) -> Result<Case, String> {
    all()?.into_iter().find(|case| case.slug == slug).ok_or_else(|| format!("there is no case `{slug}`"))
}

#[cfg(test)]
mod tests;
