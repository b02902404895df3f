//! Instruction-set dispatch of stages.

use crate::{ContactChunk, Real, Stage};

/// Boxes a stage so that its loop is compiled for AVX2, too, and the widest instruction set of the machine is chosen at
/// run time. Both versions give the same bits, because nothing is fused or reordered.
///
/// The loop is only recompiled if `run` (and what it calls) is `#[inline(always)]`.
pub fn vectorised<T: Real, S: Stage<T> + 'static>(stage: S) -> Box<dyn Stage<T>> {
    Box::new(Vectorised(stage))
}

struct Vectorised<S>(S);

impl<T: Real, S: Stage<T>> Stage<T> for Vectorised<S> {
    fn run(&self, chunk: &mut ContactChunk<'_, T>) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the instruction set was detected on this machine.
            #[expect(
                unsafe_code,
                reason = "calling a function that was compiled for a detected instruction set"
            )]
            return unsafe { run_avx2(&self.0, chunk) };
        }
        self.0.run(chunk);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<T: Real, S: Stage<T>>(stage: &S, chunk: &mut ContactChunk<'_, T>) {
    stage.run(chunk);
}
