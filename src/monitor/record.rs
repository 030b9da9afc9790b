//! What was learnt of a driver, as bytes that the caller keeps while the power is off.
//!
//! | bytes | content |
//! |---|---|
//! | 0..8 | `PWDRIVER` |
//! | 8..12 | version, as all numbers in little-endian order |
//! | 12..16 | CRC-32 of what follows |
//! | 16..20 | 1: the open eye is known, 2: the natural pose, 3: both |
//! | 20..28 | openness of the open left and right eye, `f32` |
//! | 28..36 | yaw and pitch of the natural pose, from the configured road \[deg\], `f32` |
//! | 36..64 | 0 |
//!
//! A record is a guess for the person who drives next: what is observed of that person replaces it.

use core::fmt;
use posewise_format::crc32;

/// Bytes of a record.
pub const MONITOR_RECORD_BYTES: usize = 64;

const KIND: [u8; 8] = *b"PWDRIVER";
const VERSION: u32 = 1;
const HEAD: usize = 16;
const EYES: u32 = 1;
const POSE: u32 = 2;
/// Range of an openness.
const OPENNESS: core::ops::RangeInclusive<f32> = 0.0..=1.0;
/// Largest angle of a natural pose \[deg\].
const MOST_DEG: f32 = 90.0;

/// Why a record is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RecordError {
    /// It is none, is cut or damaged.
    Damaged,
    /// Its version is one that this library does not read.
    Version,
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RecordError::Damaged => "the record is none, is cut or damaged",
            RecordError::Version => "the record has a version that this library does not read",
        })
    }
}

impl core::error::Error for RecordError {}

/// What was learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Learnt {
    /// Openness of the open left and right eye.
    pub(super) open_eye: Option<[f32; 2]>,
    /// Yaw and pitch of the natural pose \[deg\].
    pub(super) natural_deg: Option<[f32; 2]>,
}

impl Learnt {
    pub(super) fn to_bytes(self) -> [u8; MONITOR_RECORD_BYTES] {
        let flag = |is_known: bool, flag: u32| if is_known { flag } else { 0 };
        let flags = flag(self.open_eye.is_some(), EYES) | flag(self.natural_deg.is_some(), POSE);
        let [left, right] = self.open_eye.unwrap_or_default();
        let [yaw, pitch] = self.natural_deg.unwrap_or_default();
        let numbers = [left, right, yaw, pitch].map(f32::to_bits);
        let mut bytes = [0; MONITOR_RECORD_BYTES];
        let (head, rest) = bytes.split_at_mut(HEAD);
        let words = [flags].into_iter().chain(numbers);
        for (to, word) in rest.chunks_exact_mut(4).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        let check = crc32(rest);
        let words = [VERSION, check].map(u32::to_le_bytes);
        let fields = KIND.iter().chain(words.as_flattened());
        head.iter_mut()
            .zip(fields)
            .for_each(|(to, from)| *to = *from);
        bytes
    }

    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Learnt, RecordError> {
        let mut words = bytes.chunks_exact(4).map(|word| {
            let word = word.first_chunk::<4>().copied().unwrap_or_default();
            u32::from_le_bytes(word)
        });
        let mut next = || words.next().ok_or(RecordError::Damaged);
        if !bytes.starts_with(&KIND) {
            return Err(RecordError::Damaged);
        }
        let [_, _, version, check, flags] = [next()?, next()?, next()?, next()?, next()?];
        if version != VERSION {
            return Err(RecordError::Version);
        }
        let rest = bytes.get(HEAD..).unwrap_or_default();
        if bytes.len() != MONITOR_RECORD_BYTES || crc32(rest) != check {
            return Err(RecordError::Damaged);
        }
        let [left, right, yaw, pitch] = [next()?, next()?, next()?, next()?].map(f32::from_bits);
        let is_valid = [left, right].iter().all(|open| OPENNESS.contains(open))
            && [yaw, pitch].iter().all(|angle| angle.abs() <= MOST_DEG)
            && flags & !(EYES | POSE) == 0;
        match is_valid {
            true => Ok(Learnt {
                open_eye: (flags & EYES != 0).then_some([left, right]),
                natural_deg: (flags & POSE != 0).then_some([yaw, pitch]),
            }),
            false => Err(RecordError::Damaged),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: Learnt = Learnt {
        open_eye: Some([0.8, 0.75]),
        natural_deg: Some([-12.0, 7.5]),
    };

    #[test]
    fn what_was_learnt_survives() {
        let nothing = Learnt {
            open_eye: None,
            natural_deg: None,
        };
        for learnt in [BOTH, nothing] {
            assert_eq!(Learnt::from_bytes(&learnt.to_bytes()), Ok(learnt));
        }
    }

    #[test]
    fn every_wrong_byte_and_length_is_refused() {
        let bytes = BOTH.to_bytes();
        for i in 0..bytes.len() {
            let mut wrong = bytes;
            wrong[i] ^= 0x40;
            let error = Learnt::from_bytes(&wrong).unwrap_err();
            let is_version = (8..12).contains(&i);
            assert_eq!(error == RecordError::Version, is_version, "byte {i}");
            assert_eq!(Learnt::from_bytes(&bytes[..i]), Err(RecordError::Damaged));
        }
        let mut longer = [0; MONITOR_RECORD_BYTES + 4];
        longer[..bytes.len()].copy_from_slice(&bytes);
        assert_eq!(Learnt::from_bytes(&longer), Err(RecordError::Damaged));
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for (open, yaw) in [
            (f32::NAN, 0.0),
            (1.5, 0.0),
            (0.8, f32::INFINITY),
            (0.8, 91.0),
        ] {
            let learnt = Learnt {
                open_eye: Some([open, 0.8]),
                natural_deg: Some([yaw, 0.0]),
            };
            let read = Learnt::from_bytes(&learnt.to_bytes());
            assert_eq!(read, Err(RecordError::Damaged), "{open} {yaw}");
        }
    }
}
