//! Instruction-set dispatch of the force loop.
//!
//! The loop is compiled twice: for the baseline instruction set and for AVX2. Both give the same bits, because no
//! operation is fused or reordered.

use granule_state::Row;

use crate::gather::{Arena, Arithmetic};
use crate::space::Space;
use crate::tile::{Evaluation, Tile};

/// Evaluates a tile with the widest instruction set of this machine.
pub(crate) fn evaluate<S: Space, T: Arithmetic>(
    tile: &mut Tile,
    arena: &Arena<T>,
    at: &Evaluation<'_>,
    force: &mut [Row],
    torque: &mut [Row],
) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the instruction set was detected on this machine.
        #[expect(
            unsafe_code,
            reason = "calling a function that was compiled for a detected instruction set"
        )]
        return unsafe { evaluate_avx2::<S, T>(tile, arena, at, force, torque) };
    }
    tile.evaluate_with::<S, T>(arena, at, force, torque);
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
    tile.evaluate_with::<S, T>(arena, at, force, torque);
}
