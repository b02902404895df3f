//! Outputs about many bodies together, from scenes.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granule_drivers::{Driver, TimeStepDriver};
use granule_formats::csv::{self, Table};
use granule_observers::layer::{Layer, clusters, segregation_index};
use granule_observers::{Observers, Provenance};
use granule_tests::plan;

/// Runs a scene with its outputs and gives the layer at the end.
fn run(text: &str, folder: &Path) -> Layer {
    let plan = plan(text);
    let provenance = Provenance::new("0", "0", 0).unwrap();
    let mut observers = Observers::from_plan(&plan, folder, &provenance).unwrap();
    let mut driver = TimeStepDriver::new(plan.clone(), Some(1)).unwrap();
    observers.start(&driver.view()).unwrap();
    while driver.step() < plan.driver.steps {
        let next = observers.next_due(driver.step()).unwrap().min(plan.driver.steps);
        driver.advance(next, &AtomicBool::new(false)).unwrap();
        observers.observe(&driver.view()).unwrap();
    }
    observers.finish(&driver.view()).unwrap();
    Layer::of(&driver.view())
}

fn column<'a>(table: &'a Table, name: &str) -> &'a [f64] {
    table.column(name).unwrap_or_else(|| panic!("no column {name}"))
}

#[test]
fn restitutions_of_rolling_spheres_are_those_of_kondic() {
    // Two spheres that roll towards each other, and far away a third one, which nobody meets.
    let body = |x: f64, y: f64, v: f64| {
        format!(
            "Sphere(material: \"steel\", radius: 2e-3, position: ({x}, {y}, 2e-3), velocity: ({v}, 0, 0), spin: (0, {}, 0))",
            v / 2e-3
        )
    };
    let text = format!(
        "(version: 1, gravity: (0, 0, -9.81), materials: {{ \"steel\": (density: 7850) }},
          bodies: [{}, {}, {}],
          substrate: (laws: {{ \"steel\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1) }}),
          contacts: [(between: (\"steel\", \"steel\"), contact_end: Overlap,
                      normal: LinearSpringDashpot(contact_duration: 1e-5, restitution: 0.9))],
          driver: TimeStep(step: 1e-7), run: (duration: 0.035),
          outputs: [Impacts(path: \"impacts.csv\", every: 10, reach: 0.02),
                    Layer(path: \"layer.csv\", every: 35000, gap: 1e-4),
                    PairCorrelation(path: \"g.csv\", every: 350000, range: 0.01, bins: 5)])",
        body(2.1e-3, 0.0, -0.05),
        body(-2.1e-3, 0.0, 0.05),
        body(0.1, 0.05, 0.0),
    );
    let folder = tempfile::tempdir().unwrap();
    run(&text, folder.path());
    let table = csv::read(folder.path().join("impacts.csv")).unwrap();
    assert_eq!(table.rows(), 1);
    let value = |name: &str| column(&table, name)[0];
    assert_eq!(
        [value("contacts"), value("crowded"), value("interrupted"), value("rolled")],
        [1.0, 0.0, 0.0, 1.0]
    );
    // Q μ_k g t_col is 5e-4 of the speed, the step 1e-3.
    assert!((value("restitution") - 0.9).abs() < 0.002, "{}", value("restitution"));
    // Kondic 1999, Eq. (68): (e Q - 1)/(1 + Q) for e = 0.9 and Q = 5/2.
    let effective = value("effective_restitution");
    assert!((effective / 0.357142857 - 1.0).abs() < 0.005, "{effective}");
    assert!(value("speed_from") <= 0.1 && 0.1 < value("speed_to"));
    // Two discs of 2 mm in one of 20 mm.
    assert_eq!(value("density_from"), 0.0);

    let table = csv::read(folder.path().join("layer.csv")).unwrap();
    assert_eq!(table.rows(), 11);
    // They touch after 2 ms and are a gap of 0.1 mm apart soon after: three clusters at all entries.
    assert_eq!(column(&table, "clusters")[0], 3.0);
    assert_eq!(column(&table, "largest_cluster")[10], 1.0);
    // Velocities ±0.05 m/s and 0, along one of two directions.
    let hot = column(&table, "granular_temperature")[0];
    assert!((hot - 2.0 * 0.0025 / 6.0).abs() < 1e-12, "{hot}");
    assert_eq!(column(&table, "granular_temperature steel")[0], hot);
    assert!(column(&table, "granular_temperature")[10] < 0.2 * hot);
    assert_eq!(csv::read(folder.path().join("g.csv")).unwrap().rows(), 10);
}

#[test]
fn a_shaken_layer_is_described_the_same_by_file_and_function() {
    let friction = "normal: LinearSpringDashpot(contact_duration: 2e-4, restitution: 0.8)";
    let motion = "Sinusoidal(amplitude: (\"2 mm\", 0, 0), frequency: \"10 Hz\")";
    let text = format!(
        "(version: 1, gravity: (0, 0, -9.81), materials: {{ \"a\": (density: 7850), \"b\": (density: 7850) }},
          bodies: [
            Lattice(material: \"a\", radius: 2e-3, spacing: 4.5e-3, lo: (0.003, 0.003, 0.002), hi: (0.05, 0.048, 0.002)),
            Lattice(material: \"b\", radius: 2e-3, spacing: 4.5e-3, lo: (0.003, 0.0525, 0.002), hi: (0.05, 0.1, 0.002)),
          ],
          walls: {{ \"frame\": Box(lo: (0, 0, -1), hi: (0.053, 0.103, 1), open: [\"z-\", \"z+\"], material: \"a\",
                                   motion: {motion}) }},
          substrate: (motion: {motion}, laws: {{
            \"a\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-3),
            \"b\": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 1e-2) }}),
          contacts: [(between: (\"a\", \"a\"), {friction}), (between: (\"a\", \"b\"), {friction}),
                     (between: (\"b\", \"b\"), {friction})],
          driver: TimeStep(step: 1e-5), run: (duration: 0.2),
          outputs: [Layer(path: \"layer.csv\", every: 20000), Impacts(path: \"impacts.csv\", every: 5)])"
    );
    let folder = tempfile::tempdir().unwrap();
    let layer = run(&text, folder.path());
    let table = csv::read(folder.path().join("layer.csv")).unwrap();
    let last = |name: &str| column(&table, name)[1];
    assert_eq!(column(&table, "largest_cluster")[0], 1.0);
    // Two halves of a square lattice: 11 of 430 pairs of neighbours lie across.
    assert!(column(&table, "segregation_index")[0] > 0.9);
    assert_eq!(last("largest_cluster"), clusters(&layer, 2e-4).largest() as f64);
    assert!(last("largest_cluster") > 1.0);
    assert_eq!(last("segregation_index"), segregation_index(&layer, 2e-3));
    assert_eq!(last("granular_temperature b"), layer.granular_temperature(Some(1)));
    assert_eq!(last("density"), layer.density());
    let impacts = csv::read(folder.path().join("impacts.csv")).unwrap();
    assert!(column(&impacts, "contacts").iter().sum::<f64>() > 10.0);
}
