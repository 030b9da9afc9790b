//! The kernel in portable Rust: it defines what all kernels compute.

use super::tail::{add, dot};
use super::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Scale, Strip, Sum};

#[derive(Clone, Copy)]
pub(in crate::network) struct Scalar;

impl Kernel for Scalar {
    const WIDTH: usize = 2;
    const GROUP: usize = 2;
    const TILE: usize = 1;

    fn conv2d(self, mut strip: Strip<'_>) {
        let scale = *strip.scale();
        let blocks = strip.weights().chunks_exact(strip.block_weights().max(1));
        for (block, weights) in blocks.take(strip.blocks()).enumerate() {
            for pixel in 0..strip.pixels() {
                let sums = products(&strip, pixel, weights);
                let at = pixel * strip.channels() + block * BLOCK;
                if let Some(out) = strip.out().get_mut(at..)
                    && let Some(out) = out.first_chunk_mut()
                {
                    requantize(sums, block, &scale, out);
                }
            }
        }
    }

    fn depthwise3x3(
        self,
        input: DepthwiseInput<'_>,
        weights: &DepthwiseWeights<'_>,
        scale: &Scale<'_>,
        out: &mut [u8],
    ) {
        let pixels = input.rows(out).flat_map(|(rows, out)| {
            let pixels = out.chunks_exact_mut(rows.channels().max(1)).enumerate();
            pixels.map(move |(x, pixel)| (rows, x, pixel))
        });
        for (rows, x, pixel) in pixels {
            let taps = rows.taps(x);
            let blocks = pixel.as_chunks_mut::<BLOCK>().0.iter_mut();
            for (block, (out, weights)) in blocks.zip(weights.paired).enumerate() {
                let mut sums = [0i32; BLOCK];
                for ([first, second], weights) in taps.as_chunks::<2>().0.iter().zip(weights) {
                    let [first, second] = [first, second].map(|tap| {
                        let values = tap.get(block * BLOCK..).and_then(|v| v.first_chunk());
                        values.unwrap_or(&[0; BLOCK])
                    });
                    let values = first.iter().zip(second);
                    let weights = weights.as_chunks::<2>().0;
                    for ((sum, (a, b)), [w0, w1]) in sums.iter_mut().zip(values).zip(weights) {
                        *sum += *a as i32 * *w0 as i32 + *b as i32 * *w1 as i32;
                    }
                }
                requantize(sums, block, scale, out);
            }
        }
    }

    fn add(self, sum: &Sum, other: &[u8], out: &mut [u8]) {
        add(sum, other, out);
    }

    fn dot(self, features: &[u8], weights: &[i8]) -> i32 {
        dot(features, weights)
    }
}

/// The sums of a block of channels at a pixel of the strip.
fn products(strip: &Strip<'_>, pixel: usize, weights: &[i8]) -> [i32; BLOCK] {
    let mut sums = [0i32; BLOCK];
    let values = strip.values(pixel);
    let rows = weights.chunks_exact((strip.columns() * BLOCK).max(1));
    for (start, weights) in strip.rows().iter().zip(rows) {
        let pairs = values.get(*start..).unwrap_or(&[]).as_chunks::<4>().0;
        for ([a, b, c, d], w) in pairs.iter().zip(weights.as_chunks::<{ 2 * BLOCK }>().0) {
            let x0 = i16::from_ne_bytes([*a, *b]) as i32;
            let x1 = i16::from_ne_bytes([*c, *d]) as i32;
            for (sum, [w0, w1]) in sums.iter_mut().zip(w.as_chunks::<2>().0) {
                *sum = sum
                    .wrapping_add(x0 * *w0 as i32)
                    .wrapping_add(x1 * *w1 as i32);
            }
        }
    }
    sums
}

fn requantize(sums: [i32; BLOCK], block: usize, scale: &Scale<'_>, out: &mut [u8; BLOCK]) {
    let (pre_shift, post_shift, half) = scale.shifts();
    let constants = scale.bias.get(block).zip(scale.multiplier.get(block));
    let Some((bias, multiplier)) = constants else {
        return;
    };
    for ((out, sum), (bias, multiplier)) in
        out.iter_mut().zip(sums).zip(bias.iter().zip(multiplier))
    {
        let kept = (sum.wrapping_add(*bias) >> pre_shift) as i16 as i32;
        let scaled = (kept * *multiplier as i16 as i32).wrapping_add(half) >> post_shift;
        let lateral = match scale.lateral {
            true => 2 * (*out as i32 - 128),
            false => 0,
        };
        *out = (scaled + scale.zero_point + lateral).clamp(0, 255) as u8;
    }
}
