//! The `.posewise` model file: one read-only block of bytes, read in place.
//!
//! ```text
//! 0   magic "POSEWISE"
//! 8   u32 format version          12  u32 total length [bytes]
//! 16  u32 CRC-32 of bytes 64..    20  u32 number of sections (≤ MAX_SECTIONS)
//! 24  zeros up to 64
//! 64  table: per section  [u8; 4] tag, u32 offset, u32 length, u32 zero
//! …   sections, each at a multiple of 64 bytes
//! ```
//! All numbers are little-endian; floats are finite, and not beyond ±[`LARGEST`]. [`Blob::open`]
//! checks the header, the checksum and the table. [`Section`] then returns bounds-checked typed
//! slices of one section; what a section contains is defined by the code that opens it. Sections
//! that a reader does not know are skipped.
//!
//! The reader needs no heap. The feature `alloc` adds `AlignedBytes`, a heap buffer with the
//! alignment that [`Blob::open`] requires. The feature `write` adds the writer.
#![no_std]
#![deny(missing_docs)]
#![deny(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod aligned;
mod blob;
mod info;
mod section;
#[cfg(feature = "write")]
mod write;

pub use aligned::Aligned;
#[cfg(feature = "alloc")]
pub use aligned::AlignedBytes;
pub use blob::{ALIGN, Blob, FORMAT_VERSION, HEADER_LEN, MAGIC, MAX_SECTIONS, crc32};
pub use info::{ModelInfo, ModelTerms, SHEET_FREE, SHEET_RESEARCH, SHEET_TAG, SHEET_TITLE};
pub use section::{LARGEST, Section};
#[cfg(feature = "write")]
pub use write::{SectionWriter, Value, blob, reseal, without};

/// The name of a section: four ASCII characters.
pub type Tag = [u8; 4];

/// Why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ModelError {
    /// The bytes do not start at a multiple of [`ALIGN`].
    Misaligned,
    /// Shorter than the header or than the length that the header states.
    Truncated,
    /// Not a `.posewise` file.
    Magic,
    /// Written for another version of the format.
    Version {
        /// The version that the file states.
        found: u32,
    },
    /// The checksum does not match: bytes were changed.
    Checksum,
    /// The section table points out of the file, overlaps the header, or is too long.
    Table,
    /// A section that this build needs is not there.
    Missing(Tag),
    /// A section's content breaks a rule of the module that reads it.
    Section {
        /// Which section.
        tag: Tag,
        /// What is wrong.
        why: &'static str,
    },
}

impl ModelError {
    /// The section that is missing or wrong.
    pub fn section(&self) -> Option<Tag> {
        match *self {
            ModelError::Missing(tag) | ModelError::Section { tag, .. } => Some(tag),
            _ => None,
        }
    }

    /// What was found wrong, without the section and in a few words.
    pub fn check(&self) -> &'static str {
        match self {
            ModelError::Misaligned => "not 64-byte aligned",
            ModelError::Truncated => "truncated",
            ModelError::Magic => "not a .posewise model",
            ModelError::Version { .. } => "another format version",
            ModelError::Checksum => "the checksum does not match",
            ModelError::Table => "the section table is corrupt",
            ModelError::Missing(_) => "the section is missing",
            ModelError::Section { why, .. } => why,
        }
    }
}

impl core::fmt::Display for ModelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ModelError::Misaligned => f.write_str("the model's bytes are not 64-byte aligned"),
            ModelError::Truncated => f.write_str("the model is truncated"),
            ModelError::Magic => f.write_str("not a .posewise model"),
            ModelError::Version { found } => {
                write!(
                    f,
                    "model format version {found}, this build reads {FORMAT_VERSION}"
                )
            }
            ModelError::Checksum => {
                f.write_str("the model's checksum does not match: it is corrupt")
            }
            ModelError::Table => f.write_str("the model's section table is corrupt"),
            ModelError::Missing(tag) => {
                write!(f, "the model has no section {}", tag.escape_ascii())
            }
            ModelError::Section { tag, why } => {
                write!(
                    f,
                    "the model's section {} is wrong: {why}",
                    tag.escape_ascii()
                )
            }
        }
    }
}

impl core::error::Error for ModelError {}
