//! Checkpoints that were changed on their way: the file is refused; a state that gets past that is refused or runs on.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use granule_drivers::{DriverState, restore};
use granule_formats::checkpoint as file;
use granule_plan::Plan;

use crate::mutate::Choices;

/// Layout that the files of these tests say they have.
const LAYOUT: u32 = 1;
/// Longest time that a run may go on: one whose clock was set to the far past would take as long as its whole run.
const LONGEST: Duration = Duration::from_millis(2);

const SOFT: &str = r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
    cell: (lo: (0, 0, 0), hi: ("4 mm", "4 mm", "20 mm"), periodic: (true, true, false)),
    bodies: [Fill(material: "a", radius: "0.5 mm", count: 40, lo: (0, 0, 0), hi: ("4 mm", "4 mm", "8 mm"),
        velocity: (0, 0, -0.5), velocity_spread: 0.2)],
    walls: { "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") },
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3))],
    driver: TimeStep(integrator: ContactResolved, packing_limit: false, step: "5 us"), run: (steps: 4000), ledger: true)"#;
const FLYING: &str = r#"(version: 1, seed: 3, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
    cell: (lo: (0, 0, 0), hi: ("6 mm", "6 mm", "6 mm"), periodic: (true, true, false)),
    bodies: [Lattice(material: "a", radius: "0.4 mm", spacing: "2 mm", lo: ("1 mm", "1 mm", "1 mm"),
        hi: ("5 mm", "5 mm", "5 mm"), velocity_spread: 0.2)],
    walls: { "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") },
    contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 0.9, friction: 0.3))],
    driver: Event(step: 1e-3), run: (steps: 300))"#;
const ROLLING: &str = r#"(version: 1, seed: 3, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
    cell: (lo: (0, 0, -inf), hi: ("12 mm", "12 mm", inf), periodic: (true, true, false)),
    bodies: [Lattice(kind: Cubic, material: "a", radius: "1 mm", spacing: "3 mm", lo: (0, 0, "1 mm"),
        hi: ("11 mm", "11 mm", "1 mm"), velocity_spread: 0.1)],
    substrate: (laws: { "a": StickSlip(static_friction: 0.5, kinetic_friction: 0.1, rolling_friction: 0.01) }),
    contacts: [(between: ("a", "a"), collision: HardSphere(restitution: 0.9))],
    driver: Event(step: 1e-3, slides: Arcs()), run: (steps: 300))"#;

/// Plans, each with a state in the middle of its run.
static STATES: LazyLock<Vec<(Arc<Plan>, Vec<u8>)>> = LazyLock::new(|| {
    let state = |text: &str| {
        let plan = granule_tests::plan(text);
        let mut driver = granule_drivers::driver(plan.clone(), Some(1)).unwrap();
        driver.advance(plan.driver.steps / 2, &AtomicBool::new(false)).unwrap();
        let bytes = postcard::to_stdvec(&driver.save()).unwrap();
        (plan, bytes)
    };
    [SOFT, FLYING, ROLLING].into_iter().map(state).collect()
});

/// Folder of the files, kept until the tests end.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());

/// Changes some bytes: set, replaced by a number, taken out, copied to another place, or cut off.
fn change(bytes: &mut Vec<u8>, choices: &mut Choices<'_>) {
    for _ in 0..1 + choices.below(4) {
        if bytes.is_empty() {
            return;
        }
        let at = choices.below(bytes.len());
        match choices.byte() % 8 {
            0..3 => bytes[at] ^= choices.byte().max(1),
            3..6 => {
                let number = choices.number().to_le_bytes();
                let end = (at + 8).min(bytes.len());
                bytes[at..end].copy_from_slice(&number[..end - at]);
            }
            6 => {
                let end = (at + 1 + choices.below(64)).min(bytes.len());
                let taken: Vec<u8> = bytes.drain(at..end).collect();
                if choices.byte().is_multiple_of(2) {
                    let to = choices.below(bytes.len() + 1);
                    bytes.splice(to..to, taken);
                }
            }
            _ if choices.byte().is_multiple_of(4) => bytes.truncate(at),
            _ => bytes[at] = choices.byte(),
        }
    }
}

/// Reads a changed file, or takes up a changed state; how many bytes it was.
pub fn open(input: &[u8]) -> usize {
    let mut choices = Choices::new(input);
    let (plan, state) = &STATES[choices.below(STATES.len())];
    if choices.byte().is_multiple_of(8) {
        read(state, &mut choices)
    } else {
        take_up(plan, state, &mut choices)
    }
}

fn read(state: &[u8], choices: &mut Choices<'_>) -> usize {
    let path: PathBuf = FOLDER.path().join("a.granule");
    file::write(&path, LAYOUT, |out| out.write_all(state)).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut changed = whole.clone();
    change(&mut changed, choices);
    fs::write(&path, &changed).unwrap();
    match file::read(&path, LAYOUT) {
        Ok(content) => assert!(changed == whole && content == state, "a changed file was taken for whole"),
        Err(error) => assert!(changed != whole && !error.to_string().is_empty()),
    }
    whole.len() + changed.len()
}

fn take_up(plan: &Arc<Plan>, state: &[u8], choices: &mut Choices<'_>) -> usize {
    let mut changed = state.to_vec();
    change(&mut changed, choices);
    if let Ok(state) = postcard::from_bytes::<DriverState<'_>>(&changed)
        && let Ok(mut driver) = restore(plan.clone(), Some(1), state)
    {
        let until = driver.step().saturating_add(3).min(plan.driver.steps);
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let watch = scope.spawn(|| {
                std::thread::park_timeout(LONGEST);
                stop.store(true, Ordering::Relaxed);
            });
            let _ = driver.advance(until, &stop);
            watch.thread().unpark();
        });
    }
    state.len() + changed.len()
}
