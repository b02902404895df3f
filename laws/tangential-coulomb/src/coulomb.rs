//! f_t = -μ f_n v_t/|v_t|, stopping at rest.

use granule_law_api::{
    CHUNK, Columns, ContactChunk, ContactLaw, CoulombCap, Dimension, Form, Impact, LawError, LawInfo, Oracle,
    PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange, VelocityRule,
    register_law, vectorised,
};

const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "mu",
    doc: "Coefficient of dynamic friction.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};

/// Dynamic friction against the slip (Luding 1998, Eq. (51)). There is no static friction: a contact at rest carries no
/// tangential force, so bodies creep on a slope.
///
/// In discrete time the printed law overshoots v_t = 0 and then oscillates about it with an amplitude of μ f_n Δt/m_t.
/// Here the force is held below θ m_t |v_t|/Δt, where m_t = m12/(1 + 1/q) is the mass that the slip feels; with several
/// inertia factors q the smallest. Forces that see the velocity which they are about to change (half-step velocities) use
/// θ = 1: the slip stops at zero in one step. Forces that see synchronised velocities lag half a step behind; θ = 1 would
/// leave an undamped oscillation, and θ = 2/3 is the value under which the remaining slip dies out fastest, by
/// 1/sqrt(3) a step. Where the velocity is predicted with an acceleration extrapolated from the last two steps, that value is
/// 1/3, with 1/sqrt(2) a step, and the slip grows beyond θ = 1/2. Without a step (Δt = 0) the force is the printed one, and zero at rest.
pub struct Coulomb;

impl ContactLaw for Coulomb {
    const INFO: LawInfo = LawInfo {
        name: "Coulomb",
        summary: "Dynamic friction that stops at rest without chatter; no static friction.",
        formula: "f_t = -min(mu f_n, theta m_t |v_t|/dt) v_t/|v_t|, m_t = m12/(1 + 1/q)",
        sources: &[Source {
            work: "Luding 1998",
            place: "Eqs. (51)-(52)",
            note: "erratum L-E4: friction slows the slip; held so that the slip cannot reverse",
        }],
        slot: Slot::Tangential,
        reads: Columns::TANGENTIAL_VELOCITY.and(Columns::NORMAL_FORCE).and(Columns::REDUCED_MASS),
        writes: Columns::TANGENTIAL_FORCE,
        history: &[],
        parameters: &[&FRICTION],
        forms: &[Form { doc: "Coefficient of friction.", required: &[&FRICTION], optional: &[] }],
        examples: &[&[("friction", 0.3)], &[("friction", 0.0)], &[("friction", 5.0)]],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let share = match pair.conventions.velocity {
            VelocityRule::HalfStep => 1.0,
            VelocityRule::Synchronised => 2.0 / 3.0,
            VelocityRule::Extrapolated => 1.0 / 3.0,
        };
        let friction = T::of(params.value(&FRICTION)?);
        let stopping = T::of(share / (1.0 + 1.0 / pair.inertia_factor.min));
        Ok(match pair.conventions.coulomb_cap {
            CoulombCap::Repulsive => vectorised(Sliding::<T, true> { friction, stopping }),
            CoulombCap::Magnitude => vectorised(Sliding::<T, false> { friction, stopping }),
        })
    }

    /// None: the force is bounded by whatever step is taken.
    fn time_scale(
        _params: &Params,
        _pair: &PairContext,
        _impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        Ok(None)
    }

    fn oracle(params: &Params, _pair: &PairContext) -> Oracle {
        let Ok(friction) = params.value(&FRICTION) else {
            return Oracle::Missing;
        };
        Oracle::Tangential(Box::new(move |impact| {
            // The elastic impact has the normal impulse 2 m12 v_0.
            let normal = 2.0 * impact.impact.reduced_mass * impact.impact.normal_speed;
            Some((impact.tangential_speed - friction * normal / impact.tangential_mass).max(0.0))
        }))
    }
}

register_law!(Coulomb);

/// The loop. `REPULSIVE`: an attractive normal force carries no friction.
struct Sliding<T, const REPULSIVE: bool> {
    friction: T,
    /// θ m_t/m12.
    stopping: T,
}

impl<T: Real, const REPULSIVE: bool> Stage<T> for Sliding<T, REPULSIVE> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let moves = chunk.time_step > T::ZERO;
        let per_step = if moves { self.stopping / chunk.time_step } else { T::ZERO };
        let overlap = &chunk.overlap[..n];
        let normal_force = &chunk.normal_force[..n];
        let mass = &chunk.reduced_mass[..n];
        let [vx, vy, vz] = chunk.tangential_velocity;
        let (vx, vy, vz) = (&vx[..n], &vy[..n], &vz[..n]);
        let [fx, fy, fz] = &mut chunk.tangential_force;
        let (fx, fy, fz) = (&mut fx[..n], &mut fy[..n], &mut fz[..n]);
        // The factor goes through an array that overlaps nothing else, so that the loops become vector code.
        let mut factors = [T::ZERO; CHUNK];
        let factors = &mut factors[..n];
        for k in 0..n {
            let speed = (vx[k] * vx[k] + vy[k] * vy[k] + vz[k] * vz[k]).sqrt();
            let force = normal_force[k];
            let force = if REPULSIVE { force.max(T::ZERO) } else { force.abs() };
            let limit = (self.friction * force).keep_if(overlap[k] > T::ZERO);
            let stop = mass[k] * per_step * speed;
            let size = if moves { limit.min(stop) } else { limit };
            factors[k] = if speed > T::ZERO { -(size / speed) } else { T::ZERO };
        }
        for (force, slip) in [(&mut *fx, vx), (&mut *fy, vy), (&mut *fz, vz)] {
            for k in 0..n {
                force[k] = factors[k] * slip[k];
            }
        }
        if let Some(energy) = &mut chunk.energy {
            energy.elastic[..n].fill(T::ZERO);
            energy.viscous[..n].fill(T::ZERO);
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                friction[k] = -(fx[k] * vx[k] + fy[k] * vy[k] + fz[k] * vz[k]);
            }
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
