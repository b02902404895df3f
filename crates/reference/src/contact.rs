//! One contact under the stages of a composition.

use granule_law_api::{Columns, ContactChunk, EnergyColumns, PairContext, Slot, Stage, VelocityRule};
use granule_plan::{Composition, StagePlan};

use crate::{ReferenceError, Vector};

/// What the laws see of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinematics {
    /// Overlap \[m\].
    pub overlap: f64,
    /// Unit normal from j to i.
    pub normal: Vector,
    /// Normal velocity, positive on approach \[m/s\].
    pub normal_velocity: f64,
    /// Tangential velocity of i against j at the contact point \[m/s\].
    pub tangential_velocity: Vector,
    /// ω_i - ω_j \[rad/s\].
    pub relative_spin: Vector,
}

/// What the laws answer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Response {
    /// Normal force, positive repels \[N\].
    pub normal: f64,
    /// Tangential force on i \[N\].
    pub tangential: Vector,
    /// Torque on i besides that of the tangential force \[N m\].
    pub torque: Vector,
    /// Power dissipated by damping \[W\].
    pub viscous: f64,
    /// Power dissipated by sliding \[W\].
    pub friction: f64,
}

/// Stages with the constants of the pair.
pub(crate) struct Contact<'a> {
    pub composition: &'a Composition,
    stages: Vec<Box<dyn Stage<f64>>>,
    reduced_mass: f64,
    reduced_radius: f64,
}

impl<'a> Contact<'a> {
    /// Compiles the laws for substeps that give them the velocity with which the bodies move through the substep. In the
    /// limit of no length that is the same as any other rule, but only so a spring that slides is left at its limit.
    pub fn new(
        composition: &'a Composition,
        reduced_mass: f64,
        reduced_radius: f64,
    ) -> Result<Self, ReferenceError> {
        let mut context = composition.context;
        context.conventions.velocity = VelocityRule::HalfStep;
        context.wanted = composition.reads;
        let compile = |stage: &StagePlan| {
            let normal = context.normal.filter(|_| stage.slot != Slot::Normal);
            (stage.law.compile_f64)(&stage.params, &PairContext { normal, ..context })
                .map_err(|error| ReferenceError::Problem(format!("{}: {error}", stage.law.info.name)))
        };
        let stages = composition.stages.iter().map(compile).collect::<Result<_, _>>()?;
        Ok(Self { composition, stages, reduced_mass, reduced_radius })
    }

    /// Runs all stages and advances `history` by a step.
    pub fn respond(&self, at: &Kinematics, history: &mut [f64], step: f64) -> Response {
        let mut response = Response::default();
        let (mut stiffness, mut damping) = ([0.0], [0.0]);
        // The last substep may end a little beyond the contact; laws then see its last moment.
        let overlap = [at.overlap.max(f64::MIN_POSITIVE - self.composition.reach)];
        for (stage, compiled) in self.composition.stages.iter().zip(&self.stages) {
            let own = &mut history[stage.history_offset..stage.history_offset + stage.history_width];
            let mut columns: Vec<&mut [f64]> = own.chunks_mut(1).collect();
            let (mut elastic, mut viscous, mut friction, mut slipped) = ([0.0], [0.0], [0.0], [0.0]);
            let [nx, ny, nz] = &at.normal;
            let [vx, vy, vz] = &at.tangential_velocity;
            let [sx, sy, sz] = &at.relative_spin;
            let [fx, fy, fz] = &mut response.tangential;
            let [tx, ty, tz] = &mut response.torque;
            let one = std::slice::from_ref;
            let only = std::slice::from_mut;
            let mut chunk = ContactChunk {
                time_step: step,
                overlap: &overlap,
                normal: [one(nx), one(ny), one(nz)],
                normal_velocity: one(&at.normal_velocity),
                tangential_velocity: [one(vx), one(vy), one(vz)],
                relative_spin: [one(sx), one(sy), one(sz)],
                reduced_mass: one(&self.reduced_mass),
                reduced_radius: one(&self.reduced_radius),
                normal_force: only(&mut response.normal),
                normal_stiffness: wanted(self, Columns::NORMAL_STIFFNESS, &mut stiffness),
                normal_damping: wanted(self, Columns::NORMAL_DAMPING, &mut damping),
                tangential_force: [only(fx), only(fy), only(fz)],
                torque: [only(tx), only(ty), only(tz)],
                history: &mut columns,
                energy: Some(EnergyColumns {
                    elastic: &mut elastic,
                    viscous: &mut viscous,
                    friction: &mut friction,
                    slipped: &mut slipped,
                }),
            };
            compiled.run(&mut chunk);
            response.viscous += viscous[0];
            let cut = if step > 0.0 { slipped[0] / step } else { 0.0 };
            response.friction += friction[0] + cut;
        }
        response
    }
}

/// An optional column, as long as someone reads it.
fn wanted<'a>(contact: &Contact<'_>, column: Columns, values: &'a mut [f64; 1]) -> &'a mut [f64] {
    if contact.composition.reads.contains(column) { values } else { &mut [] }
}
