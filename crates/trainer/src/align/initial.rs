//! A network's parameters before training.

use super::graph::{Graph, Maps, Node, Scratch};
use super::network::{Network, Points};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

impl Network {
    /// Random parameters, scaled on example crops so that every map has unit deviation; the first
    /// head's bias is `offset`.
    pub fn initial(&self, offset: &Points, crops: &[Vec<f32>], rng: &mut ChaCha8Rng) -> Vec<f32> {
        let mut parameters = vec![0.0f32; self.parameters];
        let mut fill = |values: &mut [f32], bound: f32| {
            values
                .iter_mut()
                .for_each(|w| *w = rng.random_range(-bound..bound));
        };
        for node in self.graph.nodes.iter().filter(|n| n.weights > 0) {
            let inputs = node.weights as f32 / node.dims[2] as f32;
            let (weights, _) = node.parameters_mut(&mut parameters);
            fill(weights, (3.0 / inputs).sqrt());
        }
        for (k, head) in self.heads.iter().enumerate() {
            let bound = |n: usize| 1.0 / (n as f32).sqrt();
            let [project, _, expand, outer] = head.split_mut(&mut parameters);
            fill(project, bound(head.inputs));
            fill(expand, bound(head.rank));
            if k == 0 {
                outer.copy_from_slice(offset.as_flattened());
            }
        }
        normalise(&self.graph, &mut parameters, crops);
        parameters
    }
}

/// Layer by layer, scales weights and sets biases so that outputs before ReLU have mean 0 and
/// deviation 1 on these crops.
fn normalise(graph: &Graph, parameters: &mut [f32], crops: &[Vec<f32>]) {
    let mut maps: Vec<Maps> = crops
        .iter()
        .map(|crop| {
            let mut maps = graph.maps();
            maps[0].copy_from_slice(crop);
            maps
        })
        .collect();
    let mut scratch = Scratch::default();
    for (index, node) in graph.nodes.iter().enumerate().skip(1) {
        if node.weights > 0 {
            for maps in &mut maps {
                graph.forward_node(index, parameters, maps, &mut scratch, false);
            }
            normalise_node(node, parameters, maps.iter().map(|maps| &maps[index][..]));
        }
        for maps in &mut maps {
            graph.forward_node(index, parameters, maps, &mut scratch, true);
        }
    }
}

/// The same for one node with these outputs.
fn normalise_node<'a>(
    node: &Node,
    parameters: &mut [f32],
    outputs: impl Iterator<Item = &'a [f32]>,
) {
    let channels = node.dims[2];
    let (mut sums, mut squares) = (vec![0.0f64; channels], vec![0.0f64; channels]);
    let mut count = 0.0;
    for values in outputs.flat_map(|map| map.chunks_exact(channels)) {
        count += 1.0;
        for (k, v) in values.iter().enumerate() {
            sums[k] += *v as f64;
            squares[k] += (*v as f64).powi(2);
        }
    }
    let (weights, biases) = node.parameters_mut(parameters);
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
