//! Layers of a finished model, back in `f32`: a training goes on from them.
//!
//! The inverse of [`quantized_layer`](crate::quantized_layer). A section does not say what value a
//! unit of a map has, only how the units of two maps relate. A network of layers with ReLU computes
//! the same whatever those values are, so they are chosen.

use crate::quantized_layer::{INPUT_SCALE, Order};
use anyhow::Result;
use posewise_format::Section;

/// Value of a unit of a map whose unit is free: a map's largest value is then about that of a
/// standard normal variable.
const UNIT: f32 = 4.0 / 255.0;
const BLOCK: usize = 8;

/// A layer that computes in units of its maps.
pub struct UnitLayer {
    /// `[row][channel]`; none of a sum.
    pub weights: Vec<f32>,
    /// By channel; none of a sum.
    pub biases: Vec<f32>,
    /// Of a sum: units of the output in one of each input.
    pub shares: [f32; 2],
}

/// Reads a node of `rows` times `channels` weights. A sum has no rows, and its channels are its two
/// inputs.
pub fn read_layer(
    s: &mut Section<'_>,
    rows: usize,
    channels: usize,
    order: Order,
) -> Result<UnitLayer> {
    let mut header = [0u32; 10];
    for number in &mut header {
        *number = s.u32()?;
    }
    let [.., pre_shift, post_shift] = header;
    let padded = match order {
        Order::Plain => rows,
        Order::Interleaved => rows.next_multiple_of(2),
    };
    let weights = s.i8s(padded * channels)?;
    let biases = s.i32s(channels)?;
    let factor = (-(pre_shift as f32) - post_shift as f32).exp2();
    let units: Vec<f32> = s
        .i32s(channels)?
        .iter()
        .map(|m| *m as f32 * factor)
        .collect();
    if rows == 0 {
        // A sum is not shifted before it is multiplied; the input has no shares.
        let share = |k: usize| units.get(k).copied().unwrap_or(0.0);
        return Ok(UnitLayer {
            weights: vec![],
            biases: vec![],
            shares: [share(0), share(1)],
        });
    }
    let weight = |row: usize, c: usize| match order {
        Order::Plain => weights[row * channels + c],
        Order::Interleaved => {
            let pair = (c / BLOCK * (padded / 2) + row / 2) * BLOCK + c % BLOCK;
            weights[2 * pair + row % 2]
        }
    };
    let all = (0..rows * channels).map(|k| {
        let (row, c) = (k / channels, k % channels);
        f32::from(weight(row, c)) * units[c]
    });
    Ok(UnitLayer {
        weights: all.collect(),
        biases: biases
            .iter()
            .zip(&units)
            .map(|(b, u)| *b as f32 * u)
            .collect(),
        shares: [0.0; 2],
    })
}

/// The values of a unit of each map: of the input, and of maps that are free until a sum ties them.
pub struct Units(Vec<f32>);

impl Units {
    /// Of this number of maps; the first is the input.
    pub fn new(maps: usize) -> Units {
        let mut units = vec![UNIT; maps];
        units[0] = INPUT_SCALE;
        Units(units)
    }

    /// The value of a unit of a map.
    pub fn of(&self, map: usize) -> f32 {
        self.0[map]
    }

    /// Ties a map's unit to `share` units of another one.
    pub fn tie(&mut self, map: usize, share: f32, to: usize) {
        self.0[map] = share * self.0[to];
    }
}

impl UnitLayer {
    /// Weights and biases in values, given those of a unit of the input and, by channel, of the
    /// output.
    pub fn values(&self, input: f32, output: impl Fn(usize) -> f32) -> (Vec<f32>, Vec<f32>) {
        let channels = self.biases.len();
        let weight = |(k, w): (usize, &f32)| w * output(k % channels) / input;
        let weights = self.weights.iter().enumerate().map(weight).collect();
        let biases = self.biases.iter().enumerate();
        (weights, biases.map(|(c, b)| b * output(c)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantized_layer::{QuantizedLayer, write_header};
    use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

    #[test]
    fn a_layer_survives_the_way_to_a_section_and_back() {
        let (rows, channels) = (5, 16);
        let weights: Vec<f32> = (0..rows * channels)
            .map(|k| (k as f32 * 0.37).sin())
            .collect();
        let biases: Vec<f32> = (0..channels).map(|k| (k as f32 * 0.9).cos()).collect();
        let (input, to) = (0.02, vec![0.03; channels]);
        for order in [Order::Plain, Order::Interleaved] {
            let layer = QuantizedLayer::new(&weights, &biases, order, input, &to);
            let mut out = SectionWriter::new(*b"TEST");
            write_header(
                [1, 1, 1, 0, 0, 16, 0, 0, layer.pre_shift, layer.post_shift],
                &mut out,
            );
            layer.write(&mut out);
            let bytes = AlignedBytes::new(&blob(&[out]));
            let blob = Blob::open(&bytes).unwrap();
            let mut s = blob.section(b"TEST").unwrap();
            let read = read_layer(&mut s, rows, channels, order).unwrap();
            let (w, b) = read.values(input, |_| to[0]);
            let off = |a: &[f32], b: &[f32]| {
                a.iter()
                    .zip(b)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f32::max)
            };
            assert!(off(&w, &weights) < 0.01, "{}", off(&w, &weights));
            assert!(off(&b, &biases) < 0.01, "{}", off(&b, &biases));
        }
    }
}
