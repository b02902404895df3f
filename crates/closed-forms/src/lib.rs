//! Closed forms of papers, for tests and figures to hold simulations against. Nothing that simulates computes with them.

pub mod kondic;
