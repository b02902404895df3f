//! A linear spring with a fault.

use granule::parts::law_api::{
    Columns, ContactChunk, ContactLaw, Dimension, Form, Impact, LawError, LawInfo, Oracle, PairContext,
    ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};

/// What a linear spring says about itself.
pub const fn spring(name: &'static str) -> LawInfo {
    LawInfo {
        name,
        summary: "Linear spring.",
        formula: "f_n = k delta",
        sources: &[Source { work: "Luding 1998", place: "Eq. (26)", note: "" }],
        slot: Slot::Normal,
        reads: Columns::NONE,
        writes: Columns::NORMAL_FORCE,
        history: &[],
        parameters: &[&STIFFNESS],
        forms: &[Form { doc: "", required: &[&STIFFNESS], optional: &[] }],
        examples: &[],
        contact_ends: &[],
        dissipative: true,
    }
}

/// What is wrong with a spring.
pub trait Fault: Send + Sync + 'static {
    /// Name of the law in scenes.
    const NAME: &'static str;

    /// Normal force of an overlap and a velocity of the overlap's change.
    fn force<T: Real>(stiffness: T, overlap: T, normal_velocity: T) -> T;

    /// Duration of a contact; not known if it is not said.
    fn time_scale(_: f64, _: &Impact) -> Option<TimeScale> {
        None
    }
}

/// The spring.
pub struct Faulty<F>(std::marker::PhantomData<F>);

impl<F: Fault> ContactLaw for Faulty<F> {
    const INFO: LawInfo = spring(F::NAME);

    fn compile<T: Real>(params: &Params, _: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let stiffness = T::of(params.value(&STIFFNESS)?);
        Ok(Box::new(Compiled { stiffness, fault: std::marker::PhantomData::<F> }))
    }

    fn time_scale(params: &Params, _: &PairContext, impact: &Impact) -> Result<Option<TimeScale>, LawError> {
        Ok(F::time_scale(params.value(&STIFFNESS)?, impact))
    }

    fn oracle(_: &Params, _: &PairContext) -> Oracle {
        Oracle::Missing
    }
}

struct Compiled<T, F> {
    stiffness: T,
    fault: std::marker::PhantomData<F>,
}

impl<T: Real, F: Fault> Stage<T> for Compiled<T, F> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        for k in 0..chunk.len() {
            chunk.normal_force[k] = F::force(self.stiffness, chunk.overlap[k], chunk.normal_velocity[k]);
        }
    }
}
