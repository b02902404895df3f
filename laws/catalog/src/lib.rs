//! The laws that granule ships: one line a law crate
