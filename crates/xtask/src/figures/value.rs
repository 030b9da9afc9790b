//! Reads single figures out of the JSON, and formats them.

use anyhow::{Context, Result};
use serde_json::Value;

/// The CRC-32 in the header of a model, as `posewise model info` prints it.
pub fn checksum(model: &[u8]) -> Result<String> {
    let bytes = model.get(16..20).and_then(|bytes| bytes.first_chunk());
    let crc = u32::from_le_bytes(*bytes.context("the model has no header")?);
    Ok(format!("{crc:08x}"))
}

/// A figure of one model: a number, or nothing where there was none to measure.
#[derive(Clone, Copy)]
pub struct Figure(Option<f64>);

/// The figure at a JSON pointer, which must be there; `null` is nothing.
pub fn at(figures: &Value, pointer: &str) -> Result<Figure> {
    let value = figures
        .pointer(pointer)
        .with_context(|| format!("no figure {pointer}"))?;
    Ok(Figure(value.as_f64()))
}

impl Figure {
    /// With this number of decimals.
    pub fn fixed(self, decimals: usize) -> String {
        self.0
            .map_or("–".into(), |number| format!("{number:.decimals$}"))
    }

    /// A share as a percentage.
    pub fn percent(self, decimals: usize) -> String {
        Figure(self.0.map(|share| 100.0 * share)).fixed(decimals)
    }

    /// In millions or other multiples of a unit.
    pub fn over(self, unit: f64, decimals: usize) -> String {
        Figure(self.0.map(|number| number / unit)).fixed(decimals)
    }

    /// A whole number.
    pub fn count(self) -> String {
        self.fixed(0)
    }

    /// The quotient of two counts as a share.
    pub fn share_of(self, all: Figure) -> Figure {
        Figure(self.0.zip(all.0).map(|(part, all)| part / all))
    }
}
