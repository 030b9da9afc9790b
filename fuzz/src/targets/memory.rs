//! A caller's memory: exactly as long as stated, or between guards.

use std::alloc::{Layout, alloc, dealloc};

/// A heap block of exact length: a sanitizer detects every access beyond either end.
pub struct Exact {
    start: *mut u8,
    layout: Layout,
}

// SAFETY: the pointer is owned, and only `&mut` writes to what it points to.
unsafe impl Send for Exact {}
// SAFETY: as above.
unsafe impl Sync for Exact {}

impl Exact {
    /// `len` bytes, at least 1, of `fill`.
    pub fn new(len: usize, align: usize, fill: u8) -> Self {
        let layout = Layout::from_size_align(len, align).expect("a size that fits");
        assert!(len > 0);
        // SAFETY: the layout is not empty; the block is written before it is read.
        unsafe {
            let start = alloc(layout);
            assert!(!start.is_null(), "out of memory");
            start.write_bytes(fill, len);
            Exact { start, layout }
        }
    }

    /// A copy of `content`, which is not empty.
    pub fn of(content: &[u8], align: usize) -> Self {
        let mut exact = Exact::new(content.len(), align, 0);
        exact.get_mut().copy_from_slice(content);
        exact
    }

    pub fn ptr(&self) -> *mut u8 {
        self.start
    }

    pub fn get(&self) -> &[u8] {
        // SAFETY: allocated and filled by `new`.
        unsafe { std::slice::from_raw_parts(self.start, self.layout.size()) }
    }

    pub fn get_mut(&mut self) -> &mut [u8] {
        // SAFETY: as above, and borrowed for writing.
        unsafe { std::slice::from_raw_parts_mut(self.start, self.layout.size()) }
    }
}

impl Drop for Exact {
    fn drop(&mut self) {
        // SAFETY: allocated by `new` with this layout.
        unsafe { dealloc(self.start, self.layout) }
    }
}

const GUARD: usize = 256;
const GUARD_BYTE: u8 = 0x5C;

/// Memory aligned to 64 bytes, between guards that must stay unchanged.
pub struct Guarded(Exact);

impl Guarded {
    pub fn new(len: usize, fill: u8) -> Self {
        let mut exact = Exact::new(len + 2 * GUARD, 64, GUARD_BYTE);
        exact.get_mut()[GUARD..GUARD + len].fill(fill);
        Guarded(exact)
    }

    pub fn len(&self) -> usize {
        self.0.layout.size() - 2 * GUARD
    }

    pub fn ptr(&self) -> *mut u8 {
        // SAFETY: the block is longer than a guard.
        unsafe { self.0.ptr().add(GUARD) }
    }

    pub fn get(&self) -> &[u8] {
        &self.0.get()[GUARD..GUARD + self.len()]
    }

    pub fn get_mut(&mut self) -> &mut [u8] {
        let len = self.len();
        &mut self.0.get_mut()[GUARD..GUARD + len]
    }

    /// Panics when a guard was written to.
    pub fn check(&self) {
        let (before, rest) = self.0.get().split_at(GUARD);
        let after = &rest[self.len()..];
        let whole = |guard: &[u8]| guard.iter().all(|b| *b == GUARD_BYTE);
        assert!(whole(before) && whole(after), "a guard was overwritten");
    }
}
