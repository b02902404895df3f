//! Nothing allocates in a step once the lists have their size.
#![expect(unsafe_code, reason = "a global allocator is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use granule_engine::Engine;
use granule_tests::plan;

/// The system's allocator, which counts while it is asked to.
struct Counting;

static COUNTS: AtomicBool = AtomicBool::new(false);
static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

fn count() {
    if COUNTS.load(Ordering::Relaxed) {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A heap on a floor, in motion, with friction, the energy ledger, and lists that are pruned now and then.
const HEAP: &str = r#"(version: 1, seed: 7, gravity: (0, 0, -9.81), materials: { "a": (density: 2500) },
    cell: (lo: (0, 0, 0), hi: ("8 mm", "8 mm", "40 mm"), periodic: (true, true, false)),
    bodies: [Lattice(material: "a", kind: Cubic, radius: "0.5 mm", spacing: "1 mm",
        lo: ("0.5 mm", "0.5 mm", "0.5 mm"), hi: ("7.5 mm", "7.5 mm", "9.5 mm"), velocity_spread: 0.15)],
    walls: { "floor": Plane(point: (0, 0, 0), normal: (0, 0, 1), material: "a") },
    contacts: [(between: ("a", "a"), normal: LinearSpringDashpot(stiffness: 1e3, restitution: 0.7),
        tangential: TangentialSpring(stiffness: 285, friction: 0.5, damping: 1e-3))],
    ledger: true, driver: TimeStep(step: "5 us"), run: (steps: 100000))"#;

/// Steps of the heap that do not rebuild the outer list, on some threads: how many prunings and allocations they held.
fn steps(text: &str, threads: usize) -> (u64, u64) {
    let mut engine = Engine::new(plan(text), threads).unwrap();
    engine.advance(1000, &mut |_| {}).unwrap();
    let (mut prunings, mut allocations) = (0, 0);
    for _ in 0..200 {
        let (rebuilds, prunes) = engine.list_updates();
        ALLOCATIONS.store(0, Ordering::Relaxed);
        COUNTS.store(true, Ordering::Relaxed);
        engine.advance(10, &mut |_| {}).unwrap();
        COUNTS.store(false, Ordering::Relaxed);
        let (rebuilds_after, prunes_after) = engine.list_updates();
        if rebuilds_after == rebuilds {
            prunings += prunes_after - prunes;
            allocations += ALLOCATIONS.load(Ordering::Relaxed);
        }
    }
    assert!(engine.tally().contacts > 100, "there are contacts");
    (prunings, allocations)
}

/// One test, because the counter sees every thread of the program.
#[test]
fn nothing_allocates_in_a_step() {
    let text = vec![1, 2, 3];
    COUNTS.store(true, Ordering::Relaxed);
    let copy = std::hint::black_box(text.clone());
    COUNTS.store(false, Ordering::Relaxed);
    assert_eq!((copy, ALLOCATIONS.load(Ordering::Relaxed)), (text, 1), "the counter counts");
    for integrator in ["VelocityVerlet", "ContactResolved"] {
        let heap = HEAP.replace("TimeStep(", &format!("TimeStep(integrator: {integrator}, "));
        let (prunings, allocations) = steps(&heap, 1);
        assert!(prunings > 3, "{integrator}: lists were pruned {prunings} times");
        assert_eq!(allocations, 0, "{integrator} on one thread");
    }
}
