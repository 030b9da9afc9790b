//! The network of a model: its nodes, read and checked.

use crate::image::CROP_MAX;
use posewise_format::{ModelError, Section};

/// Capacity: nodes of a network.
pub const MAX_NODES: usize = 20;
/// Capacity: channels of a map.
pub const MAX_CHANNELS: usize = 96;
/// Capacity: inputs of one output of a full convolution, kernel² × channels.
pub const MAX_COLUMNS: usize = 9 * 64;
/// Capacity: weights of a node.
pub const MAX_WEIGHTS: usize = 80 * 80;
/// Memory for all maps that are in use at one time \[bytes\].
pub const ARENA: usize = 80 * 1024;

/// The input crop.
pub const OP_INPUT: u8 = 0;
/// Full convolution, then ReLU.
pub const OP_CONV: u8 = 1;
/// 3×3 convolution of each channel by itself, then ReLU.
pub const OP_DEPTHWISE: u8 = 2;
/// Adds a map to another, in place.
pub const OP_ADD: u8 = 3;
/// 1×1 convolution plus a map of half the side, upsampled to the nearest pixel, then ReLU: the
/// lateral connection of a feature pyramid (Lin et al., CVPR 2017).
pub const OP_LATERAL: u8 = 4;
/// 1×1 convolution with zero point 128 and without ReLU: the map that `OP_LATERAL` adds.
pub const OP_LINEAR: u8 = 5;

/// Place and size of a map. Narrow numbers, because a model is copied on small stacks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Map {
    /// Offset in the arena \[bytes\].
    at: u32,
    side: u16,
    channels: u16,
}

impl Map {
    /// Its bytes in the arena.
    pub fn range(&self) -> core::ops::Range<usize> {
        let start = self.at as usize;
        start..start + self.side() * self.side() * self.channels()
    }

    /// Whether the two share no byte.
    pub fn is_disjoint(&self, other: &Map) -> bool {
        let (a, b) = (self.range(), other.range());
        a.end <= b.start || b.end <= a.start
    }

    /// Height and width \[px\].
    pub fn side(&self) -> usize {
        self.side as usize
    }

    /// Values per pixel.
    pub fn channels(&self) -> usize {
        self.channels as usize
    }
}

/// A checked node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<'m> {
    pub op: u8,
    /// Side of the kernel \[px\].
    pub kernel: u8,
    pub stride: u8,
    pub input: Map,
    /// Second input of `OP_ADD` and `OP_LATERAL`.
    pub other: Map,
    pub output: Map,
    /// Input value that stands for 0.
    pub zero_point: u8,
    /// Full convolutions: `[output/8][pair of columns][8 outputs][2]`; depthwise: `[9][channels]`.
    pub weights: &'m [i8],
    /// By output channel.
    pub bias: &'m [i32],
    /// By output channel; for `OP_ADD`, by input.
    pub multiplier: &'m [i32],
    /// Right shift of a sum before the multiplication.
    pub pre_shift: u8,
    /// Right shift after it.
    pub post_shift: u8,
}

/// Numbers of a node as the model states them.
struct Raw {
    op: u8,
    kernel: usize,
    stride: usize,
    input: usize,
    other: usize,
    channels: usize,
    at: usize,
    zero_point: u8,
    pre_shift: u8,
    post_shift: u8,
}

/// A checked network.
#[derive(Clone, Copy, Debug)]
pub struct Network<'m> {
    pub(super) nodes: [Option<Node<'m>>; MAX_NODES],
}

impl<'m> Network<'m> {
    /// As [`Network::read`], and checks that no sum overflows.
    ///
    /// # Errors
    /// Likewise, or when a sum might overflow.
    #[inline(always)]
    pub fn open(s: &mut Section<'m>, side: usize) -> Result<Self, ModelError> {
        let network = Self::read(s, side);
        if let Ok(network) = &network {
            network.check_bounds(s)?;
        }
        network
    }

    /// Checks that no sum of a node overflows; `s` is where the network is from.
    ///
    /// # Errors
    /// When one might.
    #[inline(never)]
    pub fn check_bounds(&self, s: &Section<'_>) -> Result<(), ModelError> {
        let mut nodes = self.nodes.iter().flatten();
        nodes.try_for_each(|node| node.check_bounds(s))
    }

    /// Reads a network whose sums are known to be in bounds: `nodes: u32` and then each node: `op,
    /// kernel, stride, input, other, channels, at, zero_point, pre_shift, post_shift: u32`,
    /// `weights: i8[…]`, `bias: i32[…]`, `multiplier: i32[…]`. Node 0 is the crop, `side` px
    /// square; `input` and `other` are numbers of earlier nodes.
    ///
    /// # Errors
    /// When the section is too short, or a node would leave the arena or overwrite its input.
    pub fn read(s: &mut Section<'m>, side: usize) -> Result<Self, ModelError> {
        let count = s.count(2, MAX_NODES, "number of nodes")?;
        let mut network = Network {
            nodes: [None; MAX_NODES],
        };
        for index in 0..count {
            let node = network.node(s, side, index)?;
            if let Some(slot) = network.nodes.get_mut(index) {
                *slot = Some(node);
            }
        }
        Ok(network)
    }

    fn node(&self, s: &mut Section<'m>, side: usize, index: usize) -> Result<Node<'m>, ModelError> {
        let raw = Raw::read(s, index)?;
        let (from, second) = (self.map(raw.input), self.map(raw.other));
        let output_side = match (index, from) {
            (0, _) => side,
            (_, Some(from)) => from.side().div_ceil(raw.stride),
            (_, None) => return Err(s.error("a node has no input")),
        };
        let output = Map {
            at: raw.at as u32,
            side: output_side as u16,
            channels: raw.channels as u16,
        };
        s.require(output.side() <= CROP_MAX, "a map is too large")?;
        s.require(output.range().end <= ARENA, "a map leaves the memory")?;
        let (input, other) = (from.unwrap_or(output), second.unwrap_or(output));
        let (weights, channels, valid) = raw.sizes(&input, &other, &output);
        s.require(valid && weights <= MAX_WEIGHTS, "a node's sizes do not fit")?;
        let disjoint = match raw.op {
            OP_INPUT => true,
            OP_ADD => other.is_disjoint(&output),
            OP_LATERAL => {
                input.is_disjoint(&output)
                    && other.is_disjoint(&output)
                    && input.is_disjoint(&other)
            }
            _ => input.is_disjoint(&output),
        };
        s.require(disjoint, "a node overwrites its input")?;
        Ok(Node {
            op: raw.op,
            kernel: raw.kernel as u8,
            stride: raw.stride as u8,
            input,
            other,
            output,
            zero_point: raw.zero_point,
            weights: s.i8s(weights)?,
            bias: s.i32s(channels)?,
            multiplier: s.i32s(channels)?,
            pre_shift: raw.pre_shift,
            post_shift: raw.post_shift,
        })
    }

    /// The output map of a node.
    pub fn map(&self, node: usize) -> Option<Map> {
        let node = self.nodes.get(node)?;
        node.as_ref().map(|n| n.output)
    }

    /// The output map of the last node.
    pub fn output(&self) -> Map {
        let last = self.nodes.iter().flatten().last();
        last.map_or(Map::default(), |node| node.output)
    }

    /// Multiply-adds of one run.
    #[cfg(feature = "unstable-internals")]
    pub fn multiply_adds(&self) -> usize {
        let pixels = |n: &Node<'_>| n.output.side() * n.output.side() * n.weights.len();
        self.nodes.iter().flatten().map(pixels).sum()
    }
}

impl Raw {
    /// Reads node number `index` and checks each number by itself.
    fn read(s: &mut Section<'_>, index: usize) -> Result<Raw, ModelError> {
        let (first, last) = if index == 0 {
            (OP_INPUT, OP_INPUT)
        } else {
            (OP_CONV, OP_LINEAR)
        };
        let previous = index.saturating_sub(1);
        Ok(Raw {
            op: s.count(first as usize, last as usize, "node")? as u8,
            kernel: s.count(1, 5, "kernel")?,
            stride: s.count(1, 2, "stride")?,
            input: s.count(0, previous, "a node's input")?,
            other: s.count(0, previous, "a node's input")?,
            channels: s.count(1, MAX_CHANNELS, "channels")?,
            at: s.count(0, ARENA, "place in memory")?,
            zero_point: s.count(0, 255, "zero point")? as u8,
            pre_shift: s.count(0, 24, "shift")? as u8,
            post_shift: s.count(1, 30, "shift")? as u8,
        })
    }

    /// Number of weights, number of biases and multipliers, and whether the operation can be done
    /// with maps of these sizes.
    fn sizes(&self, input: &Map, other: &Map, output: &Map) -> (usize, usize, bool) {
        let Raw {
            kernel, channels, ..
        } = *self;
        let columns = (kernel * kernel * input.channels()).next_multiple_of(2);
        let blocks = channels.is_multiple_of(8);
        match self.op {
            OP_INPUT => (0, 0, channels == 1),
            OP_CONV => {
                let valid = kernel % 2 == 1 && columns <= MAX_COLUMNS && blocks;
                (columns * channels, channels, valid)
            }
            OP_LINEAR | OP_LATERAL => {
                let half = other.side() * 2 == output.side() && other.channels() == channels;
                let pointwise = kernel == 1 && self.stride == 1 && blocks;
                let valid = pointwise && (self.op == OP_LINEAR || half);
                (columns * channels, channels, valid)
            }
            OP_DEPTHWISE => (
                9 * channels,
                channels,
                channels == input.channels() && blocks,
            ),
            _ => {
                let same = other.side() == output.side() && other.channels() == channels;
                (0, 2, output == input && same)
            }
        }
    }
}

impl Node<'_> {
    /// Checks that no sum can overflow: |Σ weight·value| < 576·128·255 < 2²⁵, and the multiplier
    /// meets a sum that is cut to 16 bits. Kernels add two products in 16 bits: 2·127·128 fits.
    fn check_bounds(&self, s: &Section<'_>) -> Result<(), ModelError> {
        let least = self.weights.iter().fold(0, |least: i8, w| least.min(*w));
        s.require(least > i8::MIN, "a weight of -128")?;
        let within = |v: &i32, bits: u32| v.unsigned_abs() < 1 << bits;
        let bias = self.bias.iter().all(|b| within(b, 28));
        s.require(bias, "a bias is too large")?;
        let multiplier = self.multiplier.iter().all(|m| within(m, 15));
        s.require(multiplier, "a multiplier is too large")
    }
}
