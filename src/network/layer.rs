//! Execution of a network's nodes.

use super::kernel::{BLOCK, NO_LATERAL, Scale, TAP_PAIRS, TILE, Tile, conv2d, depthwise3x3};
use super::plan::{
    ARENA, MAX_CHANNELS, MAX_COLUMNS, MAX_WEIGHTS, Map, Network, Node, OP_ADD, OP_DEPTHWISE,
    OP_INPUT, OP_LATERAL, OP_LINEAR,
};
use crate::image::Crop;
use crate::math::isqrt;

/// Working memory of one run.
#[derive(Clone)]
pub struct Activations {
    /// The maps; each node's output has its place ([`Map`]).
    arena: [u8; ARENA],
    /// The current node's weights, widened to 16 bits.
    weights: [i16; MAX_WEIGHTS],
    /// The input windows of some output pixels (im2col).
    columns: [i16; MAX_COLUMNS],
}

impl Default for Activations {
    fn default() -> Self {
        Self::new()
    }
}

impl Activations {
    /// Zeroed memory.
    pub const fn new() -> Self {
        Activations {
            arena: [0; ARENA],
            weights: [0; MAX_WEIGHTS],
            columns: [0; MAX_COLUMNS],
        }
    }

    /// The memory of the maps, [`ARENA`] bytes, for other use between two runs.
    pub fn scratch(&mut self) -> &mut [u8] {
        &mut self.arena
    }

    /// A map's values, `[side][side][channels]`; empty when the map is not one of the network's.
    pub fn values(&self, map: &Map) -> &[u8] {
        self.arena.get(map.range()).unwrap_or(&[])
    }
}

/// Added to the standard deviation of a crop before the division by it \[grey levels\]: limits the
/// amplification of noise in flat crops.
const DEVIATION_OFFSET: i64 = 8;
/// Input map units per standard deviation, around 128.
const INPUT_SCALE: i64 = 32;

impl Network<'_> {
    /// Computes all maps of a crop, whose side is the one that the network was read for \[px\].
    pub fn run(&self, crop: &Crop, work: &mut Activations) {
        for node in self.nodes.iter().flatten() {
            match node.op {
                OP_INPUT => standardise(crop, node, work),
                OP_ADD => add(node, work),
                OP_DEPTHWISE => depthwise(node, work),
                _ => convolve(node, work),
            }
        }
    }
}

/// Standardises the crop's luma to a mean of 128 and a standard deviation of about 32, in integers.
fn standardise(crop: &Crop, node: &Node<'_>, work: &mut Activations) {
    let luma = crop.luma();
    let n = luma.len().max(1) as i64;
    let sum: i64 = luma.iter().map(|v| *v as i64).sum();
    let squares: i64 = luma.iter().map(|v| *v as i64 * *v as i64).sum();
    // Mean and variance in units of 1/256; the deviation is in units of 1/16.
    let mean = (sum * 256 + n / 2) / n;
    let variance = ((squares * n - sum * sum) * 256 / (n * n)).max(0);
    let deviation = isqrt(variance as u32) as i64 + 16 * DEVIATION_OFFSET;
    // (v − mean)·32/deviation, with 28 bits of fraction below.
    let gain = (INPUT_SCALE << 20) * 16 / deviation.max(1);
    if let Some(out) = work.arena.get_mut(node.output.range()) {
        for (out, v) in out.iter_mut().zip(luma) {
            let value = (((*v as i64 * 256 - mean) * gain + (1 << 27)) >> 28) + 128;
            *out = value.clamp(0, 255) as u8;
        }
    }
}

/// Full convolution, with the lateral map added for `OP_LATERAL`: windows of up to [`TILE`] output
/// pixels are gathered (im2col) and multiplied by the weights, [`BLOCK`] channels at a time.
fn convolve(node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    let (side, channels) = (to.side().max(1), to.channels().max(1));
    let kernel = node.kernel as usize;
    let Some(wide) = work.weights.get_mut(..node.weights.len()) else {
        return;
    };
    for (wide, weight) in wide.iter_mut().zip(node.weights) {
        *wide = *weight as i16;
    }
    let count = (kernel * kernel * from.channels())
        .next_multiple_of(2)
        .max(2);
    // As many pixels per tile as have windows that fit the memory.
    let pixels = (MAX_COLUMNS / count).clamp(1, TILE);
    let Some(columns) = work.columns.get_mut(..pixels * count) else {
        return;
    };
    // Without a second input, an empty map.
    let lateral = match node.op {
        OP_LATERAL => node.other.range(),
        _ => ARENA..ARENA,
    };
    let maps = [from.range(), lateral, to.range()];
    let Ok([input, lateral, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    for (tile, out) in output.chunks_mut((pixels * channels).max(1)).enumerate() {
        let present = out.len() / channels;
        // In the last tile, the last pixel fills the unused places.
        let index: [usize; TILE] = core::array::from_fn(|p| p.min(present.saturating_sub(1)));
        let places = index.map(|p| {
            let at = tile * pixels + p;
            (at / side, at % side)
        });
        let windows = columns.chunks_exact_mut(count).zip(places);
        for (columns, (y, x)) in windows.take(present) {
            window(node, input, y, x, columns);
        }
        let columns = index.map(|p| columns.get(p * count..(p + 1) * count).unwrap_or(&[]));
        let lateral_at = places.map(|(y, x)| ((y / 2) * node.other.side() + x / 2) * channels);
        let blocks = wide.chunks_exact((count * BLOCK).max(1));
        for (block, (weights, scale)) in blocks.zip(node.scales()).enumerate() {
            let at = block * BLOCK;
            let lateral = lateral_at.map(|start| {
                let block = lateral.get(start + at..);
                block.and_then(|b| b.first_chunk()).unwrap_or(&NO_LATERAL)
            });
            let bytes = conv2d(&Tile { columns, lateral }, weights, &scale);
            for (p, bytes) in bytes.iter().enumerate() {
                let out = out.get_mut(p * channels + at..);
                if let Some(out) = out.and_then(|o| o.first_chunk_mut()) {
                    *out = *bytes;
                }
            }
        }
    }
}

/// Gathers the input window of output pixel (x, y), row by row, minus the input's zero point; 0
/// outside the map.
#[inline]
fn window(node: &Node<'_>, input: &[u8], y: usize, x: usize, columns: &mut [i16]) {
    let from = node.input;
    let (kernel, stride) = (node.kernel as usize, node.stride as usize);
    let zero = node.zero_point as i16;
    let radius = kernel / 2;
    let width = kernel * from.channels();
    if kernel == 1 {
        let at = (y * stride * from.side() + x * stride) * from.channels();
        if let Some(values) = input.get(at..at + from.channels()) {
            for (c, v) in columns.iter_mut().zip(values) {
                *c = *v as i16 - zero;
            }
        }
        return;
    }
    let left = (x * stride).saturating_sub(radius);
    let right = (x * stride + radius + 1).min(from.side());
    let skipped = (left + radius - x * stride) * from.channels();
    let len = right.saturating_sub(left) * from.channels();
    for (row, columns) in columns.chunks_exact_mut(width.max(1)).enumerate() {
        let sy = (y * stride + row).wrapping_sub(radius);
        let at = sy
            .wrapping_mul(from.side())
            .wrapping_add(left)
            .wrapping_mul(from.channels());
        let values = match sy < from.side() {
            true => input.get(at..at + len).unwrap_or(&[]),
            false => &[],
        };
        if values.len() < width {
            columns.fill(0);
        }
        if let Some(columns) = columns.get_mut(skipped..) {
            for (c, v) in columns.iter_mut().zip(values) {
                *c = *v as i16 - zero;
            }
        }
    }
}

/// 3×3 convolution of each channel by itself, [`BLOCK`] channels at a time.
fn depthwise(node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    let stride = node.stride as usize;
    let (side, channels) = (to.side().max(1), to.channels().max(1));
    let Ok([input, output]) = work.arena.get_disjoint_mut([from.range(), to.range()]) else {
        return;
    };
    let pairs = work.weights.as_chunks_mut::<{ 2 * BLOCK }>().0;
    let Some(pairs) = pairs.get_mut(..channels / BLOCK * TAP_PAIRS) else {
        return;
    };
    pair_taps(node.weights, channels, pairs);
    let zeros = [0u8; MAX_CHANNELS];
    for (at, pixel) in output.chunks_exact_mut(channels).enumerate() {
        let (y, x) = (at / side, at % side);
        let mut taps =
            [[0, 1]; TAP_PAIRS].map(|pair| pair.map(|_: usize| zeros.as_chunks().0.iter()));
        for (tap, values) in taps.as_flattened_mut().iter_mut().take(9).enumerate() {
            let sy = (y * stride + tap / 3).wrapping_sub(1);
            let sx = (x * stride + tap % 3).wrapping_sub(1);
            if sy < from.side() && sx < from.side() {
                let at = (sy * from.side() + sx) * channels;
                *values = input
                    .get(at..at + channels)
                    .unwrap_or(&[])
                    .as_chunks()
                    .0
                    .iter();
            }
        }
        let out = pixel.as_chunks_mut::<BLOCK>().0;
        let weights = pairs.as_chunks::<TAP_PAIRS>().0;
        for ((out, weights), scale) in out.iter_mut().zip(weights).zip(node.scales()) {
            let block = taps
                .each_mut()
                .map(|pair| pair.each_mut().map(|tap| tap.next().unwrap_or(&[0; BLOCK])));
            *out = depthwise3x3(&block, weights, &scale);
        }
    }
}

/// Reorders the weights `[9][channels]` to `[block][pair of taps][channel][2]`, as the kernel reads
/// them; the tenth tap is 0.
fn pair_taps(weights: &[i8], channels: usize, pairs: &mut [[i16; 2 * BLOCK]]) {
    for (k, pair) in pairs.iter_mut().enumerate() {
        let (first, tap) = (k / TAP_PAIRS * BLOCK, k % TAP_PAIRS * 2);
        for (i, wide) in pair.iter_mut().enumerate() {
            let at = (tap + i % 2) * channels + first + i / 2;
            *wide = weights.get(at).map_or(0, |w| *w as i16);
        }
    }
}

/// Weighted sum of two maps, in place of the first.
fn add(node: &Node<'_>, work: &mut Activations) {
    let maps = [node.other.range(), node.output.range()];
    let Ok([other, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    let &[own, second] = node.multiplier else {
        return;
    };
    let (pre_shift, post_shift) = (node.pre_shift as u32 & 31, node.post_shift as u32 & 31);
    let half = 1i32 << (post_shift.wrapping_sub(1) & 31);
    for (out, other) in output.iter_mut().zip(other) {
        // 16-bit factors, for which SIMD units have a multiply-add of pairs.
        let sum = (*out as i16 as i32).wrapping_mul(own as i16 as i32);
        let sum = sum.wrapping_add((*other as i16 as i32).wrapping_mul(second as i16 as i32));
        let value = (sum >> pre_shift).wrapping_add(half) >> post_shift;
        *out = value.clamp(0, 255) as u8;
    }
}

impl<'m> Node<'m> {
    /// The requantisation of each block of channels.
    fn scales(&self) -> impl Iterator<Item = Scale<'m>> {
        let (pre_shift, post_shift) = (self.pre_shift as u32, self.post_shift as u32);
        let zero_point = if self.op == OP_LINEAR { 128 } else { 0 };
        let (bias, multiplier) = (self.bias.as_chunks().0, self.multiplier.as_chunks().0);
        bias.iter()
            .zip(multiplier)
            .map(move |(bias, multiplier)| Scale {
                bias,
                multiplier,
                pre_shift,
                post_shift,
                zero_point,
            })
    }
}
