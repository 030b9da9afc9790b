//! The questions that every call asks of addresses and lengths, as functions of numbers alone.
//!
//! `Word` is `usize`. Tests compile this file for other widths too: for one byte they try every
//! block of memory, for 32 and 64 bits a solver proves the same (tests/shipping/gates.rs).

use super::Word;

/// Whether `need` bytes, aligned to `align`, fit in the `len` bytes at an address. `align` is a
/// power of two.
#[inline(always)]
pub(super) const fn holds(at: Word, len: Word, need: Word, align: Word) -> bool {
    is_aligned(at, align) && len >= need
}

/// Whether an address is a multiple of `align`, a power of two.
#[inline(always)]
pub(super) const fn is_aligned(at: Word, align: Word) -> bool {
    at & align.wrapping_sub(1) == 0
}

/// Whether one object may have so many bytes and be there: more than half of all addresses is none,
/// and one that ends behind the last address is none.
#[inline(always)]
pub(super) const fn can_be(at: Word, len: Word) -> bool {
    len <= Word::MAX / 2 && len <= Word::MAX - at
}

/// Whether two blocks of memory have a byte in common. What is beyond the last address counts as
/// if there were more addresses.
#[inline(always)]
pub(super) const fn share_a_byte(a: Word, a_len: Word, b: Word, b_len: Word) -> bool {
    let starts_within = if a >= b { a - b < b_len } else { b - a < a_len };
    a_len > 0 && b_len > 0 && starts_within
}

/// Bytes of the items that are written where there is room for `capacity`, of at most `most`.
#[inline(always)]
pub(super) const fn written(capacity: Word, most: Word, size: Word) -> Word {
    size * if capacity < most { capacity } else { most }
}
