//! Instruction-set dispatch of the loops over a tile: once a tile.
//!
//! Each loop is compiled twice: for the baseline instruction set and for AVX2. Both give the same bits, because no
//! operation is fused or reordered.

use granule_state::{InstructionSet, Portable, Row};

use crate::level::{Arena, Arithmetic};
use crate::space::Space;
use crate::tile::{Evaluation, Incoming, Tile};

/// Evaluates a tile with the instruction set `set`.
pub(crate) fn evaluate<S: Space, T: Arithmetic>(
    set: InstructionSet,
    tile: &mut Tile,
    arena: &Arena<T>,
    at: &Evaluation<'_>,
    force: &mut [Row],
    torque: &mut [Row],
) {
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => {
            // SAFETY: `InstructionSet::detect` has found the instruction set on this machine.
            #[expect(
                unsafe_code,
                reason = "calling a function that was compiled for a detected instruction set"
            )]
            unsafe {
                evaluate_avx2::<S, T>(tile, arena, at, force, torque);
            }
        }
        InstructionSet::Baseline => tile.evaluate_with::<S, T, Portable>(arena, at, force, torque),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn evaluate_avx2<S: Space, T: Arithmetic>(
    tile: &mut Tile,
    arena: &Arena<T>,
    at: &Evaluation<'_>,
    force: &mut [Row],
    torque: &mut [Row],
) {
    tile.evaluate_with::<S, T, granule_state::Avx2>(arena, at, force, torque);
}

/// Adds what other tiles have computed for the bodies of one, with the instruction set `set`.
pub(crate) fn receive(
    set: InstructionSet,
    inbox: &[Incoming],
    tiles: &[Tile],
    force: &mut [Row],
    torque: &mut [Row],
) {
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => {
            // SAFETY: `InstructionSet::detect` has found the instruction set on this machine.
            #[expect(
                unsafe_code,
                reason = "calling a function that was compiled for a detected instruction set"
            )]
            unsafe {
                receive_avx2(inbox, tiles, force, torque);
            }
        }
        InstructionSet::Baseline => Tile::receive::<Portable>(inbox, tiles, force, torque),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn receive_avx2(inbox: &[Incoming], tiles: &[Tile], force: &mut [Row], torque: &mut [Row]) {
    Tile::receive::<granule_state::Avx2>(inbox, tiles, force, torque);
}
