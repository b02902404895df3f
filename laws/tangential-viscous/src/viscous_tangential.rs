//! f_t = -min(γ_t |v_t|, μ f_n) v_t/|v_t|.

use granule_law_api::testing::reference;
use granule_law_api::{
    Bound, CHUNK, Columns, ContactChunk, ContactLaw, CoulombCap, Dimension, DurationRule, Form, Impact,
    LawError, LawInfo, ObliqueImpact, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage,
    TimeScale, ValueRange, register_law, vectorised,
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
const TANGENTIAL_RESTITUTION: ParamSpec = ParamSpec {
    name: "tangential_restitution",
    symbol: "e_t0",
    doc: "Tangential restitution of an impact below the friction limit: minus the slip after over that before, -1 for no \
          effect; zero would need infinite damping, and a damper reverses nothing.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(-1.0), high: Bound::Exclusive(0.0), infinite: false },
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
    /// Factor times sqrt(m12 k_n).
    Root(f64),
}

fn damping(params: &Params, pair: &PairContext) -> Result<Damping, LawError> {
    Ok(match params.form() {
        0 => Damping::Fixed(params.value(&DAMPING)?),
        1 => Damping::Mass(params.value(&DAMPING_RATE)?),
        2 => Damping::Normal(params.value(&DAMPING_RATIO)?),
        _ => designed(params.value(&TANGENTIAL_RESTITUTION)?, pair)?,
    })
}

/// The damper that leaves the slip at -e_t0 of its value: exp(-2 η_t t_c) = -e_t0 with η_t = (1 + 1/q) γ_t/(2 m12) (Luding
/// 1998, Eqs. (49)-(50)) and the true duration of the contact.
fn designed(restitution: f64, pair: &PairContext) -> Result<Damping, LawError> {
    let blame = |message: String, help: &str| LawError::new(message).at("tangential_restitution").help(help);
    let q = pair.inertia_factor;
    if !q.is_single() {
        return Err(blame(
            format!(
                "one tangential restitution needs one inertia factor, but the bodies have {} to {}",
                q.min, q.max
            ),
            "give tangential_restitution per pair of materials with one shape each, or give damping",
        ));
    }
    let factor = -(-restitution).ln() * q.max / (1.0 + q.max);
    match pair.normal.map(|normal| normal.duration) {
        Some(DurationRule::Constant(duration)) => Ok(Damping::Mass(factor / duration)),
        Some(DurationRule::Oscillator(phase)) => Ok(Damping::Root(factor / phase)),
        Some(DurationRule::Unknown) | None => Err(blame(
            "needs a normal law whose contact duration is the same at every speed".to_string(),
            "use LinearSpringDashpot with (restitution, contact_duration) or (stiffness, restitution), \
             or give damping instead",
        )),
    }
}

impl Damping {
    fn at(self, mass: f64, normal_damping: f64, normal_stiffness: f64) -> f64 {
        match self {
            Self::Root(factor) => factor * (mass * normal_stiffness).sqrt(),
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
            .and(Columns::NORMAL_STIFFNESS)
            .and(Columns::REDUCED_MASS),
        writes: Columns::TANGENTIAL_FORCE,
        history: &[],
        parameters: &[&TANGENTIAL_RESTITUTION, &DAMPING, &DAMPING_RATE, &DAMPING_RATIO, &FRICTION],
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
            Form {
                doc: "Physical intent: exactly this tangential restitution below the friction limit, in the hard limit. Needs a \
                      normal law whose contact duration has a closed form, and one inertia factor.",
                required: &[&TANGENTIAL_RESTITUTION],
                optional: NO_LIMIT,
            },
        ],
        examples: &[
            &[("damping", 5.0)],
            &[("damping", 5.0), ("friction", 0.5)],
            &[("damping_rate", 1310.0), ("friction", 0.5)],
            &[("damping_ratio", 0.5), ("friction", 0.3)],
            &[("tangential_restitution", -0.4)],
            &[("tangential_restitution", -0.4), ("friction", 0.3)],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let damping = damping(params, pair)?;
        let friction = params.value(&FRICTION)?;
        let repulsive = pair.conventions.coulomb_cap == CoulombCap::Repulsive;
        let infinite = friction == f64::INFINITY;
        Ok(match damping {
            Damping::Fixed(value) => stage::<T, FIXED>(value, friction, repulsive, infinite),
            Damping::Mass(value) => stage::<T, MASS>(value, friction, repulsive, infinite),
            Damping::Normal(value) => stage::<T, NORMAL>(value, friction, repulsive, infinite),
            Damping::Root(value) => stage::<T, ROOT>(value, friction, repulsive, infinite),
        })
    }

    /// The time in which the force would stop the slip, 1/(γ_t/m_t).
    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let normal = pair.normal.and_then(|normal| normal.scale);
        let (viscous, elastic) = normal.map_or((0.0, 0.0), |scale| (scale.damping, scale.stiffness));
        let coefficient = damping(params, pair)?.at(impact.reduced_mass, viscous, elastic);
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

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        match (damping(params, pair), params.value(&FRICTION)) {
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
            2 => columns.and(Columns::NORMAL_DAMPING),
            // Which of them is needed depends on the normal law.
            _ => columns.and(Columns::REDUCED_MASS).and(Columns::NORMAL_STIFFNESS),
        }
    }
}

register_law!(ViscousTangential);

/// Luding 1998, Eq. (49) without a limit; with one, the equation of motion is integrated.
fn after(damping: Damping, friction: f64, impact: &ObliqueImpact) -> f64 {
    let coefficient = damping.at(impact.impact.reduced_mass, 0.0, impact.normal_stiffness);
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
const ROOT: u8 = 3;

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
            MASS | ROOT => &chunk.reduced_mass[..n],
            _ => &chunk.normal_damping[..n],
        };
        let stiffness: &[T] = if DAMPING == ROOT { &chunk.normal_stiffness[..n] } else { overlap };
        let gamma = |k: usize| match DAMPING {
            FIXED => self.damping,
            ROOT => self.damping * (by[k] * stiffness[k]).sqrt(),
            _ => self.damping * by[k],
        };
        let [vx, vy, vz] = chunk.tangential_velocity;
        let (vx, vy, vz) = (&vx[..n], &vy[..n], &vz[..n]);
        let [fx, fy, fz] = &mut chunk.tangential_force;
        let (fx, fy, fz) = (&mut fx[..n], &mut fy[..n], &mut fz[..n]);
        // The factor goes through an array that overlaps nothing else, so that the loops become vector code.
        let mut factors = [T::ZERO; CHUNK];
        let factors = &mut factors[..n];
        for k in 0..n {
            let gamma = gamma(k);
            let share = if LIMITED {
                let speed = (vx[k] * vx[k] + vy[k] * vy[k] + vz[k] * vz[k]).sqrt();
                let force = normal_force[k];
                let force = if self.repulsive { force.max(T::ZERO) } else { force.abs() };
                let limit = self.friction * force;
                if gamma * speed > limit { limit / speed } else { gamma }
            } else {
                gamma
            };
            // Where the normal force ends the contact, nothing slips along anything any more.
            factors[k] = -share.keep_if(overlap[k] > T::ZERO && (LIMITED || normal_force[k] != T::ZERO));
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
                let gamma = gamma(k);
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
