//! Viscous force against the slip between rolling spheres, cut off by friction in the plane and across it, or as a vector.

use granule_law_api::testing::reference;
use granule_law_api::{
    CHUNK, Columns, ContactChunk, ContactLaw, CoulombCap, Dimension, Form, Impact, LawError, LawInfo,
    ObliqueImpact, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
    register_law, vectorised,
};

const COEFFICIENT: ValueRange = ValueRange { infinite: true, ..ValueRange::NON_NEGATIVE };

const RATE: ParamSpec = ParamSpec {
    name: "damping_rate",
    symbol: "gamma_S",
    doc: "Damping coefficient per reduced mass; often half of that along the normal.",
    dimension: Dimension::RATE,
    range: ValueRange::NON_NEGATIVE,
};
const FRICTION: ParamSpec = ParamSpec {
    name: "friction",
    symbol: "nu_s",
    doc: "Largest tangential force of whatever direction per normal force.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};
const SHEAR: ParamSpec = ParamSpec {
    name: "shear_friction",
    symbol: "nu_s",
    doc: "Largest force in the x-y plane per normal force, whatever acts across it.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};
const VERTICAL: ParamSpec = ParamSpec {
    name: "vertical_friction",
    symbol: "nu_s",
    doc: "Largest force across the x-y plane per normal force, whatever acts in it.",
    dimension: Dimension::DIMENSIONLESS,
    range: COEFFICIENT,
};

/// The tangential forces between rolling spheres of Kondic 1999: shear in the plane of the surface, Eqs. (3)-(5), and the
/// force that their rolling makes across it, Eqs. (6)-(8).
pub struct KondicFriction;

#[derive(Clone, Copy)]
struct Limits {
    rate: f64,
    shear: f64,
    vertical: f64,
    separate: bool,
}

impl Limits {
    fn new(params: &Params) -> Result<Self, LawError> {
        let rate = params.value(&RATE)?;
        Ok(if params.form() == 0 {
            let both = params.value(&FRICTION)?;
            Self { rate, shear: both, vertical: both, separate: false }
        } else {
            Self { rate, shear: params.value(&SHEAR)?, vertical: params.value(&VERTICAL)?, separate: true }
        })
    }
}

impl ContactLaw for KondicFriction {
    const INFO: LawInfo = LawInfo {
        name: "KondicFriction",
        summary: "Viscous force against the slip between spheres that roll on the x-y plane, cut off by friction as a vector, \
                  or in the plane and across it.",
        formula: "isotropic: f_t = -min(gamma_S m12 |v_t|, nu_s f_n) v_t/|v_t|\n\
                  separate: the same for each of two directions, s = k x n/|k x n| and n x s, with k along z",
        sources: &[
            Source {
                work: "Kondic 1999",
                place: "Eqs. (3)-(8)",
                note: "separate limits; for any order of the bodies (erratum K-E38). Free spheres lose (1 + Q) times as much slip \
                       as frozen rotation would let them: v_t'/v_t = e^(7/2) at gamma_S = gamma_N/2, not e (erratum K-E35)",
            },
            Source {
                work: "Kondic 1999",
                place: "Eqs. (4) and (6)",
                note: "the isotropic limit of a law of friction: separate ones allow sqrt(2) nu_s f_n (erratum K-E36)",
            },
        ],
        slot: Slot::Tangential,
        reads: Columns::TANGENTIAL_VELOCITY.and(Columns::NORMAL_FORCE).and(Columns::REDUCED_MASS),
        writes: Columns::TANGENTIAL_FORCE,
        history: &[],
        parameters: &[&RATE, &FRICTION, &SHEAR, &VERTICAL],
        forms: &[
            Form { doc: "One limit for the whole force.", required: &[&RATE, &FRICTION], optional: &[] },
            Form {
                doc: "As in the paper: limits of their own for the parts in the plane and across it.",
                required: &[&RATE, &SHEAR, &VERTICAL],
                optional: &[],
            },
        ],
        // Separate limits know which way is up, so only those that do not act follow a turned frame.
        examples: &[
            &[("damping_rate", 4000.0), ("friction", 0.5)],
            &[("damping_rate", 4000.0), ("friction", f64::INFINITY)],
            &[
                ("damping_rate", 1000.0),
                ("shear_friction", f64::INFINITY),
                ("vertical_friction", f64::INFINITY),
            ],
        ],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let limits = Limits::new(params)?;
        let repulsive = pair.conventions.coulomb_cap == CoulombCap::Repulsive;
        let rate = T::of(limits.rate);
        let (shear, vertical) = (T::of(limits.shear), T::of(limits.vertical));
        Ok(if limits.separate {
            vectorised(Viscous::<T, true> { rate, shear, vertical, repulsive })
        } else {
            vectorised(Viscous::<T, false> { rate, shear, vertical, repulsive })
        })
    }

    /// The time in which the force would stop the slip.
    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let rate = Limits::new(params)?.rate;
        if rate == 0.0 {
            return Ok(None);
        }
        let felt = rate * impact.reduced_mass * (1.0 + 1.0 / pair.inertia_factor.min);
        Ok(Some(TimeScale {
            duration: impact.reduced_mass / felt,
            stiffness: 0.0,
            damping: felt,
            overlap: 0.0,
        }))
    }

    /// Kondic 1999, Eqs. (4)-(5) without a limit: exp(-(1 + Q) γ_S t); with one, the equation of motion is integrated. There
    /// is no answer for separate limits, whose force is not along the slip.
    fn oracle(params: &Params, _pair: &PairContext) -> Oracle {
        let Ok(limits) = Limits::new(params) else { return Oracle::Missing };
        Oracle::Tangential(Box::new(move |impact| after(&limits, impact)))
    }
}

register_law!(KondicFriction);

fn after(limits: &Limits, impact: &ObliqueImpact) -> Option<f64> {
    let coefficient = limits.rate * impact.impact.reduced_mass;
    let mass = impact.tangential_mass;
    if limits.shear == f64::INFINITY && limits.vertical == f64::INFINITY {
        return Some(impact.tangential_speed * (-coefficient * impact.duration / mass).exp());
    }
    if limits.separate {
        return None;
    }
    let omega = std::f64::consts::PI / impact.duration;
    let peak = limits.shear * impact.normal_stiffness * impact.impact.normal_speed / omega;
    let [velocity] = reference::integrate([impact.tangential_speed], impact.duration, |time, [v]| {
        let limit = peak * (omega * time).sin().max(0.0);
        [-(coefficient * v.abs()).min(limit) * v.signum() / mass]
    });
    Some(velocity)
}

struct Viscous<T, const SEPARATE: bool> {
    rate: T,
    shear: T,
    vertical: T,
    repulsive: bool,
}

/// Force per velocity, at most `limit` over the speed.
#[inline(always)]
fn share<T: Real>(damping: T, speed: T, limit: T) -> T {
    if damping * speed > limit { limit / speed } else { damping }
}

impl<T: Real, const SEPARATE: bool> Stage<T> for Viscous<T, SEPARATE> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let mass = &chunk.reduced_mass[..n];
        let normal_force = &chunk.normal_force[..n];
        let [nx, ny, nz] = chunk.normal;
        let [vx, vy, vz] = chunk.tangential_velocity;
        let [fx, fy, fz] = &mut chunk.tangential_force;
        let mut slides = [false; CHUNK];
        for k in 0..n {
            let damping = self.rate * mass[k];
            let force = if self.repulsive { normal_force[k].max(T::ZERO) } else { normal_force[k].abs() };
            let v = [vx[k], vy[k], vz[k]];
            let (mut up, mut part) = ([T::ZERO; 3], T::ZERO);
            if SEPARATE {
                // n x s: upwards in the tangent plane; any direction is as good where the normal is along z.
                let flat = (nx[k] * nx[k] + ny[k] * ny[k]).sqrt();
                if flat > T::ZERO {
                    up = [-(nz[k] * nx[k]) / flat, -(nz[k] * ny[k]) / flat, flat];
                }
                part = v[0] * up[0] + v[1] * up[1] + v[2] * up[2];
            }
            let rest = [v[0] - part * up[0], v[1] - part * up[1], v[2] - part * up[2]];
            let speed = (rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]).sqrt();
            let across = share(damping, part.abs(), self.vertical * force) * part;
            let within = share(damping, speed, self.shear * force);
            let acts = overlap[k] > T::ZERO;
            fx[k] = (T::ZERO - (within * rest[0] + across * up[0])).keep_if(acts);
            fy[k] = (T::ZERO - (within * rest[1] + across * up[1])).keep_if(acts);
            fz[k] = (T::ZERO - (within * rest[2] + across * up[2])).keep_if(acts);
            slides[k] = damping * speed > self.shear * force || damping * part.abs() > self.vertical * force;
        }
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                let lost = T::ZERO - (fx[k] * vx[k] + fy[k] * vy[k] + fz[k] * vz[k]);
                energy.elastic[k] = T::ZERO;
                energy.viscous[k] = lost.keep_if(!slides[k]);
                energy.friction[k] = lost.keep_if(slides[k]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_law_api::testing::{Contacts, conformance};

    #[test]
    fn conforms() {
        conformance::<KondicFriction>();
    }

    fn force(given: &[(&str, f64)], normal: [f64; 3], velocity: [f64; 3], load: f64) -> [f64; 3] {
        let params = Params::new(&KondicFriction::INFO, given).unwrap();
        let stage =
            KondicFriction::compile::<f64>(&params, &PairContext::single(1.0, 1.0, 0.4, 1.0)).unwrap();
        let mut contact = Contacts::<f64>::new(1, 0);
        contact.overlap[0] = 1e-3;
        contact.normal_force[0] = load;
        for axis in 0..3 {
            contact.normal[axis][0] = normal[axis];
            contact.tangential_velocity[axis][0] = velocity[axis];
        }
        contact.run(&*stage, 0.0);
        [0, 1, 2].map(|axis: usize| contact.tangential_force[axis][0])
    }

    const BOX: &[(&str, f64)] =
        &[("damping_rate", 10.0), ("shear_friction", 0.5), ("vertical_friction", 0.5)];
    const ROUND: &[(&str, f64)] = &[("damping_rate", 10.0), ("friction", 0.5)];

    #[test]
    fn separate_limits_make_a_box_and_a_common_one_a_circle() {
        // Erratum K-E36: along both directions at once the box lets sqrt(2) times as much through.
        let [x, y, z] = force(BOX, [1.0, 0.0, 0.0], [0.0, 3.0, 4.0], 2.0);
        assert_eq!((x, y, z), (0.0, -1.0, -1.0));
        let [_, y, z] = force(ROUND, [1.0, 0.0, 0.0], [0.0, 3.0, 4.0], 2.0);
        assert!((y + 0.6).abs() < 1e-15 && (z + 0.8).abs() < 1e-15);
        // Below the limits both are the same.
        for given in [BOX, ROUND] {
            let [_, y, z] = force(given, [1.0, 0.0, 0.0], [0.0, 0.03, 0.04], 2.0);
            assert!((y + 0.3).abs() < 1e-15 && (z + 0.4).abs() < 1e-15);
        }
    }

    #[test]
    fn the_parts_are_those_of_the_paper_for_any_normal() {
        // Eq. (3): s = (n.j, -n.i); the rest of the slip is along z for normals in the plane.
        let n = [0.6, 0.8, 0.0];
        let s = [n[1], -n[0], 0.0];
        let f = force(BOX, n, [0.02 * s[0], 0.02 * s[1], 7.0], 2.0);
        let shear = f[0] * s[0] + f[1] * s[1];
        assert!((shear + 0.2).abs() < 1e-15 && (f[2] + 1.0).abs() < 1e-15, "{f:?}");
        // Bodies of different size touch at a slope: force and slip stay in the tangent plane.
        let n = [0.48, 0.64, 0.6];
        let f = force(BOX, n, [0.8, -0.6, 0.0], 2.0);
        assert!((f[0] * n[0] + f[1] * n[1] + f[2] * n[2]).abs() < 1e-15);
        assert!((f[0] + 0.8).abs() < 1e-15 && (f[1] - 0.6).abs() < 1e-15, "{f:?}");
        // Straight above each other no direction is special.
        let f = force(BOX, [0.0, 0.0, 1.0], [3.0, 4.0, 0.0], 2.0);
        assert!((f[0] + 0.6).abs() < 1e-15 && (f[1] + 0.8).abs() < 1e-15, "{f:?}");
    }
}
