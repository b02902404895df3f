//! What every fuzz target holds its inputs to: an end in time, and memory bounded by the length of the input.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fmt::Write as _;
use std::sync::{Mutex, Once};
use std::time::{Duration, Instant};

/// The system's allocator, which counts what each thread holds.
pub struct Counting;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

fn change(bytes: isize) {
    // A thread that ends has no counters any more.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + bytes);
        let _ = PEAK.try_with(|peak| peak.set(peak.get().max(held.get())));
    });
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        change(layout.size() as isize);
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        change(-(layout.size() as isize));
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Both are there while the content moves.
        change(size as isize);
        change(-(layout.size() as isize));
        // SAFETY: as above.
        unsafe { System.realloc(memory, layout, size) }
    }
}

/// An input that takes longer hangs. Planning of the largest scene that the targets allow takes a second or two on a busy
/// machine.
const LONGEST: Duration = Duration::from_secs(100);

/// What the targets do at the moment: name, begin, input.
static RUNNING: Mutex<Vec<(&str, Instant, Vec<u8>)>> = Mutex::new(Vec::new());
static WATCH: Once = Once::new();

/// Ends the program when an input hangs: nothing else could.
fn watch() {
    loop {
        std::thread::sleep(Duration::from_secs(1));
        let Ok(running) = RUNNING.lock() else { return };
        if let Some((name, _, input)) = running.iter().find(|(_, begin, _)| begin.elapsed() > LONGEST) {
            eprintln!("target {name} hangs on the input {}", hexadecimal(input));
            std::process::abort();
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Memory that a target may hold at a time \[bytes\].
pub struct Bound {
    /// For any input.
    pub constant: usize,
    /// For each byte of what is read.
    pub each: usize,
}

/// Feeds random inputs of up to `longest` bytes to a target: `quick` of them, or as many as `GRANULE_FUZZ_INPUTS` says. The
/// target answers how many bytes of text or data it made of the input.
pub fn fuzz(name: &'static str, quick: usize, longest: usize, bound: Bound, target: fn(&[u8]) -> usize) {
    WATCH.call_once(|| drop(std::thread::spawn(watch)));
    let inputs = std::env::var("GRANULE_FUZZ_INPUTS").ok().map(|text| {
        text.parse().unwrap_or_else(|_| panic!("GRANULE_FUZZ_INPUTS is no number of inputs: {text}"))
    });
    let begin = Instant::now();
    let (mut count, mut slowest, mut largest) = (0u64, Duration::ZERO, 0);
    let inputs = inputs.unwrap_or(quick);
    let counts = std::sync::Arc::new(Mutex::new((&mut count, &mut slowest, &mut largest)));
    let shared = std::panic::AssertUnwindSafe(&counts);
    bolero::check!().with_iterations(inputs).with_max_len(longest).for_each(move |input: &[u8]| {
        let begin = Instant::now();
        if let Ok(mut running) = RUNNING.lock() {
            running.retain(|(other, ..)| *other != name);
            running.push((name, begin, input.to_vec()));
        }
        let before = HELD.with(Cell::get);
        PEAK.with(|peak| peak.set(before));
        let read = target(input);
        let held = PEAK.with(Cell::get) - before;
        if let Ok(mut running) = RUNNING.lock() {
            running.retain(|(other, ..)| *other != name);
        }
        let allowed = bound.constant + bound.each * read;
        assert!(held <= allowed as isize, "{name} held {held} bytes for {read} bytes, more than {allowed}");
        if let Ok(mut counts) = shared.lock() {
            *counts.0 += 1;
            *counts.1 = (*counts.1).max(begin.elapsed());
            *counts.2 = (*counts.2).max(held);
        }
    });
    drop(counts);
    println!(
        "{name}: {count} inputs in {:.1} s; the slowest took {:.3} s, the largest held {:.1} KiB",
        begin.elapsed().as_secs_f64(),
        slowest.as_secs_f64(),
        largest as f64 / 1024.0
    );
}
