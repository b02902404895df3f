//! The general power law.

use granule_law_api::testing::reference;
use granule_law_api::{
    Bound, Columns, ContactChunk, ContactEnd, ContactLaw, Dimension, DurationRule, Form, Impact,
    ImpactOutcome, LawError, LawInfo, NormalSummary, Oracle, PairContext, ParamSpec, Params, Real, Slot,
    Source, Stage, TimeScale, ValueRange, oscillator, register_law, vectorised,
};

use crate::closed_form::PowerContact;
use crate::design;

const MODULUS: ParamSpec = ParamSpec {
    name: "modulus",
    symbol: "Y",
    doc: "Modulus of the elastic force; 2/3 E* for the Hertz exponent.",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
const EXPONENT: ParamSpec = ParamSpec {
    name: "exponent",
    symbol: "alpha",
    doc: "Non-linearity: the elastic force goes with delta^(1+alpha); 0 is linear, 1/2 is Hertz.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(0.0), high: Bound::Inclusive(4.0), infinite: false },
};
const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Restitution of a head-on impact under the chosen end of contact, at every speed; zero would need infinite damping.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};
const DAMPING: ParamSpec = ParamSpec {
    name: "damping",
    symbol: "gamma",
    doc: "Damping coefficient at an overlap of one reduced diameter and at the reference speed.",
    dimension: Dimension::DAMPING,
    range: ValueRange::NON_NEGATIVE,
};
const OVERLAP_EXPONENT: ParamSpec = ParamSpec {
    name: "overlap_exponent",
    symbol: "zeta_0",
    doc: "The damping coefficient goes with (delta/d)^zeta_0.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(0.0), high: Bound::Inclusive(4.0), infinite: false },
};
const VELOCITY_EXPONENT: ParamSpec = ParamSpec {
    name: "velocity_exponent",
    symbol: "zeta_1",
    doc: "The damping coefficient goes with |v_n/v_ref|^zeta_1.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange { low: Bound::Inclusive(0.0), high: Bound::Inclusive(4.0), infinite: false },
};
const REFERENCE_SPEED: ParamSpec = ParamSpec {
    name: "reference_speed",
    symbol: "v_ref",
    doc: "Speed to which the velocity exponent refers.",
    dimension: Dimension::VELOCITY,
    range: ValueRange::POSITIVE,
};

/// Power law f_n = Y d² (δ/d)^(1+α) + γ (δ/d)^ζ0 |v_n/v_ref|^ζ1 v_n (Luding 1998, Eqs. (37) and (38)).
///
/// d = 2 d_i d_j/(d_i + d_j) = 4 R* is the reduced diameter. α = 0 is the linear spring k = Y d, and α = 1/2 is the Hertz
/// contact with Y = 2/3 E*; the law [`Hertz`](crate::Hertz) computes the same without powers.
///
/// The damping is written in SI units: γ in kg/s is the damping coefficient at an overlap of d and at the speed v_ref. The
/// paper's η is γ over these references. Its Eq. (38) has δ'^ζ1, which is complex on unloading or drives instead of damps;
/// |δ'|^ζ1 is meant (erratum L-E19). With 2 (ζ0 + ζ1) + α (ζ1 - 1) = 0 the restitution does not depend on the speed, at any
/// strength of damping (erratum L-E23); the form with `restitution` has ζ0 = α/2, ζ1 = 0 and the coefficient that gives it
/// exactly.
pub struct PowerLaw;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Damping {
    /// γ = 2 β sqrt((2+α)/2 · k_n m12) with the damping ratio β and the secant stiffness k_n.
    Ratio(f64),
    /// γ (δ/d)^ζ0 |v/v_ref|^ζ1.
    General { coefficient: f64, overlap_exponent: f64, velocity_exponent: f64, reference_speed: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Model {
    modulus: f64,
    exponent: f64,
    damping: Damping,
}

impl Model {
    fn new(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        let value = |spec: &ParamSpec| params.value(spec);
        let (modulus, exponent) = (value(&MODULUS)?, value(&EXPONENT)?);
        let general = |coefficient: f64| -> Result<Self, LawError> {
            let damping = Damping::General {
                coefficient,
                overlap_exponent: value(&OVERLAP_EXPONENT)?,
                velocity_exponent: value(&VELOCITY_EXPONENT)?,
                reference_speed: value(&REFERENCE_SPEED)?,
            };
            Ok(Self { modulus, exponent, damping })
        };
        match params.form() {
            0 => {
                let ratio = oscillator::damping_ratio(value(&RESTITUTION)?, pair.contact_end);
                Ok(Self { modulus, exponent, damping: Damping::Ratio(ratio) })
            }
            1 => general(value(&DAMPING)?),
            _ => general(1.0)?.tuned(value(&RESTITUTION)?, value(&REFERENCE_SPEED)?, pair),
        }
    }

    /// The same with the damping coefficient that gives this restitution at this speed, to 1e-7.
    fn tuned(self, restitution: f64, speed: f64, pair: &PairContext) -> Result<Self, LawError> {
        let Damping::General { overlap_exponent, velocity_exponent, reference_speed, .. } = self.damping
        else {
            return Ok(self);
        };
        if !(pair.reduced_mass.is_single() && pair.reduced_radius.is_single()) {
            let (mass, radius) = (pair.reduced_mass, pair.reduced_radius);
            return Err(LawError::new(format!(
                "one damping coefficient gives one restitution at one reduced mass and radius, but the bodies have {:e} to {:e} \
                 kg and {:e} to {:e} m",
                mass.min, mass.max, radius.min, radius.max
            ))
            .at("restitution")
            .help("give damping, or leave out reference_speed for a restitution that is the same for every pair"));
        }
        let impact = Impact {
            reduced_mass: pair.reduced_mass.max,
            reduced_radius: pair.reduced_radius.max,
            normal_speed: speed,
        };
        let with = |coefficient: f64| Self {
            damping: Damping::General { coefficient, overlap_exponent, velocity_exponent, reference_speed },
            ..self
        };
        // Critical damping at the largest overlap, in units of the coefficient.
        let overlap = with(0.0).outcome(&impact, pair.contact_end).maximum_overlap;
        let (stiffness, unit) = with(1.0).at(overlap, speed, impact.reduced_mass, impact.reduced_radius);
        let scale = (stiffness * impact.reduced_mass).sqrt() / unit;
        let coefficient = design::coefficient(restitution, scale, |coefficient| {
            with(coefficient).outcome(&impact, pair.contact_end).restitution
        });
        Ok(with(coefficient))
    }

    /// Secant stiffness and damping coefficient.
    fn at(&self, overlap: f64, velocity: f64, mass: f64, radius: f64) -> (f64, f64) {
        let diameter = 4.0 * radius;
        let strain = overlap / diameter;
        let stiffness = self.modulus * diameter * strain.powf(self.exponent);
        let damping = match self.damping {
            Damping::Ratio(ratio) => 2.0 * ratio * (0.5 * (2.0 + self.exponent) * stiffness * mass).sqrt(),
            Damping::General { coefficient, overlap_exponent, velocity_exponent, reference_speed } => {
                coefficient
                    * strain.powf(overlap_exponent)
                    * (velocity.abs() / reference_speed).powf(velocity_exponent)
            }
        };
        (stiffness, damping)
    }

    fn outcome(&self, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
        let (mass, radius) = (impact.reduced_mass, impact.reduced_radius);
        let diameter = 4.0 * radius;
        let contact = |damping_ratio: f64| PowerContact {
            exponent: self.exponent,
            stiffness: self.modulus * diameter.powf(1.0 - self.exponent),
            damping_ratio,
        };
        match self.damping {
            Damping::Ratio(ratio) => contact(ratio).outcome(impact, end),
            Damping::General { coefficient: 0.0, .. } => contact(0.0).outcome(impact, end),
            Damping::General { .. } => {
                let scale = contact(0.0).outcome(impact, end).duration;
                reference::impact(impact, end, scale, |overlap, velocity| {
                    let (stiffness, damping) = self.at(overlap, velocity, mass, radius);
                    stiffness * overlap + damping * velocity
                })
            }
        }
    }
}

impl ContactLaw for PowerLaw {
    const INFO: LawInfo = LawInfo {
        name: "PowerLaw",
        summary: "Elastic force and damping as powers of overlap and speed; linear and Hertz contacts are special cases.",
        formula: "f_n = Y d^2 (delta/d)^(1+alpha) + gamma (delta/d)^zeta_0 |v_n/v_ref|^zeta_1 v_n, d = 4 R*; with the contact \
                  end `force`: max(f_n, 0)",
        sources: &[
            Source { work: "Luding 1998", place: "Eqs. (37), (39)-(44)", note: "errata L-E23, L-E26" },
            Source {
                work: "Luding 1998",
                place: "Eq. (38)",
                note: "erratum L-E19: the magnitude of the velocity is raised to zeta_1",
            },
        ],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY.and(Columns::REDUCED_MASS).and(Columns::REDUCED_RADIUS),
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[],
        parameters: &[
            &MODULUS,
            &EXPONENT,
            &RESTITUTION,
            &DAMPING,
            &OVERLAP_EXPONENT,
            &VELOCITY_EXPONENT,
            &REFERENCE_SPEED,
        ],
        forms: &[
            Form {
                doc: "Physical intent: zeta_0 = alpha/2, zeta_1 = 0 and the damping that gives exactly this restitution at every \
                      speed and mass.",
                required: &[&MODULUS, &EXPONENT, &RESTITUTION],
                optional: &[],
            },
            Form {
                doc: "Damping of any exponents; the restitution may depend on the speed.",
                required: &[&MODULUS, &EXPONENT, &DAMPING],
                optional: &[(&OVERLAP_EXPONENT, 0.0), (&VELOCITY_EXPONENT, 0.0), (&REFERENCE_SPEED, 1.0)],
            },
            Form {
                doc: "Damping of any exponents, with the coefficient that gives this restitution at the reference speed; for one \
                      reduced mass and radius.",
                required: &[&MODULUS, &EXPONENT, &RESTITUTION, &REFERENCE_SPEED],
                optional: &[(&OVERLAP_EXPONENT, 0.0), (&VELOCITY_EXPONENT, 0.0)],
            },
        ],
        examples: &[
            &[("modulus", 3e7), ("exponent", 0.5), ("restitution", 0.8)],
            &[("modulus", 3e7), ("exponent", 1.0), ("restitution", 0.6)],
            &[("modulus", 3e7), ("exponent", 0.5), ("damping", 0.0)],
            &[("modulus", 3e7), ("exponent", 0.5), ("damping", 5.0), ("overlap_exponent", 0.5)],
            &[
                ("modulus", 3e7),
                ("exponent", 0.5),
                ("damping", 0.1),
                ("velocity_exponent", 0.2),
                ("reference_speed", 0.5),
            ],
            &[
                ("modulus", 3e7),
                ("exponent", 0.5),
                ("restitution", 0.7),
                ("reference_speed", 0.5),
                ("overlap_exponent", 0.5),
            ],
        ],
        contact_ends: &[ContactEnd::Force, ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let model = Model::new(params, pair)?;
        let exponent = T::of(model.exponent);
        let (ratio, factor, overlap_exponent, velocity_exponent, reference_speed) = match model.damping {
            Damping::Ratio(ratio) => {
                (true, 2.0 * ratio * (0.5 * (2.0 + model.exponent)).sqrt(), 0.0, 0.0, 1.0)
            }
            Damping::General { coefficient, overlap_exponent, velocity_exponent, reference_speed } => {
                (false, coefficient, overlap_exponent, velocity_exponent, reference_speed)
            }
        };
        LawError::unless_finite::<T>(&[("modulus", model.modulus), ("damping", factor)])?;
        let stage = Power {
            modulus: T::of(model.modulus),
            exponent,
            factor: T::of(factor),
            overlap_exponent: T::of(overlap_exponent),
            velocity_exponent: T::of(velocity_exponent),
            reference_speed: T::of(reference_speed),
            ratio,
            clamp: pair.contact_end == ContactEnd::Force,
        };
        Ok(vectorised(stage))
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
        let (mass, radius, overlap) = (impact.reduced_mass, impact.reduced_radius, outcome.maximum_overlap);
        let (secant, damping) = model.at(overlap, impact.normal_speed, mass, radius);
        let stiffness = (1.0 + model.exponent) * secant;
        Ok(Some(TimeScale { duration, stiffness, damping, overlap }))
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

register_law!(PowerLaw);

/// The loop. Powers cost far more than everything else, so that the choices are not worth a version each.
struct Power<T> {
    modulus: T,
    exponent: T,
    factor: T,
    overlap_exponent: T,
    velocity_exponent: T,
    reference_speed: T,
    ratio: bool,
    clamp: bool,
}

impl<T: Real> Power<T> {
    /// Secant stiffness and damping of a contact that touches.
    #[inline(always)]
    fn at(&self, overlap: T, velocity: T, mass: T, radius: T) -> (T, T) {
        let diameter = T::of(4.0) * radius;
        let strain = overlap.max(T::ZERO) / diameter;
        let stiffness = self.modulus * diameter * strain.powf(self.exponent);
        let damping = if self.ratio {
            self.factor * (stiffness * mass).sqrt()
        } else {
            self.factor
                * strain.powf(self.overlap_exponent)
                * (velocity.abs() / self.reference_speed).powf(self.velocity_exponent)
        };
        (stiffness, damping)
    }
}

impl<T: Real> Stage<T> for Power<T> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let velocity = &chunk.normal_velocity[..n];
        let mass = &chunk.reduced_mass[..n];
        let radius = &chunk.reduced_radius[..n];
        let force = &mut chunk.normal_force[..n];
        let share = T::ONE / (T::of(2.0) + self.exponent);
        for k in 0..n {
            let (stiffness, damping) = self.at(overlap[k], velocity[k], mass[k], radius[k]);
            let elastic = stiffness * overlap[k];
            let total = elastic + damping * velocity[k];
            let total = if self.clamp { total.max(T::ZERO) } else { total };
            let touches = overlap[k] > T::ZERO;
            force[k] = total.keep_if(touches);
            if let Some(out) = chunk.normal_stiffness.get_mut(k) {
                *out = stiffness;
            }
            if let Some(out) = chunk.normal_damping.get_mut(k) {
                *out = damping;
            }
            if let Some(energy) = &mut chunk.energy {
                // What the motion puts in and the elastic force does not take up is dissipated.
                let spring = elastic.keep_if(touches);
                energy.elastic[k] = share * spring * overlap[k];
                energy.viscous[k] = (force[k] - spring) * velocity[k];
                energy.friction[k] = T::ZERO;
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
        conformance::<PowerLaw>();
    }

    fn force(values: &[(&str, f64)], overlap: f64, radius: f64) -> f64 {
        let params = Params::new(&PowerLaw::INFO, values).unwrap();
        let pair = PairContext::single(1.0, radius, 0.4, 1.0);
        let stage = PowerLaw::compile::<f64>(&params, &pair).unwrap();
        let mut contact = Contacts::new(1, 0);
        contact.overlap[0] = overlap;
        contact.reduced_radius[0] = radius;
        contact.run(&*stage, 0.0);
        contact.normal_force[0]
    }

    /// Case A07: Luding 1998, Eq. (37), is the Hertz contact for unequal spheres and for a wall, d = 2 d_i d_j/(d_i + d_j).
    #[test]
    fn hertz_is_the_exponent_one_half() {
        let modulus = 7e7;
        for (i, j) in [(1e-3, 3e-3), (1e-3, f64::INFINITY)] {
            // Radii are half the diameters; R* = R_i at a wall.
            let radius = 0.5 / (1.0 / i + 1.0 / j);
            let d = 2.0 / (1.0 / i + 1.0 / j);
            let overlap: f64 = 2e-5;
            let hertz = 4.0 / 3.0 * modulus * f64::sqrt(radius) * overlap.powf(1.5);
            let values = [("modulus", 2.0 / 3.0 * modulus), ("exponent", 0.5), ("damping", 0.0)];
            let found = force(&values, overlap, radius);
            // A power and a handful of products: 1e-12 is some thousand ulps.
            approx::assert_relative_eq!(found, hertz, max_relative = 1e-12);
            let printed = values[0].1 * d * d * (overlap / d).powf(1.5);
            approx::assert_relative_eq!(found, printed, max_relative = 1e-12);
        }
    }

    fn restitution(exponents: [f64; 3], damping: f64, speed: f64) -> f64 {
        let [exponent, overlap_exponent, velocity_exponent] = exponents;
        let values = [
            ("modulus", 3e7),
            ("exponent", exponent),
            ("damping", damping),
            ("overlap_exponent", overlap_exponent),
            ("velocity_exponent", velocity_exponent),
        ];
        let params = Params::new(&PowerLaw::INFO, &values).unwrap();
        let pair = PairContext::single(1e-4, 1e-3, 0.4, speed);
        let Oracle::Normal(oracle) = PowerLaw::oracle(&params, &pair) else { panic!("no oracle") };
        oracle(&Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: speed }).restitution
    }

    /// Luding 1998, Eq. (43): 1-e goes with v^(-1/5), v^0, v^(1/5) for ζ0 = 0, 1/4, 1/2 and α = 1/2.
    #[test]
    fn loss_scales_with_the_speed_as_predicted() {
        for (overlap_exponent, slope) in [(0.0, -0.2), (0.25, 0.0), (0.5, 0.2)] {
            let loss = |speed| 1.0 - restitution([0.5, overlap_exponent, 0.0], 1e-3, speed);
            let found = (loss(0.2_f64) / loss(0.1)).log2();
            // The exponent is that of the limit of weak damping, 1-e below 1 % here.
            assert!((found - slope).abs() < 2e-3, "{overlap_exponent}: {found}");
        }
    }

    /// 2 (ζ0 + ζ1) + α (ζ1 - 1) = 0 gives a restitution independent of the speed, at strong damping too (erratum L-E23).
    #[test]
    fn balanced_exponents_give_a_constant_restitution_at_strong_damping() {
        for (exponents, damping) in [([0.5, 0.25, 0.0], 5.0), ([0.5, 0.0, 0.2], 0.5)] {
            let e = [0.01, 0.1, 1.0].map(|speed| restitution(exponents, damping, speed));
            assert!(e[0] < 0.9, "not strong: {e:?}");
            // The reference integration is good to 1e-8.
            assert!((e[0] - e[1]).abs() < 1e-7 && (e[1] - e[2]).abs() < 1e-7, "{e:?}");
        }
    }

    /// Any exponents can be tuned to a restitution at a speed, for both ends of contact.
    #[test]
    fn damping_is_found_from_the_restitution_at_a_speed() {
        for end in [ContactEnd::Force, ContactEnd::Overlap] {
            for [exponent, overlap_exponent, velocity_exponent] in
                [[0.5, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [1.0, 0.3, 0.2]]
            {
                for wanted in [0.9, 0.4] {
                    let values = [
                        ("modulus", 3e7),
                        ("exponent", exponent),
                        ("restitution", wanted),
                        ("reference_speed", 0.3),
                        ("overlap_exponent", overlap_exponent),
                        ("velocity_exponent", velocity_exponent),
                    ];
                    let params = Params::new(&PowerLaw::INFO, &values).unwrap();
                    let pair = PairContext { contact_end: end, ..PairContext::single(2e-5, 1e-3, 0.4, 0.3) };
                    let impact = Impact { reduced_mass: 2e-5, reduced_radius: 1e-3, normal_speed: 0.3 };
                    let stage = PowerLaw::compile::<f64>(&params, &pair).unwrap();
                    let found = reference::impact_with(&*stage, &impact, end, 1e-4).restitution;
                    // The stated accuracy.
                    assert!((found - wanted).abs() < 2e-7, "{end:?} {values:?}: {found}");
                }
            }
        }
    }

    /// Erratum L-E19: with the printed δ'^ζ1 an even exponent drives the unloading and a fractional one has no real value.
    #[test]
    fn printed_damping_is_not_a_damping() {
        let impact = Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: 0.5 };
        let stiffness = 1e5;
        let run = |damping: fn(f64) -> f64| {
            reference::impact(&impact, ContactEnd::Overlap, 1e-4, |overlap, velocity| {
                stiffness * overlap + 2.0 * damping(velocity / 0.5) * 0.5
            })
            .restitution
        };
        let corrected = run(|v| v.abs().powi(1) * v);
        let printed = run(|v| v * v);
        assert!(corrected < 0.8, "{corrected}");
        // Printed, what the loading loses the unloading gains.
        assert!(printed > 0.95, "{printed}");
        assert!((-0.5_f64).powf(0.2).is_nan());
    }
}
