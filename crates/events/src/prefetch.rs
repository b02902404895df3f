//! Telling the processor which records will be needed soon.

/// Starts to load a record into the first-level cache. Does nothing on machines without the instruction, and beyond the end.
#[inline(always)]
pub fn prefetch<T>(records: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let record = records.as_ptr().wrapping_add(index);
        // SAFETY: prefetching never faults, whatever the address.
        #[expect(unsafe_code, reason = "the intrinsic takes a raw pointer")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(record.cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (records, index);
}
