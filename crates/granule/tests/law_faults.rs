//! A law of somebody else that panics is named, and the run ends with whole files.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule::parts::law_api::{
    Columns, ContactChunk, ContactLaw, Dimension, Form, Impact, LawEntry, LawError, LawInfo, Oracle,
    PairContext, ParamSpec, Params, Real, Slot, Source, Stage, TimeScale, ValueRange,
};
use granule::prelude::{RunError, RunOptions, Silent};

const STIFFNESS: ParamSpec = ParamSpec {
    name: "stiffness",
    symbol: "k",
    doc: "Stiffness.",
    dimension: Dimension::STIFFNESS,
    range: ValueRange::POSITIVE,
};

/// f_n = k δ, with a panic at overlaps over a thousandth of a millimetre.
struct Fussy;

static ENTRY: LawEntry = LawEntry::of::<Fussy>("test", "0.0.0");

impl ContactLaw for Fussy {
    const INFO: LawInfo = LawInfo {
        name: "Fussy",
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
            assert!(overlap < T::of(1e-6), "an overlap that I do not like");
            chunk.normal_force[k] = self.stiffness * overlap;
        }
    }
}

/// Spheres on a lattice that fly about until two of them meet, or that overlap from the start.
fn scene(spacing: &str) -> String {
    format!(
        r#"(version: 1, materials: {{ "a": (density: 2500) }},
    cell: (lo: (0, 0, 0), hi: ("48 mm", "48 mm", "48 mm"), periodic: (true, true, true)),
    bodies: [Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "{spacing}", lo: (0, 0, 0),
        hi: ("47 mm", "47 mm", "47 mm"), velocity_spread: 1)],
    contacts: [(between: ("a", "a"), normal: Fussy(stiffness: 1e4))],
    driver: TimeStep(step: "1 us"), run: (steps: 5000), allow_overlap: true,
    outputs: [Series(path: "series.csv", columns: ["kinetic_energy"], every: 10)])"#
    )
}

#[test]
fn a_law_that_panics_is_named_and_files_are_whole() {
    let laws = granule::laws().unwrap();
    let entries = laws.entries().iter().copied().chain([&ENTRY]);
    let laws = granule::parts::law_api::Registry::from_entries(entries).unwrap();
    for (spacing, threads, begins) in [("3 mm", 1, true), ("3 mm", 4, true), ("1.99 mm", 4, false)] {
        let parsed = granule::parts::scene::parse(&scene(spacing));
        let (plan, problems) = granule::parts::plan::build(&parsed.scene.unwrap(), &laws, Path::new("."));
        let plan = plan.unwrap_or_else(|| panic!("{:?} {problems:?}", parsed.diagnostics));
        let folder = tempfile::tempdir().unwrap();
        let (mut silent, stop) = (Silent, AtomicBool::new(false));
        let options = RunOptions {
            output_dir: None,
            threads: Some(threads),
            force: false,
            progress: &mut silent,
            stop: &stop,
            max_time: None,
        };
        let error = granule::run_plan(plan, None, folder.path(), options).unwrap_err();
        let told = error.to_string();
        assert!(matches!(error, RunError::Engine { .. }), "{told}");
        assert!(told.contains("the law Fussy panicked at step"), "{told}");
        assert!(told.contains("an overlap that I do not like"), "{told}");
        assert_eq!(told.contains("at step 0 "), !begins, "{told}");
        if begins {
            let manifest = std::fs::read_to_string(folder.path().join("manifest.json")).unwrap();
            assert!(manifest.contains("failed: the law Fussy panicked"), "{manifest}");
            let series = granule::parts::formats::csv::read(folder.path().join("series.csv")).unwrap();
            assert!(!series.column("step").unwrap().is_empty());
        }
    }
}
