//! The learned part of a local feature: a small dense layer with `i8` weights.

use super::VALUES;
use crate::model::{ModelError, Section};

/// Most features per landmark.
pub const MAX_FEATURES: usize = 48;

/// `features[j] = clamp(((Σᵢ weight[j][i]·value[i] + bias[j]) · gain[j]) >> 24)`, the same weights
/// at every landmark.
#[derive(Clone, Copy, Debug)]
pub struct Projection<'m> {
    features: usize,
    /// `features` rows of [`VALUES`].
    weight: &'m [i8],
    bias: &'m [i32],
    gain: &'m [i32],
}

impl<'m> Projection<'m> {
    /// Reads `features: u32, weight: i8[features·VALUES], bias: i32[features], gain: i32[features]`.
    ///
    /// # Errors
    /// When the section ends or the number of features is out of range.
    pub fn read(section: &mut Section<'m>) -> Result<Self, ModelError> {
        let features = section.count(1, MAX_FEATURES, "number of features")?;
        let weight = section.i8s(features * VALUES)?;
        let bias = section.i32s(features)?;
        let gain = section.i32s(features)?;
        // |Σ weight·value| < 72·128·255 < 2^22: such a bias cannot overflow the sum.
        section.require(
            bias.iter().all(|b| b.unsigned_abs() < 1 << 30),
            "a bias is too large",
        )?;
        Ok(Projection {
            features,
            weight,
            bias,
            gain,
        })
    }

    /// Features per landmark.
    pub fn features(&self) -> usize {
        self.features
    }

    /// Projects one descriptor into `out` (`features()` values of −127..=127).
    pub fn project(&self, values: &[u8; VALUES], out: &mut [i8]) {
        let rows = self
            .weight
            .chunks_exact(VALUES)
            .zip(self.bias)
            .zip(self.gain);
        for (((weight, bias), gain), out) in rows.zip(out) {
            let sum: i32 = weight
                .iter()
                .zip(values)
                .map(|(w, v)| *w as i32 * *v as i32)
                .sum();
            let scaled = ((sum + bias) as i64 * *gain as i64) >> 24;
            *out = scaled.clamp(-127, 127) as i8;
        }
    }
}
