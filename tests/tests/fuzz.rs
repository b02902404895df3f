//! Hostile input: whatever a file holds, nothing panics, nothing hangs, and memory stays within a bound that the length of the
//! input gives. A few thousand inputs each here, a million each with `cargo xtask fuzz`.
#![expect(unsafe_code, reason = "a global allocator is an unsafe trait")]

#[path = "fuzz/checkpoint.rs"]
mod checkpoint;
#[path = "fuzz/guard.rs"]
mod guard;
#[path = "fuzz/mutate.rs"]
mod mutate;

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use granule_calibration::Options;
use granule_formats::{csv, lammps_data, lammps_dump};
use granule_geometry::{Cell, Cylinder, Motion, NeighbourGrid, Plane, Surface, Wall, brute_force_pairs};
use granule_law_api::Registry;
use granule_laws as _;
use granule_plan::{Allowance, DataFiles};
use guard::{Bound, Counting, fuzz};
use mutate::{Choices, mutated};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What planning may take in these tests \[bytes\]: some thousand bodies.
const MEMORY: u64 = 24 << 20;

static REGISTRY: LazyLock<Registry> = LazyLock::new(|| Registry::collect().expect("one registry"));

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/good"))
}

/// Texts of all scenes of the tests, good and bad.
static SCENES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let mut paths: Vec<_> = ["good", "bad"]
        .iter()
        .flat_map(|name| fs::read_dir(folder().with_file_name(name)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .collect();
    paths.sort();
    paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect()
});

/// Values at the edge of what is allowed, signs that do not match, names that exist elsewhere.
const SCENE_SPICE: [&str; 62] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "\"",
    "'",
    "//",
    "/*",
    "*/",
    "r#\"",
    "#",
    "-",
    "inf",
    "NaN",
    "1e308",
    "-1e-300",
    "0",
    "1",
    "2",
    "7",
    "65536",
    "4294967295",
    "18446744073709551616",
    "1e9",
    "1e-9",
    "5e-324",
    "0.5",
    "\"1 mm\"",
    "\"1 Gm\"",
    "\"1e-30 m\"",
    "\"-1 s\"",
    "\"1e300 N/m\"",
    "\"90 deg\"",
    "\"100 %\"",
    "\"glass\"",
    "\"\"",
    "\"../x\"",
    "\"/dev/zero\"",
    "\"spheres.data\"",
    "()",
    "Some(1)",
    "None",
    "true",
    "false",
    "ä",
    "\0",
    "\u{202e}",
    "radius",
    "Lattice",
    "Fill",
    "Import",
    "Auto()",
    "Steps",
    "Event()",
    "TimeStep",
    "periodic",
    "(true, true, true)",
    "Hexagonal",
];

fn scene(input: &[u8]) -> String {
    let mut choices = Choices::new(input);
    let text = &SCENES[choices.below(SCENES.len())];
    mutated(text, &SCENE_SPICE, &mut choices)
}

/// Reads a text as a scene and shows its diagnostics.
fn read_scene(text: &str) -> Option<granule_scene::Scene> {
    let parsed = granule_scene::parse(text);
    for diagnostic in parsed.diagnostics.iter().take(20) {
        assert!(diagnostic.span.end <= text.len());
        assert!(!diagnostic.render("scene.ron", text).is_empty());
    }
    assert!(parsed.scene.is_some() || !parsed.diagnostics.is_empty(), "neither a scene nor a reason");
    parsed.scene
}

#[test]
fn scene_reader() {
    let bound = Bound { constant: 1 << 20, each: 2000 };
    fuzz("scene_reader", 2000, 256, bound, |input| {
        // Every third input is no scene at all.
        let text = match input.split_first() {
            Some((first, rest)) if first.is_multiple_of(3) => String::from_utf8_lossy(rest).into_owned(),
            _ => scene(input),
        };
        read_scene(&text);
        text.len()
    });
}

#[test]
fn planner() {
    // Twice what is allowed, for lists that grow by doubling.
    let bound = Bound { constant: 2 * MEMORY as usize, each: 20_000 };
    fuzz("planner", 300, 64, bound, |input| {
        let text = scene(input);
        let Some(scene) = read_scene(&text) else { return text.len() };
        let allowance = Allowance { memory: MEMORY, files: DataFiles::BesideScene };
        let (plan, diagnostics) = granule_plan::build_within(&scene, &REGISTRY, folder(), &allowance);
        assert!(plan.is_some() || !scene.complete || !diagnostics.is_empty(), "no plan and no reason");
        for diagnostic in diagnostics.iter().take(20) {
            assert!(diagnostic.span.end <= text.len());
            assert!(!diagnostic.render("scene.ron", &text).is_empty());
        }
        if let Some(plan) = plan {
            assert!(granule_plan::memory_estimate(&plan) <= MEMORY);
            assert!(!granule_plan::explain(&plan).is_empty());
        }
        text.len()
    });
}

const FILE_SPICE: [&str; 40] = [
    "\n",
    " ",
    "\t",
    "\r\n",
    "#",
    "0",
    "1",
    "-1",
    "2",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "0x10",
    "4294967296",
    "9223372036854775807",
    "99999999999999999999",
    "1.5",
    "1e",
    "atoms",
    "atom types",
    "xlo xhi",
    "xy xz yz",
    "Atoms",
    "Atoms # sphere",
    "Velocities",
    "Masses",
    "ITEM: TIMESTEP",
    "ITEM: ATOMS",
    "ITEM: NUMBER OF ATOMS",
    "ITEM: BOX BOUNDS pp pp pp",
    "id type x y z",
    "radius",
    "mass",
    "vx vy vz",
    ",",
    ";",
    "ä",
    "\0",
    "\u{feff}",
];

fn file(input: &[u8], valid: &str) -> String {
    match input.split_first() {
        Some((first, rest)) if first.is_multiple_of(8) => String::from_utf8_lossy(rest).into_owned(),
        _ => mutated(valid, &FILE_SPICE, &mut Choices::new(input)),
    }
}

static DATA: LazyLock<String> = LazyLock::new(|| fs::read_to_string(folder().join("spheres.data")).unwrap());
static DUMP: LazyLock<String> = LazyLock::new(|| fs::read_to_string(folder().join("spheres.dump")).unwrap());

#[test]
fn data_file() {
    let bound = Bound { constant: 1 << 16, each: 100 };
    fuzz("data_file", 5000, 256, bound, |input| {
        let text = file(input, &DATA);
        match lammps_data::parse(Path::new("x.data"), &text) {
            Ok(data) => {
                assert!(data.atoms.iter().all(|atom| atom.radius() > 0.0 && atom.position[0].is_finite()));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        text.len()
    });
}

#[test]
fn dump() {
    let bound = Bound { constant: 1 << 16, each: 100 };
    fuzz("dump", 5000, 256, bound, |input| {
        let text = file(input, &DUMP);
        // A reader goes on until its first error.
        for frame in lammps_dump::Reader::new("x.dump", text.as_bytes()) {
            match frame {
                Ok(mut frame) => {
                    frame.sort_by_id();
                    let _ =
                        (frame.positions(), frame.ids(), frame.materials(), frame.vector(["vx", "vy", "vz"]));
                }
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
        text.len()
    });
}

#[test]
fn checkpoints() {
    let bound = Bound { constant: 1 << 20, each: 100 };
    fuzz("checkpoints", 2000, 64, bound, checkpoint::open);
}

/// Impacts of spheres with psi1 from 0 to 9 that stick, then slide (restitution 0.9, friction 0.2, tangential restitution
/// 0.5).
const IMPACTS: &str = "psi1,psi2,restitution\n0.2,-0.1,0.9\n0.5,-0.25,0.9\n1,-0.5,0.91\n1.5,-0.75,0.89\n3,1.67,0.9\n\
    5,3.67,0.92\n7,5.67,0.9\n9,7.67,0.88\n";
const MEASURED: &str = "normal_speed [m/s],tangential_velocity [m/s],rebound_normal_speed [m/s],\
    rebound_tangential_velocity [m/s],radius [m],spin [rad/s],rebound_spin [rad/s]\n1,0.5,0.9,0.3,1e-3,0,20\n\
    1,1,0.9,0.7,1e-3,0,40\n1,2,0.9,1.5,1e-3,5,60\n1,4,0.9,3.4,1e-3,-5,80\n";

#[test]
fn impacts() {
    let bound = Bound { constant: 1 << 16, each: 200 };
    fuzz("impacts", 5000, 256, bound, |input| {
        let valid = if input.len().is_multiple_of(2) { IMPACTS } else { MEASURED };
        let text = file(input, valid);
        let Ok(table) = csv::parse(Path::new("x.csv"), &text) else { return text.len() };
        if let Ok(impacts) = granule_calibration::table(&table) {
            assert!(impacts.iter().all(|impact| impact.psi1.is_finite() && impact.psi1 >= 0.0));
            let mut choices = Choices::new(input);
            let options = Options {
                inertia_factor: if choices.byte() < 200 { 0.4 } else { choices.number() },
                restitution: (choices.byte() < 50).then(|| choices.number()),
                confidence: if choices.byte() < 200 { 0.95 } else { choices.number() },
            };
            let _ = granule_calibration::fit(&impacts, &options);
        }
        text.len()
    });
}

/// Pairs of bodies with the code of their image.
type Lists = (Vec<u32>, Vec<u32>, Vec<u8>);

#[test]
fn neighbours() {
    let bound = Bound { constant: 1 << 20, each: 4000 };
    fuzz("neighbours", 3000, 600, bound, |input| {
        let mut choices = Choices::new(input);
        let flags = choices.byte();
        let mut extent = |limit: u8| {
            if choices.byte() < limit { (0.0, 1.0) } else { (choices.number(), choices.number()) }
        };
        let ends = [extent(230), extent(230), extent(230)];
        let periodic = [flags & 1 > 0, flags & 2 > 0, flags & 4 > 0];
        let Ok(cell) = Cell::new(ends.map(|(lo, _)| lo), ends.map(|(_, hi)| hi), periodic) else { return 0 };
        let margin = if flags & 8 > 0 { 0.05 * choices.share() } else { choices.number() };
        let mut bodies = Vec::new();
        while !choices.is_empty() && bodies.len() < 60 {
            let position: [f64; 3] = std::array::from_fn(|_| choices.number());
            let radius = match choices.byte() {
                0..200 => 0.1 * choices.share(),
                200..240 => 1e-4 * choices.share(),
                _ => choices.number().abs(),
            };
            bodies.push([position[0], position[1], position[2], radius]);
        }
        let (mut grid, mut force) = (Lists::default(), Lists::default());
        NeighbourGrid::new().half_pairs(&bodies, &cell, margin, &mut grid.0, &mut grid.1, &mut grid.2);
        brute_force_pairs(&bodies, &cell, margin, &mut force.0, &mut force.1, &mut force.2);
        assert_eq!(grid, force, "{cell:?} {margin} {bodies:?}");
        32 * bodies.len()
    });
}

#[test]
fn walls() {
    let bound = Bound { constant: 1 << 16, each: 200 };
    fuzz("walls", 20_000, 256, bound, |input| {
        let mut choices = Choices::new(input);
        let vector = |choices: &mut Choices<'_>| -> [f64; 3] { std::array::from_fn(|_| choices.number()) };
        let (at, direction) = (vector(&mut choices), vector(&mut choices));
        let surface: Option<Surface> = if choices.byte().is_multiple_of(2) {
            Plane::new(at.into(), direction.into()).ok().map(Surface::from)
        } else {
            let inside = choices.byte().is_multiple_of(2);
            Cylinder::new(at.into(), direction.into(), choices.number(), inside).ok().map(Surface::from)
        };
        let motion = match choices.byte() % 4 {
            0 => Motion::constant_velocity(vector(&mut choices).into()),
            1 => Motion::sinusoidal(vector(&mut choices).into(), choices.number(), choices.number()),
            2 => Motion::rotation(vector(&mut choices).into(), vector(&mut choices).into(), choices.number()),
            _ => {
                let rows = 1 + choices.below(8);
                Motion::table((0..rows).map(|_| (choices.number(), vector(&mut choices).into())).collect())
            }
        };
        let (Some(surface), Ok(motion)) = (surface, motion) else { return input.len() };
        let wall = Wall::new(surface, motion);
        for _ in 0..4 {
            let (place, time) = (vector(&mut choices), choices.number());
            let contact = wall.surface_at(time).contact(place.into());
            let ordinary =
                |values: &[f64]| values.iter().all(|x| x.abs() < 1e6 && (*x == 0.0 || x.abs() > 1e-6));
            // Whatever is within ten powers of ten has a distance and a normal of length one.
            if wall.motion().is_fixed() && ordinary(&at) && ordinary(&direction) && ordinary(&place) {
                let length = contact.normal.norm();
                assert!(contact.distance.is_finite() && (length - 1.0).abs() < 1e-12, "{contact:?}");
            }
        }
        input.len()
    });
}
