//! A network of convolutional layers: its nodes in order of computation, run forwards and
//! backwards, one sample at a time.

pub use super::layer::Scratch;
use super::layer::{Conv, Depthwise, Dims, add, add_downsampled, add_upsampled};

/// What a node computes from its inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// The crop.
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
    /// Size of its output.
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

/// The outputs of all nodes for one sample, or the loss's gradients by them.
pub type Maps = Vec<Vec<f32>>;

impl Graph {
    /// A network whose node 0 is a square crop of this side \[px\].
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
        let of_node = |n: &Node| n.dims[0] * n.dims[1] * n.weights;
        self.nodes.iter().map(of_node).sum()
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
        let (weights, biases) = node.parameters(parameters);
        match node.op {
            Op::Input => {}
            Op::Conv { .. } | Op::Linear | Op::Lateral => {
                let conv = node.convolution(from);
                conv.forward(input, weights, biases, out, scratch);
                if node.op == Op::Lateral {
                    let coarse_width = self.nodes[node.other].dims[1];
                    add_upsampled(out, node.dims, &before[node.other], coarse_width);
                }
            }
            Op::Depthwise { stride } => {
                let to = node.dims;
                Depthwise { from, to, stride }.forward(input, weights, biases, out);
            }
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

    /// Adds the parameters' gradient. `by_maps` holds the gradients by the maps that the loss
    /// reads and is zero elsewhere; it is zeroed.
    pub fn backward(
        &self,
        parameters: &[f32],
        maps: &Maps,
        by_maps: &mut Maps,
        gradient: &mut [f32],
        scratch: &mut Scratch,
    ) {
        for index in (1..self.nodes.len()).rev() {
            self.backward_node(index, parameters, maps, by_maps, gradient, scratch);
            by_maps[index].fill(0.0);
        }
        by_maps[0].fill(0.0);
    }

    /// Adds the gradients by one node's parameters and inputs.
    fn backward_node(
        &self,
        index: usize,
        parameters: &[f32],
        maps: &Maps,
        by_maps: &mut Maps,
        gradient: &mut [f32],
        scratch: &mut Scratch,
    ) {
        let node = &self.nodes[index];
        let (before, rest) = by_maps.split_at_mut(index);
        let by_output = &mut rest[0];
        if node.has_relu() {
            for (by, value) in by_output.iter_mut().zip(&maps[index]) {
                if *value <= 0.0 {
                    *by = 0.0;
                }
            }
        }
        let from = self.nodes[node.input].dims;
        let input = &maps[node.input];
        let (weights, _) = node.parameters(parameters);
        let (by_weights, by_biases) = node.parameters_mut(gradient);
        if node.weights > 0 {
            for by in by_output.chunks_exact(node.dims[2]) {
                add(by_biases, by);
            }
        }
        match node.op {
            Op::Input => {}
            Op::Conv { .. } | Op::Linear | Op::Lateral => {
                let conv = node.convolution(from);
                // Nothing reads the gradient by the crop.
                let by_input = (node.input != 0).then_some(&mut before[node.input][..]);
                conv.backward(input, weights, by_output, by_weights, by_input, scratch);
                if node.op == Op::Lateral {
                    let coarse_width = self.nodes[node.other].dims[1];
                    let by_coarse = &mut before[node.other];
                    add_downsampled(by_coarse, coarse_width, by_output, node.dims);
                }
            }
            Op::Depthwise { stride } => {
                let to = node.dims;
                let by_input = &mut before[node.input];
                let layer = Depthwise { from, to, stride };
                layer.backward(input, weights, by_output, by_weights, by_input);
            }
            Op::Add => {
                add(&mut before[node.input], by_output);
                add(&mut before[node.other], by_output);
            }
        }
    }
}

impl Node {
    /// The full convolution that it computes.
    fn convolution(&self, from: Dims) -> Conv {
        let (kernel, stride) = match self.op {
            Op::Conv { kernel, stride } => (kernel, stride),
            _ => (1, 1),
        };
        let to = self.dims;
        Conv {
            from,
            to,
            kernel,
            stride,
        }
    }

    fn biases(&self) -> usize {
        if self.weights == 0 { 0 } else { self.dims[2] }
    }

    /// Its weights and biases among all parameters.
    fn parameters<'a>(&self, all: &'a [f32]) -> (&'a [f32], &'a [f32]) {
        all[self.at..][..self.weights + self.biases()].split_at(self.weights)
    }

    /// The same, to be changed.
    pub fn parameters_mut<'a>(&self, all: &'a mut [f32]) -> (&'a mut [f32], &'a mut [f32]) {
        all[self.at..][..self.weights + self.biases()].split_at_mut(self.weights)
    }

    /// Whether its output is never negative.
    pub fn has_relu(&self) -> bool {
        matches!(
            self.op,
            Op::Conv { .. } | Op::Depthwise { .. } | Op::Lateral
        )
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

    /// The loss is a random weighting of the last map.
    #[test]
    fn gradients_agree_with_finite_differences() {
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
        let mut by_maps = graph.maps();
        let last = by_maps.last_mut().expect("nodes");
        last.iter_mut()
            .enumerate()
            .for_each(|(k, v)| *v = noise(k + 99));
        let mut gradient = vec![0.0; graph.parameters];
        graph.backward(
            &parameters,
            &maps,
            &mut by_maps,
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
            // A ReLU's kink inside the step makes a few differ.
            let off = (slope - gradient[k]).abs() > 0.05 * gradient[k].abs().max(1.0);
            wrong += off as usize;
        }
        assert!(wrong * 50 <= graph.parameters / 3, "{wrong} slopes differ");
    }
}
