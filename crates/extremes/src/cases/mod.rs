//! All cases, one file a kind.

mod hard;
mod impact;
mod lasting;
mod many;
mod place;
mod refused;
mod rest;
mod scale;
mod spin;

use crate::Case;

pub use many::{crowd, swarm};

/// Every extreme, in the order in which it is told: by the files of this folder.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    [
        impact::CASES,
        scale::CASES,
        place::CASES,
        spin::CASES,
        rest::CASES,
        lasting::CASES,
        many::CASES,
        hard::CASES,
        refused::CASES,
    ]
    .into_iter()
    .flatten()
}
