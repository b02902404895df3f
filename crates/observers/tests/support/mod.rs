//! Plans made by hand, with a linear spring and dashpot of their own.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_geometry::Cell;
use granule_law_api::{
    Columns, ContactChunk, ContactEnd, ContactLaw, Conventions, Dimension, Form, Impact, LawEntry, LawError,
    LawInfo, Oracle, PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
};
use granule_observers::{Observers, Provenance};
use granule_plan::{
    BodyTable, Composition, Dimensions, MaterialPlan, OutputKind, OutputPlan, Partner, Plan, Precision,
    Scheme, Search, StagePlan, TimeStepPlan,
};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};
const DAMPING: ParamSpec = ParamSpec {
    name: "damping",
    symbol: "gamma",
    doc: "Damping.",
    dimension: Dimension::DAMPING,
    range: ValueRange::NON_NEGATIVE,
};

/// f_n = k δ + γ v_n while δ > 0.
struct Spring;

static ENTRY: LawEntry = LawEntry::of::<Spring>("test", "0.0.0");

impl ContactLaw for Spring {
    const INFO: LawInfo = LawInfo {
        name: "Spring",
        summary: "Linear spring and dashpot.",
        formula: "f_n = k delta + gamma v_n",
        sources: &[Source { work: "Luding 1998", place: "Eq. (26)", note: "" }],
        slot: Slot::Normal,
        reads: Columns::NORMAL_VELOCITY,
        writes: Columns::NORMAL_FORCE,
        history: &[],
        parameters: &[&STIFFNESS, &DAMPING],
        forms: &[Form { doc: "", required: &[&STIFFNESS, &DAMPING], optional: &[] }],
        examples: &[],
        contact_ends: &[ContactEnd::Overlap],
        dissipative: true,
    };

    fn compile<T: Real>(params: &Params, _: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        let (k, gamma) = (params.value(&STIFFNESS)?, params.value(&DAMPING)?);
        Ok(Box::new(SpringStage { stiffness: T::of(k), damping: T::of(gamma) }))
    }

    fn time_scale(_: &Params, _: &PairContext, _: &Impact) -> Result<Option<TimeScale>, LawError> {
        Ok(None)
    }

    fn oracle(_: &Params, _: &PairContext) -> Oracle {
        Oracle::Missing
    }
}

struct SpringStage<T> {
    stiffness: T,
    damping: T,
}

impl<T: Real> Stage<T> for SpringStage<T> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        for k in 0..chunk.len() {
            let (overlap, velocity) = (chunk.overlap[k], chunk.normal_velocity[k]);
            chunk.normal_force[k] = self.stiffness * overlap + self.damping * velocity;
            if let Some(energy) = &mut chunk.energy {
                energy.elastic[k] = T::of(0.5) * self.stiffness * overlap * overlap;
                energy.viscous[k] = self.damping * velocity * velocity;
                energy.friction[k] = T::ZERO;
            }
        }
    }
}

/// A body of a test plan.
pub struct Body {
    pub mass: f64,
    pub radius: f64,
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    pub spin: [f64; 3],
    pub frozen: bool,
}

impl Default for Body {
    fn default() -> Self {
        Self { mass: 1.0, radius: 0.5, position: [0.0; 3], velocity: [0.0; 3], spin: [0.0; 3], frozen: false }
    }
}

/// A plan of spheres with a linear spring and dashpot between them. Ids are 1, 2, ...
pub fn plan(bodies: &[Body], stiffness: f64, damping: f64, step: f64, steps: u64) -> Plan {
    let params = Params::new(&Spring::INFO, &[("stiffness", stiffness), ("damping", damping)]).unwrap();
    let context = PairContext::single(1.0, 0.5, 0.4, 1.0);
    let stage = StagePlan {
        slot: Slot::Normal,
        law: &ENTRY,
        reads: Spring::INFO.reads,
        history_offset: 0,
        history_width: 0,
        double: (ENTRY.compile_f64)(&params, &context).unwrap().into(),
        single: None,
        params,
    };
    let table = BodyTable {
        id: (1..=bodies.len() as u32).collect(),
        material: vec![0; bodies.len()],
        radius: bodies.iter().map(|body| body.radius).collect(),
        mass: bodies.iter().map(|body| body.mass).collect(),
        inertia_factor: vec![0.4; bodies.len()],
        position: bodies.iter().map(|body| body.position).collect(),
        velocity: bodies.iter().map(|body| body.velocity).collect(),
        spin: bodies.iter().map(|body| body.spin).collect(),
        frozen: bodies.iter().map(|body| body.frozen).collect(),
    };
    Plan {
        title: String::new(),
        dimensions: Dimensions::Three,
        rotation: true,
        ledger: true,
        precision: Precision::Double,
        conventions: Conventions::PHYSICAL,
        gravity: [0.0; 3],
        cell: Cell::unbounded(),
        materials: vec![MaterialPlan { name: "glass".into() }],
        bodies: table,
        walls: Vec::new(),
        substrate: None,
        compositions: vec![Composition {
            material: 0,
            partner: Partner::Body(0),
            stages: vec![stage],
            contact_end: ContactEnd::Overlap,
            context,
            history_width: 0,
            reach: 0.0,
            reads: Spring::INFO.reads,
            writes: Spring::INFO.writes,
        }],
        event: None,
        driver: TimeStepPlan {
            scheme: Scheme::VelocityVerlet,
            step,
            steps,
            step_limit: f64::INFINITY,
            search: Search::AllPairs,
            skin: 0.1,
            threads: Some(1),
        },
        outputs: Vec::new(),
        checkpoint: None,
        guards: granule_plan::Guards::default(),
        decisions: Vec::new(),
        fingerprint: FINGERPRINT.into(),
    }
}

/// An output of a test plan.
pub fn output(path: &str, kind: OutputKind, every: u64) -> OutputPlan {
    OutputPlan { path: path.into(), kind, every }
}

/// Fingerprint of all test plans.
pub const FINGERPRINT: &str = "0123456789abcdef0123456789abcdef";

/// Where all test files come from.
pub fn provenance() -> Provenance {
    Provenance::new("0.1.0", FINGERPRINT, 1_764_000_000).unwrap()
}

/// Runs a plan to its end with its outputs in `directory` and gives the driver back.
pub fn run(plan: Plan, directory: &std::path::Path) -> TimeStepDriver {
    let mut observers = Observers::from_plan(&plan, directory, &provenance()).unwrap();
    let steps = plan.driver.steps;
    let mut driver = TimeStepDriver::new(Arc::new(plan), None).unwrap();
    let never = AtomicBool::new(false);
    observers.start(&driver.view()).unwrap();
    while driver.step() < steps {
        let next = observers.next_due(driver.step()).unwrap_or(steps).min(steps);
        driver.advance(next, &never).unwrap();
        observers.observe(&driver.view()).unwrap();
    }
    observers.finish(&driver.view()).unwrap();
    driver
}
