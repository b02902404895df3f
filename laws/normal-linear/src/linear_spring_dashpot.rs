//! f_n = k δ + γ v_n.

use std::f64::consts::PI;

use granule_law_api::{
    Columns, ContactChunk, ContactEnd, ContactLaw, Dimension, DurationRule, Form, Impact, ImpactOutcome,
    LawError, LawInfo, NormalSummary, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage,
    TimeScale, ValueRange, oscillator, register_law, vectorised,
};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness of the spring.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const DAMPING: ParamSpec = ParamSpec {
    name: "damping",
    symbol: "gamma",
    doc: "Damping coefficient: viscous force per normal velocity, the same for every pair.",
    dimension: Dimension::DAMPING,
    range: ValueRange::NON_NEGATIVE,
};
const DAMPING_RATE: ParamSpec = ParamSpec {
    name: "damping_rate",
    symbol: "gamma/m12",
    doc: "Damping coefficient per reduced mass (gamma_n of LAMMPS gran/hooke, gamman of LIGGGHTS hooke/stiffness).",
    dimension: Dimension::RATE,
    range: ValueRange::NON_NEGATIVE,
};
const RESTITUTION: ParamSpec = ParamSpec {
    name: "restitution",
    symbol: "e_n",
    doc: "Restitution of a head-on impact under the chosen end of contact; zero would need infinite damping.",
    dimension: Dimension::DIMENSIONLESS,
    range: ValueRange::POSITIVE_UNIT,
};
const CONTACT_DURATION: ParamSpec = ParamSpec {
    name: "contact_duration",
    symbol: "t_c",
    doc: "Duration of a head-on contact under the chosen end of contact, the same for every pair.",
    dimension: Dimension::TIME,
    range: ValueRange::POSITIVE,
};

/// Linear spring and dashpot in parallel: f_n = k δ + γ v_n (Luding 1998, Eqs. (26)-(28)).
pub struct LinearSpringDashpot;

/// How k and γ follow from the reduced mass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Model {
    /// k and γ are the same for every pair.
    Fixed { stiffness: f64, damping: f64 },
    /// γ = rate · m12.
    Rate { stiffness: f64, rate: f64 },
    /// γ = 2 β sqrt(k m12): the same damping ratio β for every pair.
    Ratio { stiffness: f64, ratio: f64 },
    /// k = stiffness · m12 and γ = rate · m12: the same motion for every pair.
    Proportional { stiffness: f64, rate: f64 },
}

impl Model {
    fn new(params: &Params, pair: &PairContext) -> Result<Self, LawError> {
        let end = pair.contact_end;
        let ratio = |params: &Params| Ok(oscillator::damping_ratio(params.value(&RESTITUTION)?, end));
        match params.form() {
            0 => {
                let ratio: f64 = ratio(params)?;
                let omega = oscillator::duration(ratio, end) / params.value(&CONTACT_DURATION)?;
                Ok(Self::Proportional { stiffness: omega * omega, rate: 2.0 * ratio * omega })
            }
            1 => Ok(Self::Ratio { stiffness: params.value(&STIFFNESS)?, ratio: ratio(params)? }),
            2 => Ok(Self::Fixed { stiffness: params.value(&STIFFNESS)?, damping: params.value(&DAMPING)? }),
            _ => Ok(Self::Rate { stiffness: params.value(&STIFFNESS)?, rate: params.value(&DAMPING_RATE)? }),
        }
    }

    /// Stiffness and damping at a reduced mass.
    fn at(&self, mass: f64) -> (f64, f64) {
        match *self {
            Self::Fixed { stiffness, damping } => (stiffness, damping),
            Self::Rate { stiffness, rate } => (stiffness, rate * mass),
            Self::Ratio { stiffness, ratio } => (stiffness, 2.0 * ratio * (stiffness * mass).sqrt()),
            Self::Proportional { stiffness, rate } => (stiffness * mass, rate * mass),
        }
    }

    /// Damping ratio β at a reduced mass.
    fn ratio(&self, mass: f64) -> f64 {
        if let Self::Ratio { ratio, .. } = self {
            return *ratio;
        }
        let (stiffness, damping) = self.at(mass);
        damping / (2.0 * (stiffness * mass).sqrt())
    }

    /// Outcome of a head-on impact.
    fn outcome(&self, impact: &Impact, end: ContactEnd) -> ImpactOutcome {
        let mass = impact.reduced_mass;
        let (stiffness, _) = self.at(mass);
        let (omega, ratio) = ((stiffness / mass).sqrt(), self.ratio(mass));
        ImpactOutcome {
            duration: oscillator::duration(ratio, end) / omega,
            maximum_overlap: impact.normal_speed * oscillator::largest_overlap(ratio) / omega,
            restitution: oscillator::restitution(ratio, end),
        }
    }

    fn duration_rule(&self, pair: &PairContext) -> DurationRule {
        let of_ratio = |ratio: f64| oscillator::duration(ratio, pair.contact_end);
        let rule = match *self {
            Self::Ratio { ratio, .. } => DurationRule::Oscillator(of_ratio(ratio)),
            Self::Proportional { stiffness, .. } => {
                DurationRule::Constant(of_ratio(self.ratio(1.0)) / stiffness.sqrt())
            }
            Self::Fixed { damping: 0.0, .. } | Self::Rate { rate: 0.0, .. } => DurationRule::Oscillator(PI),
            Self::Fixed { .. } | Self::Rate { .. } if pair.reduced_mass.is_single() => {
                DurationRule::Oscillator(of_ratio(self.ratio(pair.reduced_mass.max)))
            }
            _ => DurationRule::Unknown,
        };
        match rule {
            DurationRule::Oscillator(value) | DurationRule::Constant(value) if !value.is_finite() => {
                DurationRule::Unknown
            }
            rule => rule,
        }
    }
}

impl ContactLaw for LinearSpringDashpot {
    const INFO: LawInfo = LawInfo {
        name: "LinearSpringDashpot",
        summary: "Linear spring and dashpot: restitution and duration do not depend on the speed.",
        formula: "f_n = k delta + gamma v_n; with the contact end `force`: max(f_n, 0)",
        sources: &[
            Source {
                work: "Luding 1998",
                place: "Eqs. (26)-(36)",
                note: "errata L-E7, L-E8: restitution and duration under the contact end in use, exact at any damping",
            },
            Source { work: "Cundall and Strack 1979", place: "Sec. 2", note: "" },
        ],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY.and(Columns::REDUCED_MASS),
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[],
        parameters: &[&RESTITUTION, &CONTACT_DURATION, &STIFFNESS, &DAMPING, &DAMPING_RATE],
        forms: &[
            Form {
                doc: "Physical intent: k and gamma in proportion to the reduced mass, so that every pair has exactly this \
                      restitution and duration.",
                required: &[&RESTITUTION, &CONTACT_DURATION],
                optional: &[],
            },
            Form {
                doc: "One stiffness; gamma in proportion to sqrt(m12), so that every pair has exactly this restitution.",
                required: &[&STIFFNESS, &RESTITUTION],
                optional: &[],
            },
            Form {
                doc: "One stiffness and one damping coefficient; the restitution depends on the reduced mass.",
                required: &[&STIFFNESS, &DAMPING],
                optional: &[],
            },
            Form {
                doc: "As LAMMPS gran/hooke and LIGGGHTS hooke/stiffness: gamma in proportion to the reduced mass.",
                required: &[&STIFFNESS, &DAMPING_RATE],
                optional: &[],
            },
        ],
        examples: &[
            &[("restitution", 0.9), ("contact_duration", 1e-4)],
            &[("restitution", 0.05), ("contact_duration", 1e-4)],
            &[("stiffness", 1e5), ("restitution", 0.6)],
            &[("stiffness", 1e5), ("restitution", 1.0)],
            &[("stiffness", 1e5), ("damping", 5.0)],
            &[("stiffness", 1e5), ("damping", 100.0)],
            &[("stiffness", 1000.0), ("damping_rate", 2620.0)],
        ],
        contact_ends: &[ContactEnd::Force, ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let clamp = pair.contact_end == ContactEnd::Force;
        let model = Model::new(params, pair)?;
        let (stiffness, damping) = model.at(pair.reduced_mass.max);
        LawError::unless_finite::<T>(&[("stiffness", stiffness), ("damping", damping)])?;
        Ok(match model {
            Model::Fixed { stiffness, damping } => stage::<T, FIXED>(stiffness, damping, clamp),
            Model::Rate { stiffness, rate } => stage::<T, RATE>(stiffness, rate, clamp),
            Model::Ratio { stiffness, ratio } => {
                stage::<T, RATIO>(stiffness, 2.0 * ratio * stiffness.sqrt(), clamp)
            }
            Model::Proportional { stiffness, rate } => stage::<T, PROPORTIONAL>(stiffness, rate, clamp),
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
        let (stiffness, damping) = model.at(impact.reduced_mass);
        let duration = if outcome.duration.is_finite() {
            outcome.duration
        } else {
            model.outcome(impact, ContactEnd::Force).duration
        };
        Ok(Some(TimeScale { duration, stiffness, damping, overlap: outcome.maximum_overlap }))
    }

    fn summary(params: &Params, pair: &PairContext) -> Option<NormalSummary> {
        let model = Model::new(params, pair).ok()?;
        let impact = Impact {
            reduced_mass: pair.reduced_mass.min,
            reduced_radius: pair.reduced_radius.min,
            normal_speed: pair.impact_speed,
        };
        let scale = Self::time_scale(params, pair, &impact).ok().flatten();
        Some(NormalSummary { duration: model.duration_rule(pair), scale })
    }

    fn oracle(params: &Params, pair: &PairContext) -> Oracle {
        let Ok(model) = Model::new(params, pair) else {
            return Oracle::Missing;
        };
        let end = pair.contact_end;
        Oracle::Normal(Box::new(move |impact| model.outcome(impact, end)))
    }
}

register_law!(LinearSpringDashpot);

const FIXED: u8 = 0;
const RATE: u8 = 1;
const RATIO: u8 = 2;
const PROPORTIONAL: u8 = 3;

/// The loop for one way in which k and γ depend on the reduced mass. `CLAMP` ends the contact with the force.
struct Linear<T, const MODEL: u8, const CLAMP: bool> {
    stiffness: T,
    damping: T,
}

fn stage<T: Real, const MODEL: u8>(stiffness: f64, damping: f64, clamp: bool) -> Box<dyn Stage<T>> {
    let (stiffness, damping) = (T::of(stiffness), T::of(damping));
    if clamp {
        vectorised(Linear::<T, MODEL, true> { stiffness, damping })
    } else {
        vectorised(Linear::<T, MODEL, false> { stiffness, damping })
    }
}

impl<T: Real, const MODEL: u8, const CLAMP: bool> Linear<T, MODEL, CLAMP> {
    #[inline(always)]
    fn stiffness(&self, mass: T) -> T {
        if MODEL == PROPORTIONAL { self.stiffness * mass } else { self.stiffness }
    }

    #[inline(always)]
    fn damping(&self, mass: T) -> T {
        match MODEL {
            FIXED => self.damping,
            RATIO => self.damping * mass.sqrt(),
            _ => self.damping * mass,
        }
    }

    #[inline(always)]
    fn force(&self, overlap: T, velocity: T, mass: T) -> T {
        let force = self.stiffness(mass) * overlap + self.damping(mass) * velocity;
        let force = if CLAMP { force.max(T::ZERO) } else { force };
        force.keep_if(overlap > T::ZERO)
    }
}

impl<T: Real, const MODEL: u8, const CLAMP: bool> Stage<T> for Linear<T, MODEL, CLAMP> {
    #[inline(always)]
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let velocity = &chunk.normal_velocity[..n];
        let mass = &chunk.reduced_mass[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            force[k] = self.force(overlap[k], velocity[k], mass[k]);
        }
        for (stiffness, mass) in chunk.normal_stiffness.iter_mut().zip(mass) {
            *stiffness = self.stiffness(*mass);
        }
        for (damping, mass) in chunk.normal_damping.iter_mut().zip(mass) {
            *damping = self.damping(*mass);
        }
        if let Some(energy) = &mut chunk.energy {
            let elastic = &mut energy.elastic[..n];
            let viscous = &mut energy.viscous[..n];
            let friction = &mut energy.friction[..n];
            for k in 0..n {
                // What the motion puts in and the spring does not take up is dissipated; once the force is cut to zero
                // this is the spring relaxing against the dashpot.
                let spring = (self.stiffness(mass[k]) * overlap[k]).max(T::ZERO);
                elastic[k] = T::of(0.5) * spring * overlap[k];
                viscous[k] = (force[k] - spring) * velocity[k];
                friction[k] = T::ZERO;
            }
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
