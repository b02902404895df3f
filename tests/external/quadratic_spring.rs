//! f_n = a delta^2: a law that granule does not ship, as a stranger would write it.

use granule_law_api::{
    Columns, ContactChunk, ContactLaw, Dimension, DurationRule, Form, Impact, ImpactOutcome, LawError, LawInfo,
    NormalSummary, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
    register_law,
};

/// ∫ dx / sqrt(1 - x^3) from 0 to 1, that is B(1/3, 1/2)/3.
const HALF_DURATION: f64 = 1.402_182_105_325_454;

const COEFFICIENT: ParamSpec = ParamSpec {
    name: "coefficient",
    symbol: "a",
    doc: "Force per square of the overlap.",
    dimension: Dimension::PRESSURE,
    range: ValueRange::POSITIVE,
};

/// Elastic force in proportion to the square of the overlap.
pub struct QuadraticSpring;

fn outcome(coefficient: f64, impact: &Impact) -> ImpactOutcome {
    let speed = impact.normal_speed;
    let maximum_overlap = (1.5 * impact.reduced_mass * speed * speed / coefficient).cbrt();
    ImpactOutcome { duration: 2.0 * HALF_DURATION * maximum_overlap / speed, maximum_overlap, restitution: 1.0 }
}

impl ContactLaw for QuadraticSpring {
    const INFO: LawInfo = LawInfo {
        name: "QuadraticSpring",
        summary: "Elastic force in proportion to the square of the overlap.",
        formula: "f_n = a delta^2",
        sources: &[Source {
            work: "Energy conservation",
            place: "a delta^3/3 = m12 v^2/2 at the turning point",
            note: "",
        }],
        slot: Slot::Normal,
        reads: Columns::NONE,
        writes: Columns::NORMAL_FORCE.and(Columns::NORMAL_STIFFNESS).and(Columns::NORMAL_DAMPING),
        history: &[],
        parameters: &[&COEFFICIENT],
        forms: &[Form { doc: "The same for every pair.", required: &[&COEFFICIENT], optional: &[] }],
        examples: &[&[("coefficient", 1e9)]],
        contact_ends: &[],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, _pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        Ok(Box::new(Compiled { coefficient: T::of(params.value(&COEFFICIENT)?) }))
    }

    fn time_scale(
        params: &Params,
        _pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError> {
        let coefficient = params.value(&COEFFICIENT)?;
        let ImpactOutcome { duration, maximum_overlap: overlap, .. } = outcome(coefficient, impact);
        Ok(Some(TimeScale { duration, stiffness: 2.0 * coefficient * overlap, damping: 0.0, overlap }))
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

    fn oracle(params: &Params, _pair: &PairContext) -> Oracle {
        match params.value(&COEFFICIENT) {
            Ok(coefficient) => Oracle::Normal(Box::new(move |impact| outcome(coefficient, impact))),
            Err(_) => Oracle::Missing,
        }
    }
}

register_law!(QuadraticSpring);

struct Compiled<T> {
    coefficient: T,
}

impl<T: Real> Stage<T> for Compiled<T> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        let overlap = &chunk.overlap[..n];
        let force = &mut chunk.normal_force[..n];
        for k in 0..n {
            let overlap = overlap[k].max(T::ZERO);
            force[k] = self.coefficient * overlap * overlap;
        }
        for (stiffness, overlap) in chunk.normal_stiffness.iter_mut().zip(overlap) {
            *stiffness = self.coefficient * overlap.max(T::ZERO);
        }
        chunk.normal_damping.fill(T::ZERO);
        if let Some(energy) = &mut chunk.energy {
            for k in 0..n {
                energy.elastic[k] = force[k] * overlap[k] / T::of(3.0);
                energy.viscous[k] = T::ZERO;
                energy.friction[k] = T::ZERO;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conforms() {
        granule_law_api::testing::conformance::<QuadraticSpring>();
    }
}
