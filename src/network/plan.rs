//! What the model says about the network, checked.

use crate::image::CROP_MAX;
use crate::model::{ModelError, Section};

/// Most nodes.
pub const MAX_NODES: usize = 20;
/// Most channels of a map.
pub const MAX_CHANNELS: usize = 96;
/// Most inputs of one output of a full convolution: kernel² × channels.
pub const MAX_COLUMNS: usize = 9 * 64;
/// Most weights of one node.
pub const MAX_WEIGHTS: usize = 80 * 80;
/// Bytes for all maps that are alive at one time.
pub const ARENA: usize = 96 * 1024;

/// The picture.
pub const OP_INPUT: u8 = 0;
/// Full convolution, then ReLU.
pub const OP_CONV: u8 = 1;
/// 3×3 convolution of each channel by itself, then ReLU.
pub const OP_DEPTHWISE: u8 = 2;
/// Adds a map to another, in place.
pub const OP_ADD: u8 = 3;
/// 1×1 convolution plus a map of half the size at its nearest pixel, then ReLU.
pub const OP_LATERAL: u8 = 4;
/// 1×1 convolution around 128 instead of a ReLU: what `OP_LATERAL` adds.
pub const OP_LINEAR: u8 = 5;

/// Where a map lies, and its size. Narrow numbers: a model is copied on small stacks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Map {
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
    pub fn apart(&self, other: &Map) -> bool {
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

/// One node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<'m> {
    pub op: u8,
    pub kernel: u8,
    pub stride: u8,
    pub input: Map,
    pub other: Map,
    pub output: Map,
    /// What an input value of zero is.
    pub zero: u8,
    /// Full convolutions: `[output/8][pair of columns][8 outputs][2]`; depthwise: `[9][channels]`.
    pub weights: &'m [i8],
    pub bias: &'m [i32],
    /// By channel: the sum's factor, after `before` bits are dropped and before `after` bits are.
    pub factor: &'m [i32],
    pub before: u8,
    pub after: u8,
}

/// A checked network.
#[derive(Clone, Copy, Debug)]
pub struct Network<'m> {
    pub(super) nodes: [Option<Node<'m>>; MAX_NODES],
}

impl<'m> Network<'m> {
    /// Reads `nodes: u32` and then each node: `op, kernel, stride, input, other, channels, at,
    /// zero, before, after: u32`, `weights: i8[…]`, `bias: i32[…]`, `factor: i32[…]`. Node 0 is
    /// the picture, `side` px square.
    ///
    /// # Errors
    /// When the section ends, or a node could leave the arena or overflow its sums.
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
        let (first, last) = if index == 0 {
            (OP_INPUT, OP_INPUT)
        } else {
            (OP_CONV, OP_LINEAR)
        };
        let op = s.count(first as usize, last as usize, "node")? as u8;
        let kernel = s.count(1, 5, "kernel")?;
        let stride = s.count(1, 2, "stride")?;
        let before = index.saturating_sub(1);
        let input = s.count(0, before, "a node's input")?;
        let other = s.count(0, before, "a node's input")?;
        let channels = s.count(1, MAX_CHANNELS, "channels")?;
        let at = s.count(0, ARENA, "place in memory")?;
        let zero = s.count(0, 255, "zero")? as u8;
        let (before, after) = (s.count(0, 24, "shift")?, s.count(1, 30, "shift")?);
        let (from, second) = (self.map(input), self.map(other));
        let map = |side: usize| Map {
            at: at as u32,
            side: side as u16,
            channels: channels as u16,
        };
        let output = match (index, from) {
            (0, _) => map(side),
            (_, Some(from)) => map(from.side().div_ceil(stride)),
            (_, None) => return Err(s.error("a node has no input")),
        };
        s.require(output.side() <= CROP_MAX, "a map is too large")?;
        s.require(output.range().end <= ARENA, "a map leaves the memory")?;
        let (input, other) = (from.unwrap_or(output), second.unwrap_or(output));
        let columns = (kernel * kernel * input.channels()).next_multiple_of(2);
        let (weights, biases, sound) = match op {
            OP_INPUT => (0, 0, channels == 1),
            OP_CONV => (
                columns * channels,
                channels,
                kernel % 2 == 1 && columns <= MAX_COLUMNS && channels.is_multiple_of(8),
            ),
            OP_LINEAR | OP_LATERAL => (
                columns * channels,
                channels,
                kernel == 1
                    && stride == 1
                    && channels.is_multiple_of(8)
                    && (op == OP_LINEAR
                        || other.side() * 2 == output.side() && other.channels() == channels),
            ),
            OP_DEPTHWISE => (
                9 * channels,
                channels,
                channels == input.channels() && channels.is_multiple_of(8),
            ),
            _ => (
                0,
                2,
                output == input && other.side() == output.side() && other.channels() == channels,
            ),
        };
        s.require(sound && weights <= MAX_WEIGHTS, "a node's sizes do not fit")?;
        let free = match op {
            OP_INPUT => true,
            OP_ADD => other.apart(&output),
            OP_LATERAL => input.apart(&output) && other.apart(&output) && input.apart(&other),
            _ => input.apart(&output),
        };
        s.require(free, "a node overwrites its input")?;
        let node = Node {
            op,
            kernel: kernel as u8,
            stride: stride as u8,
            input,
            other,
            output,
            zero,
            weights: s.i8s(weights)?,
            bias: s.i32s(biases)?,
            factor: s.i32s(biases)?,
            before: before as u8,
            after: after as u8,
        };
        // |Σ weight·value| < 576·128·255 < 2^25; the sum is dropped to 16 bits before the factor.
        let bound = |v: &i32, bits: u32| v.unsigned_abs() < 1 << bits;
        s.require(
            node.bias.iter().all(|b| bound(b, 28)),
            "a bias is too large",
        )?;
        s.require(
            node.factor.iter().all(|f| bound(f, 15)),
            "a factor is too large",
        )?;
        Ok(node)
    }

    /// The map that a node makes.
    pub fn map(&self, node: usize) -> Option<Map> {
        let node = self.nodes.get(node)?;
        node.as_ref().map(|n| n.output)
    }

    /// Multiply-adds of one run.
    pub fn multiply_adds(&self) -> usize {
        let pixels = |n: &Node<'_>| n.output.side() * n.output.side() * n.weights.len();
        self.nodes.iter().flatten().map(pixels).sum()
    }
}
