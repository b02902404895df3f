//! Telling the processor which rows will be needed soon.

use granule_state::Row;

/// Starts to load a row into the first-level cache. Does nothing on machines without the instruction, and beyond the end of
/// `rows`.
#[inline(always)]
pub(crate) fn prefetch(rows: &[Row], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let row = rows.as_ptr().wrapping_add(index);
        // SAFETY: prefetching never faults, whatever the address.
        #[expect(unsafe_code, reason = "the intrinsic takes a raw pointer")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(row.cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (rows, index);
}
