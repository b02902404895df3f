//! From a scene file to a plan.

use std::io::Read;
use std::path::{Path, PathBuf};

use granule_law_api::{Registry, RegistryError};
use granule_laws as _;
use granule_plan::{Allowance, Decision, Plan};
use granule_scene::{Diagnostic, Parsed, Scene};
use granule_trade::Choice;

/// Largest scene file that is read \[bytes\]. Many bodies belong into an imported file, not into the scene.
const LARGEST_SCENE: u64 = 64 << 20;

/// The text of a scene and where it came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Path as the user gave it.
    pub path: PathBuf,
    /// The whole text.
    pub text: String,
}

/// A scene that can run.
pub struct Loaded {
    /// Its text.
    pub source: Source,
    /// What will run.
    pub plan: Plan,
    /// What is probably not meant, but no obstacle.
    pub warnings: Vec<Diagnostic>,
    /// Why the step is what it is, where the scene asks for an accuracy or a time instead; the text of the source is then the
    /// scene with the choice.
    pub choice: Option<Choice>,
}

/// Why a scene cannot be loaded.
#[derive(Debug)]
pub enum LoadError {
    /// The file cannot be read.
    Read {
        /// Path as given.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// The path is a folder.
    Folder(PathBuf),
    /// The file is not UTF-8 text.
    NotText {
        /// Path as given.
        path: PathBuf,
        /// Offset of the first byte that is not UTF-8.
        offset: usize,
    },
    /// The file is larger than any scene.
    TooLarge(PathBuf),
    /// Linked laws contradict each other.
    Registry(RegistryError),
    /// The scene has errors.
    Scene {
        /// Its text.
        source: Source,
        /// All problems, in the order of their places.
        diagnostics: Vec<Diagnostic>,
    },
}

impl std::fmt::Display for LoadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Read { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Folder(path) => write!(f, "{} is a folder, not a scene file", path.display()),
            Self::NotText { path, offset } => {
                write!(f, "{} is not UTF-8 text (byte {offset}); is it a scene file?", path.display())
            }
            Self::TooLarge(path) => write!(
                f,
                "{} is larger than {} MiB; import many bodies from a data file instead",
                path.display(),
                LARGEST_SCENE >> 20
            ),
            Self::Registry(error) => error.fmt(f),
            Self::Scene { source, diagnostics } => {
                let file = source.path.display().to_string();
                for diagnostic in diagnostics {
                    f.write_str(&diagnostic.render(&file, &source.text))?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { error, .. } => Some(error),
            Self::Registry(error) => Some(error),
            _ => None,
        }
    }
}

/// All laws linked into this program: those that granule ships, and those of every crate that registers its own and is
/// referenced by the program.
///
/// # Errors
/// Two laws of one name, or a law built against another law interface.
pub fn laws() -> Result<Registry, RegistryError> {
    Registry::collect()
}

/// Reads a scene file and plans it.
///
/// # Errors
/// The file cannot be read, or the scene has errors; see [`LoadError`].
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, LoadError> {
    load_within(path, &Allowance::UNBOUNDED)
}

/// The same for a scene that somebody else wrote: what asks for more than `allowance` is an error of the scene.
///
/// # Errors
/// As for [`load`].
pub fn load_within(path: impl AsRef<Path>, allowance: &Allowance) -> Result<Loaded, LoadError> {
    let path = path.as_ref();
    text_within(path, read(path)?, allowance)
}

/// Reads a scene file and plans it with the step of its driver block, whatever accuracy or time it asks for.
///
/// # Errors
/// As for [`load`].
pub fn load_without_wish(path: impl AsRef<Path>, allowance: &Allowance) -> Result<Loaded, LoadError> {
    let path = path.as_ref();
    let text = read(path)?;
    let without = ["accuracy", "budget"]
        .into_iter()
        .try_fold(text.clone(), |text, field| granule_scene::remove_field(&text, field));
    // A text that is no RON has its errors reported as it is.
    text_within(path, without.unwrap_or(text), allowance)
}

/// Plans the text of a scene. Files that it imports are looked for beside `path`, which itself need not exist.
///
/// # Errors
/// As for [`load`].
pub fn load_text(path: &Path, text: String) -> Result<Loaded, LoadError> {
    text_within(path, text, &Allowance::UNBOUNDED)
}

/// The same for a scene that somebody else wrote.
///
/// # Errors
/// As for [`load`].
pub(crate) fn load_text_within(
    path: &Path,
    text: String,
    allowance: &Allowance,
) -> Result<Loaded, LoadError> {
    text_within(path, text, allowance)
}

fn text_within(path: &Path, text: String, allowance: &Allowance) -> Result<Loaded, LoadError> {
    let registry = laws().map_err(LoadError::Registry)?;
    let source = Source { path: path.to_path_buf(), text };
    let parsed = granule_scene::parse(&source.text);
    let asks = parsed.scene.as_ref().filter(|scene| scene.accuracy.is_some() && scene.complete);
    if let Some(scene) = asks {
        return decided(&registry, scene, source, parsed.diagnostics, allowance);
    }
    let (plan, diagnostics) = plan(&registry, &source, parsed, allowance);
    match plan {
        Some(plan) => Ok(Loaded { source, plan, warnings: diagnostics, choice: None }),
        None => Err(LoadError::Scene { source, diagnostics }),
    }
}

fn plan(
    registry: &Registry,
    source: &Source,
    parsed: Parsed,
    allowance: &Allowance,
) -> (Option<Plan>, Vec<Diagnostic>) {
    let mut diagnostics = parsed.diagnostics;
    let mut plan = None;
    if let Some(scene) = &parsed.scene {
        let (built, problems) = granule_plan::build_within(scene, registry, folder(&source.path), allowance);
        plan = built;
        diagnostics.extend(problems);
        granule_scene::tidy(&mut diagnostics);
    }
    (plan, diagnostics)
}

/// Plans a scene that asks for an accuracy or a time.
fn decided(
    registry: &Registry,
    scene: &Scene,
    source: Source,
    mut diagnostics: Vec<Diagnostic>,
    allowance: &Allowance,
) -> Result<Loaded, LoadError> {
    let beside = folder(&source.path);
    // Every other problem first: a choice for a wrong scene has no sense.
    let plain = Scene { accuracy: None, ..scene.clone() };
    let (ready, problems) = granule_plan::build_within(&plain, registry, beside, allowance);
    diagnostics.extend(problems);
    let mut fail = |problems: Vec<Diagnostic>| {
        diagnostics.extend(problems);
        granule_scene::tidy(&mut diagnostics);
        LoadError::Scene { source: source.clone(), diagnostics: std::mem::take(&mut diagnostics) }
    };
    if ready.is_none() {
        return Err(fail(Vec::new()));
    }
    drop(ready);
    let choice = match granule_trade::decide(&source.text, scene, registry, beside) {
        Ok(Some(choice)) => choice,
        Ok(None) => return Err(fail(Vec::new())),
        Err(problems) => return Err(fail(problems)),
    };
    let source = Source { text: choice.text.clone(), ..source };
    let parsed = granule_scene::parse(&source.text);
    let (plan, warnings) = plan(registry, &source, parsed, allowance);
    let Some(mut plan) = plan else { return Err(LoadError::Scene { source, diagnostics: warnings }) };
    plan.decisions.push(Decision { topic: choice.goal.field(), included: true, why: choice.why() });
    for row in &choice.table {
        plan.decisions.push(Decision { topic: "measured", included: false, why: row.clone() });
    }
    Ok(Loaded { source, plan, warnings, choice: Some(choice) })
}

/// Repeats the measurement that led to a choice, at other phases of the step. `None` where nothing was measured but a table
/// decided.
///
/// # Errors
/// An impact has no result.
pub fn measured_again(choice: &Choice, source: &Source) -> Result<Option<f64>, String> {
    let Loaded { plan, .. } =
        load_text(&source.path, choice.text.clone()).map_err(|error| error.to_string())?;
    choice.measured_again(&plan)
}

/// The folder that a scene lies in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn read(path: &Path) -> Result<String, LoadError> {
    let fail = |error| LoadError::Read { path: path.to_path_buf(), error };
    if path.is_dir() {
        return Err(LoadError::Folder(path.to_path_buf()));
    }
    let file = std::fs::File::open(path).map_err(fail)?;
    let mut bytes = Vec::new();
    file.take(LARGEST_SCENE + 1).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > LARGEST_SCENE {
        return Err(LoadError::TooLarge(path.to_path_buf()));
    }
    String::from_utf8(bytes).map_err(|error| LoadError::NotText {
        path: path.to_path_buf(),
        offset: error.utf8_error().valid_up_to(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_scene_file_is_said_so() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| load(path).err().unwrap().to_string();
        assert!(message(folder.path()).contains("is a folder"));
        assert!(message(&folder.path().join("none.ron")).contains("none.ron: No such file"));
        let binary = folder.path().join("binary.ron");
        std::fs::write(&binary, b"(a\xff)").unwrap();
        assert!(message(&binary).contains("not UTF-8 text (byte 2)"));
    }

    #[test]
    fn the_folder_of_a_bare_name_is_the_current_one() {
        assert_eq!(folder(Path::new("scene.ron")), Path::new("."));
        assert_eq!(folder(Path::new("a/scene.ron")), Path::new("a"));
    }
}
