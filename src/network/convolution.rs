//! Full convolutions: input rows are staged for a kernel, strip by strip.

use super::activations::Activations;
use super::kernel::{BLOCK, Kernel, MAX_ROWS, STAGING, Scale, Strip, StripParts};
use super::plan::{ARENA, MAX_CHANNELS, Node, OP_LATERAL, OP_LINEAR};

/// Full convolution, with the lateral map added for `OP_LATERAL`.
pub(super) fn convolve<K: Kernel>(kernel: K, node: &Node<'_>, work: &mut Activations) {
    let (from, to) = (node.input, node.output);
    // Without a second input, an empty map.
    let lateral = match node.op {
        OP_LATERAL => node.other.range(),
        _ => ARENA..ARENA,
    };
    let maps = [from.range(), lateral, to.range()];
    let Ok([input, lateral, output]) = work.arena.get_disjoint_mut(maps) else {
        return;
    };
    upsample(lateral, to.side(), to.channels(), output);
    let conv = Convolution::new::<K>(node);
    let scale = node.scale(node.bias.as_chunks().0);
    let staged = work.staging.bytes();
    if from.channels() > 1 {
        conv.run(kernel, input, node.weights, &scale, staged, output);
        return;
    }
    // The rows of windows of one channel are padded, block by block.
    let weights = node.weights.chunks_exact(conv.unpadded().max(1));
    let constants = scale
        .bias
        .chunks_exact(1)
        .zip(scale.multiplier.chunks_exact(1));
    for (block, (weights, (bias, multiplier))) in weights.zip(constants).enumerate() {
        let scale = Scale {
            bias,
            multiplier,
            ..scale
        };
        let weights = conv.padded(weights);
        let weights = weights.as_flattened().get(..conv.block_weights());
        if let Some((weights, output)) = weights.zip(output.get_mut(block * BLOCK..)) {
            conv.run(kernel, input, weights, &scale, staged, output);
        }
    }
}

/// Copies each pixel of a map of half the side to the four pixels of `output` that it covers.
fn upsample(map: &[u8], side: usize, channels: usize, output: &mut [u8]) {
    let row = side * channels;
    let halves = map.chunks_exact((row / 2).max(1));
    for (half, rows) in halves.zip(output.chunks_exact_mut((2 * row).max(1))) {
        let Some((first, second)) = rows.split_at_mut_checked(row) else {
            return;
        };
        let pixels = first.chunks_exact_mut((2 * channels).max(1));
        for (from, to) in half.chunks_exact(channels.max(1)).zip(pixels) {
            for to in to.chunks_exact_mut(channels.max(1)) {
                // By block: a call for so few bytes would cost more than they do.
                let blocks = to.as_chunks_mut::<BLOCK>().0.iter_mut();
                blocks
                    .zip(from.as_chunks().0)
                    .for_each(|(to, from)| *to = *from);
            }
        }
        let copies = second.iter_mut().zip(first);
        copies.for_each(|(to, from)| *to = *from);
    }
}

/// Geometry of a full convolution. One of 1×1 pixels is that of a single row of them.
struct Convolution {
    /// Rows and pixels per row of the input \[px\].
    from: [usize; 2],
    /// The same of the output.
    to: [usize; 2],
    kernel: usize,
    stride: usize,
    /// Of the input.
    channels: usize,
    /// Of the output.
    outputs: usize,
    /// Input value that stands for 0.
    zero_point: u8,
    /// Values of a row of a window, padded.
    columns: usize,
}

/// Columns of a row of a window of one channel, padded.
const PADDED: usize = 8;

impl Convolution {
    fn new<K: Kernel>(node: &Node<'_>) -> Self {
        let (from, to) = (node.input, node.output);
        let (kernel, stride) = (node.kernel as usize, node.stride as usize);
        let (from_size, to_size) = match kernel == 1 && stride == 1 {
            true => ([1, from.side() * from.side()], [1, to.side() * to.side()]),
            false => ([from.side(); 2], [to.side(); 2]),
        };
        Convolution {
            from: from_size,
            to: to_size,
            kernel,
            stride,
            channels: from.channels(),
            outputs: to.channels(),
            zero_point: node.zero_point,
            columns: (kernel * from.channels()).next_multiple_of(K::GROUP),
        }
    }

    /// Weights of a block in the model.
    fn unpadded(&self) -> usize {
        let columns = self.kernel * self.kernel * self.channels;
        columns.next_multiple_of(2) * BLOCK
    }

    /// The weights of a block for one input channel, `[pair of columns][8 channels][2]`, in rows
    /// that are padded with zeros: `[row][pair of columns][8 channels][2]`.
    fn padded(&self, weights: &[i8]) -> [[i8; PADDED * BLOCK]; MAX_ROWS] {
        let mut padded = [[0; PADDED * BLOCK]; MAX_ROWS];
        let place =
            |column: usize, channel: usize| column / 2 * 2 * BLOCK + channel * 2 + column % 2;
        let out = padded.as_flattened_mut();
        for row in 0..self.kernel {
            for column in 0..self.kernel {
                for channel in 0..BLOCK {
                    let from = weights.get(place(row * self.kernel + column, channel));
                    let to = row * self.columns * BLOCK + place(column, channel);
                    if let Some((to, from)) = out.get_mut(to).zip(from) {
                        *to = *from;
                    }
                }
            }
        }
        padded
    }

    /// Weights of a block, padded.
    fn block_weights(&self) -> usize {
        self.kernel * self.columns * BLOCK
    }

    /// Computes the blocks of channels that the scale has: strip by strip, so that the staged rows
    /// fit the memory, and in a strip row by row, so that each is staged once.
    fn run<K: Kernel>(
        &self,
        kernel: K,
        input: &[u8],
        weights: &[i8],
        scale: &Scale<'_>,
        staged: &mut [u8],
        output: &mut [u8],
    ) {
        let mut bias = [[0; BLOCK]; MAX_CHANNELS / BLOCK];
        let Some(bias) = bias.get_mut(..scale.bias.len()) else {
            return;
        };
        bias.copy_from_slice(scale.bias);
        kernel.correct(weights, self.zero_point, bias);
        let scale = Scale { bias, ..*scale };
        let [height, width] = self.to;
        let step = self.stride * self.channels * K::WIDTH;
        // As many pixels as have windows that fit, in whole tiles.
        let row_bytes = STAGING / self.kernel.max(1) / 16 * 16;
        let windows = row_bytes.saturating_sub(self.columns * K::WIDTH) / step.max(1) + 1;
        let tiles = (windows / K::TILE * K::TILE).max(windows.min(K::TILE));
        let direct = self.run_directly(kernel, input, weights, &scale, output);
        for first in (direct..width).step_by(tiles.max(1)) {
            let pixels = tiles.min(width - first);
            let mut next = 0;
            for y in 0..height {
                let top = y * self.stride;
                // Rows are counted from the first one of the padding.
                for row in next.max(top)..top + self.kernel {
                    let slot = row % self.kernel.max(1) * row_bytes;
                    if let Some(staged) = staged.get_mut(slot..slot + row_bytes) {
                        self.stage_row(kernel, input, row, [first, pixels], staged);
                    }
                }
                next = top + self.kernel;
                let mut rows = [0; MAX_ROWS];
                let mut slot = top % self.kernel.max(1);
                for row in rows.iter_mut().take(self.kernel) {
                    *row = slot * row_bytes;
                    slot = if slot + 1 < self.kernel { slot + 1 } else { 0 };
                }
                let at = (y * width + first) * self.outputs;
                let end = at + (pixels - 1) * self.outputs + scale.bias.len() * BLOCK;
                let parts = StripParts {
                    values: staged,
                    rows: rows.get(..self.kernel).unwrap_or(&[]),
                    step,
                    columns: self.columns,
                    filled: self.kernel * self.channels,
                    weights,
                    scale,
                    out: output.get_mut(at..end).unwrap_or(&mut []),
                    channels: self.outputs,
                };
                if let Some(strip) = Strip::new(parts, K::WIDTH, K::GROUP) {
                    kernel.conv2d(strip);
                }
            }
        }
    }

    /// Computes whole tiles of a convolution of 1×1 pixels from the input as it is, where the
    /// kernel takes it so. Returns how many pixels they have.
    fn run_directly<K: Kernel>(
        &self,
        kernel: K,
        input: &[u8],
        weights: &[i8],
        scale: &Scale<'_>,
        output: &mut [u8],
    ) -> usize {
        let [height, width] = self.to;
        let pixels = width / K::TILE * K::TILE;
        let parts = StripParts {
            values: input,
            rows: &[0],
            step: self.channels,
            columns: self.columns,
            filled: self.channels,
            weights,
            scale: *scale,
            out: output.get_mut(..pixels * self.outputs).unwrap_or(&mut []),
            channels: self.outputs,
        };
        let is_direct = K::DIRECT
            && (self.kernel, self.stride, height) == (1, 1, 1)
            && self.columns == self.channels
            && scale.bias.len() * BLOCK == self.outputs;
        match Strip::new(parts, K::WIDTH, K::GROUP) {
            Some(strip) if is_direct && pixels > 0 => {
                kernel.conv2d(strip);
                pixels
            }
            _ => 0,
        }
    }

    /// Stages what the windows of some output pixels read of an input row, which is counted from
    /// the first one of the padding.
    #[inline]
    fn stage_row<K: Kernel>(
        &self,
        kernel: K,
        input: &[u8],
        row: usize,
        [first, pixels]: [usize; 2],
        staged: &mut [u8],
    ) {
        let [height, width] = self.from;
        let radius = self.kernel / 2;
        let from = first * self.stride;
        let to = from + (pixels - 1) * self.stride + self.kernel;
        // In pixels, counted from the first one of the padding.
        let (left, right) = (from.max(radius), to.min(width + radius));
        let pixel_bytes = self.channels * K::WIDTH;
        // Beside the map there is padding, which stays there for later rows.
        let has_sides = from < left || right < to || self.channels == 1;
        let (is_first, row) = (row < self.kernel, row.wrapping_sub(radius));
        if row >= height || (is_first && has_sides) {
            // Behind the last window there are weights of 0.
            let windows = staged.get_mut(..(to - from) * pixel_bytes);
            windows
                .unwrap_or(&mut [])
                .fill(kernel.padding(self.zero_point));
        }
        if row < height && left < right {
            let at = row * width;
            let [start, end] = [left, right].map(|v| (at + v - radius) * self.channels);
            let values = input.get(start..end);
            let staged = staged.get_mut((left - from) * pixel_bytes..);
            if let Some((values, staged)) = values.zip(staged) {
                kernel.stage(values, self.zero_point, staged);
            }
        }
    }
}

impl<'m> Node<'m> {
    /// The requantisation of all channels.
    pub(super) fn scale<'a>(&self, bias: &'a [[i32; BLOCK]]) -> Scale<'a>
    where
        'm: 'a,
    {
        Scale {
            bias,
            multiplier: self.multiplier.as_chunks().0,
            pre_shift: self.pre_shift as u32,
            post_shift: self.post_shift as u32,
            zero_point: if self.op == OP_LINEAR { 128 } else { 0 },
            lateral: self.op == OP_LATERAL,
        }
    }
}
