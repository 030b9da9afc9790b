//! Runs the nodes.

use super::kernel::{BLOCK, products};
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

/// The sum's share of the next layer's bytes.
#[inline]
fn requantise(sum: i32, factor: i32, node: &Node<'_>) -> i32 {
    let (before, after) = (node.before as u32, node.after as u32);
    let kept = sum >> (before & 31);
    let round = 1i32 << (after.wrapping_sub(1) & 31);
    kept.wrapping_mul(factor).wrapping_add(round) >> (after & 31)
}

fn convolve(node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    let kernel = node.kernel as usize;
    let Some(wide) = work.weights.get_mut(..node.weights.len()) else {
        return;
    };
    for (wide, weight) in wide.iter_mut().zip(node.weights) {
        *wide = *weight as i16;
    }
    let count = (kernel * kernel * from.channels()).next_multiple_of(2);
    let Some(columns) = work.columns.get_mut(..count) else {
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
    let floor = if node.op == OP_LINEAR { 128 } else { 0 };
    let pixels = output.chunks_exact_mut(to.channels().max(1));
    for (at, pixel) in pixels.enumerate() {
        let (y, x) = (at / to.side().max(1), at % to.side().max(1));
        window(node, input, y, x, columns);
        let coarse = if lateral {
            let first = ((y / 2) * node.other.side() + x / 2) * to.channels();
            other.get(first..first + to.channels()).unwrap_or(&[])
        } else {
            &[]
        };
        let blocks = wide.chunks_exact((count * BLOCK).max(1));
        let constants = node
            .bias
            .as_chunks::<BLOCK>()
            .0
            .iter()
            .zip(node.factor.as_chunks::<BLOCK>().0);
        let outputs = pixel.as_chunks_mut::<BLOCK>().0;
        for (block, ((out, weights), (bias, factor))) in
            outputs.iter_mut().zip(blocks).zip(constants).enumerate()
        {
            let mut sums = products(columns, weights);
            for ((sum, bias), factor) in sums.iter_mut().zip(bias).zip(factor) {
                *sum = requantise(sum.wrapping_add(*bias), *factor, node) + floor;
            }
            let coarse = coarse.as_chunks::<BLOCK>().0.get(block);
            if let Some(coarse) = coarse {
                for (sum, c) in sums.iter_mut().zip(coarse) {
                    *sum += 2 * (*c as i32 - 128);
                }
            }
            *out = sums.map(|v| v.clamp(0, 255) as u8);
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
    let Ok([input, output]) = work.arena.get_disjoint_mut([from.range(), to.range()]) else {
        return;
    };
    let channels = to.channels().min(MAX_CHANNELS);
    let mut sums = [0i32; MAX_CHANNELS];
    let Some(sums) = sums.get_mut(..channels) else {
        return;
    };
    for (at, pixel) in output.chunks_exact_mut(channels.max(1)).enumerate() {
        let (y, x) = (at / to.side().max(1), at % to.side().max(1));
        sums.iter_mut().zip(node.bias).for_each(|(s, b)| *s = *b);
        for (tap, weights) in node.weights.chunks_exact(channels.max(1)).enumerate() {
            let sy = (y * stride + tap / 3).wrapping_sub(1);
            let sx = (x * stride + tap % 3).wrapping_sub(1);
            if sy >= from.side() || sx >= from.side() {
                continue;
            }
            let at = (sy * from.side() + sx) * channels;
            let values = input.get(at..at + channels).unwrap_or(&[]);
            for ((sum, value), weight) in sums.iter_mut().zip(values).zip(weights) {
                // 255·127 fits 16 bits.
                *sum += (*value as i16).wrapping_mul(*weight as i16) as i32;
            }
        }
        for ((out, sum), factor) in pixel.iter_mut().zip(&*sums).zip(node.factor) {
            *out = requantise(*sum, *factor, node).clamp(0, 255) as u8;
        }
    }
}

fn add(node: &Node<'_>, work: &mut Activations) {
    let maps = [node.other.range(), node.output.range()];
    let Ok([other, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    let &[own, second] = node.factor else { return };
    for (out, other) in output.iter_mut().zip(other) {
        let sum = (*out as i32)
            .wrapping_mul(own)
            .wrapping_add((*other as i32).wrapping_mul(second));
        *out = requantise(sum, 1, node).clamp(0, 255) as u8;
    }
}
