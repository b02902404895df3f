//! Telling the processor which rows will be needed soon.

use granule_state::Row;

/// Starts to load a row into the first-level cache. Does nothing beyond the end of `rows` or on machines without the
/// instruction.
#[inline(always)]
pub(crate) fn prefetch(rows: &[Row], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(row) = rows.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: prefetching never faults, and the address is that of a live row.
        #[expect(unsafe_code, reason = "the intrinsic takes a raw pointer")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(row).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (rows, index);
}
