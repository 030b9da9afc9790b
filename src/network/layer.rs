//! Execution of a network's nodes.

use super::activations::Activations;
use super::convolution::convolve;
use super::kernel::{BLOCK, DepthwiseInput, DepthwiseWeights, Kernel, Sum, TapWeights, dispatch};
use super::plan::{Network, Node, OP_ADD, OP_DEPTHWISE, OP_INPUT};
use crate::image::Crop;

impl Network<'_> {
    /// Computes all maps of a standardised crop, whose side is the one that the network was read
    /// for \[px\].
    pub fn run(&self, crop: &Crop, work: &mut Activations) {
        dispatch!(kernel => self.run_with(kernel, crop, work));
    }

    fn run_with<K: Kernel>(&self, kernel: K, crop: &Crop, work: &mut Activations) {
        for node in self.nodes.iter().flatten() {
            match node.op {
                OP_INPUT => input(crop, node, work),
                OP_ADD => add(kernel, node, work),
                OP_DEPTHWISE => depthwise(kernel, node, work),
                _ => convolve(kernel, node, work),
            }
        }
    }
}

/// Takes the crop as the map of the first node.
fn input(crop: &Crop, node: &Node<'_>, work: &mut Activations) {
    if let Some(out) = work.arena.get_mut(node.output.range()) {
        let pixels = out.iter_mut().zip(crop.luma());
        pixels.for_each(|(out, luma)| *out = *luma);
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
    let tap = |tap: usize, block: usize| {
        let weights = weights.get(tap * channels + block * BLOCK..);
        weights.and_then(|weights| weights.first_chunk::<BLOCK>())
    };
    for (block, pairs) in blocks.iter_mut().enumerate() {
        for (pair, wide) in pairs.iter_mut().enumerate() {
            let [first, second] =
                [2 * pair, 2 * pair + 1].map(|k| tap(k, block).copied().unwrap_or_default());
            let channels = wide.as_chunks_mut::<2>().0.iter_mut();
            for (wide, (first, second)) in channels.zip(first.into_iter().zip(second)) {
                *wide = [i16::from(first), i16::from(second)];
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
