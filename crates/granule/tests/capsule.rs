//! The smallest scene in which a run fails as it has: it fails when it is run.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule::parts::law_api::{
    Columns, ContactChunk, ContactLaw, Dimension, Form, Impact, LawError, LawInfo, Oracle, PairContext,
    ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange, register_law,
};
use granule::prelude::{EngineError, RunError, RunOptions, Silent};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};

/// f_n = k δ up to 0.02 mm, and no number beyond.
struct Cracking;

register_law!(Cracking);

impl ContactLaw for Cracking {
    const INFO: LawInfo = LawInfo {
        name: "Cracking",
        summary: "Linear spring that ends.",
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
    };

    fn compile<T: Real>(params: &Params, _: &PairContext) -> Result<Box<dyn Stage<T>>, LawError> {
        Ok(Box::new(Compiled { stiffness: T::of(params.value(&STIFFNESS)?) }))
    }

    fn time_scale(_: &Params, _: &PairContext, _: &Impact) -> Result<Option<TimeScale>, LawError> {
        Ok(None)
    }

    fn oracle(_: &Params, _: &PairContext) -> Oracle {
        Oracle::Missing
    }
}

struct Compiled<T> {
    stiffness: T,
}

impl<T: Real> Stage<T> for Compiled<T> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        for k in 0..chunk.len() {
            let overlap = chunk.overlap[k];
            chunk.normal_force[k] =
                if overlap < T::of(2e-5) { self.stiffness * overlap } else { T::of(f64::NAN) };
        }
    }
}

fn run(scene: &Path, folder: &Path) -> RunError {
    let (mut silent, stop) = (Silent, AtomicBool::new(false));
    let options = RunOptions {
        output_dir: Some(folder.to_path_buf()),
        threads: Some(2),
        force: false,
        progress: &mut silent,
        stop: &stop,
        max_time: None,
    };
    granule::run(scene, options).expect_err("the law ends")
}

/// A gas of a thousand spheres in which, after a while, two meet too fast.
#[test]
fn a_number_that_is_not_finite_leaves_the_pair_that_made_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gas.ron");
    let text = r#"(version: 1, seed: 5, materials: { "a": (density: 2500) },
    cell: (lo: (0, 0, 0), hi: ("30 mm", "30 mm", "30 mm"), periodic: (true, true, true)),
    bodies: [
        Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "3 mm", lo: (0, 0, 0), hi: ("29 mm", "29 mm", "29 mm"),
            velocity_spread: 0.2),
    ],
    contacts: [(between: ("a", "a"), normal: Cracking(stiffness: 1e3))],
    driver: TimeStep(step: "2 us"), run: (steps: 100000), // a comment
    outputs: [Series(path: "series.csv", columns: ["kinetic_energy"], every: 10)])"#;
    std::fs::write(&path, text).unwrap();
    let error = run(&path, &folder.path().join("out"));
    let told = error.to_string();
    let RunError::Engine { error: EngineError::LawNotFinite { law, step, .. }, aftermath, .. } = &error
    else {
        panic!("{told}")
    };
    assert!(*step > 1 && *law == "Cracking", "{told}");
    assert!(told.contains("likely cause") && told.contains("touches"), "{told}");
    let capsule = aftermath.capsule.as_ref().expect("a scene is left");
    assert!(told.contains("the same happens in a scene of ") && told.contains("crash.ron"), "{told}");
    let scene = std::fs::read_to_string(capsule).unwrap();
    let bodies = scene.matches("Body(id:").count();
    assert!((1..=2).contains(&bodies), "{scene}");
    let again = run(capsule, &folder.path().join("again"));
    let RunError::Engine { error: EngineError::LawNotFinite { law, .. }, .. } = &again else {
        panic!("{again}")
    };
    assert_eq!(*law, "Cracking");
}
