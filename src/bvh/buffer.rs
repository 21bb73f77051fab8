//! Arrays for nodes and leaf blocks: aligned to cache lines, on huge pages where they are large.
//!
//! A bounce ray pays for memory latency, not for arithmetic: with 2 MiB pages a miss of a large
//! tree costs no page walk (see the section "Rays" of `docs/performance.md`).

use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;

const CACHE_LINE: usize = 64;
const HUGE_PAGE: usize = 2 << 20;

/// A fixed-length array of plain data that starts out as zero bytes.
pub(super) struct Buffer<T: bytemuck::Zeroable + Copy> {
    data: NonNull<T>,
    len: usize,
}

// SAFETY: the buffer owns its memory and hands it out by the rules of `&` and `&mut` only.
unsafe impl<T: bytemuck::Zeroable + Copy + Send> Send for Buffer<T> {}
// SAFETY: as above.
unsafe impl<T: bytemuck::Zeroable + Copy + Sync> Sync for Buffer<T> {}

impl<T: bytemuck::Zeroable + Copy> Buffer<T> {
    /// `len` zeroed elements.
    pub fn zeroed(len: usize) -> Self {
        let Some(layout) = Self::layout(len) else {
            return Self { data: NonNull::dangling(), len: 0 };
        };
        // SAFETY: the layout is not of size 0.
        let memory = unsafe { alloc(layout) };
        let Some(data) = NonNull::new(memory.cast::<T>()) else { handle_alloc_error(layout) };
        if layout.align() == HUGE_PAGE {
            advise_huge_pages(memory, layout.size());
        }
        // The first touch, hence after the advice.
        // SAFETY: `layout.size()` bytes are ours, and zero bytes are a valid `T`.
        unsafe { memory.write_bytes(0, layout.size()) };
        Self { data, len }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        Self::layout(self.len).map_or(0, |layout| layout.size())
    }

    /// Large arrays start on a huge page and fill it to its end; `None` for an empty array.
    fn layout(len: usize) -> Option<Layout> {
        let size = len.checked_mul(size_of::<T>()).expect("the acceleration structure exceeds the address space");
        // Up to one eighth of the memory may go into filling the last huge page.
        let align = if size >= 8 * HUGE_PAGE { HUGE_PAGE } else { CACHE_LINE.max(align_of::<T>()) };
        let layout = Layout::from_size_align(size, align).expect("an array within the address space").pad_to_align();
        (size > 0).then_some(layout)
    }
}

/// Asks for huge pages before the memory is first touched. A refusal costs speed, nothing else.
fn advise_huge_pages(memory: *mut u8, size: usize) {
    #[cfg(all(target_os = "linux", not(miri)))]
    {
        unsafe extern "C" {
            fn madvise(address: *mut std::ffi::c_void, length: usize, advice: i32) -> i32;
        }
        const MADV_HUGEPAGE: i32 = 14;
        // SAFETY: the range is ours and the advice changes no content.
        unsafe { madvise(memory.cast(), size, MADV_HUGEPAGE) };
    }
    #[cfg(not(all(target_os = "linux", not(miri))))]
    let _ = (memory, size);
}

impl<T: bytemuck::Zeroable + Copy> Drop for Buffer<T> {
    fn drop(&mut self) {
        if let Some(layout) = Self::layout(self.len) {
            // SAFETY: allocated in `zeroed` with the same layout.
            unsafe { dealloc(self.data.as_ptr().cast(), layout) };
        }
    }
}

impl<T: bytemuck::Zeroable + Copy> Deref for Buffer<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        // SAFETY: `len` initialized elements, or none behind a dangling pointer.
        unsafe { std::slice::from_raw_parts(self.data.as_ptr(), self.len) }
    }
}

impl<T: bytemuck::Zeroable + Copy> DerefMut for Buffer<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as above, and borrowed exclusively.
        unsafe { std::slice::from_raw_parts_mut(self.data.as_ptr(), self.len) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_zeroed_aligned_and_may_be_empty() {
        assert!(Buffer::<u32>::zeroed(0).is_empty());
        let mut small = Buffer::<u32>::zeroed(3);
        assert_eq!(&small[..], &[0, 0, 0]);
        small[2] = 7;
        assert_eq!(small[2], 7);
        assert_eq!(small.as_ptr() as usize % CACHE_LINE, 0);
        let large = Buffer::<u64>::zeroed(8 * HUGE_PAGE / 8 + 1);
        assert_eq!(large.as_ptr() as usize % HUGE_PAGE, 0);
        assert_eq!(large.bytes(), 9 * HUGE_PAGE);
        assert!(large.iter().all(|&v| v == 0));
    }
}
