//! The conformance kit itself: a sound law passes, and each check catches the fault that it is there for.

use granule_law_api::testing::{Failure, conformance, failures};
use granule_law_api::{
    Columns, ContactChunk, ContactEnd, ContactLaw, Dimension, Form, HistoryColumn, Impact, ImpactOutcome,
    LawEntry, LawError, LawInfo, Oracle, PairContext, ParamSpec, Params, Parity, Real, Slot, Source, Stage,
    TimeScale, ValueRange,
};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};

const SOUND: LawInfo = LawInfo {
    name: "Spring",
    summary: "A spring.",
    formula: "f = k delta",
    sources: &[Source { work: "Hooke 1678", place: "De potentia restitutiva", note: "" }],
    slot: Slot::Normal,
    reads: Columns::NONE,
    writes: Columns::NORMAL_FORCE,
    history: &[],
    parameters: &[&STIFFNESS],
    forms: &[Form { doc: "Stiffness.", required: &[&STIFFNESS], optional: &[] }],
    examples: &[&[("stiffness", 1e5)]],
    contact_ends: &[ContactEnd::Force],
    dissipative: true,
};

/// What is wrong with a spring.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    GainsEnergy,
    ForgetsEnergy,
    WritesTorque,
    LeavesEnergy,
    LooksAtNeighbour,
    ReadsMass,
    Overflows,
    PrefersAxis,
    DiffersInSingle,
    AdvancesWithoutTime,
    WrongParity,
    WrongOracle,
    NoOracle,
    WrongTimeScale,
}

struct Run<T> {
    stiffness: T,
    fault: Fault,
}

impl<T: Real> Stage<T> for Run<T> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        let n = chunk.len();
        for k in 0..n {
            let overlap = chunk.overlap[k].max(T::ZERO);
            let mut stiffness = self.stiffness;
            let unloads = chunk.normal_velocity[k] < T::ZERO;
            match self.fault {
                Fault::GainsEnergy if unloads => stiffness = stiffness * T::of(1.5),
                Fault::ForgetsEnergy if unloads => stiffness = stiffness * T::of(0.5),
                Fault::LooksAtNeighbour => stiffness += chunk.overlap[(k + 1) % n],
                Fault::ReadsMass => stiffness = stiffness * (T::ONE + chunk.reduced_mass[k]),
                Fault::PrefersAxis => stiffness = stiffness * (T::ONE + T::of(1e-3) * chunk.normal[0][k]),
                Fault::DiffersInSingle if T::EPSILON.wide() > 1e-10 => stiffness = stiffness * T::of(1.01),
                _ => {}
            }
            let force = match self.fault {
                Fault::Overflows => {
                    stiffness * overlap * (chunk.normal_velocity[k] * T::of(1e40)).abs().max(T::ONE)
                }
                _ => stiffness * overlap,
            };
            chunk.normal_force[k] = force;
            if self.fault == Fault::WritesTorque {
                chunk.torque[0][k] = force;
            }
            match (self.fault, &mut *chunk.history) {
                (Fault::AdvancesWithoutTime, [column]) => column[k] += overlap,
                (Fault::WrongParity, [column]) => column[k] = column[k].max(overlap * chunk.time_step),
                _ => {}
            }
            if let Some(energy) = &mut chunk.energy {
                if self.fault != Fault::LeavesEnergy {
                    energy.elastic[k] = T::of(0.5) * self.stiffness * overlap * overlap;
                }
                energy.viscous[k] = T::ZERO;
                energy.friction[k] = T::ZERO;
            }
        }
    }
}

fn compile<T: Real>(params: &Params, fault: Fault) -> Result<Box<dyn Stage<T>>, LawError> {
    Ok(Box::new(Run { stiffness: T::of(params.value(&STIFFNESS)?), fault }))
}

fn outcome(stiffness: f64, impact: &Impact) -> ImpactOutcome {
    let omega = (stiffness / impact.reduced_mass).sqrt();
    ImpactOutcome {
        duration: std::f64::consts::PI / omega,
        maximum_overlap: impact.normal_speed / omega,
        restitution: 1.0,
    }
}

macro_rules! spring {
    ($name:ident, $fault:expr, $info:expr) => {
        struct $name;

        impl ContactLaw for $name {
            const INFO: LawInfo = $info;

            fn compile<T: Real>(params: &Params, _: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
                compile(params, $fault)
            }

            fn time_scale(
                params: &Params,
                _: &PairContext,
                impact: &Impact,
            ) -> Result<Option<TimeScale>, LawError> {
                let stiffness = params.value(&STIFFNESS)?;
                let ImpactOutcome { duration, maximum_overlap: overlap, .. } = outcome(stiffness, impact);
                let duration = if $fault == Fault::WrongTimeScale { 3.0 * duration } else { duration };
                Ok(Some(TimeScale { duration, stiffness, damping: 0.0, overlap }))
            }

            fn oracle(params: &Params, _: &PairContext) -> Oracle {
                let Ok(stiffness) = params.value(&STIFFNESS) else { return Oracle::Missing };
                match $fault {
                    Fault::NoOracle => Oracle::Missing,
                    Fault::WrongOracle => Oracle::Normal(Box::new(move |impact| ImpactOutcome {
                        duration: 1.0001 * outcome(stiffness, impact).duration,
                        ..outcome(stiffness, impact)
                    })),
                    _ => Oracle::Normal(Box::new(move |impact| outcome(stiffness, impact))),
                }
            }
        }
    };
}

spring!(Sound, Fault::None, SOUND);
spring!(GainsEnergy, Fault::GainsEnergy, SOUND);
spring!(ForgetsEnergy, Fault::ForgetsEnergy, SOUND);
spring!(WritesTorque, Fault::WritesTorque, SOUND);
spring!(LeavesEnergy, Fault::LeavesEnergy, SOUND);
spring!(LooksAtNeighbour, Fault::LooksAtNeighbour, SOUND);
spring!(ReadsMass, Fault::ReadsMass, SOUND);
spring!(Overflows, Fault::Overflows, SOUND);
spring!(PrefersAxis, Fault::PrefersAxis, SOUND);
spring!(DiffersInSingle, Fault::DiffersInSingle, SOUND);
spring!(WrongOracle, Fault::WrongOracle, SOUND);
spring!(NoOracle, Fault::NoOracle, SOUND);
spring!(WrongTimeScale, Fault::WrongTimeScale, SOUND);

const MEMORY: &[HistoryColumn] = &[HistoryColumn {
    name: "largest_overlap",
    components: 1,
    parity: Parity::Even,
    dimension: Dimension::LENGTH,
}];
spring!(AdvancesWithoutTime, Fault::AdvancesWithoutTime, LawInfo { history: MEMORY, ..SOUND });
const ODD_MEMORY: &[HistoryColumn] = &[HistoryColumn { parity: Parity::Odd, ..MEMORY[0] }];
spring!(WrongParity, Fault::WrongParity, LawInfo { history: ODD_MEMORY, ..SOUND });

fn found<L: ContactLaw>() -> Vec<Failure> {
    failures(&LawEntry::of::<L>("toy", "0"))
}

/// The law fails the named check, with this in the message.
fn caught<L: ContactLaw>(check: &str, message: &str) {
    let failures = found::<L>();
    assert!(
        failures.iter().any(|failure| failure.check == check && failure.message.contains(message)),
        "no failure of `{check}` with `{message}`, but {failures:#?}"
    );
}

#[test]
fn a_sound_law_passes() {
    conformance::<Sound>();
}

#[test]
#[should_panic(expected = "Spring: check `energy` with (stiffness = 100000.0), contact end Force: an impact")]
fn the_panic_names_law_check_and_parameters() {
    conformance::<GainsEnergy>();
}

#[test]
fn energy_is_watched() {
    caught::<GainsEnergy>("energy", "gains");
    caught::<ForgetsEnergy>("energy", "miss");
}

#[test]
fn columns_are_watched() {
    caught::<WritesTorque>("writes", "torque x is written but not declared");
    caught::<LeavesEnergy>("writes", "elastic energy depends on what was in the column before");
    caught::<ReadsMass>("reads", "normal force changes when columns other than []");
}

#[test]
fn lanes_and_precision_are_watched() {
    caught::<LooksAtNeighbour>("chunk", "normal force depends on the company");
    caught::<Overflows>("finite", "normal force becomes");
    caught::<DiffersInSingle>("precision", "normal force is");
}

#[test]
fn symmetries_are_watched() {
    caught::<PrefersAxis>("symmetry", "normal force does not follow a frame");
    caught::<PrefersAxis>("symmetry", "normal force is not opposite and equal");
    caught::<WrongParity>("symmetry", "history column 0 is not opposite and equal");
}

#[test]
fn history_is_watched() {
    caught::<AdvancesWithoutTime>("history", "in a step of no time");
}

#[test]
fn predictions_are_watched() {
    caught::<WrongOracle>("oracle", "the duration at 0.5 m/s");
    caught::<NoOracle>("oracle", "oracle missing");
    caught::<WrongTimeScale>("time scale", "the duration is");
}

const LENGTH: ParamSpec = ParamSpec { name: "Length", symbol: "", dimension: Dimension::LENGTH, ..STIFFNESS };
spring!(
    BadInfo,
    Fault::None,
    LawInfo {
        name: "bad name",
        summary: "",
        sources: &[],
        writes: Columns::TORQUE,
        reads: Columns::NORMAL_FORCE,
        parameters: &[&STIFFNESS, &LENGTH, &STIFFNESS],
        examples: &[&[("stiffness", -1.0)]],
        history: &[HistoryColumn { name: "Bad", components: 2, ..MEMORY[0] }],
        ..SOUND
    }
);

#[test]
fn information_is_watched() {
    for message in [
        "not a CamelCase identifier",
        "the summary is empty",
        "no source is given",
        "a normal law writes",
        "a normal law runs first",
        "the parameter `Length` is not in snake_case",
        "the parameter `Length` lacks its document or symbol",
        "the parameter `Length` belongs to no form",
        "the parameter `stiffness` is declared twice",
        "the history column `Bad` is not in snake_case",
        "has 2 components",
        "is not valid: stiffness: -1 is not allowed",
        "no example uses the form (stiffness)",
    ] {
        caught::<BadInfo>("info", message);
    }
}

const RUBBING: LawInfo = LawInfo {
    name: "Rubbing",
    formula: "f = -k/1e5 v",
    slot: Slot::Tangential,
    reads: Columns::TANGENTIAL_VELOCITY,
    writes: Columns::TANGENTIAL_FORCE,
    contact_ends: &[],
    ..SOUND
};

/// A viscous tangential force and the damping that its energy account tells of.
struct Rub<T> {
    damping: T,
    told: T,
}

impl<T: Real> Stage<T> for Rub<T> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        for k in 0..chunk.len() {
            let v = chunk.tangential_velocity.map(|column| column[k]);
            for axis in 0..3 {
                chunk.tangential_force[axis][k] = -self.damping * v[axis];
            }
            if let Some(energy) = &mut chunk.energy {
                energy.elastic[k] = T::ZERO;
                energy.viscous[k] = self.told * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                energy.friction[k] = T::ZERO;
            }
        }
    }
}

macro_rules! rubbing {
    ($name:ident, $damping:expr, $told:expr, $oracle:expr) => {
        struct $name;

        impl ContactLaw for $name {
            const INFO: LawInfo = RUBBING;

            fn compile<T: Real>(_: &Params, _: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
                Ok(Box::new(Rub { damping: T::of($damping), told: T::of($told) }))
            }

            fn time_scale(_: &Params, _: &PairContext, _: &Impact) -> Result<Option<TimeScale>, LawError> {
                Ok(None)
            }

            fn oracle(_: &Params, _: &PairContext) -> Oracle {
                $oracle
            }
        }
    };
}

fn exponential(rate: f64) -> Oracle {
    Oracle::Tangential(Box::new(move |impact| {
        Some(impact.tangential_speed * (-rate * impact.duration / impact.tangential_mass).exp())
    }))
}

rubbing!(Rubs, 0.1, 0.1, exponential(0.1));
rubbing!(Pushes, -0.1, -0.1, exponential(-0.1));
rubbing!(Misreports, 0.1, 0.2, exponential(0.1));
rubbing!(Mispredicts, 0.1, 0.1, exponential(0.10001));
rubbing!(PredictsNothing, 0.1, 0.1, Oracle::Tangential(Box::new(|_| None)));
rubbing!(PredictsTheNormal, 0.1, 0.1, Oracle::Normal(Box::new(|impact| outcome(1e5, impact))));

#[test]
fn tangential_laws_are_watched() {
    conformance::<Rubs>();
    caught::<Pushes>("energy", "draws");
    caught::<Pushes>("energy", "has gained");
    caught::<Misreports>("energy", "miss");
    caught::<Mispredicts>("oracle", "the tangential velocity");
    caught::<PredictsNothing>("oracle", "oracle missing: it answers none");
    caught::<PredictsTheNormal>("oracle", "cannot describe an oblique impact");
}
