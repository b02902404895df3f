//! Conformance kit.

pub mod reference;
