//! Bulk physics of many bodies against what is known of it; docs/bulk.md tells what comes out.
//!
//! These are runs of minutes on four cores: `cargo xtask test --all bulk`.

mod chute;
mod jamming;
mod janssen;
mod support;
