//! Convolutional layers in `f32`, forwards and backwards, one sample at a time.
//!
//! Maps are `[height][width][channels]`. Convolutions are matrix products over unrolled windows;
//! borders are padded with zeros so that a stride of 1 keeps the size and a stride of 2 halves it.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Height, width, channels.
pub type Dims = [usize; 3];

/// What a node computes from its inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// The picture.
    Input,
    /// Full convolution with a square kernel (1, 3 or 5 wide), then ReLU.
    Conv {
        /// Width of the kernel.
        kernel: usize,
        /// Distance between output pixels.
        stride: usize,
    },
    /// 3×3 convolution of each channel by itself, then ReLU.
    Depthwise {
        /// Distance between output pixels.
        stride: usize,
    },
    /// Sum of two maps.
    Add,
    /// 1×1 convolution, plus a second map of half the size read at its nearest pixel, then ReLU.
    Lateral,
    /// 1×1 convolution without ReLU.
    Linear,
}

/// One node; inputs are nodes before it.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it computes.
    pub op: Op,
    /// The node it reads.
    pub input: usize,
    /// The second node that `Add` and `Lateral` read.
    pub other: usize,
    /// Size of what it makes.
    pub dims: Dims,
    /// Its weights `[kernel²·inputs][outputs]` (`[9][channels]` when depthwise), then biases, start
    /// here in the parameters.
    pub at: usize,
    /// Number of weights.
    pub weights: usize,
}

/// A network of such nodes.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// In order of computation.
    pub nodes: Vec<Node>,
    /// Parameters in all.
    pub parameters: usize,
}

/// The maps of one sample, or the gradients by them.
pub type Maps = Vec<Vec<f32>>;

impl Graph {
    /// A network whose node 0 is a picture of this size.
    pub fn new(side: usize) -> Graph {
        Graph {
            nodes: vec![Node {
                op: Op::Input,
                input: 0,
                other: 0,
                dims: [side, side, 1],
                at: 0,
                weights: 0,
            }],
            parameters: 0,
        }
    }

    /// Adds a node with `channels` outputs; returns its number.
    pub fn add(&mut self, op: Op, input: usize, other: usize, channels: usize) -> usize {
        let [height, width, inputs] = self.nodes[input].dims;
        let (stride, weights) = match op {
            Op::Input => unreachable!("there is one input"),
            Op::Conv { kernel, stride } => (stride, kernel * kernel * inputs * channels),
            Op::Depthwise { stride } => (stride, 9 * channels),
            Op::Add => (1, 0),
            Op::Lateral | Op::Linear => (1, inputs * channels),
        };
        let biases = if weights == 0 { 0 } else { channels };
        self.nodes.push(Node {
            op,
            input,
            other,
            dims: [height.div_ceil(stride), width.div_ceil(stride), channels],
            at: self.parameters,
            weights,
        });
        self.parameters += weights + biases;
        self.nodes.len() - 1
    }

    /// Depthwise and pointwise convolution; added to its input where the sizes allow it.
    pub fn separable(&mut self, input: usize, channels: usize, stride: usize) -> usize {
        let from = self.nodes[input].dims[2];
        let depthwise = self.add(Op::Depthwise { stride }, input, 0, from);
        let kernel_one = Op::Conv {
            kernel: 1,
            stride: 1,
        };
        let pointwise = self.add(kernel_one, depthwise, 0, channels);
        if from == channels && stride == 1 {
            self.add(Op::Add, pointwise, input, channels)
        } else {
            pointwise
        }
    }

    /// Zeroed maps of all nodes.
    pub fn maps(&self) -> Maps {
        let size = |n: &Node| n.dims.iter().product();
        self.nodes.iter().map(|n| vec![0.0; size(n)]).collect()
    }

    /// Multiply-adds of one run.
    pub fn multiply_adds(&self) -> usize {
        self.nodes
            .iter()
            .map(|n| match n.op {
                Op::Depthwise { .. } | Op::Conv { .. } | Op::Lateral | Op::Linear => {
                    n.dims[0] * n.dims[1] * n.weights
                }
                Op::Input | Op::Add => 0,
            })
            .sum()
    }

    /// Computes one node from those before it; `relu` off leaves out its last step.
    pub fn forward_node(
        &self,
        index: usize,
        parameters: &[f32],
        maps: &mut Maps,
        scratch: &mut Scratch,
        relu: bool,
    ) {
        let node = &self.nodes[index];
        let (before, rest) = maps.split_at_mut(index);
        let out = &mut rest[0];
        let input = &before[node.input];
        let from = self.nodes[node.input].dims;
        let weights = &parameters[node.at..node.at + node.weights];
        let channels = node.dims[2];
        let biases = if node.weights == 0 {
            &[][..]
        } else {
            &parameters[node.at + node.weights..node.at + node.weights + channels]
        };
        match node.op {
            Op::Input => {}
            Op::Conv { .. } | Op::Linear | Op::Lateral => {
                let (kernel, stride) = node.window();
                let columns = kernel * kernel * from[2];
                let rows = node.dims[0] * node.dims[1];
                out.chunks_exact_mut(channels)
                    .for_each(|o| o.copy_from_slice(biases));
                if kernel == 1 && stride == 1 {
                    product(out, [rows, channels], input, weights, columns);
                } else {
                    unroll(input, from, kernel, stride, node.dims, &mut scratch.columns);
                    product(out, [rows, channels], &scratch.columns, weights, columns);
                }
                if node.op == Op::Lateral {
                    let coarse = &before[node.other];
                    let half = self.nodes[node.other].dims[1];
                    for (at, o) in out.chunks_exact_mut(channels).enumerate() {
                        let (y, x) = (at / node.dims[1] / 2, at % node.dims[1] / 2);
                        let c = &coarse[(y * half + x) * channels..][..channels];
                        o.iter_mut().zip(c).for_each(|(o, c)| *o += c);
                    }
                }
            }
            Op::Depthwise { stride } => depthwise(input, from, stride, weights, biases, out, node),
            Op::Add => {
                let second = &before[node.other];
                for ((o, a), b) in out.iter_mut().zip(input).zip(second) {
                    *o = a + b;
                }
            }
        }
        if relu && node.has_relu() {
            out.iter_mut().for_each(|v| *v = v.max(0.0));
        }
    }

    /// Computes all nodes from `maps[0]`.
    pub fn forward(&self, parameters: &[f32], maps: &mut Maps, scratch: &mut Scratch) {
        for index in 1..self.nodes.len() {
            self.forward_node(index, parameters, maps, scratch, true);
        }
    }

    /// Adds the parameters' gradient, given the gradients by the maps that the loss reads in
    /// `slopes` (the others zero); `slopes` is used up.
    pub fn backward(
        &self,
        parameters: &[f32],
        maps: &Maps,
        slopes: &mut Maps,
        gradient: &mut [f32],
        scratch: &mut Scratch,
    ) {
        for index in (1..self.nodes.len()).rev() {
            let node = &self.nodes[index];
            let (before, rest) = slopes.split_at_mut(index);
            let slope = &mut rest[0];
            if node.has_relu() {
                for (s, v) in slope.iter_mut().zip(&maps[index]) {
                    if *v <= 0.0 {
                        *s = 0.0;
                    }
                }
            }
            let channels = node.dims[2];
            let rows = node.dims[0] * node.dims[1];
            if node.weights > 0 {
                let biases = &mut gradient[node.at + node.weights..][..channels];
                for s in slope.chunks_exact(channels) {
                    biases.iter_mut().zip(s).for_each(|(b, s)| *b += s);
                }
            }
            let from = self.nodes[node.input].dims;
            let input = &maps[node.input];
            let weights = &parameters[node.at..node.at + node.weights];
            let by_weights = &mut gradient[node.at..node.at + node.weights];
            match node.op {
                Op::Input => {}
                Op::Conv { .. } | Op::Linear | Op::Lateral => {
                    let (kernel, stride) = node.window();
                    let columns = kernel * kernel * from[2];
                    let of_weights = [columns, channels];
                    let of_input = [rows, columns];
                    if kernel == 1 && stride == 1 {
                        product_of_transpose(by_weights, of_weights, input, slope, rows);
                        let by_input = &mut before[node.input];
                        product_by_transpose(by_input, of_input, slope, weights, channels);
                    } else {
                        let unrolled = &mut scratch.columns;
                        unroll(input, from, kernel, stride, node.dims, unrolled);
                        product_of_transpose(by_weights, of_weights, unrolled, slope, rows);
                        // The picture has no use for its gradient.
                        if node.input != 0 {
                            unrolled.fill(0.0);
                            product_by_transpose(unrolled, of_input, slope, weights, channels);
                            let by_input = &mut before[node.input];
                            roll(unrolled, from, kernel, stride, node.dims, by_input);
                        }
                    }
                    if node.op == Op::Lateral {
                        let coarse = &mut before[node.other];
                        let half = self.nodes[node.other].dims[1];
                        for (at, s) in slope.chunks_exact(channels).enumerate() {
                            let (y, x) = (at / node.dims[1] / 2, at % node.dims[1] / 2);
                            let c = &mut coarse[(y * half + x) * channels..][..channels];
                            c.iter_mut().zip(s).for_each(|(c, s)| *c += s);
                        }
                    }
                }
                Op::Depthwise { stride } => {
                    let by_input = &mut before[node.input];
                    for_taps(from, stride, node.dims, |tap, source, target| {
                        let w = &weights[tap * channels..][..channels];
                        let g = &mut by_weights[tap * channels..][..channels];
                        let s = &slope[target..target + channels];
                        let x = &input[source..source + channels];
                        let d = &mut by_input[source..source + channels];
                        for k in 0..channels {
                            g[k] += s[k] * x[k];
                            d[k] += s[k] * w[k];
                        }
                    });
                }
                Op::Add => {
                    before[node.input]
                        .iter_mut()
                        .zip(&*slope)
                        .for_each(|(d, s)| *d += s);
                    before[node.other]
                        .iter_mut()
                        .zip(&*slope)
                        .for_each(|(d, s)| *d += s);
                }
            }
            slope.fill(0.0);
        }
        slopes[0].fill(0.0);
    }
}

impl Node {
    /// Width and stride of a full convolution's window.
    fn window(&self) -> (usize, usize) {
        match self.op {
            Op::Conv { kernel, stride } => (kernel, stride),
            _ => (1, 1),
        }
    }

    /// Whether what it makes is never negative.
    pub fn has_relu(&self) -> bool {
        matches!(
            self.op,
            Op::Conv { .. } | Op::Depthwise { .. } | Op::Lateral
        )
    }
}

/// Working memory of one thread.
#[derive(Default)]
pub struct Scratch {
    columns: Vec<f32>,
}

/// out += a·b; a is `rows × inner`.
fn product(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(&a[..size[0] * inner], size[0], inner);
    let b = MatRef::from_row_major_slice(b, inner, size[1]);
    add_product(out, size, a, b);
}

/// out += aᵀ·b; a is `inner × rows`.
fn product_of_transpose(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(&a[..size[0] * inner], inner, size[0]);
    let b = MatRef::from_row_major_slice(b, inner, size[1]);
    add_product(out, size, a.transpose(), b);
}

/// out += a·bᵀ; b is `columns × inner`.
fn product_by_transpose(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(a, size[0], inner);
    let b = MatRef::from_row_major_slice(b, size[1], inner);
    add_product(&mut out[..size[0] * size[1]], size, a, b.transpose());
}

fn add_product(out: &mut [f32], [rows, columns]: [usize; 2], a: MatRef<f32>, b: MatRef<f32>) {
    let out = MatMut::from_row_major_slice_mut(out, rows, columns);
    matmul(out, Accum::Add, a, b, 1.0, Par::Seq);
}

/// Calls `each(tap, input index, output index)` for the 3×3 windows, borders left out.
fn for_taps(from: Dims, stride: usize, to: Dims, mut each: impl FnMut(usize, usize, usize)) {
    let channels = to[2];
    for y in 0..to[0] {
        for x in 0..to[1] {
            let target = (y * to[1] + x) * channels;
            for tap in 0..9 {
                let (sy, sx) = (y * stride + tap / 3, x * stride + tap % 3);
                if (1..=from[0]).contains(&sy) && (1..=from[1]).contains(&sx) {
                    each(tap, ((sy - 1) * from[1] + sx - 1) * channels, target);
                }
            }
        }
    }
}

fn depthwise(
    input: &[f32],
    from: Dims,
    stride: usize,
    weights: &[f32],
    biases: &[f32],
    out: &mut [f32],
    node: &Node,
) {
    let channels = node.dims[2];
    out.chunks_exact_mut(channels)
        .for_each(|o| o.copy_from_slice(biases));
    for_taps(from, stride, node.dims, |tap, source, target| {
        let w = &weights[tap * channels..][..channels];
        let x = &input[source..source + channels];
        let o = &mut out[target..target + channels];
        for k in 0..channels {
            o[k] += w[k] * x[k];
        }
    });
}

/// One row per output pixel: its window, row by row.
fn unroll(
    input: &[f32],
    from: Dims,
    kernel: usize,
    stride: usize,
    to: Dims,
    columns: &mut Vec<f32>,
) {
    let width = kernel * from[2];
    columns.clear();
    columns.resize(to[0] * to[1] * kernel * width, 0.0);
    for_windows(from, kernel, stride, to, |at, source, len| {
        columns[at..at + len].copy_from_slice(&input[source..source + len]);
    });
}

/// The transpose of [`unroll`]: adds windows back.
fn roll(columns: &[f32], from: Dims, kernel: usize, stride: usize, to: Dims, out: &mut [f32]) {
    for_windows(from, kernel, stride, to, |at, source, len| {
        let out = &mut out[source..source + len];
        out.iter_mut()
            .zip(&columns[at..at + len])
            .for_each(|(o, c)| *o += c);
    });
}

/// Calls `each(index in columns, index in map, length)` for every row of every window.
fn for_windows(
    from: Dims,
    kernel: usize,
    stride: usize,
    to: Dims,
    mut each: impl FnMut(usize, usize, usize),
) {
    let (reach, channels) = (kernel / 2, from[2]);
    for y in 0..to[0] {
        for x in 0..to[1] {
            let row = (y * to[1] + x) * kernel * kernel * channels;
            let left = (x * stride).saturating_sub(reach);
            let right = (x * stride + kernel - reach).min(from[1]);
            let skipped = left + reach - x * stride;
            for ky in 0..kernel {
                let sy = y * stride + ky;
                if sy < reach || sy - reach >= from[0] || left >= right {
                    continue;
                }
                let at = row + (ky * kernel + skipped) * channels;
                let source = ((sy - reach) * from[1] + left) * channels;
                each(at, source, (right - left) * channels);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Graph {
        let mut g = Graph::new(12);
        let conv = |kernel, stride| Op::Conv { kernel, stride };
        let a = g.add(conv(5, 2), 0, 0, 4);
        let b = g.separable(a, 4, 1);
        let c = g.separable(b, 6, 2);
        let d = g.add(conv(3, 1), c, 0, 5);
        let e = g.add(Op::Linear, d, 0, 3);
        g.add(Op::Lateral, b, e, 3);
        g
    }

    /// Gradients agree with finite differences of a random weighting of the last map.
    #[test]
    fn gradients_are_slopes() {
        let graph = small();
        let noise = |k: usize| ((k * 7919 + 13) % 1009) as f32 / 504.5 - 1.0;
        let mut parameters: Vec<f32> = (0..graph.parameters).map(|k| 0.4 * noise(k)).collect();
        let mut maps = graph.maps();
        let mut scratch = Scratch::default();
        let mut loss = |parameters: &[f32], maps: &mut Maps| -> f64 {
            maps[0]
                .iter_mut()
                .enumerate()
                .for_each(|(k, v)| *v = noise(k + 5));
            graph.forward(parameters, maps, &mut scratch);
            let last = maps.last().expect("nodes");
            last.iter()
                .enumerate()
                .map(|(k, v)| (v * noise(k + 99)) as f64)
                .sum()
        };
        loss(&parameters, &mut maps);
        let mut slopes = graph.maps();
        let last = slopes.last_mut().expect("nodes");
        last.iter_mut()
            .enumerate()
            .for_each(|(k, v)| *v = noise(k + 99));
        let mut gradient = vec![0.0; graph.parameters];
        graph.backward(
            &parameters,
            &maps,
            &mut slopes,
            &mut gradient,
            &mut Scratch::default(),
        );
        let mut wrong = 0;
        for k in (0..graph.parameters).step_by(3) {
            let (kept, h) = (parameters[k], 1e-2);
            parameters[k] = kept + h;
            let above = loss(&parameters, &mut maps);
            parameters[k] = kept - h;
            let below = loss(&parameters, &mut maps);
            parameters[k] = kept;
            let slope = ((above - below) / (2.0 * h as f64)) as f32;
            // A ReLU's kink inside the step bends a few.
            let off = (slope - gradient[k]).abs() > 0.05 * gradient[k].abs().max(1.0);
            wrong += off as usize;
        }
        assert!(wrong * 50 <= graph.parameters / 3, "{wrong} slopes differ");
    }
}
