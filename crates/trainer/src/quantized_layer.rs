//! A trained layer in the integers that the core computes with.

use posewise_format::SectionWriter;

/// The input map holds `INPUT_ZERO + v / INPUT_SCALE` for a standardised pixel value `v`.
pub const INPUT_SCALE: f32 = 1.0 / 32.0;
pub const INPUT_ZERO: u32 = 128;
/// Outputs whose weights are interleaved.
const BLOCK: usize = 8;

/// Writes a node's numbers as [`posewise::network::Network::read`] lists them, up to `post_shift`.
pub fn write_header(numbers: [u32; 10], out: &mut SectionWriter) {
    for number in numbers {
        out.scalar(number);
    }
}

/// Factors as integers of 15 bits, and the shift that undoes their scale.
pub fn fixed(values: &[f32]) -> (Vec<i32>, u32) {
    let largest = values.iter().fold(1e-12f32, |m, v| m.max(*v));
    let shift = (32_767.0 / largest).log2().floor().clamp(1.0, 30.0);
    let factor = |v: &f32| (v * shift.exp2()).round().min(32_767.0) as i32;
    (values.iter().map(factor).collect(), shift as u32)
}

/// How a layer's weights lie.
#[derive(Clone, Copy, PartialEq)]
pub enum Order {
    /// `[row][channel]`, as they are trained.
    Plain,
    /// `[output/8][pair of rows][8 outputs][2]`; an odd number of rows gets one of zeros.
    Interleaved,
}

/// A layer's numbers as the core has them.
pub struct QuantizedLayer {
    weights: Vec<i8>,
    bias: Vec<i32>,
    multiplier: Vec<i32>,
    pub pre_shift: u32,
    pub post_shift: u32,
}

impl QuantizedLayer {
    /// Of weights `[row][channel]` and biases by channel. `input` is the value of a unit of the
    /// layer's input, `to` that of its outputs by channel.
    pub fn new(weights: &[f32], biases: &[f32], order: Order, input: f32, to: &[f32]) -> Self {
        let channels = biases.len();
        let rows = weights.len() / channels;
        let unit = |c: usize| {
            let column = weights.iter().skip(c).step_by(channels);
            column.fold(1e-9f32, |m, w| m.max(w.abs())) / 127.0
        };
        let units: Vec<f32> = (0..channels).map(unit).collect();
        let rounded = |r: usize, c: usize| (weights[r * channels + c] / units[c]).round() as i8;
        let bias = |c: usize| (biases[c] / (units[c] * input)).round().clamp(-1e8, 1e8) as i32;
        let bias: Vec<i32> = (0..channels).map(bias).collect();
        let most = (0..channels).map(|c| {
            let sum: i64 = (0..rows)
                .map(|r| i64::from(rounded(r, c)).abs() * 255)
                .sum();
            sum + i64::from(bias[c].unsigned_abs())
        });
        // The largest sum that can occur is cut to 16 bits before it is multiplied.
        let pre_shift = (64 - most.max().unwrap_or(0).leading_zeros()).saturating_sub(15);
        let shares: Vec<f32> = units
            .iter()
            .zip(to)
            .map(|(unit, to)| unit * input / to * (pre_shift as f32).exp2())
            .collect();
        let (multiplier, post_shift) = fixed(&shares);
        let weights = match order {
            Order::Plain => (0..weights.len())
                .map(|k| rounded(k / channels, k % channels))
                .collect(),
            Order::Interleaved => interleaved(rows, channels, rounded),
        };
        QuantizedLayer {
            weights,
            bias,
            multiplier,
            pre_shift,
            post_shift,
        }
    }

    /// Writes the arrays that follow a node's header.
    pub fn write(&self, out: &mut SectionWriter) {
        out.array(&self.weights)
            .array(&self.bias)
            .array(&self.multiplier);
    }
}

fn interleaved(rows: usize, channels: usize, weight: impl Fn(usize, usize) -> i8) -> Vec<i8> {
    let mut out = vec![];
    for block in (0..channels).step_by(BLOCK) {
        for pair in (0..rows).step_by(2) {
            for c in block..block + BLOCK {
                out.push(weight(pair, c));
                out.push(if pair + 1 < rows {
                    weight(pair + 1, c)
                } else {
                    0
                });
            }
        }
    }
    out
}
