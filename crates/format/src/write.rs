//! Writes model files.

use crate::blob::ENTRY_LEN;
use crate::section::ARRAY_ALIGN;
use crate::{ALIGN, AlignedBytes, Blob, FORMAT_VERSION, HEADER_LEN, MAGIC, ModelError, Tag, crc32};
use alloc::vec::Vec;

/// Numbers that a section may hold.
pub trait Value: Copy {
    /// Appends the little-endian bytes.
    fn put(self, out: &mut Vec<u8>);
}

macro_rules! value {
    ($($t:ty),*) => {$(impl Value for $t {
        fn put(self, out: &mut Vec<u8>) {
            out.extend_from_slice(&self.to_le_bytes());
        }
    })*};
}
value!(u8, i8, u16, i16, i32, u32, f32);

/// One section being written; [`Section`](crate::Section) reads it.
#[derive(Clone)]
pub struct SectionWriter {
    tag: Tag,
    bytes: Vec<u8>,
}

impl SectionWriter {
    /// An empty section.
    pub fn new(tag: Tag) -> Self {
        SectionWriter {
            tag,
            bytes: Vec::new(),
        }
    }

    /// A section of these bytes, as [`SectionWriter::bytes`] returned them.
    pub fn of_bytes(tag: Tag, bytes: Vec<u8>) -> Self {
        SectionWriter { tag, bytes }
    }

    /// The sections of a model file but those of these tags.
    pub fn all_but(tags: &[Tag], model: &Blob<'_>) -> Vec<Self> {
        let kept = model.sections().filter(|(tag, _)| !tags.contains(tag));
        kept.map(|(tag, content)| Self::of_bytes(tag, content.to_vec()))
            .collect()
    }

    /// What was written so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// A single `u32` or `f32`; read back with `Section::u32`, `count` or `f32`.
    ///
    /// # Panics
    /// When the value is not four bytes long.
    pub fn scalar(&mut self, value: impl Value) -> &mut Self {
        let before = self.bytes.len();
        value.put(&mut self.bytes);
        assert_eq!(self.bytes.len() - before, 4, "scalars are four bytes");
        self
    }

    /// An array; read back with `Section::f32s` and its siblings.
    pub fn array<T: Value>(&mut self, values: &[T]) -> &mut Self {
        self.bytes
            .resize(self.bytes.len().next_multiple_of(ARRAY_ALIGN), 0);
        values.iter().for_each(|v| v.put(&mut self.bytes));
        // A scalar may follow an odd number of bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self
    }
}

/// The model file of these sections.
pub fn blob(sections: &[SectionWriter]) -> Vec<u8> {
    let mut table = Vec::new();
    let mut content = Vec::new();
    let start = (HEADER_LEN + ENTRY_LEN * sections.len()).next_multiple_of(ALIGN);
    for section in sections {
        content.resize(content.len().next_multiple_of(ALIGN), 0);
        table.extend_from_slice(&section.tag);
        ((start + content.len()) as u32).put(&mut table);
        (section.bytes.len() as u32).put(&mut table);
        0u32.put(&mut table);
        content.extend_from_slice(&section.bytes);
    }
    table.resize(start - HEADER_LEN, 0);
    let mut out = Vec::from(MAGIC);
    FORMAT_VERSION.put(&mut out);
    ((start + content.len()) as u32).put(&mut out);
    0u32.put(&mut out); // the checksum, which `reseal` writes
    (sections.len() as u32).put(&mut out);
    out.resize(HEADER_LEN, 0);
    out.extend(table);
    out.extend(content);
    reseal(&mut out);
    out
}

/// Writes the checksum of a file whose bytes were changed; does nothing to a file that is shorter
/// than the header.
pub fn reseal(file: &mut [u8]) {
    let Some((header, body)) = file.split_at_mut_checked(HEADER_LEN) else {
        return;
    };
    let stated = u32::from_le_bytes([header[12], header[13], header[14], header[15]]) as usize;
    let covered = stated.saturating_sub(HEADER_LEN).min(body.len());
    header[16..20].copy_from_slice(&crc32(&body[..covered]).to_le_bytes());
}

/// A model file without the sections of these tags, for builds that do not read them.
///
/// # Errors
/// When `file` is not a valid model file.
pub fn without(file: &[u8], tags: &[Tag]) -> Result<Vec<u8>, ModelError> {
    let aligned = AlignedBytes::new(file);
    Ok(blob(&SectionWriter::all_but(tags, &Blob::open(&aligned)?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let mut a = SectionWriter::new(*b"AAAA");
        a.scalar(7u32).array(&[1i8, -2, 3]).scalar(0.5f32);
        let mut b = SectionWriter::new(*b"BBBB");
        b.array(&[1.5f32, 2.5]).array(&[-3i16]);
        let file = blob(&[a, b]);
        let aligned = AlignedBytes::new(&file);
        let opened = Blob::open(&aligned).unwrap();
        assert_eq!(opened.total_len(), file.len());
        let mut a = opened.section(b"AAAA").unwrap();
        assert_eq!(a.u32(), Ok(7));
        assert_eq!(a.i8s(3), Ok(&[1i8, -2, 3][..]));
        assert_eq!(a.f32(), Ok(0.5));
        let mut b = opened.section(b"BBBB").unwrap();
        assert_eq!(b.f32s(2), Ok(&[1.5f32, 2.5][..]));
        assert_eq!(b.i16s(1), Ok(&[-3i16][..]));

        let smaller = AlignedBytes::new(&without(&file, &[*b"AAAA"]).unwrap());
        let opened = Blob::open(&smaller).unwrap();
        assert_eq!(opened.sections().count(), 1);
        assert!(opened.section(b"BBBB").is_ok());
    }

    #[test]
    fn changed_files_are_rejected_until_they_are_resealed() {
        let mut section = SectionWriter::new(*b"AAAA");
        section.scalar(7u32);
        let mut file = AlignedBytes::new(&blob(&[section]));
        let last = file.len() - 1;
        file[last] = 1;
        assert_eq!(Blob::open(&file).unwrap_err(), ModelError::Checksum);
        reseal(&mut file);
        assert!(Blob::open(&file).is_ok());
        reseal(&mut [0; HEADER_LEN - 1]);
    }
}
