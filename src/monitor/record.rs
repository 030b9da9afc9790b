//! What was learnt of a driver, as bytes that the caller keeps while the power is off.
//!
//! | bytes | content |
//! |---|---|
//! | 16..20 | 1: the open eye is known, 2: the natural pose, 3: both |
//! | 20..28 | openness of the open left and right eye, `f32` |
//! | 28..36 | yaw and pitch of the natural pose, from the configured road \[deg\], `f32` |
//! | 36..64 | 0 |
//!
//! Before these are the 16 bytes of every record (`crate::record`). It is a guess for the person
//! who drives next: what is observed of that person replaces it.

use crate::record::{RecordError, RecordKind};

/// Bytes of a record.
pub const MONITOR_RECORD_BYTES: usize = 64;

const KIND: RecordKind = RecordKind {
    name: *b"PWDRIVER",
    version: 1,
};
const EYES: u32 = 1;
const POSE: u32 = 2;
/// Range of an openness.
const OPENNESS: core::ops::RangeInclusive<f32> = 0.0..=1.0;
/// Largest angle of a natural pose \[deg\].
const MOST_DEG: f32 = 90.0;

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
        KIND.to_bytes([flags].into_iter().chain(numbers))
    }

    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Learnt, RecordError> {
        let mut words = KIND.words::<MONITOR_RECORD_BYTES>(bytes)?;
        let mut next = || words.next().ok_or(RecordError::Kind);
        let flags = next()?;
        let [left, right, yaw, pitch] = [next()?, next()?, next()?, next()?].map(f32::from_bits);
        let is_valid = [left, right].iter().all(|open| OPENNESS.contains(open))
            && [yaw, pitch].iter().all(|angle| angle.abs() <= MOST_DEG)
            && flags & !(EYES | POSE) == 0;
        match is_valid {
            true => Ok(Learnt {
                open_eye: (flags & EYES != 0).then_some([left, right]),
                natural_deg: (flags & POSE != 0).then_some([yaw, pitch]),
            }),
            false => Err(RecordError::Kind),
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
            assert_eq!(read, Err(RecordError::Kind), "{open} {yaw}");
        }
    }
}
