//! Our own run of a scene, dumped like a peer's.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::Plan;
use granule_scene::{ConventionsBlock, PrecisionChoice, Scene, Spanned};

use crate::peers::Frame;

/// A scene of the validation, read and ready to be planned under different conventions.
#[derive(Clone)]
pub struct SceneFile {
    path: PathBuf,
    base: PathBuf,
    text: String,
    scene: Scene,
    registry: Registry,
}

impl SceneFile {
    /// Reads a scene.
    ///
    /// # Errors
    /// The problems of the file, as text.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let registry = Registry::collect().map_err(|error| error.to_string())?;
        let parsed = granule_scene::parse(&text);
        let problems =
            parsed.diagnostics.iter().map(|problem| problem.render(&path.display().to_string(), &text));
        let problems: Vec<String> = problems.collect();
        let scene = parsed.scene.ok_or_else(|| problems.join("\n"))?;
        let base = path.parent().unwrap_or(Path::new(".")).to_path_buf();
        Ok(Self { path: path.to_path_buf(), base, text, scene, registry })
    }

    /// The scene with its files in another folder.
    pub fn in_folder(mut self, folder: &Path) -> Self {
        self.base = folder.to_path_buf();
        self
    }

    /// The same scene with another seed.
    #[must_use]
    pub fn with_seed(&self, seed: u64) -> Self {
        let mut scene = self.clone();
        scene.scene.seed = seed;
        scene
    }

    /// The scene in a cell that is so many times as long in x and y; the bodies have to be there.
    pub fn repeated(mut self, copies: [usize; 2]) -> Self {
        if let Some(cell) = &mut self.scene.cell {
            for (axis, count) in copies.into_iter().enumerate() {
                let lo = cell.lo.components[axis].value;
                let hi = &mut cell.hi.components[axis].value;
                // An endless cell stays as it is.
                if count > 1 && hi.is_finite() {
                    *hi = lo + count as f64 * (*hi - lo);
                }
            }
        }
        self
    }

    /// The scene with the laws in single precision.
    pub fn in_single_precision(mut self) -> Self {
        self.scene.precision = PrecisionChoice::Single;
        self
    }

    /// Plans the scene as it is written.
    ///
    /// # Errors
    /// The problems of the scene, as text.
    pub fn plan(&self) -> Result<Arc<Plan>, String> {
        self.build(&self.scene)
    }

    /// Plans the scene under the conventions of a preset with changes `(convention, choice)`.
    ///
    /// # Errors
    /// The problems of the scene, as text.
    pub fn plan_under(&self, preset: &str, changes: &[(&str, &str)]) -> Result<Arc<Plan>, String> {
        let word = |word: &str| Spanned::new(word.to_string(), 0..0);
        let mut scene = self.scene.clone();
        scene.conventions = ConventionsBlock {
            preset: Some(word(preset)),
            changes: changes.iter().map(|(name, choice)| (word(name), word(choice))).collect(),
        };
        scene.driver.integrator = None;
        self.build(&scene)
    }

    fn build(&self, scene: &Scene) -> Result<Arc<Plan>, String> {
        let (plan, problems) = granule_plan::build(scene, &self.registry, &self.base);
        plan.map(Arc::new).ok_or_else(|| {
            let name = self.path.display().to_string();
            problems.iter().map(|problem| problem.render(&name, &self.text)).collect::<Vec<_>>().join("\n")
        })
    }
}

/// Plans the text of a scene that needs no files.
///
/// # Errors
/// The problems of the scene, as text.
pub fn plan_text(text: &str) -> Result<Arc<Plan>, String> {
    let registry = Registry::collect().map_err(|error| error.to_string())?;
    let parsed = granule_scene::parse(text);
    let mut problems = parsed.diagnostics;
    let plan = parsed.scene.and_then(|scene| {
        let (plan, more) = granule_plan::build(&scene, &registry, Path::new("."));
        problems.extend(more);
        plan
    });
    let told = || problems.iter().map(|problem| problem.render("scene", text)).collect::<Vec<_>>().join("\n");
    plan.map(Arc::new).ok_or_else(told)
}

/// Runs a plan and keeps a frame at step 0 and every `every` steps.
///
/// # Errors
/// The run stops, with the reason.
pub fn frames(plan: &Arc<Plan>, every: u64, threads: usize) -> Result<Vec<Frame>, String> {
    frames_until(plan, plan.driver.steps, every, threads)
}

/// The same over the first steps only, up to `last`.
///
/// # Errors
/// The run stops, with the reason.
pub fn frames_until(plan: &Arc<Plan>, last: u64, every: u64, threads: usize) -> Result<Vec<Frame>, String> {
    let mut driver = TimeStepDriver::new(plan.clone(), Some(threads)).map_err(|error| error.to_string())?;
    let stop = AtomicBool::new(false);
    let mut frames = vec![frame(&driver)];
    let mut step = every;
    while step <= last {
        driver.advance(step, &stop).map_err(|error| error.to_string())?;
        frames.push(frame(&driver));
        step += every;
    }
    Ok(frames)
}

fn frame(driver: &TimeStepDriver) -> Frame {
    let view = driver.view();
    let rows = view.bodies();
    // Peers set the force on a frozen body to zero before they dump it; ours is what the others exert on it.
    let of_mobile = |place: usize, vector: [f64; 3]| if rows.is_frozen(place) { [0.0; 3] } else { vector };
    // Spins that never act are not part of the state; they stay as they are.
    let plan = driver.engine().plan();
    let spin = |rank: usize, place: usize| {
        if plan.rotation { rows.spin_of(place) } else { plan.bodies.spin[rank] }
    };
    let places: Vec<usize> = view.order().iter().map(|&place| place as usize).collect();
    Frame {
        step: view.step(),
        ids: places.iter().map(|&place| u64::from(rows.id[place])).collect(),
        position: (0..places.len()).map(|rank| view.position(rank)).collect(),
        velocity: places.iter().map(|&place| rows.velocity_of(place)).collect(),
        angular_velocity: places.iter().enumerate().map(|(rank, &place)| spin(rank, place)).collect(),
        force: places.iter().map(|&place| of_mobile(place, rows.force_of(place))).collect(),
        torque: places.iter().map(|&place| of_mobile(place, rows.torque_of(place))).collect(),
    }
}
