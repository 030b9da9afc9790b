//! A network: a small convolutional trunk, and answers from its last map as a whole and from a fine
//! map read at the points.

use super::graph::{Graph, Maps, Op, Scratch};
use posewise::align::{GLOBAL, SHAPE_INDEXED};
use posewise::shape::LANDMARKS;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// Points in a crop \[px\], from its centre.
pub type Points = Vec<[f32; 2]>;
/// Crop px per pixel of the fine map.
pub const FINE_STRIDE: f32 = 4.0;

/// How large the network is.
#[derive(Clone, Debug, Serialize)]
pub struct Sizes {
    /// Side of the crop \[px\].
    pub side: usize,
    /// Crop px per canonical unit.
    pub zoom: f32,
    /// Channels of the maps at 1/2, 1/4 (twice) and 1/8 of the crop's resolution.
    pub channels: [usize; 4],
    /// Channels of the fine map.
    pub fine: usize,
    /// Separable layers at 1/4 and 1/8.
    pub depth: [usize; 2],
    /// Dimensions of an answer before it is spread over the coordinates.
    pub rank: usize,
    /// Points that it places.
    pub points: usize,
    /// What each answer reads: `GLOBAL`, `SHAPE_INDEXED` or both.
    pub reads: Vec<u32>,
}

impl Default for Sizes {
    fn default() -> Self {
        Sizes {
            side: 112,
            zoom: 1.15,
            channels: [8, 24, 32, 80],
            fine: 32,
            depth: [2, 3],
            rank: 64,
            points: LANDMARKS,
            reads: vec![GLOBAL, SHAPE_INDEXED, SHAPE_INDEXED],
        }
    }
}

impl Sizes {
    /// Of a refiner.
    pub fn of_refiner(points: usize, side: usize, zoom: f32) -> Sizes {
        Sizes {
            side,
            zoom,
            channels: [8, 24, 32, 64],
            fine: 24,
            depth: [1, 2],
            rank: 32,
            points,
            reads: vec![GLOBAL | SHAPE_INDEXED; 2],
        }
    }
}

/// `out = spread·(project·features + inner) + outer`: two matrices, rows of outputs.
#[derive(Clone, Debug)]
pub struct Head {
    /// Features read.
    pub inputs: usize,
    /// Dimensions between.
    pub rank: usize,
    /// Coordinates written: two per point.
    pub outputs: usize,
    /// What it reads.
    pub reads: u32,
    /// First of `[rank][inputs]`, `[rank]`, `[outputs][rank]`, `[outputs]`.
    pub at: usize,
}

impl Head {
    fn size(&self) -> usize {
        self.rank * (self.inputs + 1) + self.outputs * (self.rank + 1)
    }

    /// The four parts of this head's parameters.
    pub fn split<'a>(&self, parameters: &'a [f32]) -> [&'a [f32]; 4] {
        let (project, rest) = parameters[self.at..].split_at(self.rank * self.inputs);
        let (inner, rest) = rest.split_at(self.rank);
        let (spread, rest) = rest.split_at(self.outputs * self.rank);
        [project, inner, spread, &rest[..self.outputs]]
    }

    fn forward(&self, parameters: &[f32], features: &[f32], inner: &mut [f32]) -> Vec<f32> {
        let [project, bias, spread, outer] = self.split(parameters);
        for ((i, row), b) in inner
            .iter_mut()
            .zip(project.chunks_exact(self.inputs))
            .zip(bias)
        {
            *i = dot(row, features) + b;
        }
        let rows = spread.chunks_exact(self.rank).zip(outer);
        rows.map(|(row, o)| dot(row, inner) + o).collect()
    }

    /// Adds to the gradient; gives the gradient by the features.
    fn backward(
        &self,
        parameters: &[f32],
        features: &[f32],
        inner: &[f32],
        slope: &[f32],
        gradient: &mut [f32],
        by_features: &mut [f32],
    ) {
        let [project, _, spread, _] = self.split(parameters);
        let gradient = &mut gradient[self.at..self.at + self.size()];
        let (g_squeeze, rest) = gradient.split_at_mut(self.rank * self.inputs);
        let (g_inner, rest) = rest.split_at_mut(self.rank);
        let (g_spread, g_outer) = rest.split_at_mut(self.outputs * self.rank);
        let mut by_inner = vec![0.0; self.rank];
        for (((s, w), g), o) in slope
            .iter()
            .zip(spread.chunks_exact(self.rank))
            .zip(g_spread.chunks_exact_mut(self.rank))
            .zip(g_outer)
        {
            *o += s;
            add_scaled(g, inner, *s);
            add_scaled(&mut by_inner, w, *s);
        }
        by_features.fill(0.0);
        for (((s, w), g), i) in by_inner
            .iter()
            .zip(project.chunks_exact(self.inputs))
            .zip(g_squeeze.chunks_exact_mut(self.inputs))
            .zip(g_inner)
        {
            *i += s;
            add_scaled(g, features, *s);
            add_scaled(by_features, w, *s);
        }
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    // Eight sums side by side, so that the compiler may use vectors.
    let mut sums = [0.0f32; 8];
    let (a8, b8) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (x, y) in a8.0.iter().zip(b8.0) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    let rest: f32 = a8.1.iter().zip(b8.1).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f32>() + rest
}

fn add_scaled(to: &mut [f32], from: &[f32], by: f32) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += by * f);
}

/// Trunk and heads.
#[derive(Clone, Debug)]
pub struct Network {
    /// How large it is.
    pub sizes: Sizes,
    /// The trunk.
    pub graph: Graph,
    /// Node of the fine map.
    pub fine: usize,
    /// Node of the last map.
    pub last: usize,
    /// The answers, one after the other.
    pub heads: Vec<Head>,
    /// Parameters in all.
    pub parameters: usize,
}

/// Points after each head, and what led to them.
pub struct Answer {
    /// After each answer.
    pub shapes: Vec<Points>,
    features: Vec<Vec<f32>>,
    inner: Vec<Vec<f32>>,
    /// Where each answer began, and read the fine map.
    points: Vec<Points>,
}

impl Answer {
    /// Of each answer, the dimensions before they are spread over the coordinates.
    pub fn inner(&self) -> &[Vec<f32>] {
        &self.inner
    }
}

impl Network {
    /// The network of these sizes.
    pub fn new(sizes: &Sizes) -> Network {
        let [c1, c2, c3, c4] = sizes.channels;
        let mut graph = Graph::new(sizes.side);
        let conv = |kernel, stride| Op::Conv { kernel, stride };
        let mut at = graph.add(conv(5, 2), 0, 0, c1);
        at = graph.add(conv(3, 2), at, 0, c2);
        for _ in 0..sizes.depth[0] {
            at = graph.separable(at, c3, 1);
        }
        let quarter = at;
        at = graph.separable(at, c4, 2);
        for _ in 1..sizes.depth[1] {
            at = graph.separable(at, c4, 1);
        }
        let context = graph.add(Op::Linear, at, 0, sizes.fine);
        let last = graph.separable(at, c4, 2);
        let fine = graph.add(Op::Lateral, quarter, context, sizes.fine);
        let mut parameters = graph.parameters;
        let from_last = graph.nodes[last].dims.iter().product::<usize>();
        let heads = sizes
            .reads
            .iter()
            .map(|reads| {
                let whole = if reads & GLOBAL != 0 { from_last } else { 0 };
                let local = if reads & SHAPE_INDEXED != 0 {
                    sizes.points * sizes.fine
                } else {
                    0
                };
                let head = Head {
                    inputs: whole + local,
                    rank: sizes.rank,
                    outputs: 2 * sizes.points,
                    reads: *reads,
                    at: parameters,
                };
                parameters += head.size();
                head
            })
            .collect();
        Network {
            sizes: sizes.clone(),
            graph,
            fine,
            last,
            heads,
            parameters,
        }
    }

    /// Random parameters, scaled on example crops so that every map has unit deviation; the first
    /// answer begins with `offset`.
    pub fn initial(&self, offset: &Points, crops: &[Vec<f32>], rng: &mut ChaCha8Rng) -> Vec<f32> {
        let mut parameters = vec![0.0f32; self.parameters];
        for node in &self.graph.nodes[1..] {
            let channels = node.dims[2].max(1);
            let bound = (3.0 * channels as f32 / node.weights.max(1) as f32).sqrt();
            for w in &mut parameters[node.at..node.at + node.weights] {
                *w = rng.random_range(-bound..bound);
            }
        }
        for (k, head) in self.heads.iter().enumerate() {
            let bound = |n: usize| 1.0 / (n as f32).sqrt();
            let (inputs, rank) = (bound(head.inputs), bound(head.rank));
            let project = head.at..head.at + head.rank * head.inputs;
            parameters[project.clone()]
                .iter_mut()
                .for_each(|w| *w = rng.random_range(-inputs..inputs));
            let spread = project.end + head.rank..project.end + head.rank * (1 + head.outputs);
            parameters[spread.clone()]
                .iter_mut()
                .for_each(|w| *w = rng.random_range(-rank..rank));
            if k == 0 {
                let outer = &mut parameters[spread.end..spread.end + head.outputs];
                outer
                    .iter_mut()
                    .zip(offset.iter().flatten())
                    .for_each(|(o, v)| *o = *v);
            }
        }
        self.normalise(&mut parameters, crops);
        parameters
    }

    /// Layer by layer, scales weights and sets biases so that outputs before ReLU have mean 0 and
    /// deviation 1 on these crops.
    fn normalise(&self, parameters: &mut [f32], crops: &[Vec<f32>]) {
        let mut maps: Vec<Maps> = crops
            .iter()
            .map(|crop| {
                let mut maps = self.graph.maps();
                maps[0].copy_from_slice(crop);
                maps
            })
            .collect();
        let mut scratch = Scratch::default();
        for index in 1..self.graph.nodes.len() {
            let node = &self.graph.nodes[index];
            let channels = node.dims[2];
            if node.weights > 0 {
                let (mut sums, mut squares) = (vec![0.0f64; channels], vec![0.0f64; channels]);
                let mut count = 0.0;
                for maps in &mut maps {
                    self.graph
                        .forward_node(index, parameters, maps, &mut scratch, false);
                    for values in maps[index].chunks_exact(channels) {
                        count += 1.0;
                        for (k, v) in values.iter().enumerate() {
                            sums[k] += *v as f64;
                            squares[k] += (*v as f64).powi(2);
                        }
                    }
                }
                let (weights, biases) = parameters[node.at..node.at + node.weights + channels]
                    .split_at_mut(node.weights);
                for k in 0..channels {
                    let mean = sums[k] / count;
                    let gain = 1.0 / (squares[k] / count - mean * mean).max(1e-8).sqrt();
                    weights[k..]
                        .iter_mut()
                        .step_by(channels)
                        .for_each(|w| *w *= gain as f32);
                    biases[k] = (-mean * gain) as f32;
                }
            }
            for maps in &mut maps {
                self.graph
                    .forward_node(index, parameters, maps, &mut scratch, true);
            }
        }
    }

    /// Runs on the crop in `maps[0]`, beginning at `start`; `shake` moves where an answer begins,
    /// while training.
    pub fn forward(
        &self,
        parameters: &[f32],
        maps: &mut Maps,
        scratch: &mut Scratch,
        start: &Points,
        mut shake: impl FnMut() -> [f32; 2],
    ) -> Answer {
        self.graph.forward(parameters, maps, scratch);
        let mut answer = Answer {
            shapes: vec![],
            features: vec![],
            inner: vec![],
            points: vec![],
        };
        for head in &self.heads {
            let mut points = answer.shapes.last().unwrap_or(start).clone();
            if !answer.shapes.is_empty() {
                let [dx, dy] = shake();
                points.iter_mut().for_each(|p| *p = [p[0] + dx, p[1] + dy]);
            }
            let mut features = vec![];
            if head.reads & SHAPE_INDEXED != 0 {
                features = self.read(&maps[self.fine], &points);
            }
            if head.reads & GLOBAL != 0 {
                features.extend(&maps[self.last]);
            }
            let mut inner = vec![0.0; head.rank];
            let moved = head.forward(parameters, &features, &mut inner);
            let pairs = points.iter().zip(moved.as_chunks::<2>().0);
            let shape = pairs.map(|(p, m)| [p[0] + m[0], p[1] + m[1]]).collect();
            answer.shapes.push(shape);
            answer.features.push(features);
            answer.inner.push(inner);
            answer.points.push(points);
        }
        answer
    }

    /// Adds the gradient of a loss whose slopes by each of the answer's shapes are given; every
    /// head learns for itself: where a correction reads is taken as given.
    pub fn backward(
        &self,
        parameters: &[f32],
        maps: &Maps,
        answer: &Answer,
        slopes: &[Vec<f32>],
        gradient: &mut [f32],
        work: &mut (Maps, Scratch),
    ) {
        let (map_slopes, scratch) = work;
        for (k, head) in self.heads.iter().enumerate() {
            let mut by_features = vec![0.0; head.inputs];
            head.backward(
                parameters,
                &answer.features[k],
                &answer.inner[k],
                &slopes[k],
                gradient,
                &mut by_features,
            );
            let local = head.inputs - map_slopes[self.last].len() * (head.reads & GLOBAL) as usize;
            let (local, whole) = by_features.split_at(local);
            add_scaled(&mut map_slopes[self.last], whole, 1.0);
            self.read_back(&mut map_slopes[self.fine], &answer.points[k], local);
        }
        self.graph
            .backward(parameters, maps, map_slopes, gradient, scratch);
    }

    /// The four pixels of the fine map around a point, and their shares.
    fn corners(&self, [x, y]: [f32; 2]) -> [(usize, f32); 4] {
        let side = self.graph.nodes[self.fine].dims[1];
        let centre = (self.sizes.side as f32 - 1.0) / 2.0;
        let at = |v: f32| ((v + centre) / FINE_STRIDE).clamp(0.0, side as f32 - 1.001);
        let (x, y) = (at(x), at(y));
        let (fx, fy) = (x.fract(), y.fract());
        let first = y as usize * side + x as usize;
        [
            (first, (1.0 - fx) * (1.0 - fy)),
            (first + 1, fx * (1.0 - fy)),
            (first + side, (1.0 - fx) * fy),
            (first + side + 1, fx * fy),
        ]
    }

    fn read(&self, fine: &[f32], points: &Points) -> Vec<f32> {
        let n = self.sizes.fine;
        let mut features = vec![0.0; points.len() * n];
        for (point, out) in points.iter().zip(features.chunks_exact_mut(n)) {
            for (pixel, share) in self.corners(*point) {
                add_scaled(out, &fine[pixel * n..(pixel + 1) * n], share);
            }
        }
        features
    }

    fn read_back(&self, slopes: &mut [f32], points: &Points, by_features: &[f32]) {
        let n = self.sizes.fine;
        for (point, slope) in points.iter().zip(by_features.chunks_exact(n)) {
            for (pixel, share) in self.corners(*point) {
                add_scaled(&mut slopes[pixel * n..(pixel + 1) * n], slope, share);
            }
        }
    }
}
