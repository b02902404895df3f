//! Hysteretic contact along the normal: plastic loss with a memory of the largest overlap (Walton and Braun 1986).

mod impact;
mod model;
mod stage;
mod walton_braun;

pub use walton_braun::WaltonBraun;

#[cfg(test)]
mod tests;
