//! Hertz contact with damping.

use granule_law_api::testing::reference;
use granule_law_api::{
    Bound, Columns, ContactChunk, ContactEnd, ContactLaw, Dimension, DurationRule, Form, Impact,
    ImpactOutcome, LawError, LawInfo, NormalSummary, Oracle, PairContext, ParamSpec, Params, Real, Slot,
    Source, Stage, TimeScale, ValueRange, oscillator, register_law, vectorised,
};

use crate::closed_form::PowerContact;

const EFFECTIVE_MODULUS: ParamSpec = ParamSpec {
    name: "effective_modulus",
    symbol: "E*",
    doc: "Effective modulus, 1/E* = (1-nu_i^2)/E_i + (1-nu_j^2)/E_j.",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
const YOUNGS_MODULUS: ParamSpec = ParamSpec {
    name: "youngs_modulus",
    symbol: "E",
    doc: "Young's modulus of both bodies.",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
const POISSON_RATIO: ParamSpec = ParamSpec {
    name: "poisson_ratio",
    symbol: "nu",
    doc: "Poisson's ratio of both bodies.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Exclusive(-1.0), high: Bound::Inclusive(0.5), infinite: false },
};
const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Restitution of a head-on impact under the chosen end of contact, at every speed; zero would need infinite damping.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};
const DAMPING_COEFFICIENT: ParamSpec = ParamSpec {
    name: "damping_coefficient",
    symbol: "alpha",
    doc: "gamma = alpha sqrt(m12 k_n) with the secant stiffness k_n = 4/3 E* sqrt(R* delta): the Tsuji coefficient of LAMMPS \
          pair granular; LIGGGHTS hertz has alpha = sqrt(5) |ln e|/sqrt(pi^2 + ln^2 e).",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::NON_NEGATIVE,
};
const STIFFNESS_PRESSURE: ParamSpec = ParamSpec {
    name: "stiffness_pressure",
    symbol: "K_n",
    doc: "Stiffness per contact radius, 4/3 E* (K_n of LAMMPS gran/hertz).",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
const DAMPING_RATE_PER_LENGTH: ParamSpec = ParamSpec {
    name: "damping_rate_per_length",
    symbol: "gamma_n",
    doc: "gamma_n of LAMMPS gran/hertz: damping coefficient m12 gamma_n sqrt(R* delta).",
    dimension: Dimension::new(-1, 0, -1),
    range: ValueRange::NON_NEGATIVE,
};

/// Hertz contact of elastic spheres with damping: f_n = 4/3 E* sqrt(R* δ) δ + γ v_n, the case α = 1/2 of Luding 1998,
/// Eq. (37).
///
/// With a damping in proportion to δ^(1/4) the restitution does not depend on the speed (Tsuji, Tanaka and Ishida 1992),
/// and it is known in closed form for both ends of contact (erratum L-E26).
pub struct Hertz;

/// Damping coefficient γ of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damping {
    /// Factor times sqrt(m12 k_n).
    Root(f64),
    /// Factor times m12 sqrt(R* δ).
    MassContactRadius(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Model {
    /// Secant stiffness over contact radius sqrt(R* δ) \[Pa\].
    pressure: f64,
    damping: Damping,
}

/// Damping coefficient over damping ratio: γ = 2 β sqrt(5/4 k_n m12).
const COEFFICIENT_PER_RATIO: f64 = 2.236_067_977_499_79;

impl Model {
    fn new(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        let value = |spec: &ParamSpec| params.value(spec);
        let tuned = || -> Result<Damping, LawError> {
            let ratio = oscillator::damping_ratio(value(&RESTITUTION)?, pair.contact_end);
            Ok(Damping::Root(COEFFICIENT_PER_RATIO * ratio))
        };
        let four_thirds = 4.0 / 3.0;
        Ok(match params.form() {
            0 => Self { pressure: four_thirds * value(&EFFECTIVE_MODULUS)?, damping: tuned()? },
            1 => {
                let nu = value(&POISSON_RATIO)?;
                let modulus = value(&YOUNGS_MODULUS)? / (2.0 * (1.0 - nu * nu));
                Self { pressure: four_thirds * modulus, damping: tuned()? }
            }
            2 => Self {
                pressure: four_thirds * value(&EFFECTIVE_MODULUS)?,
                damping: Damping::Root(value(&DAMPING_COEFFICIENT)?),
            },
            _ => Self {
                pressure: value(&STIFFNESS_PRESSURE)?,
                damping: Damping::MassContactRadius(value(&DAMPING_RATE_PER_LENGTH)?),
            },
        })
    }

    /// Secant stiffness and damping coefficient.
    fn at(&self, overlap: f64, mass: f64, radius: f64) -> (f64, f64) {
        let contact_radius = (radius * overlap).sqrt();
        let stiffness = self.pressure * contact_radius;
        let damping = match self.damping {
            Damping::Root(factor) => factor * (mass * stiffness).sqrt(),
            Damping::MassContactRadius(rate) => rate * mass * contact_radius,
        };
        (stiffness, damping)
    }

    fn outcome(&self, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
        let (mass, radius) = (impact.reduced_mass, impact.reduced_radius);
        let contact = |damping_ratio: f64| PowerContact {
            exponent: 0.5,
            stiffness: self.pressure * radius.sqrt(),
            damping_ratio,
        };
        match self.damping {
            Damping::Root(factor) => contact(factor / COEFFICIENT_PER_RATIO).outcome(impact, end),
            Damping::MassContactRadius(0.0) => contact(0.0).outcome(impact, end),
            Damping::MassContactRadius(_) => {
                let scale = contact(0.0).outcome(impact, end).duration;
                reference::impact(impact, end, scale, |overlap, velocity| {
                    let (stiffness, damping) = self.at(overlap, mass, radius);
                    stiffness * overlap + damping * velocity
                })
            }
        }
    }
}

impl ContactLaw for Hertz {
    const INFO: LawInfo = LawInfo {
        name: "Hertz",
        summary: "Elastic spheres (Hertz 1882) with damping; stiffer at larger overlap and speed.",
        formula: "f_n = 4/3 E* sqrt(R* delta) delta + gamma v_n; with the contact end `force`: max(f_n, 0)",
        sources: &[
            Source { work: "Hertz 1882", place: "J. Reine Angew. Math. 92, 156", note: "" },
            Source {
                work: "Luding 1998",
                place: "Eqs. (37)-(44)",
                note: "alpha = 1/2, zeta_0 = 1/4, zeta_1 = 0; erratum L-E26: exact restitution at any damping",
            },
            Source {
                work: "Tsuji, Tanaka and Ishida 1992",
                place: "Eq. (9)",
                note: "coefficient from the exact restitution instead of a fit",
            },
        ],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY.and(Columns::REDUCED_MASS).and(Columns::REDUCED_RADIUS),
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[],
        parameters: &[
            &EFFECTIVE_MODULUS,
            &YOUNGS_MODULUS,
            &POISSON_RATIO,
            &RESTITUTION,
            &DAMPING_COEFFICIENT,
            &STIFFNESS_PRESSURE,
            &DAMPING_RATE_PER_LENGTH,
        ],
        forms: &[
            Form {
                doc: "Effective modulus of the pair, and exactly this restitution at every speed and mass.",
                required: &[&EFFECTIVE_MODULUS, &RESTITUTION],
                optional: &[],
            },
            Form {
                doc: "Two bodies of one material, and exactly this restitution.",
                required: &[&YOUNGS_MODULUS, &POISSON_RATIO, &RESTITUTION],
                optional: &[],
            },
            Form {
                doc: "Damping coefficient as in LAMMPS pair granular (tsuji) and LIGGGHTS hertz.",
                required: &[&EFFECTIVE_MODULUS, &DAMPING_COEFFICIENT],
                optional: &[],
            },
            Form {
                doc: "As LAMMPS gran/hertz/history and LIGGGHTS hertz/stiffness: damping in proportion to the contact radius; \
                      the restitution depends on the speed.",
                required: &[&STIFFNESS_PRESSURE, &DAMPING_RATE_PER_LENGTH],
                optional: &[],
            },
        ],
        examples: &[
            &[("effective_modulus", 5e7), ("restitution", 0.8)],
            &[("effective_modulus", 5e7), ("restitution", 1.0)],
            &[("effective_modulus", 5e7), ("restitution", 0.05)],
            &[("youngs_modulus", 48e9), ("poisson_ratio", 0.2), ("restitution", 0.9)],
            &[("effective_modulus", 5e7), ("damping_coefficient", 0.12)],
            &[("stiffness_pressure", 7.1e7), ("damping_rate_per_length", 1e6)],
        ],
        contact_ends: &[ContactEnd::Force, ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let model = Model::new(params, pair)?;
        let pressure = T::of(model.pressure);
        let (root, factor) = match model.damping {
            Damping::Root(factor) => (true, T::of(factor)),
            Damping::MassContactRadius(rate) => (false, T::of(rate)),
        };
        Ok(match (root, pair.contact_end) {
            (true, ContactEnd::Force) => vectorised(HertzStage::<T, true, true> { pressure, factor }),
            (true, ContactEnd::Overlap) => vectorised(HertzStage::<T, true, false> { pressure, factor }),
            (false, ContactEnd::Force) => vectorised(HertzStage::<T, false, true> { pressure, factor }),
            (false, ContactEnd::Overlap) => vectorised(HertzStage::<T, false, false> { pressure, factor }),
        })
    }

    /// The duration is that of a force-ended contact where an overlap-ended one would creep for ever.
    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let model = Model::new(params, pair)?;
        let outcome = model.outcome(impact, pair.contact_end);
        let duration = if outcome.duration.is_finite() {
            outcome.duration
        } else {
            model.outcome(impact, ContactEnd::Force).duration
        };
        let (secant, damping) = model.at(outcome.maximum_overlap, impact.reduced_mass, impact.reduced_radius);
        Ok(Some(TimeScale { duration, stiffness: 1.5 * secant, damping, overlap: outcome.maximum_overlap }))
    }

    fn summary(params: &Params, pair: &PairContext) -> Option<NormalSummary> {
        let impact = Impact {
            reduced_mass: pair.reduced_mass.min,
            reduced_radius: pair.reduced_radius.min,
            normal_speed: pair.impact_speed,
        };
        let scale = Self::time_scale(params, pair, &impact).ok().flatten();
        Some(NormalSummary { duration: DurationRule::Unknown, scale })
    }

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        let Ok(model) = Model::new(params, pair) else {
            return Oracle::Missing;
        };
        let end = pair.contact_end;
        Oracle::Normal(Box::new(move |impact| model.outcome(impact, end)))
    }
}

register_law!(Hertz);

/// The loop. `ROOT`: γ = factor sqrt(m12 k_n), else factor m12 sqrt(R* δ). `CLAMP` ends the contact with the force.
struct HertzStage<T, const ROOT: bool, const CLAMP: bool> {
    pressure: T,
    factor: T,
}

impl<T: Real, const ROOT: bool, const CLAMP: bool> HertzStage<T, ROOT, CLAMP> {
    /// Secant stiffness and damping; both zero without overlap.
    #[inline(always)]
    fn at(&self, overlap: T, mass: T, radius: T) -> (T, T) {
        let contact_radius = (radius * overlap.max(T::ZERO)).sqrt();
        let stiffness = self.pressure * contact_radius;
        let damping =
            if ROOT { self.factor * (mass * stiffness).sqrt() } else { self.factor * mass * contact_radius };
        (stiffness, damping)
    }
}

impl<T: Real, const ROOT: bool, const CLAMP: bool> Stage<T> for HertzStage<T, ROOT, CLAMP> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let velocity = &chunk.normal_velocity[..n];
        let mass = &chunk.reduced_mass[..n];
        let radius = &chunk.reduced_radius[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            let (stiffness, damping) = self.at(overlap[k], mass[k], radius[k]);
            let total = stiffness * overlap[k] + damping * velocity[k];
            force[k] = if CLAMP { total.max(T::ZERO) } else { total };
        }
        if !chunk.normal_stiffness.is_empty() {
            let out = &mut chunk.normal_stiffness[..n];
            for k in 0..n {
                out[k] = self.at(overlap[k], mass[k], radius[k]).0;
            }
        }
        if !chunk.normal_damping.is_empty() {
            let out = &mut chunk.normal_damping[..n];
            for k in 0..n {
                out[k] = self.at(overlap[k], mass[k], radius[k]).1;
            }
        }
        if let Some(energy) = &mut chunk.energy {
            let elastic = &mut energy.elastic[..n];
            let viscous = &mut energy.viscous[..n];
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                // What the motion puts in and the elastic force does not take up is dissipated.
                let spring = self.at(overlap[k], mass[k], radius[k]).0 * overlap[k];
                elastic[k] = T::of(0.4) * spring * overlap[k];
                viscous[k] = (force[k] - spring) * velocity[k];
                friction[k] = T::ZERO;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_law_api::testing::{Contacts, conformance};
    use std::f64::consts::PI;

    #[test]
    fn conforms() {
        conformance::<Hertz>();
    }

    fn compiled(values: &[(&str, f64)], end: ContactEnd) -> Box<dyn Stage<f64>> {
        let params = Params::new(&Hertz::INFO, values).unwrap();
        let pair = PairContext { contact_end: end, ..PairContext::single(1e-4, 1e-3, 0.4, 1.0) };
        Hertz::compile::<f64>(&params, &pair).unwrap()
    }

    /// Chung and Ooi 2011, benchmark 1: two spheres of 10 mm radius at 10 m/s each. Largest overlap, largest force and
    /// duration in closed form; the paper's figures read 10.70 kN and 40.48 us for glass.
    #[test]
    fn chung_and_ooi_benchmark_1() {
        for (modulus, nu, density, overlap, force, duration) in [
            (48e9, 0.2, 2800.0, 274.113e-6, 10.6969e3, 40.339e-6),
            (20e9, 0.25, 2500.0, 368.304e-6, 7.1082e3, 54.201e-6),
        ] {
            let radius: f64 = 0.01;
            let mass = 4.0 / 3.0 * PI * radius.powi(3) * density;
            let impact =
                Impact { reduced_mass: 0.5 * mass, reduced_radius: 0.5 * radius, normal_speed: 20.0 };
            let values = [("youngs_modulus", modulus), ("poisson_ratio", nu), ("restitution", 1.0)];
            let params = Params::new(&Hertz::INFO, &values).unwrap();
            let pair = PairContext::single(impact.reduced_mass, impact.reduced_radius, 0.4, 20.0);
            let Oracle::Normal(oracle) = Hertz::oracle(&params, &pair) else { panic!("no oracle") };
            let outcome = oracle(&impact);
            // The references have six digits, the force and the durations five.
            assert!((outcome.maximum_overlap / overlap - 1.0).abs() < 5e-6, "{outcome:?}");
            assert!((outcome.duration / duration - 1.0).abs() < 2e-5, "{outcome:?}");
            let mut contact = Contacts::new(1, 0);
            contact.overlap[0] = outcome.maximum_overlap;
            contact.reduced_radius[0] = impact.reduced_radius;
            contact.run(&*Hertz::compile::<f64>(&params, &pair).unwrap(), 0.0);
            assert!((contact.normal_force[0] / force - 1.0).abs() < 2e-5, "{}", contact.normal_force[0]);
        }
    }

    /// Erratum L-E26, and Chung and Ooi 2011, benchmark 3: what is asked for comes out, under either end, at every speed.
    #[test]
    fn restitution_is_what_was_asked_for() {
        for end in [ContactEnd::Force, ContactEnd::Overlap] {
            for restitution in [0.2, 0.4, 0.6, 0.8, 1.0] {
                let stage = compiled(&[("effective_modulus", 5e7), ("restitution", restitution)], end);
                for speed in [0.01, 3.9] {
                    let impact = Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: speed };
                    let found = reference::impact_with(&*stage, &impact, end, 1e-3).restitution;
                    // The reference integration is good to about 1e-8 on root-like forces.
                    assert!((found - restitution).abs() < 1e-6, "{end:?} {restitution} {speed}: {found}");
                }
            }
        }
    }

    /// LIGGGHTS hertz has 2 sqrt(5/6) |β| sqrt(2 Y* sqrt(R* δ) m12) with β = ln e/sqrt(π² + ln² e), tuned for the overlap end;
    /// with its force limited the restitution is higher (erratum L-E26; measured in LIGGGHTS: .90203, .63229, .39714).
    #[test]
    fn liggghts_damping_is_the_overlap_ended_form() {
        let (modulus, overlap, mass, radius): (f64, f64, f64, f64) = (6e7, 1.7e-5, 3e-5, 7e-4);
        for (restitution, limited) in [(0.9, 0.902026), (0.6, 0.632291), (0.3, 0.397141)] {
            let log = f64::ln(restitution);
            let beta = -log / (log * log + PI * PI).sqrt();
            let printed = 2.0
                * (5.0_f64 / 6.0).sqrt()
                * beta
                * (2.0 * modulus * (radius * overlap).sqrt() * mass).sqrt();
            let coefficient = 5.0_f64.sqrt() * beta;
            for values in [
                [("effective_modulus", modulus), ("restitution", restitution)],
                [("effective_modulus", modulus), ("damping_coefficient", coefficient)],
            ] {
                let mut contact = Contacts::new(1, 0);
                contact.overlap[0] = overlap;
                contact.reduced_mass[0] = mass;
                contact.reduced_radius[0] = radius;
                contact.run(&*compiled(&values, ContactEnd::Overlap), 0.0);
                approx::assert_relative_eq!(contact.normal_damping[0], printed, max_relative = 1e-14);
            }
            let stage = compiled(
                &[("effective_modulus", modulus), ("damping_coefficient", coefficient)],
                ContactEnd::Force,
            );
            let impact = Impact { reduced_mass: mass, reduced_radius: radius, normal_speed: 0.1 };
            let found = reference::impact_with(&*stage, &impact, ContactEnd::Force, 1e-3).restitution;
            assert!((found - limited).abs() < 2e-6, "{restitution}: {found}");
        }
    }

    /// LAMMPS gran/hertz: F_n = sqrt(δ R*) (K_n δ - m12 γ_n v_n), with v_n negative on approach.
    #[test]
    fn lammps_gran_hertz_is_a_form() {
        let stage = compiled(
            &[("stiffness_pressure", 7.11e7), ("damping_rate_per_length", 1.5e8)],
            ContactEnd::Overlap,
        );
        let (overlap, velocity, mass, radius): (f64, f64, f64, f64) = (1e-5, 0.13, 2e-6, 2.7e-4);
        let mut contact = Contacts::new(1, 0);
        contact.overlap[0] = overlap;
        contact.normal_velocity[0] = velocity;
        contact.reduced_mass[0] = mass;
        contact.reduced_radius[0] = radius;
        contact.run(&*stage, 0.0);
        let printed = (overlap * radius).sqrt() * (7.11e7 * overlap + mass * 1.5e8 * velocity);
        approx::assert_relative_eq!(contact.normal_force[0], printed, max_relative = 1e-14);
    }

    #[test]
    fn zero_restitution_is_refused() {
        let errors =
            Params::new(&Hertz::INFO, &[("effective_modulus", 1e7), ("restitution", 0.0)]).unwrap_err();
        assert_eq!(
            errors[0].to_string(),
            "restitution: 0 is not allowed (restitution must be greater than 0 and at most 1)"
        );
    }
}
