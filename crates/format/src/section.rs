//! Typed, bounds-checked, zero-copy reading of one section.
//!
//! A section is a sequence of little-endian numbers and arrays. Every array starts at a multiple
//! of 16 bytes from the section's start, so it can be viewed in place.

// The only place of this crate that needs `unsafe`: typed views of bytes.
#![allow(unsafe_code)]

use super::{ModelError, Tag};

#[cfg(target_endian = "big")]
compile_error!("model blobs are read in place and are little-endian");

/// Arrays start at multiples of this many bytes from the section's start.
pub(crate) const ARRAY_ALIGN: usize = 16;

/// Numbers that may be viewed in place: no padding, every bit pattern valid.
trait Plain: Copy {}
impl Plain for u8 {}
impl Plain for i8 {}
impl Plain for u16 {}
impl Plain for i16 {}
impl Plain for i32 {}
impl Plain for u32 {}
impl Plain for f32 {}

/// Largest magnitude of a float in a model. Those of trained models are below 1,000; products of
/// a few of the largest ones are still finite, so that forged models give finite results.
pub const LARGEST: f32 = 1e6;

/// Whether a float may be in a model; not if it is no number.
fn is_in_range(value: f32) -> bool {
    value.abs() <= LARGEST
}

/// A reader over one section; each call reads on from where the last one ended.
#[derive(Clone, Debug)]
pub struct Section<'m> {
    tag: Tag,
    bytes: &'m [u8],
    at: usize,
}

impl<'m> Section<'m> {
    pub(super) fn new(tag: Tag, bytes: &'m [u8]) -> Self {
        Section { tag, bytes, at: 0 }
    }

    /// An error of this section.
    pub fn error(&self, why: &'static str) -> ModelError {
        ModelError::Section { tag: self.tag, why }
    }

    /// `Ok` if `holds`, else an error of this section.
    ///
    /// # Errors
    /// [`ModelError::Section`] with `why`.
    pub fn require(&self, holds: bool, why: &'static str) -> Result<(), ModelError> {
        if holds { Ok(()) } else { Err(self.error(why)) }
    }

    /// The next `u32`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn u32(&mut self) -> Result<u32, ModelError> {
        // The writer pads arrays of bytes to the next scalar.
        let start = self.at.next_multiple_of(4);
        let chunk = self.bytes.get(start..).and_then(|rest| rest.first_chunk());
        let chunk = chunk.ok_or(self.error("it ends too early"))?;
        self.at = start + 4;
        Ok(u32::from_le_bytes(*chunk))
    }

    /// The next `u32`, which must lie in `min..=max`.
    ///
    /// # Errors
    /// Also when out of range, with `why`.
    pub fn count(
        &mut self,
        min: usize,
        max: usize,
        why: &'static str,
    ) -> Result<usize, ModelError> {
        let value = self.u32()? as usize;
        self.require((min..=max).contains(&value), why)?;
        Ok(value)
    }

    /// The next `f32`, not beyond ±[`LARGEST`].
    ///
    /// # Errors
    /// Also when it is beyond, or not a number.
    pub fn f32(&mut self) -> Result<f32, ModelError> {
        let value = f32::from_bits(self.u32()?);
        self.require(is_in_range(value), "a number is out of range")?;
        Ok(value)
    }

    /// The next `len` values of `f32`, none beyond ±[`LARGEST`].
    ///
    /// # Errors
    /// Also when one is beyond, or not a number.
    pub fn f32s(&mut self, len: usize) -> Result<&'m [f32], ModelError> {
        let values: &[f32] = self.array(len)?;
        self.require(
            values.iter().copied().all(is_in_range),
            "a number is out of range",
        )?;
        Ok(values)
    }

    /// The next `len` values of `i8`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn i8s(&mut self, len: usize) -> Result<&'m [i8], ModelError> {
        self.array(len)
    }

    /// The next `len` values of `u8`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn u8s(&mut self, len: usize) -> Result<&'m [u8], ModelError> {
        self.array(len)
    }

    /// The next `len` values of `u16`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    #[inline(never)] // a section has several, and programs are to be small
    pub fn u16s(&mut self, len: usize) -> Result<&'m [u16], ModelError> {
        self.array(len)
    }

    /// The next `len` values of `i16`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn i16s(&mut self, len: usize) -> Result<&'m [i16], ModelError> {
        self.array(len)
    }

    /// The next `len` values of `i32`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn i32s(&mut self, len: usize) -> Result<&'m [i32], ModelError> {
        self.array(len)
    }

    /// The next `len` values of `u32`.
    ///
    /// # Errors
    /// [`ModelError::Section`] at the end, as for all readers here.
    pub fn u32s(&mut self, len: usize) -> Result<&'m [u32], ModelError> {
        self.array(len)
    }

    fn array<T: Plain>(&mut self, len: usize) -> Result<&'m [T], ModelError> {
        let early = self.error("it ends too early");
        let start = self.at.next_multiple_of(ARRAY_ALIGN);
        let size = len.checked_mul(size_of::<T>()).ok_or(early)?;
        let end = start.checked_add(size).ok_or(early)?;
        let bytes = self.bytes.get(start..end).ok_or(early)?;
        // SAFETY: `Plain` types have no padding and no invalid bit patterns; `align_to` itself
        // keeps the middle aligned, and a short middle is rejected below.
        let (head, values, tail) = unsafe { bytes.align_to::<T>() };
        self.require(
            head.is_empty() && tail.is_empty() && values.len() == len,
            "it is misaligned",
        )?;
        self.at = end;
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aligned;

    #[test]
    fn arrays_are_aligned_and_bounded() {
        let mut b = Aligned([0u8; 32]);
        b.0[0] = 3;
        b.0[16..20].copy_from_slice(&1.5f32.to_le_bytes());
        b.0[20..24].copy_from_slice(&f32::NAN.to_le_bytes());
        let mut s = Section::new(*b"TEST", &b.0);
        assert_eq!(s.count(1, 3, "count").unwrap(), 3);
        let mut t = s.clone();
        assert_eq!(t.f32s(1).unwrap(), &[1.5]);
        assert!(s.clone().f32s(2).is_err(), "NaN");
        for (value, accepted) in [(LARGEST, true), (-LARGEST, true), (1.1 * LARGEST, false)] {
            let bytes = Aligned(value.to_le_bytes());
            let mut s = Section::new(*b"TEST", &bytes.0);
            assert_eq!(s.clone().f32().is_ok(), accepted, "{value}");
            assert_eq!(s.f32s(1).is_ok(), accepted, "{value}");
        }
        assert!(s.clone().f32s(usize::MAX).is_err());
        assert!(s.clone().u8s(17).is_err());
        assert_eq!(s.i16s(8).unwrap().len(), 8);
        assert!(s.u32().is_err());
    }
}
