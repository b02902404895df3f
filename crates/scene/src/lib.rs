//! The scene file: RON with spans, and diagnostics.
//!
//! [`parse`] reads a text into a [`Scene`] and reports all problems at once, each with its place. A scene is what the
//! user wrote: which laws exist, whether bodies overlap or a time step is stable is for the plan to say.

mod diagnostic;
mod edit;
mod manual;
mod read;
mod reader;
mod scene;
mod spec;
mod syntax;

pub use diagnostic::{Diagnostic, Severity, nearest, position, suggestion, tidy};
pub use edit::{remove_field, replace_all, set_field};
pub use manual::manual;
pub use read::{Parsed, parse};
pub use scene::*;
