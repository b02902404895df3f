//! Initial states: what a plan places where, and what its fingerprint hangs on.

use std::path::{Path, PathBuf};

use granule_geometry::Cell;
use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::{BodyTable, Partner, Plan};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/good")
}

fn try_plan(text: &str) -> Result<Plan, String> {
    let parsed = granule_scene::parse(text);
    let mut diagnostics = parsed.diagnostics;
    let plan = parsed.scene.and_then(|scene| {
        let (plan, more) = granule_plan::build(&scene, &Registry::collect().unwrap(), &folder());
        diagnostics.extend(more);
        plan
    });
    plan.ok_or_else(|| diagnostics.iter().map(|d| d.render("scene.ron", text)).collect())
}

fn plan(text: &str) -> Plan {
    try_plan(text).unwrap_or_else(|problems| panic!("{problems}"))
}

/// A scene with these bodies and further fields.
fn scene(bodies: &str, more: &str) -> String {
    format!(
        "(version: 1, materials: {{ \"glass\": (density: 2500) }}, bodies: [{bodies}], {more} contacts: [(between: \
         (\"glass\", \"glass\"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.9))], run: (steps: 10))"
    )
}

/// Smallest gap between two bodies, with periodic images.
fn smallest_gap(bodies: &BodyTable, cell: &Cell) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..bodies.len() {
        for j in 0..i {
            let apart = std::array::from_fn(|axis| bodies.position[i][axis] - bodies.position[j][axis]);
            let (image, _) = cell.minimum_image(apart);
            let distance = image.iter().map(|x| x * x).sum::<f64>().sqrt();
            least = least.min(distance - bodies.radius[i] - bodies.radius[j]);
        }
    }
    least
}

#[test]
fn a_fill_is_clear_of_everything() {
    let plan = plan(&scene(
        "Sphere(material: \"glass\", radius: 3e-3, position: (0.01, 0.01, 0.01)), \
         Fill(material: \"glass\", radius: Mixture([(0.4e-3, 3), (\"1 mm\", 1)]), volume_fraction: 0.2, \
         lo: (0, 0, 0), hi: (0.02, 0.02, 0.02), velocity: (0, 0, 1), velocity_spread: 0.1)",
        "seed: 5, cell: (lo: (0, 0, -1), hi: (0.02, 0.02, 1), periodic: (true, true, false)), \
         walls: { \"floor\": Plane(point: (0, 0, 0.001), normal: (0, 0, 1), material: \"glass\") },",
    ));
    let bodies = &plan.bodies;
    assert!(smallest_gap(bodies, &plan.cell) >= 0.0);
    let filled = 1..bodies.len();
    let volume: f64 =
        filled.clone().map(|k| bodies.radius[k].powi(3) * 4.0 / 3.0 * std::f64::consts::PI).sum();
    // The last body may miss the target by half its volume: 2.1e-9 of 8e-6 m³.
    assert!((volume / 8e-6 - 0.2).abs() < 3e-4, "{}", volume / 8e-6);
    let small = filled.clone().filter(|k| bodies.radius[*k] < 0.5e-3).count() as f64;
    let count = filled.len() as f64;
    // Three quarters of the number are small, within five standard errors.
    assert!((small / count - 0.75).abs() < 5.0 * (0.1875 / count).sqrt(), "{small} of {count}");
    for k in filled {
        assert!(
            bodies.position[k][2] >= 0.001 + bodies.radius[k]
                && bodies.position[k][2] <= 0.02 - bodies.radius[k]
        );
        assert!((bodies.velocity[k][2] - 1.0).abs() <= 0.1 && bodies.velocity[k][0].abs() <= 0.1);
    }
    // Bodies do lie across the periodic sides: the fill has no gap there.
    assert!((0..bodies.len()).any(|k| bodies.position[k][0] < bodies.radius[k]));
}

#[test]
fn a_seed_repeats_its_fill_and_another_does_not() {
    let fill = |seed: u32| {
        plan(&scene(
            "Fill(material: \"glass\", radius: Normal(mean: 1e-3, standard_deviation: 1e-4), count: 50, \
             lo: (0, 0, 0), hi: (0.02, 0.02, 0.02))",
            &format!("seed: {seed},"),
        ))
    };
    let (first, again, other) = (fill(1), fill(1), fill(2));
    assert_eq!(first.bodies.position, again.bodies.position);
    assert_eq!(first.bodies.radius, again.bodies.radius);
    assert_eq!(first.fingerprint, again.fingerprint);
    assert_ne!(first.bodies.position, other.bodies.position);
    assert_ne!(first.fingerprint, other.fingerprint);
    assert!(first.bodies.radius.iter().all(|radius| (radius - 1e-3).abs() <= 3e-4));
}

#[test]
fn ids_that_are_not_given_are_the_smallest_free_ones() {
    let sphere =
        |id: &str, x: f64| format!("Sphere({id} material: \"glass\", radius: 1e-3, position: ({x}, 0, 0))");
    let bodies =
        [sphere("", 0.1), sphere("id: 3,", 0.2), sphere("", 0.3), sphere("id: 1,", 0.4), sphere("", 0.5)];
    let table = plan(&scene(&bodies.join(", "), "")).bodies;
    assert_eq!(table.id, [1, 2, 3, 4, 5]);
    let x: Vec<f64> = table.position.iter().map(|p| p[0]).collect();
    assert_eq!(x, [0.4, 0.1, 0.2, 0.3, 0.5]);
}

#[test]
fn masses_and_inertia_of_each_shape() {
    let table = plan(
        "(version: 1, dimensions: 2, materials: { \"m\": (density: 1000) }, bodies: [\
         Sphere(material: \"m\", radius: 1, position: (0, 0)), Disc(material: \"m\", radius: 1, position: (3, 0), spin: 4), \
         HollowSphere(material: \"m\", radius: 1, position: (6, 0)), \
         Body(inertia_factor: 0.7, material: \"m\", mass: \"3 kg\", radius: 1, position: (9, 0, 0), spin: (0, 0, 5))], \
         contacts: [(between: (\"m\", \"m\"), normal: LinearSpringDashpot(stiffness: 1, restitution: 1))], run: (steps: 1))",
    )
    .bodies;
    let pi = std::f64::consts::PI;
    assert_eq!(table.inertia_factor, [0.4, 0.5, 2.0 / 3.0, 0.7]);
    for (mass, expected) in table.mass.iter().zip([4e3 / 3.0 * pi, 1e3 * pi, 4e3 / 3.0 * pi, 3.0]) {
        // Four roundings.
        assert!((mass / expected - 1.0).abs() < 1e-15, "{mass} {expected}");
    }
    assert_eq!(table.spin[1], [0.0, 0.0, 4.0]);
    assert_eq!(table.spin[3], [0.0, 0.0, 5.0]);
}

#[test]
fn bodies_are_wrapped_into_the_cell() {
    let plan = plan(&scene(
        "Sphere(material: \"glass\", radius: 1e-3, position: (-0.25, 2.5, 0))",
        "cell: (lo: (0, 0, -inf), hi: (1, 1, inf), periodic: (true, true, false)), driver: TimeStep(step: 1e-6),",
    ));
    assert_eq!(plan.bodies.position[0], [0.75, 0.5, 0.0]);
}

#[test]
fn contexts_hold_what_occurs_and_no_more() {
    // Two bodies of one material: one pair, one reduced mass.
    let sphere = |r: f64, x: f64, more: &str| {
        format!("Sphere(material: \"glass\", radius: {r}, mass: {r}, position: ({x}, 0, 0) {more})")
    };
    let two = plan(&scene(&[sphere(1e-3, 0.0, ""), sphere(3e-3, 0.1, "")].join(", "), ""));
    let span = two.compositions[0].context.reduced_mass;
    assert_eq!(span.min, span.max);
    assert!((span.min - 0.75e-3).abs() < 1e-18);
    assert!((two.compositions[0].context.reduced_radius.max - 0.75e-3).abs() < 1e-18);
    // A frozen partner counts as infinitely heavy.
    let frozen = plan(&scene(&[sphere(1e-3, 0.0, ""), sphere(3e-3, 0.1, ", frozen: true")].join(", "), ""));
    assert!((frozen.compositions[0].context.reduced_mass.max - 1e-3).abs() < 1e-18);
    assert!(frozen.composition(0, Partner::Body(0)).is_some());
    // Many bodies: bounds that hold every pair.
    let many: Vec<String> = (0..80)
        .map(|k| {
            sphere(
                1e-3 + 1e-5 * f64::from(k),
                0.01 * f64::from(k),
                if k % 3 == 0 { ", frozen: true" } else { "" },
            )
        })
        .collect();
    let plan = plan(&scene(&many.join(", "), ""));
    let (table, span) = (&plan.bodies, plan.compositions[0].context.reduced_mass);
    let inverse = |k: usize| if table.frozen[k] { 0.0 } else { 1.0 / table.mass[k] };
    for i in 0..table.len() {
        for j in 0..i {
            let sum = inverse(i) + inverse(j);
            assert!(
                sum == 0.0
                    || (1.0 / sum >= span.min * (1.0 - 1e-15) && 1.0 / sum <= span.max * (1.0 + 1e-15))
            );
        }
    }
}

#[test]
fn the_fingerprint_hangs_on_physics_alone() {
    let text = |friction: &str, more: &str| {
        format!(
            "(version: 1, materials: {{ \"glass\": (density: 2500) }}, bodies: [Sphere(material: \"glass\", radius: 1e-3, \
             position: (0, 0, 0)), Sphere(material: \"glass\", radius: 1e-3, position: (0.01, 0, 0))], contacts: [(between: \
             (\"glass\", \"glass\"), normal: LinearSpringDashpot(stiffness: 1e4, restitution: 0.9), tangential: \
             TangentialSpring(stiffness: 2e3, friction: {friction}))], driver: TimeStep(step: 1e-6), {more})"
        )
    };
    let print = |friction: &str, more: &str| plan(&text(friction, more)).fingerprint;
    let first = print("0.5", "run: (steps: 10)");
    for same in [
        "run: (steps: 20)",
        "run: (steps: 10), title: \"other\"",
        "run: (steps: 10), outputs: [LammpsDump(path: \"a\")]",
        "run: (steps: 10), ledger: true",
    ] {
        assert_eq!(first, print("0.5", same), "{same}");
    }
    for other in [
        "run: (steps: 10), precision: Single",
        "run: (steps: 10), conventions: (coulomb_cap: Magnitude)",
        "run: (steps: 10), gravity: (0, 0, -1)",
        "run: (steps: 10), impact_speed: 3",
        "run: (steps: 10), cell: (lo: (-1, -1, -1), hi: (1, 1, 1))",
    ] {
        assert_ne!(first, print("0.5", other), "{other}");
    }
    assert_ne!(first, print("0.5000000000000001", "run: (steps: 10)"));
}

#[test]
fn a_dump_and_a_data_file_of_the_same_bodies_make_the_same_plan() {
    let import = |file: &str, format: &str| {
        plan(&format!(
            "(version: 1, materials: {{ \"glass\": (), \"wall\": () }}, bodies: [Import(file: \"{file}\", format: {format}, \
             materials: {{ 1: \"glass\", 2: \"wall\" }}, frozen_types: [2])], contacts: [(between: (\"glass\", \"glass\")), \
             (between: (\"glass\", \"wall\"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.9))], \
             driver: TimeStep(step: 1e-6), run: (steps: 1))"
        ))
    };
    let data = import("spheres.data", "LammpsData");
    let last = import("spheres.dump", "LammpsDump(frame: Last)");
    assert_eq!(data.bodies.id, last.bodies.id);
    assert_eq!(data.bodies.position, last.bodies.position);
    assert_eq!(data.bodies.velocity, last.bodies.velocity);
    assert_eq!(data.bodies.mass, last.bodies.mass);
    assert_eq!(data.bodies.spin, last.bodies.spin);
    assert_eq!(data.bodies.frozen, [false, false, true]);
    assert_eq!(data.fingerprint, last.fingerprint);
    let first = import("spheres.dump", "LammpsDump(frame: 0)");
    assert_eq!(first.bodies.position[0], [-1.0, 0.0, 0.0]);
}

#[test]
fn a_scene_of_many_bodies_is_read_in_reasonable_time() {
    let mut bodies = String::new();
    for k in 0..20_000 {
        let (x, y, z) = (k % 30, k / 30 % 30, k / 900);
        bodies.push_str(&format!(
            "Sphere(id: {}, material: \"glass\", radius: \"1 mm\", position: ({}, {}, {}), velocity: (0.1, 0, 0)),\n",
            k + 1,
            0.0021 * f64::from(x),
            0.0021 * f64::from(y),
            0.0021 * f64::from(z)
        ));
    }
    let begin = std::time::Instant::now();
    assert_eq!(plan(&scene(&bodies, "")).bodies.len(), 20_000);
    // One to three seconds; anything quadratic takes minutes.
    assert!(begin.elapsed().as_secs() < 30, "{:?}", begin.elapsed());
}
