//! Records: what was learnt, as bytes that the caller keeps while the power is off.
//!
//! | bytes | content |
//! |---|---|
//! | 0..8 | which kind of record |
//! | 8..12 | version, as all numbers in little-endian order |
//! | 12..16 | CRC-32 of what follows |
//! | 16.. | words of the kind, to a size that is that of the version |

use core::fmt;
use posewise_format::crc32;

/// Bytes before the words of a kind.
pub const HEAD: usize = 16;

/// Why a record is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RecordError {
    /// It is none of this kind, or has a number that is out of range.
    Kind,
    /// It is longer or shorter than such a record.
    Size,
    /// Its version is one that this library does not read.
    Version,
    /// Its checksum does not match: it is damaged.
    Checksum,
    /// It was made with another 3D face than that of this model.
    Model,
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RecordError::Kind => "the bytes are no record of this kind",
            RecordError::Size => "the record is cut, or has bytes behind its end",
            RecordError::Version => "the record has a version that this library does not read",
            RecordError::Checksum => "the checksum of the record does not match: it is damaged",
            RecordError::Model => "the record was made with another 3D face than the model's",
        })
    }
}

impl core::error::Error for RecordError {}

/// A kind of record.
pub struct RecordKind {
    /// Its first bytes.
    pub name: [u8; 8],
    /// Its version.
    pub version: u32,
}

impl RecordKind {
    /// A record of `N` bytes of these words; what is left over is 0.
    pub fn to_bytes<const N: usize>(&self, words: impl Iterator<Item = u32>) -> [u8; N] {
        const { assert!(N > HEAD && N.is_multiple_of(4)) };
        let mut bytes = [0; N];
        let (head, rest) = bytes.split_at_mut(HEAD);
        for (to, word) in rest.chunks_exact_mut(4).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        let words = [self.version, crc32(rest)].map(u32::to_le_bytes);
        let fields = self.name.iter().chain(words.as_flattened());
        head.iter_mut()
            .zip(fields)
            .for_each(|(to, from)| *to = *from);
        bytes
    }

    /// The words of a record of `N` bytes.
    pub fn words<'r, const N: usize>(
        &self,
        bytes: &'r [u8],
    ) -> Result<impl Iterator<Item = u32> + 'r, RecordError> {
        let (head, rest) = bytes.split_at_checked(HEAD).ok_or(RecordError::Size)?;
        if !head.starts_with(&self.name) {
            return Err(RecordError::Kind);
        }
        let mut numbers = words(head).skip(2);
        if numbers.next() != Some(self.version) {
            return Err(RecordError::Version);
        }
        if bytes.len() != N {
            return Err(RecordError::Size);
        }
        if numbers.next() != Some(crc32(rest)) {
            return Err(RecordError::Checksum);
        }
        Ok(words(rest))
    }
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    let words = bytes.as_chunks::<4>().0.iter();
    words.map(|word| u32::from_le_bytes(*word))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: RecordKind = RecordKind {
        name: *b"PWTESTED",
        version: 3,
    };
    const SIZE: usize = 32;

    #[test]
    fn words_survive() {
        let bytes: [u8; SIZE] = KIND.to_bytes([1, u32::MAX, 3].into_iter());
        let read = KIND.words::<SIZE>(&bytes).unwrap();
        assert!(read.eq([1, u32::MAX, 3, 0]));
    }

    #[test]
    fn every_wrong_byte_and_length_has_its_error() {
        let error = |bytes: &[u8]| KIND.words::<SIZE>(bytes).map(drop).unwrap_err();
        let bytes: [u8; SIZE] = KIND.to_bytes([1, 2, 3].into_iter());
        for i in 0..SIZE {
            let mut wrong = bytes;
            wrong[i] ^= 0x40;
            let expected = match i {
                0..8 => RecordError::Kind,
                8..12 => RecordError::Version,
                _ => RecordError::Checksum,
            };
            assert_eq!(error(&wrong), expected, "byte {i}");
            assert_eq!(error(&bytes[..i]), RecordError::Size);
        }
        let mut longer = [0; SIZE + 1];
        longer[..SIZE].copy_from_slice(&bytes);
        assert_eq!(error(&longer), RecordError::Size);
    }
}
