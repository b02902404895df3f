//! The project's tasks, as functions: `cargo xtask` calls them, and so do the tests that hold the project to its own rules.
//!
//! No dependency but the standard library, because everybody builds this first. Physics runs in other programs, in release.

pub mod bench;
pub mod bench_event;
pub mod ci;
pub mod command;
pub mod directions;
pub mod figures;
pub mod files;
pub mod fuzz;
pub mod json;
pub mod members;
pub mod new_law;
pub mod pages;
pub mod test;
pub mod tidy;
pub mod validate;

/// Names of the tasks.
pub const TASKS: [&str; 11] =
    ["validate", "test", "bench", "figures", "atlas", "extremes", "fuzz", "new-law", "pages", "tidy", "ci"];
