//! f_n = k δ + γ_N m12 v_n, with k and γ_N from elastic constants.

use granule_law_api::{
    Columns, ContactChunk, ContactEnd, ContactLaw, Dimension, DurationRule, Form, Impact, ImpactOutcome,
    LawError, LawInfo, NormalSummary, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage,
    TimeScale, ValueRange, oscillator, register_law, vectorised,
};

use crate::material::{collision_time, linear_model};

const YOUNG: ParamSpec = ParamSpec {
    name: "young_modulus",
    symbol: "Y",
    doc: "Young modulus of both bodies.",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};
const POISSON: ParamSpec = ParamSpec {
    name: "poisson_ratio",
    symbol: "sigma",
    doc: "Poisson ratio of both bodies.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange {
        low: granule_law_api::Bound::Exclusive(-1.0),
        high: granule_law_api::Bound::Inclusive(0.5),
        infinite: false,
    },
};
const SPEED: ParamSpec = ParamSpec {
    name: "reference_speed",
    symbol: "v_0",
    doc: "Relative speed of the impact whose Hertz duration the linear spring gets; the duration goes with v_0^(-1/5).",
    dimension: Dimension::VELOCITY,
    range: ValueRange::POSITIVE,
};
const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Restitution of a head-on impact that ends with the overlap.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};
const FORCE_CONSTANT: ParamSpec = ParamSpec {
    name: "force_constant",
    symbol: "k",
    doc: "Force per overlap.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const DAMPING_RATE: ParamSpec = ParamSpec {
    name: "damping_rate",
    symbol: "gamma_N",
    doc: "Damping coefficient per reduced mass.",
    dimension: Dimension::RATE,
    range: ValueRange::NON_NEGATIVE,
};

/// The normal force of Kondic 1999, Eq. (2): a linear spring and dashpot whose constants follow from the Hertz duration of a
/// collision at a reference speed (Appendix B with errata K-E33 and K-E34).
pub struct KondicNormal;

/// k and γ_N m12 of one pair.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Model {
    stiffness: f64,
    rate: f64,
}

impl Model {
    fn new(params: &Params, mass: f64, radius: f64) -> Result<Self, LawError> {
        if params.form() == 1 {
            let (stiffness, rate) = (params.value(&FORCE_CONSTANT)?, params.value(&DAMPING_RATE)?);
            return Ok(Self { stiffness, rate });
        }
        let duration = collision_time(
            mass,
            radius,
            params.value(&YOUNG)?,
            params.value(&POISSON)?,
            params.value(&SPEED)?,
        );
        let (omega, rate) = linear_model(duration, params.value(&RESTITUTION)?);
        Ok(Self { stiffness: mass * omega * omega, rate })
    }

    fn of(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        if params.form() == 0 && !(pair.reduced_mass.is_single() && pair.reduced_radius.is_single()) {
            return Err(LawError::new(
                "elastic constants give one spring to pairs of one mass and radius only",
            )
            .help("give equal spheres, or force_constant and damping_rate"));
        }
        Self::new(params, pair.reduced_mass.max, pair.reduced_radius.max)
    }

    fn outcome(&self, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
        let omega = (self.stiffness / impact.reduced_mass).sqrt();
        let ratio = 0.5 * self.rate / omega;
        ImpactOutcome {
            duration: oscillator::duration(ratio, end) / omega,
            maximum_overlap: impact.normal_speed * oscillator::largest_overlap(ratio) / omega,
            restitution: oscillator::restitution(ratio, end),
        }
    }
}

impl ContactLaw for KondicNormal {
    const INFO: LawInfo = LawInfo {
        name: "KondicNormal",
        summary: "Linear spring and dashpot whose duration is that of a Hertz impact at a reference speed.",
        formula: "f_n = k delta + gamma_N m12 v_n; with the contact end `force`: max(f_n, 0)\n\
                  k = m12 (pi^2 + ln(e_n)^2)/t_col^2, gamma_N = -2 ln(e_n)/t_col\n\
                  t_col = 2.94 (5/4)^(2/5) (m12/((4/3) E* sqrt(R*)))^(2/5) v_0^(-1/5), E* = Y/(2 (1 - sigma^2))",
        sources: &[
            Source { work: "Kondic 1999", place: "Eqs. (2), (A1)-(A6)", note: "exact at any damping" },
            Source {
                work: "Kondic 1999",
                place: "Eqs. (B1) and (B2)",
                note: "errata K-E33, K-E34: 2 E R/m in (B1), exponents 1/(2+b) and -b/(2+b) in (B2). The durations of the paper, \
                       2.55e-5 s for steel spheres at 0.1 m/s, are 2^(2/5) times too long",
            },
        ],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY.and(Columns::REDUCED_MASS),
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[],
        parameters: &[&YOUNG, &POISSON, &SPEED, &RESTITUTION, &FORCE_CONSTANT, &DAMPING_RATE],
        forms: &[
            Form {
                doc: "From elastic constants, for equal spheres; masses and radii are those of the bodies.",
                required: &[&YOUNG, &POISSON, &SPEED, &RESTITUTION],
                optional: &[],
            },
            Form {
                doc: "The constants of the force itself.",
                required: &[&FORCE_CONSTANT, &DAMPING_RATE],
                optional: &[],
            },
        ],
        examples: &[
            &[
                ("young_modulus", 2.06e11),
                ("poisson_ratio", 0.28),
                ("reference_speed", 0.1),
                ("restitution", 0.9),
            ],
            &[
                ("young_modulus", 2.06e11),
                ("poisson_ratio", 0.28),
                ("reference_speed", 0.1),
                ("restitution", 1.0),
            ],
            &[("force_constant", 1e5), ("damping_rate", 1e3)],
        ],
        contact_ends: &[ContactEnd::Force, ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let model = Model::of(params, pair)?;
        let (stiffness, rate) = (T::of(model.stiffness), T::of(model.rate));
        Ok(if pair.contact_end == ContactEnd::Force {
            vectorised(Linear::<T, true> { stiffness, rate })
        } else {
            vectorised(Linear::<T, false> { stiffness, rate })
        })
    }

    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let model = Model::new(params, impact.reduced_mass, impact.reduced_radius)?;
        let outcome = model.outcome(impact, pair.contact_end);
        let duration = if outcome.duration.is_finite() {
            outcome.duration
        } else {
            model.outcome(impact, ContactEnd::Force).duration
        };
        Ok(Some(TimeScale {
            duration,
            stiffness: model.stiffness,
            damping: model.rate * impact.reduced_mass,
            overlap: outcome.maximum_overlap,
        }))
    }

    fn summary(params: &Params, pair: &PairContext) -> Option<NormalSummary> {
        let impact = Impact {
            reduced_mass: pair.reduced_mass.min,
            reduced_radius: pair.reduced_radius.min,
            normal_speed: pair.impact_speed,
        };
        let scale = Self::time_scale(params, pair, &impact).ok().flatten()?;
        let single = pair.reduced_mass.is_single() && scale.duration.is_finite();
        let duration = if single { DurationRule::Constant(scale.duration) } else { DurationRule::Unknown };
        Some(NormalSummary { duration, scale: Some(scale) })
    }

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        let Ok(model) = Model::of(params, pair) else { return Oracle::Missing };
        let end = pair.contact_end;
        Oracle::Normal(Box::new(move |impact| model.outcome(impact, end)))
    }
}

register_law!(KondicNormal);

struct Linear<T, const CLAMP: bool> {
    stiffness: T,
    rate: T,
}

impl<T: Real, const CLAMP: bool> Stage<T> for Linear<T, CLAMP> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let velocity = &chunk.normal_velocity[..n];
        let mass = &chunk.reduced_mass[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            let value = self.stiffness * overlap[k] + self.rate * mass[k] * velocity[k];
            let value = if CLAMP { value.max(T::ZERO) } else { value };
            force[k] = value.keep_if(overlap[k] > T::ZERO);
        }
        for stiffness in chunk.normal_stiffness.iter_mut() {
            *stiffness = self.stiffness;
        }
        for (damping, mass) in chunk.normal_damping.iter_mut().zip(mass) {
            *damping = self.rate * *mass;
        }
        if let Some(energy) = &mut chunk.energy {
            let elastic = &mut energy.elastic[..n];
            let viscous = &mut energy.viscous[..n];
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                let spring = (self.stiffness * overlap[k]).max(T::ZERO);
                elastic[k] = T::of(0.5) * spring * overlap[k];
                viscous[k] = (force[k] - spring) * velocity[k];
                friction[k] = T::ZERO;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use granule_law_api::testing::{conformance, reference};

    #[test]
    fn conforms() {
        conformance::<KondicNormal>();
    }

    #[test]
    fn the_clamp_at_the_end_of_a_collision_raises_the_restitution() {
        // Erratum K-E42: nominal 0.9 becomes 0.9020 where the force may not attract.
        let params = Params::new(&KondicNormal::INFO, KondicNormal::INFO.examples[0]).unwrap();
        let pair = |contact_end| PairContext { contact_end, ..PairContext::single(1e-4, 1e-3, 0.4, 0.1) };
        let impact = Impact { reduced_mass: 1e-4, reduced_radius: 1e-3, normal_speed: 0.1 };
        for (end, expected) in [(ContactEnd::Overlap, 0.9), (ContactEnd::Force, 0.902_026_069)] {
            let stage = KondicNormal::compile::<f64>(&params, &pair(end)).unwrap();
            let scale = KondicNormal::time_scale(&params, &pair(end), &impact).unwrap().unwrap();
            let outcome = reference::impact_with(&*stage, &impact, end, scale.duration);
            assert!((outcome.restitution - expected).abs() < 1e-8, "{end:?}: {outcome:?}");
        }
    }

    #[test]
    fn unequal_spheres_need_constants() {
        let params = Params::new(&KondicNormal::INFO, KondicNormal::INFO.examples[0]).unwrap();
        let mut pair = PairContext::single(1e-4, 1e-3, 0.4, 0.1);
        pair.reduced_mass.max = 2e-4;
        assert!(KondicNormal::compile::<f64>(&params, &pair).is_err());
    }
}
