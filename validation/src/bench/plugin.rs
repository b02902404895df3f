//! What it costs that laws are crates: the shipped laws of a packing against the same law fused by hand into one loop.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granule_drivers::{Driver, TimeStepDriver};
use granule_law_api::{ContactChunk, Slot, Stage, vectorised};
use granule_plan::Plan;
use serde::Serialize;

use super::cases::CASES;
use super::child::Job;
use super::{Options, Scratch, states};
use crate::peers::processor_seconds;

/// The case whose laws are fused.
const CASE: &str = "settled-10k-hooke";

/// Linear spring-dashpot and tangential spring with history in the conventions of LAMMPS, in one loop: what one would write
/// into an engine that knew nothing else.
struct Fused {
    stiffness: f64,
    damping_rate: f64,
    tangential_stiffness: f64,
    tangential_damping_rate: f64,
    friction: f64,
}

/// The numbers of the scene `settled-hooke`.
const FUSED: Fused = Fused {
    stiffness: 1000.0,
    damping_rate: 2620.0,
    tangential_stiffness: 285.714_285_714_285_7,
    tangential_damping_rate: 1310.0,
    friction: 0.5,
};

/// Contacts that the loop keeps in local arrays, as the shipped law does.
const BLOCK: usize = 32;

impl Stage<f64> for Fused {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, f64>) {
        let dt = chunk.time_step;
        let total = chunk.len();
        let mut out = [[0.0; BLOCK]; 7];
        let mut start = 0;
        while start < total {
            let n = (total - start).min(BLOCK);
            self.block(chunk, start, n, dt, &mut out);
            chunk.normal_force[start..][..n].copy_from_slice(&out[0][..n]);
            for axis in 0..3 {
                chunk.tangential_force[axis][start..][..n].copy_from_slice(&out[1 + axis][..n]);
                if dt > 0.0 {
                    chunk.history[axis][start..][..n].copy_from_slice(&out[4 + axis][..n]);
                }
            }
            start += n;
        }
    }
}

impl Fused {
    #[inline(always)]
    fn block(
        &self,
        chunk: &ContactChunk<'_, f64>,
        start: usize,
        n: usize,
        dt: f64,
        out: &mut [[f64; BLOCK]; 7],
    ) {
        let overlap = &chunk.overlap[start..][..n];
        let approach = &chunk.normal_velocity[start..][..n];
        let mass = &chunk.reduced_mass[start..][..n];
        let [nx, ny, nz] = chunk.normal;
        let (nx, ny, nz) = (&nx[start..][..n], &ny[start..][..n], &nz[start..][..n]);
        let [vx, vy, vz] = chunk.tangential_velocity;
        let (vx, vy, vz) = (&vx[start..][..n], &vy[start..][..n], &vz[start..][..n]);
        let (sx, sy, sz) = (
            &chunk.history[0][start..][..n],
            &chunk.history[1][start..][..n],
            &chunk.history[2][start..][..n],
        );
        let [force, fx, fy, fz, kx, ky, kz] = out;
        for k in 0..n {
            let touches = overlap[k] > 0.0;
            let normal_force = self.stiffness * overlap[k] + self.damping_rate * mass[k] * approach[k];
            let normal_force = if touches { normal_force } else { 0.0 };
            let limit = self.friction * normal_force.abs();
            let kt = self.tangential_stiffness;
            let gamma = self.tangential_damping_rate * mass[k];
            let grown = [sx[k] + vx[k] * dt, sy[k] + vy[k] * dt, sz[k] + vz[k] * dt];
            let tilt = -(grown[0] * nx[k] + grown[1] * ny[k] + grown[2] * nz[k]);
            let spring = [grown[0] + nx[k] * tilt, grown[1] + ny[k] * tilt, grown[2] + nz[k] * tilt];
            let damper = [vx[k] * gamma, vy[k] * gamma, vz[k] * gamma];
            let trial = [spring[0] * kt + damper[0], spring[1] * kt + damper[1], spring[2] * kt + damper[2]];
            let size = (trial[0] * trial[0] + trial[1] * trial[1] + trial[2] * trial[2]).sqrt();
            let slides = size > limit;
            let cut = if slides { limit / size } else { 1.0 };
            let length = spring[0] * spring[0] + spring[1] * spring[1] + spring[2] * spring[2];
            let empty = slides && length == 0.0;
            let share = if empty { 0.0 } else { cut };
            let wound = (1.0 - cut) / kt;
            let wound = if wound < 1.0 / f64::EPSILON { wound } else { 1.0 / f64::EPSILON };
            let wound = if slides && !empty { wound } else { 0.0 };
            force[k] = normal_force;
            fx[k] = if touches { -(trial[0] * share) } else { 0.0 };
            fy[k] = if touches { -(trial[1] * share) } else { 0.0 };
            fz[k] = if touches { -(trial[2] * share) } else { 0.0 };
            kx[k] = if touches { spring[0] * cut + damper[0] * -wound } else { 0.0 };
            ky[k] = if touches { spring[1] * cut + damper[1] * -wound } else { 0.0 };
            kz[k] = if touches { spring[2] * cut + damper[2] * -wound } else { 0.0 };
        }
    }
}

/// The plan with every normal and tangential stage replaced by the fused loop.
fn fuse(mut plan: Plan) -> Plan {
    for composition in &mut plan.compositions {
        composition.stages.retain(|stage| stage.slot == Slot::Tangential);
        for stage in &mut composition.stages {
            stage.double = Arc::from(vectorised(FUSED));
            stage.reads = composition.reads;
        }
    }
    plan
}

/// What was measured.
#[derive(Clone, Debug, Serialize)]
pub struct PlugIn {
    /// Case.
    pub case: String,
    /// 10^6 particle-steps a second of the shipped laws, round by round.
    pub registered_mps: Vec<f64>,
    /// The same of the fused loop.
    pub fused_mps: Vec<f64>,
    /// Time of a step with the shipped laws over that with the fused loop: least and median of all rounds.
    pub ratio: [f64; 2],
    /// Both ended with the same bits.
    pub same_bits: bool,
}

/// Measures the shipped laws and the fused loop in turn on one core.
///
/// # Errors
/// The scene cannot be planned, or a run stops.
pub fn plug_in(options: &Options, scratch: &Scratch) -> Result<PlugIn, String> {
    let case = CASES.iter().find(|case| case.name == CASE).ok_or("the case is gone")?;
    let job = Job {
        scene: states::scenes().join(case.scene).join("scene.ron"),
        base: states::prepare(case.recipe, case.copies, &scratch.states)?,
        copies: case.copies,
        single: false,
        cores: 1,
        warm_up: 200,
        steps: options.steps.unwrap_or(1500),
        vtp: false,
    };
    let scene = job.scene()?;
    let mut result = PlugIn {
        case: case.name.to_string(),
        registered_mps: Vec::new(),
        fused_mps: Vec::new(),
        ratio: [0.0; 2],
        same_bits: true,
    };
    let mut ratios = Vec::new();
    for _ in 0..options.pairs.max(5) {
        let (registered, bits) = speed(scene.plan()?, &job)?;
        let plan = Arc::try_unwrap(scene.plan()?).map_err(|_| "the plan is shared")?;
        let (fused, fused_bits) = speed(Arc::new(fuse(plan)), &job)?;
        result.same_bits &= bits == fused_bits;
        result.registered_mps.push(registered);
        result.fused_mps.push(fused);
        ratios.push(fused / registered);
    }
    let median = granule_report::statistics::median(&ratios).map_err(|error| error.to_string())?;
    result.ratio = [ratios.iter().copied().fold(f64::INFINITY, f64::min), median];
    Ok(result)
}

fn speed(plan: Arc<Plan>, job: &Job) -> Result<(f64, u64), String> {
    let n = plan.bodies.len() as f64;
    let mut driver = TimeStepDriver::new(plan, Some(job.cores)).map_err(|error| error.to_string())?;
    let never = AtomicBool::new(false);
    driver.advance(job.warm_up, &never).map_err(|error| error.to_string())?;
    let (begin, processor) = (Instant::now(), processor_seconds("self"));
    driver.advance(job.warm_up + job.steps, &never).map_err(|error| error.to_string())?;
    let spent = processor.zip(processor_seconds("self")).map(|(before, after)| after - before);
    let seconds = spent.filter(|spent| *spent > 0.0).unwrap_or(begin.elapsed().as_secs_f64());
    Ok((n * job.steps as f64 / seconds / 1e6, driver.result_hash()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ours::SceneFile;

    /// A pile that falls, slides and rests gives the same bits, so the fused loop is the same law.
    #[test]
    fn the_fused_loop_is_the_shipped_law() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ron");
        let scene = std::fs::read_to_string(states::scenes().join("settled-hooke/scene.ron")).unwrap();
        let import = scene.lines().find(|line| line.trim_start().starts_with("bodies:")).unwrap();
        let fill = "bodies: [Fill(material: \"glass\", radius: \"0.5 mm\", count: 230, lo: (0, 0, 0), \
                    hi: (\"5 mm\", \"5 mm\", \"20 mm\"), velocity_spread: 1)],";
        let narrow = scene.replace(import, fill).replace("(\"20 mm\", \"20 mm\",", "(\"5 mm\", \"5 mm\",");
        std::fs::write(&path, narrow).unwrap();
        let scene = SceneFile::read(&path).unwrap();
        let job = Job {
            scene: path,
            base: None,
            copies: [1, 1],
            single: false,
            cores: 1,
            warm_up: 0,
            steps: 40_000,
            vtp: false,
        };
        let shipped = speed(scene.plan().unwrap(), &job).unwrap().1;
        let mut driver = TimeStepDriver::new(scene.plan().unwrap(), Some(1)).unwrap();
        driver.advance(job.steps, &AtomicBool::new(false)).unwrap();
        let tally = driver.engine().tally();
        assert!(tally.contacts > 100, "{tally:?}");
        let plan = Arc::try_unwrap(scene.plan().unwrap()).ok().unwrap();
        assert_eq!(speed(Arc::new(fuse(plan)), &job).unwrap().1, shipped);
    }
}
