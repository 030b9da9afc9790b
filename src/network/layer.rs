//! Runs the nodes.

use super::kernel::{BLOCK, NO_COARSE, Scale, TAP_PAIRS, TILE, Tile, conv2d, depthwise3x3};
use super::plan::{
    ARENA, MAX_CHANNELS, MAX_COLUMNS, MAX_WEIGHTS, Map, Network, Node, OP_ADD, OP_DEPTHWISE,
    OP_INPUT, OP_LATERAL, OP_LINEAR,
};
use crate::image::Crop;
use crate::math::isqrt;

/// Memory for the maps of one run.
#[derive(Clone)]
pub struct Activations {
    arena: [u8; ARENA],
    /// One node's weights, widened.
    weights: [i16; MAX_WEIGHTS],
    /// One output pixel's window.
    columns: [i16; MAX_COLUMNS],
}

impl Default for Activations {
    fn default() -> Self {
        Self::new()
    }
}

impl Activations {
    /// Empty memory.
    pub const fn new() -> Self {
        Activations {
            arena: [0; ARENA],
            weights: [0; MAX_WEIGHTS],
            columns: [0; MAX_COLUMNS],
        }
    }

    /// The memory for maps, to use for something else between two runs.
    pub fn scratch(&mut self) -> &mut [u8] {
        &mut self.arena
    }

    /// A map's values, `[side][side][channels]`; empty when there is no such map.
    pub fn values(&self, map: &Map) -> &[u8] {
        self.arena.get(map.range()).unwrap_or(&[])
    }
}

/// Added to the standard deviation of a crop before dividing by it: flat crops stay quiet.
const QUIET: i64 = 8;
/// A standardised value of 1 in the input map, around 128.
const UNIT: i64 = 32;

impl Network<'_> {
    /// Computes all maps of a crop (`side` px square, as the network was read for).
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

/// Mean 128, deviation about 32.
fn standardise(crop: &Crop, node: &Node<'_>, work: &mut Activations) {
    let luma = crop.luma();
    let n = luma.len().max(1) as i64;
    let sum: i64 = luma.iter().map(|v| *v as i64).sum();
    let squares: i64 = luma.iter().map(|v| *v as i64 * *v as i64).sum();
    // Variance and mean in 1/256 units, so that the deviation comes in 1/16.
    let mean = (sum * 256 + n / 2) / n;
    let variance = ((squares * n - sum * sum) * 256 / (n * n)).max(0);
    let deviation = isqrt(variance as u32) as i64 + 16 * QUIET;
    // (v − mean)·32/deviation, both in 1/256.
    let gain = (UNIT << 20) * 16 / deviation.max(1);
    if let Some(out) = work.arena.get_mut(node.output.range()) {
        for (out, v) in out.iter_mut().zip(luma) {
            let value = (((*v as i64 * 256 - mean) * gain + (1 << 27)) >> 28) + 128;
            *out = value.clamp(0, 255) as u8;
        }
    }
}

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
    // As many pixels at a time as there is room for their windows.
    let pixels = (MAX_COLUMNS / count).clamp(1, TILE);
    let Some(columns) = work.columns.get_mut(..pixels * count) else {
        return;
    };
    let lateral = node.op == OP_LATERAL;
    // A map of no bytes stands in where no second map is read.
    let other = if lateral {
        node.other.range()
    } else {
        ARENA..ARENA
    };
    let maps = [from.range(), other, to.range()];
    let Ok([input, other, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    for (tile, out) in output.chunks_mut((pixels * channels).max(1)).enumerate() {
        let present = out.len() / channels;
        // Where there are fewer, the last stands in for the others.
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
        let under = places.map(|(y, x)| ((y / 2) * node.other.side() + x / 2) * channels);
        let blocks = wide.chunks_exact((count * BLOCK).max(1));
        for (block, (weights, scale)) in blocks.zip(node.scales()).enumerate() {
            let at = block * BLOCK;
            let coarse = under.map(|under| {
                let block = other.get(under + at..);
                block.and_then(|b| b.first_chunk()).unwrap_or(&NO_COARSE)
            });
            let bytes = conv2d(&Tile { columns, coarse }, weights, &scale);
            for (p, bytes) in bytes.iter().enumerate() {
                let out = out.get_mut(p * channels + at..);
                if let Some(out) = out.and_then(|o| o.first_chunk_mut()) {
                    *out = *bytes;
                }
            }
        }
    }
}

/// The window around an output pixel, row by row; what lies outside the map is zero.
#[inline]
fn window(node: &Node<'_>, input: &[u8], y: usize, x: usize, columns: &mut [i16]) {
    let from = node.input;
    let (kernel, stride) = (node.kernel as usize, node.stride as usize);
    let zero = node.zero as i16;
    let reach = kernel / 2;
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
    let left = (x * stride).saturating_sub(reach);
    let right = (x * stride + reach + 1).min(from.side());
    let skipped = (left + reach - x * stride) * from.channels();
    let len = right.saturating_sub(left) * from.channels();
    for (row, columns) in columns.chunks_exact_mut(width.max(1)).enumerate() {
        let sy = (y * stride + row).wrapping_sub(reach);
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

fn depthwise(node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    let stride = node.stride as usize;
    let (side, channels) = (to.side().max(1), to.channels().max(1));
    let Ok([input, output]) = work.arena.get_disjoint_mut([from.range(), to.range()]) else {
        return;
    };
    // [block][pair of taps][channel][2]
    let blocks = channels / BLOCK;
    let pairs = work.weights.as_chunks_mut::<{ 2 * BLOCK }>().0;
    let Some(pairs) = pairs.get_mut(..blocks * TAP_PAIRS) else {
        return;
    };
    for (k, pair) in pairs.iter_mut().enumerate() {
        let (first, tap) = (k / TAP_PAIRS * BLOCK, k % TAP_PAIRS * 2);
        for (i, wide) in pair.iter_mut().enumerate() {
            let at = (tap + i % 2) * channels + first + i / 2;
            *wide = node.weights.get(at).map_or(0, |w| *w as i16);
        }
    }
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

fn add(node: &Node<'_>, work: &mut Activations) {
    let maps = [node.other.range(), node.output.range()];
    let Ok([other, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    let &[own, second] = node.factor else { return };
    let (before, after) = (node.before as u32 & 31, node.after as u32 & 31);
    let half = 1i32 << (after.wrapping_sub(1) & 31);
    for (out, other) in output.iter_mut().zip(other) {
        // 16-bit factors: what machines multiply in pairs.
        let sum = (*out as i16 as i32).wrapping_mul(own as i16 as i32);
        let sum = sum.wrapping_add((*other as i16 as i32).wrapping_mul(second as i16 as i32));
        let value = (sum >> before).wrapping_add(half) >> after;
        *out = value.clamp(0, 255) as u8;
    }
}

impl<'m> Node<'m> {
    /// How sums become bytes, block by block.
    fn scales(&self) -> impl Iterator<Item = Scale<'m>> {
        let (before, after) = (self.before as u32, self.after as u32);
        let floor = if self.op == OP_LINEAR { 128 } else { 0 };
        let (bias, factor) = (self.bias.as_chunks().0, self.factor.as_chunks().0);
        bias.iter().zip(factor).map(move |(bias, factor)| Scale {
            bias,
            factor,
            before,
            after,
            floor,
        })
    }
}
