//! Contracts across crates
