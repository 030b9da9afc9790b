//! What was learnt of a person's head, as bytes that the caller keeps while the power is off.
//!
//! | bytes | content |
//! |---|---|
//! | 16..20 | which 3D face: `FaceModel::checksum` |
//! | 20..24 | 0 |
//! | 24..152 | the weights of the identity modes \[standard deviations of all people\], `f32` |
//! | 152..280 | one over the variance of each, beyond that of all people, `f32` |
//! | 280..288 | 0 |
//!
//! Before these are the 16 bytes of every record (`crate::record`). It is a guess for a person who
//! is seen later: what is observed of that person replaces it.

use super::{FaceModel, Identity, MAX_IDENTITIES};
use crate::record::{RecordError, RecordKind};

/// Largest identity weight \[standard deviations\].
pub(super) const MAX_WEIGHT: f32 = 3.0;

/// Largest precision, beyond that of all people.
pub(super) const MAX_PRECISION: f32 = 1e4;

/// Bytes of a record.
pub const IDENTITY_RECORD_BYTES: usize = 288;

const KIND: RecordKind = RecordKind {
    name: *b"PWPERSON",
    version: 1,
};

/// What a record says of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guess {
    /// Weights of the identity modes.
    pub(crate) mean: Identity,
    /// One over the variance of each, less 1: what is known beyond what is known of anybody.
    pub(crate) precision: Identity,
}

impl Guess {
    /// Anybody.
    pub(crate) const NONE: Guess = Guess {
        mean: [0.0; MAX_IDENTITIES],
        precision: [0.0; MAX_IDENTITIES],
    };

    /// As bytes.
    pub(crate) fn to_bytes(self, face: &FaceModel<'_>) -> [u8; IDENTITY_RECORD_BYTES] {
        let numbers = self.mean.into_iter().chain(self.precision);
        let head = [face.checksum(), 0];
        KIND.to_bytes(head.into_iter().chain(numbers.map(f32::to_bits)))
    }

    /// Of bytes, for a model with this 3D face.
    pub(crate) fn from_bytes(bytes: &[u8], face: &FaceModel<'_>) -> Result<Guess, RecordError> {
        let mut words = KIND.words::<IDENTITY_RECORD_BYTES>(bytes)?;
        let [of_face, reserved] = [words.next(), words.next()];
        if of_face != Some(face.checksum()) {
            return Err(RecordError::Model);
        }
        let mut guess = Guess::NONE;
        let numbers = guess.mean.iter_mut().chain(&mut guess.precision);
        for (number, word) in numbers.zip(&mut words) {
            *number = f32::from_bits(word);
        }
        let is_valid = reserved == Some(0)
            && words.all(|word| word == 0)
            && guess.mean.iter().all(|w| w.abs() <= MAX_WEIGHT)
            && guess
                .precision
                .iter()
                .all(|p| (0.0..=MAX_PRECISION).contains(p));
        is_valid.then_some(guess).ok_or(RecordError::Kind)
    }
}

/// Whether a head has the shape of that of a record. It is no identification: two people may have
/// heads of one shape, as far as landmarks show it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Likeness {
    /// Too little was seen, or it fits both.
    #[default]
    Unknown,
    /// The same shape.
    Same,
    /// Another one.
    Other,
}

impl Likeness {
    /// All of them, in the order of their numbers in the C ABI.
    pub const ALL: [Likeness; 3] = [Likeness::Unknown, Likeness::Same, Likeness::Other];

    /// Its word in all interfaces.
    pub const fn name(self) -> &'static str {
        match self {
            Likeness::Unknown => "unknown",
            Likeness::Same => "same",
            Likeness::Other => "other",
        }
    }
}
