//! f_t = -min(γ_t |v_t|, μ f_n) v_t/|v_t|.

use granule_law_api::testing::reference;
use granule_law_api::{
    CHUNK, Columns, ContactChunk, ContactLaw, CoulombCap, Dimension, Form, Impact, LawError, LawInfo,
    ObliqueImpact, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
    register_law, vectorised,
};

const DAMPING: ParamSpec = ParamSpec {
    name: "damping",
    symbol: "gamma_t",
    doc: "Tangential damping coefficient, the same for every pair.",
    dimension: Dimension::DAMPING,
    range: ValueRange::NON_NEGATIVE,
};
const DAMPING_RATE: ParamSpec = ParamSpec {
    name: "damping_rate",
    symbol: "gamma_t/m12",
    doc: "Tangential damping coefficient per reduced mass (gamma_t of LAMMPS gran/hooke, gammat of LIGGGHTS hooke/stiffness).",
    dimension: Dimension::RATE,
    range: ValueRange::NON_NEGATIVE,
};
const DAMPING_RATIO: ParamSpec = ParamSpec {
    name: "damping_ratio",
    symbol: "gamma_t/gamma_n",
    doc: "Tangential over normal damping coefficient (x_gammat of LAMMPS pair granular).",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "mu",
    doc: "Friction coefficient of the Coulomb limit; inf for no limit.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { infinite: true, ..ValueRange::NON_NEGATIVE },
};
const NO_LIMIT: &[(&ParamSpec, f64)] = &[(&FRICTION, f64::INFINITY)];

/// Viscous force against the slip (Luding 1998, Eq. (48)), optionally under a Coulomb limit. A contact at rest carries no
/// tangential force: there is no static friction.
pub struct ViscousTangential;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Damping {
    /// The same for every pair.
    Fixed(f64),
    /// Factor times m12.
    Mass(f64),
    /// Factor times the damping of the normal law.
    Normal(f64),
}

fn damping(params: &Params) -> Result<Damping, LawError> {
    Ok(match params.form() {
        0 => Damping::Fixed(params.value(&DAMPING)?),
        1 => Damping::Mass(params.value(&DAMPING_RATE)?),
        _ => Damping::Normal(params.value(&DAMPING_RATIO)?),
    })
}

impl Damping {
    fn at(self, mass: f64, normal_damping: f64) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Mass(rate) => rate * mass,
            Self::Normal(ratio) => ratio * normal_damping,
        }
    }
}

impl ContactLaw for ViscousTangential {
    const INFO: LawInfo = LawInfo {
        name: "ViscousTangential",
        summary: "Viscous force against the slip, optionally limited by friction; no static friction.",
        formula: "f_t = -min(gamma_t |v_t|, mu f_n) v_t/|v_t|",
        sources: &[
            Source { work: "Luding 1998", place: "Eqs. (48)-(50)", note: "" },
            Source {
                work: "Haff and Werner 1986",
                place: "Eq. (2)",
                note: "the form with the friction limit",
            },
        ],
        slot: Slot::Tangential,
        reads: Columns::TANGENTIAL_VELOCITY
            .and(Columns::NORMAL_FORCE)
            .and(Columns::NORMAL_DAMPING)
            .and(Columns::REDUCED_MASS),
        writes: Columns::TANGENTIAL_FORCE,
        history: &[],
        parameters: &[&DAMPING, &DAMPING_RATE, &DAMPING_RATIO, &FRICTION],
        forms: &[
            Form {
                doc: "One damping coefficient for every pair.",
                required: &[&DAMPING],
                optional: NO_LIMIT,
            },
            Form {
                doc: "As LAMMPS gran/hooke and LIGGGHTS no_history: damping in proportion to the reduced mass.",
                required: &[&DAMPING_RATE],
                optional: NO_LIMIT,
            },
            Form {
                doc: "Damping as a fraction of that of the normal law.",
                required: &[&DAMPING_RATIO],
                optional: NO_LIMIT,
            },
        ],
        examples: &[
            &[("damping", 5.0)],
            &[("damping", 5.0), ("friction", 0.5)],
            &[("damping_rate", 1310.0), ("friction", 0.5)],
            &[("damping_ratio", 0.5), ("friction", 0.3)],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let damping = damping(params)?;
        let friction = params.value(&FRICTION)?;
        let repulsive = pair.conventions.coulomb_cap == CoulombCap::Repulsive;
        let infinite = friction == f64::INFINITY;
        Ok(match damping {
            Damping::Fixed(value) => stage::<T, FIXED>(value, friction, repulsive, infinite),
            Damping::Mass(value) => stage::<T, MASS>(value, friction, repulsive, infinite),
            Damping::Normal(value) => stage::<T, NORMAL>(value, friction, repulsive, infinite),
        })
    }

    /// The time in which the force would stop the slip, 1/(γ_t/m_t).
    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let normal = pair.normal.and_then(|normal| normal.scale);
        let coefficient = damping(params)?.at(impact.reduced_mass, normal.map_or(0.0, |scale| scale.damping));
        if coefficient == 0.0 {
            return Ok(None);
        }
        // m12/m_t for bodies of one inertia factor; the smallest one is the most mobile.
        let felt = coefficient * (1.0 + 1.0 / pair.inertia_factor.min);
        Ok(Some(TimeScale {
            duration: impact.reduced_mass / felt,
            stiffness: 0.0,
            damping: felt,
            overlap: 0.0,
        }))
    }

    fn oracle(params: &Params, _pair: &PairContext) -> Oracle {
        match (damping(params), params.value(&FRICTION)) {
            (Ok(damping), Ok(friction)) => {
                Oracle::Tangential(Box::new(move |impact| Some(after(damping, friction, impact))))
            }
            _ => Oracle::Missing,
        }
    }

    fn reads(params: &Params) -> Columns {
        let columns = Columns::TANGENTIAL_VELOCITY.and(Columns::NORMAL_FORCE);
        match params.form() {
            0 => columns,
            1 => columns.and(Columns::REDUCED_MASS),
            _ => columns.and(Columns::NORMAL_DAMPING),
        }
    }
}

register_law!(ViscousTangential);

/// Luding 1998, Eq. (49) without a limit; with one, the equation of motion is integrated.
fn after(damping: Damping, friction: f64, impact: &ObliqueImpact) -> f64 {
    let coefficient = damping.at(impact.impact.reduced_mass, 0.0);
    let mass = impact.tangential_mass;
    if friction == f64::INFINITY {
        return impact.tangential_speed * (-coefficient * impact.duration / mass).exp();
    }
    let omega = std::f64::consts::PI / impact.duration;
    let peak = friction * impact.normal_stiffness * impact.impact.normal_speed / omega;
    let [velocity] = reference::integrate([impact.tangential_speed], impact.duration, |time, [v]| {
        let limit = peak * (omega * time).sin().max(0.0);
        [-(coefficient * v.abs()).min(limit) * v.signum() / mass]
    });
    velocity
}

const FIXED: u8 = 0;
const MASS: u8 = 1;
const NORMAL: u8 = 2;

struct Viscous<T, const DAMPING: u8, const LIMITED: bool> {
    damping: T,
    friction: T,
    repulsive: bool,
}

fn stage<T: Real, const DAMPING: u8>(
    damping: f64,
    friction: f64,
    repulsive: bool,
    infinite: bool,
) -> Box<dyn Stage<T>> {
    let (damping, friction) = (T::of(damping), T::of(friction));
    if infinite {
        vectorised(Viscous::<T, DAMPING, false> { damping, friction, repulsive })
    } else {
        vectorised(Viscous::<T, DAMPING, true> { damping, friction, repulsive })
    }
}

impl<T: Real, const DAMPING: u8, const LIMITED: bool> Stage<T> for Viscous<T, DAMPING, LIMITED> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let normal_force = &chunk.normal_force[..n];
        let by: &[T] = match DAMPING {
            FIXED => overlap,
            MASS => &chunk.reduced_mass[..n],
            _ => &chunk.normal_damping[..n],
        };
        let [vx, vy, vz] = chunk.tangential_velocity;
        let (vx, vy, vz) = (&vx[..n], &vy[..n], &vz[..n]);
        let [fx, fy, fz] = &mut chunk.tangential_force;
        let (fx, fy, fz) = (&mut fx[..n], &mut fy[..n], &mut fz[..n]);
        // The factor goes through an array that overlaps nothing else, so that the loops become vector code.
        let mut factors = [T::ZERO; CHUNK];
        let factors = &mut factors[..n];
        for k in 0..n {
            let gamma = if DAMPING == FIXED { self.damping } else { self.damping * by[k] };
            let share = if LIMITED {
                let speed = (vx[k] * vx[k] + vy[k] * vy[k] + vz[k] * vz[k]).sqrt();
                let force = normal_force[k];
                let force = if self.repulsive { force.max(T::ZERO) } else { force.abs() };
                let limit = self.friction * force;
                if gamma * speed > limit { limit / speed } else { gamma }
            } else {
                gamma
            };
            factors[k] = -share.keep_if(overlap[k] > T::ZERO);
        }
        for (force, slip) in [(&mut *fx, vx), (&mut *fy, vy), (&mut *fz, vz)] {
            for k in 0..n {
                force[k] = factors[k] * slip[k];
            }
        }
        if let Some(energy) = &mut chunk.energy {
            let elastic = &mut energy.elastic[..n];
            let viscous = &mut energy.viscous[..n];
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                let square = vx[k] * vx[k] + vy[k] * vy[k] + vz[k] * vz[k];
                let gamma = if DAMPING == FIXED { self.damping } else { self.damping * by[k] };
                let force = normal_force[k];
                let force = if self.repulsive { force.max(T::ZERO) } else { force.abs() };
                let slides = LIMITED && gamma * square.sqrt() > self.friction * force;
                let lost = -(fx[k] * vx[k] + fy[k] * vy[k] + fz[k] * vz[k]);
                elastic[k] = T::ZERO;
                viscous[k] = lost.keep_if(!slides);
                friction[k] = lost.keep_if(slides);
            }
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
