//! The tile network in `f32`, forwards and backwards.
//!
//! Maps are `[height][width][channels]`, borders are zero, a stride of 2 halves the size: as in
//! [`align::graph`](crate::align), whose layers take several times as long on maps of so few
//! channels.

use super::layer::{ADDEND_BACK, FIRST_KERNEL, Layer, OUTPUTS, Op};
use super::loops::{columns, depthwise, depthwise_back, gemm, outer};
use posewise::detect::TILE;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// The chain of layers.
#[derive(Clone)]
pub struct Network {
    pub layers: Vec<Layer>,
    /// Number of weights and biases.
    pub parameters: usize,
}

/// Memory of one tile's run: `maps[0]` is the tile, `maps[k + 1]` the output of layer k.
pub struct Work {
    pub maps: Vec<Vec<f32>>,
    /// The loss's gradients by them.
    pub by_maps: Vec<Vec<f32>>,
    /// Normalised sums of each layer, before its factors and biases; only in training.
    pub hats: Vec<Vec<f32>>,
    columns: Vec<f32>,
    transposed: Vec<f32>,
}

/// [`Network::forward`], to be compiled for the processor's vectors.
struct Forward<'a> {
    network: &'a Network,
    p: &'a [f32],
    work: &'a mut Work,
}

impl pulp::WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (k, l) in self.network.layers.iter().enumerate() {
            self.network.sums(k, self.p, self.work, true);
            if l.has_relu() {
                let map = self.work.maps[k + 1].iter_mut();
                map.for_each(|v| *v = v.max(0.0));
            }
        }
    }
}

impl Network {
    /// The network of the options' channels and depth.
    pub fn new([half, quarter, eighth]: [usize; 3], depth: usize) -> Network {
        let mut network = Network {
            layers: vec![],
            parameters: 0,
        };
        network.add(Op::First, half);
        network.separable(quarter, 2);
        network.separable(eighth, 2);
        for _ in 0..depth {
            network.separable(eighth, 1);
            network.add(Op::Add, eighth);
        }
        network.add(Op::Head, OUTPUTS);
        network
    }

    fn add(&mut self, op: Op, channels: usize) {
        let (side_in, inputs) = match self.layers.last() {
            Some(l) => (l.side, l.channels),
            None => (TILE, 1),
        };
        let (stride, weights) = match op {
            Op::First => (2, FIRST_KERNEL * FIRST_KERNEL * channels),
            Op::Depthwise { stride } => (stride, 9 * channels),
            Op::Pointwise | Op::Head => (1, inputs * channels),
            Op::Add => (1, 0),
        };
        let layer = Layer {
            op,
            side_in,
            inputs,
            side: side_in.div_ceil(stride),
            channels,
            at: self.parameters,
            weights,
        };
        self.parameters += weights + layer.biases();
        self.layers.push(layer);
    }

    fn separable(&mut self, channels: usize, stride: usize) {
        let inputs = self.layers.last().expect("a layer").channels;
        self.add(Op::Depthwise { stride }, inputs);
        self.add(Op::Pointwise, channels);
    }

    /// Multiply-adds of a tile.
    pub fn multiply_adds(&self) -> usize {
        let of = |l: &Layer| l.side * l.side * l.weights;
        self.layers.iter().map(of).sum()
    }

    /// Memory of a run.
    pub fn work(&self) -> Work {
        let mut maps = vec![vec![0.0; TILE * TILE]];
        let size = |l: &Layer| l.side * l.side * l.channels;
        maps.extend(self.layers.iter().map(|l| vec![0.0; size(l)]));
        Work {
            by_maps: maps.clone(),
            hats: vec![vec![]; self.layers.len()],
            maps,
            columns: vec![],
            transposed: vec![],
        }
    }

    /// He's initial weights; the score starts at a small probability.
    pub fn initial(&self, rng: &mut ChaCha8Rng) -> Vec<f32> {
        let mut all = vec![0.0; self.parameters];
        for layer in self.layers.iter().filter(|l| l.weights > 0) {
            let fan = layer.weights / layer.channels;
            let scale = match layer.op {
                Op::Head => 0.3 / (fan as f32).sqrt(),
                _ => (2.0 / fan as f32).sqrt(),
            };
            let (weights, biases) = layer.parameters_mut(&mut all);
            for v in weights {
                let normal: f32 = (0..6).map(|_| rng.random_range(-0.707f32..0.707)).sum();
                *v = scale * normal;
            }
            if layer.op == Op::Head {
                biases[0] = -4.0;
            }
        }
        all
    }

    /// Computes all maps.
    pub fn forward(&self, p: &[f32], work: &mut Work) {
        let network = self;
        pulp::Arch::new().dispatch(Forward { network, p, work });
    }

    /// A layer's output before its ReLU; without its biases where they follow a normalisation.
    #[inline(always)]
    pub fn sums(&self, k: usize, p: &[f32], work: &mut Work, is_biased: bool) {
        let l = &self.layers[k];
        let (before, rest) = work.maps.split_at_mut(k + 1);
        let (input, out) = (&before[k], &mut rest[0]);
        let (weights, biases) = l.parameters(p);
        out.chunks_exact_mut(l.channels)
            .for_each(|o| match is_biased {
                true if l.weights > 0 => o.copy_from_slice(biases),
                _ => o.fill(0.0),
            });
        match l.op {
            Op::First => {
                columns(input, l, &mut work.columns);
                gemm(
                    &work.columns,
                    FIRST_KERNEL * FIRST_KERNEL,
                    weights,
                    l.channels,
                    out,
                );
            }
            Op::Pointwise | Op::Head => gemm(input, l.inputs, weights, l.channels, out),
            Op::Depthwise { stride } => depthwise(input, l, stride, weights, out),
            Op::Add => {
                for ((o, a), b) in out.iter_mut().zip(input).zip(&before[k - ADDEND_BACK]) {
                    *o = a + b;
                }
            }
        }
    }

    /// Adds the gradient by a layer's parameters and inputs, given that by its sums.
    #[inline(always)]
    pub fn by_sums(&self, k: usize, p: &[f32], work: &mut Work, gradient: &mut [f32]) {
        let l = &self.layers[k];
        let (before, rest) = work.by_maps.split_at_mut(k + 1);
        let by_out = &rest[0];
        let input = &work.maps[k];
        let (weights, _) = l.parameters(p);
        let (by_weights, by_biases) = l.parameters_mut(gradient);
        if l.op == Op::Head {
            for by in by_out.chunks_exact(l.channels) {
                by_biases.iter_mut().zip(by).for_each(|(b, v)| *b += v);
            }
        }
        match l.op {
            Op::First => {
                columns(input, l, &mut work.columns);
                let inputs = FIRST_KERNEL * FIRST_KERNEL;
                outer(&work.columns, inputs, by_out, l.channels, by_weights);
            }
            Op::Pointwise | Op::Head => {
                outer(input, l.inputs, by_out, l.channels, by_weights);
                work.transposed.clear();
                for o in 0..l.channels {
                    let column = weights.iter().skip(o).step_by(l.channels);
                    work.transposed.extend(column);
                }
                gemm(
                    by_out,
                    l.channels,
                    &work.transposed,
                    l.inputs,
                    &mut before[k],
                );
            }
            Op::Depthwise { stride } => {
                depthwise_back(
                    input,
                    l,
                    stride,
                    weights,
                    by_out,
                    by_weights,
                    &mut before[k],
                );
            }
            Op::Add => {
                let (a, b) = before.split_at_mut(k);
                let by_inputs = b[0].iter_mut().zip(&mut a[k - ADDEND_BACK]);
                for ((x, y), v) in by_inputs.zip(by_out) {
                    *x += v;
                    *y += v;
                }
            }
        }
    }
}
