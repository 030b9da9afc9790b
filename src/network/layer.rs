//! Execution of a network's nodes.

use super::activations::Activations;
use super::convolution::convolve;
use super::kernel::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Sum, TapWeights, dispatch};
use super::plan::{Network, Node, OP_ADD, OP_DEPTHWISE, OP_INPUT};
use crate::image::Crop;
use crate::math::isqrt;

/// Added to the standard deviation of a crop before the division by it \[grey levels\]: limits the
/// amplification of noise in flat crops.
const DEVIATION_OFFSET: i64 = 8;
/// Input map units per standard deviation, around 128.
const INPUT_SCALE: i64 = 32;

impl Network<'_> {
    /// Computes all maps of a crop, whose side is the one that the network was read for \[px\].
    pub fn run(&self, crop: &Crop, work: &mut Activations) {
        dispatch!(kernel => self.run_with(kernel, crop, work));
    }

    fn run_with<K: Kernel>(&self, kernel: K, crop: &Crop, work: &mut Activations) {
        for node in self.nodes.iter().flatten() {
            match node.op {
                OP_INPUT => standardise(crop, node, work),
                OP_ADD => add(kernel, node, work),
                OP_DEPTHWISE => depthwise(kernel, node, work),
                _ => convolve(kernel, node, work),
            }
        }
    }
}

/// Standardises the crop's luma to a mean of 128 and a standard deviation of about 32, in integers.
fn standardise(crop: &Crop, node: &Node<'_>, work: &mut Activations) {
    let luma = crop.luma();
    let n = luma.len().max(1) as i64;
    // The squares of 128² bytes add up to less than 2³².
    let sum = i64::from(luma.iter().map(|v| u32::from(*v)).sum::<u32>());
    let squares = luma.iter().map(|v| u32::from(*v) * u32::from(*v));
    let squares = i64::from(squares.fold(0, u32::wrapping_add));
    // Mean and variance in units of 1/256; the deviation is in units of 1/16.
    let mean = (sum * 256 + n / 2) / n;
    let variance = ((squares * n - sum * sum) * 256 / (n * n)).max(0);
    let deviation = isqrt(variance as u32) as i64 + 16 * DEVIATION_OFFSET;
    // (v − mean)·32/deviation, with 28 bits of fraction below.
    let gain = (INPUT_SCALE << 20) * 16 / deviation.max(1);
    let mut table = [0u8; 256];
    for (v, out) in table.iter_mut().enumerate() {
        let value = (((v as i64 * 256 - mean) * gain + (1 << 27)) >> 28) + 128;
        *out = value.clamp(0, 255) as u8;
    }
    if let Some(out) = work.arena.get_mut(node.output.range()) {
        let look_up = |v: &u8| table.get(usize::from(*v)).copied().unwrap_or(0);
        let (out, last) = out.as_chunks_mut::<8>();
        let (luma, last_luma) = luma.as_chunks::<8>();
        for (out, luma) in out.iter_mut().zip(luma) {
            *out = luma.each_ref().map(look_up);
        }
        let rest = last.iter_mut().zip(last_luma);
        rest.for_each(|(out, v)| *out = look_up(v));
    }
}

/// 3×3 convolution of each channel by itself.
fn depthwise<K: Kernel>(kernel: K, node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    let channels = to.channels();
    let Ok([input, output]) = work.arena.get_disjoint_mut([from.range(), to.range()]) else {
        return;
    };
    let blocks = if K::PAIRED { channels / BLOCK } else { 0 };
    let paired = work.staging.tap_weights();
    let Some(paired) = paired.get_mut(..blocks) else {
        return;
    };
    pair_taps(node.weights, channels, paired);
    let weights = DepthwiseWeights {
        raw: node.weights,
        paired,
    };
    let scale = node.scale(node.bias.as_chunks().0);
    if let Some(input) = DepthwiseInput::new(input, from.side(), channels, node.stride as usize) {
        kernel.depthwise3x3(input, &weights, &scale, output);
    }
}

/// Reorders the weights `[9][channels]` to `[block][pair of taps][channel][2]`, as the kernels read
/// them; the tenth tap is 0.
pub(super) fn pair_taps(weights: &[i8], channels: usize, blocks: &mut [TapWeights]) {
    for (block, pairs) in blocks.iter_mut().enumerate() {
        for (pair, wide) in pairs.iter_mut().enumerate() {
            for (i, wide) in wide.iter_mut().enumerate() {
                let at = (2 * pair + i % 2) * channels + block * BLOCK + i / 2;
                *wide = weights.get(at).map_or(0, |w| *w as i16);
            }
        }
    }
}

/// Weighted sum of two maps, in place of the first.
fn add<K: Kernel>(kernel: K, node: &Node<'_>, work: &mut Activations) {
    let maps = [node.other.range(), node.output.range()];
    let Ok([other, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    let &[own, second] = node.multiplier else {
        return;
    };
    let sum = Sum {
        factors: [own as i16, second as i16],
        pre_shift: node.pre_shift as u32,
        post_shift: node.post_shift as u32,
    };
    kernel.add(&sum, other, output);
}
