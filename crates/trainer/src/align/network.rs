//! A network: a small convolutional trunk, and heads that read its last map as a whole and a fine
//! map at the points.

use super::graph::{Graph, Maps, Op, Scratch};
use super::head::{Head, add_scaled};
use posewise::align::{GLOBAL, SHAPE_INDEXED};
use posewise::shape::LANDMARKS;
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
    /// Rank of each head.
    pub rank: usize,
    /// Points that it places.
    pub points: usize,
    /// What each head reads: `GLOBAL`, `SHAPE_INDEXED` or both.
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
    /// In order: each starts at the points of the one before it.
    pub heads: Vec<Head>,
    /// Parameters in all.
    pub parameters: usize,
}

/// Points after each head, and the values from which they were computed.
pub struct Prediction {
    /// After each head.
    pub shapes: Vec<Points>,
    features: Vec<Vec<f32>>,
    inner: Vec<Vec<f32>>,
    /// Where each head started, and read the fine map.
    points: Vec<Points>,
}

impl Prediction {
    /// Of each head, the values between its two matrices.
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

    /// Runs on the crop in `maps[0]` from the points `start`. `jitter` displaces the points at
    /// which all heads but the first start, while training.
    pub fn forward(
        &self,
        parameters: &[f32],
        maps: &mut Maps,
        scratch: &mut Scratch,
        start: &Points,
        mut jitter: impl FnMut() -> [f32; 2],
    ) -> Prediction {
        self.graph.forward(parameters, maps, scratch);
        let mut prediction = Prediction {
            shapes: vec![],
            features: vec![],
            inner: vec![],
            points: vec![],
        };
        for head in &self.heads {
            let mut points = prediction.shapes.last().unwrap_or(start).clone();
            if !prediction.shapes.is_empty() {
                let [dx, dy] = jitter();
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
            prediction.shapes.push(shape);
            prediction.features.push(features);
            prediction.inner.push(inner);
            prediction.points.push(points);
        }
        prediction
    }

    /// Adds the parameters' gradient, given the loss's gradients by the shapes after each head.
    /// Heads are trained independently: the points at which a head starts count as constant.
    pub fn backward(
        &self,
        parameters: &[f32],
        maps: &Maps,
        prediction: &Prediction,
        by_shapes: &[Vec<f32>],
        gradient: &mut [f32],
        work: &mut (Maps, Scratch),
    ) {
        let (by_maps, scratch) = work;
        for (k, head) in self.heads.iter().enumerate() {
            let mut by_features = vec![0.0; head.inputs];
            head.backward(
                parameters,
                &prediction.features[k],
                &prediction.inner[k],
                &by_shapes[k],
                gradient,
                &mut by_features,
            );
            let local = head.inputs - by_maps[self.last].len() * (head.reads & GLOBAL) as usize;
            let (local, whole) = by_features.split_at(local);
            add_scaled(&mut by_maps[self.last], whole, 1.0);
            self.read_back(&mut by_maps[self.fine], &prediction.points[k], local);
        }
        self.graph
            .backward(parameters, maps, by_maps, gradient, scratch);
    }

    /// The four pixels of the fine map around a point, and their bilinear weights.
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

    /// Features of the fine map at points, bilinear.
    fn read(&self, fine: &[f32], points: &Points) -> Vec<f32> {
        let n = self.sizes.fine;
        let mut features = vec![0.0; points.len() * n];
        for (point, out) in points.iter().zip(features.chunks_exact_mut(n)) {
            for (pixel, weight) in self.corners(*point) {
                add_scaled(out, &fine[pixel * n..(pixel + 1) * n], weight);
            }
        }
        features
    }

    /// The transpose of [`Network::read`]: adds the features' gradients to the map's.
    fn read_back(&self, by_fine: &mut [f32], points: &Points, by_features: &[f32]) {
        let n = self.sizes.fine;
        for (point, by) in points.iter().zip(by_features.chunks_exact(n)) {
            for (pixel, weight) in self.corners(*point) {
                add_scaled(&mut by_fine[pixel * n..(pixel + 1) * n], by, weight);
            }
        }
    }
}
