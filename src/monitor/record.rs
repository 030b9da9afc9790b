//! What was learnt of a driver, as bytes that the caller keeps while the power is off.
//!
//! | bytes | content |
//! |---|---|
//! | 16..20 | sum of what is known; 1: open eye, 2: natural pose, 4: gaze on the road, 8: place |
//! | 20..28 | openness of the open left and right eye, `f32` |
//! | 28..36 | yaw and pitch of the natural pose, from the configured road \[deg\], `f32` |
//! | 36..44 | yaw and pitch of the gaze on the road, likewise, `f32` |
//! | 44..56 | the driver's place, camera frame \[mm\], `f32` |
//! | 56..64 | 0 |
//!
//! Before these are the 16 bytes of every record (`crate::record`). It is a guess for the person
//! who drives next: what is observed of that person replaces it.

use crate::record::{RecordError, RecordKind};
use crate::shape::FARTHEST_MM;

/// Bytes of a record.
pub const MONITOR_RECORD_BYTES: usize = 64;

const KIND: RecordKind = RecordKind {
    name: *b"PWDRIVER",
    version: 1,
};
const EYES: u32 = 1;
const POSE: u32 = 2;
const GAZE: u32 = 4;
const PLACE: u32 = 8;
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
    /// Yaw and pitch of the gaze that is on the road \[deg\].
    pub(super) gaze_deg: Option<[f32; 2]>,
    /// The driver's place \[mm\].
    pub(super) place_mm: Option<[f32; 3]>,
}

impl Learnt {
    pub(super) fn to_bytes(self) -> [u8; MONITOR_RECORD_BYTES] {
        let flag = |is_known: bool, flag: u32| if is_known { flag } else { 0 };
        let flags = flag(self.open_eye.is_some(), EYES)
            | flag(self.natural_deg.is_some(), POSE)
            | flag(self.gaze_deg.is_some(), GAZE)
            | flag(self.place_mm.is_some(), PLACE);
        let [left, right] = self.open_eye.unwrap_or_default();
        let [yaw, pitch] = self.natural_deg.unwrap_or_default();
        let [gaze_yaw, gaze_pitch] = self.gaze_deg.unwrap_or_default();
        let angles = [yaw, pitch, gaze_yaw, gaze_pitch];
        let place_mm = self.place_mm.unwrap_or_default();
        let numbers = [left, right].into_iter().chain(angles).chain(place_mm);
        let numbers = numbers.map(f32::to_bits);
        KIND.to_bytes([flags].into_iter().chain(numbers))
    }

    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Learnt, RecordError> {
        let mut words = KIND.words::<MONITOR_RECORD_BYTES>(bytes)?;
        let mut next = || words.next().ok_or(RecordError::Kind);
        let flags = next()?;
        let mut two = || Some([f32::from_bits(next().ok()?), f32::from_bits(next().ok()?)]);
        let mut pair = || two().ok_or(RecordError::Kind);
        let (open_eye, natural_deg, gaze_deg) = (pair()?, pair()?, pair()?);
        let ([x, y], [z, _]) = (pair()?, pair()?);
        let mut angles = natural_deg.iter().chain(&gaze_deg);
        let is_valid = open_eye.iter().all(|open| OPENNESS.contains(open))
            && angles.all(|angle| angle.abs() <= MOST_DEG)
            && [x, y, z].iter().all(|v| v.abs() <= FARTHEST_MM)
            && flags & !(EYES | POSE | GAZE | PLACE) == 0;
        let known = |flag: u32, pair: [f32; 2]| (flags & flag != 0).then_some(pair);
        match is_valid {
            true => Ok(Learnt {
                open_eye: known(EYES, open_eye),
                natural_deg: known(POSE, natural_deg),
                gaze_deg: known(GAZE, gaze_deg),
                place_mm: (flags & PLACE != 0).then_some([x, y, z]),
            }),
            false => Err(RecordError::Kind),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Learnt = Learnt {
        open_eye: Some([0.8, 0.75]),
        natural_deg: Some([-12.0, 7.5]),
        gaze_deg: Some([-9.0, 4.5]),
        place_mm: Some([50.0, -20.0, 700.0]),
    };

    #[test]
    fn what_was_learnt_survives() {
        let nothing = Learnt {
            open_eye: None,
            natural_deg: None,
            gaze_deg: None,
            place_mm: None,
        };
        for learnt in [ALL, nothing] {
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
                gaze_deg: Some([0.0, yaw]),
                place_mm: Some([0.0, 0.0, 700.0]),
            };
            let read = Learnt::from_bytes(&learnt.to_bytes());
            assert_eq!(read, Err(RecordError::Kind), "{open} {yaw}");
        }
    }
}
