//! Networks of a finished model as the parameters of a training that goes on.

use super::graph::Op;
use super::network::{Network, Sizes};
use crate::dequantized::{UnitLayer, Units, read_layer};
use crate::quantized_layer::Order;
use anyhow::{Result, ensure};
use posewise::align::SHAPE_INDEXED;
use posewise_format::Section;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The parameters of a regressor that [`write_regressor`](super::write_regressor) wrote, for a
/// network whose heads may have a higher rank: their further dimensions read the features at random
/// and move nothing yet.
pub fn parameters(s: &mut Section<'_>, sizes: &Sizes, seed: u64) -> Result<Vec<f32>> {
    let network = Network::new(sizes);
    let side = s.u32()? as usize;
    let zoom = s.f32()?;
    ensure!(side == sizes.side && zoom == sizes.zoom, "another crop");
    let maps = [s.u32()? as usize, s.u32()? as usize];
    let [heads, rank] = [s.u32()? as usize, s.u32()? as usize];
    let nodes = s.u32()? as usize;
    let same = maps == [network.fine, network.last]
        && heads == network.heads.len()
        && rank <= sizes.rank
        && nodes == network.graph.nodes.len();
    ensure!(same, "another network");
    let mut parameters = vec![0.0; network.parameters];
    let units = trunk(s, &network, &mut parameters)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for k in 0..heads {
        head(s, &network, k, rank, &units, &mut parameters, &mut rng)?;
    }
    Ok(parameters)
}

/// Reads the nodes; returns the values of a unit of each map.
fn trunk(s: &mut Section<'_>, network: &Network, parameters: &mut [f32]) -> Result<Units> {
    let nodes = &network.graph.nodes;
    let mut units = Units::new(nodes.len());
    let mut layers: Vec<UnitLayer> = vec![];
    for (index, node) in nodes.iter().enumerate() {
        let channels = node.dims[2];
        let layer = match node.op {
            Op::Input => read_layer(s, 0, 0, Order::Plain),
            Op::Add => read_layer(s, 0, 2, Order::Plain),
            Op::Depthwise { .. } => read_layer(s, 9, channels, Order::Plain),
            _ => read_layer(s, node.weights / channels, channels, Order::Interleaved),
        }?;
        match node.op {
            Op::Add => {
                units.tie(index, 1.0 / layer.shares[1], node.other);
                units.tie(node.input, layer.shares[0], index);
            }
            // As the writer has it.
            Op::Lateral => units.tie(node.other, 2.0, index),
            _ => {}
        }
        layers.push(layer);
    }
    for (index, (node, layer)) in nodes.iter().zip(&layers).enumerate() {
        if node.weights > 0 {
            let (weights, biases) = layer.values(units.of(node.input), |_| units.of(index));
            let own = node.parameters_mut(parameters);
            own.0.copy_from_slice(&weights);
            own.1.copy_from_slice(&biases);
        }
    }
    Ok(units)
}

/// Reads a head into the first dimensions of the network's.
fn head(
    s: &mut Section<'_>,
    network: &Network,
    k: usize,
    rank: usize,
    units: &Units,
    parameters: &mut [f32],
    rng: &mut ChaCha8Rng,
) -> Result<()> {
    let head = &network.heads[k];
    let local = match head.reads & SHAPE_INDEXED {
        0 => 0,
        _ => network.sizes.points * network.sizes.fine,
    };
    let unit = |i: usize| {
        units.of(if i < local {
            network.fine
        } else {
            network.last
        })
    };
    ensure!(s.u32()? == head.reads, "another head");
    let (weights, scale) = (s.i8s(rank * head.inputs)?, s.f32s(rank)?);
    let (bias, rows) = (s.f32s(rank)?, s.i8s(rank * head.outputs)?);
    let (row_scale, offset) = (s.f32s(rank)?, s.f32s(head.outputs)?);
    let bound = 1.0 / (head.inputs as f32).sqrt();
    let [project, inner, expand, outer] = head.split_mut(parameters);
    for (r, row) in project.chunks_exact_mut(head.inputs).enumerate() {
        for (i, slot) in row.iter_mut().enumerate() {
            *slot = match scale.get(r) {
                Some(scale) => f32::from(weights[r * head.inputs + i]) * scale / unit(i),
                None => rng.random_range(-bound..bound),
            };
        }
    }
    inner[..rank].copy_from_slice(bias);
    for (i, row) in expand.chunks_exact_mut(head.rank).enumerate() {
        for (r, slot) in row.iter_mut().take(rank).enumerate() {
            *slot = f32::from(rows[r * head.outputs + i]) * row_scale[r];
        }
    }
    outer.copy_from_slice(offset);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::quantize::write_regressor;
    use super::super::samples::Sample;
    use super::super::train::Trained;
    use super::*;
    use crate::align::graph::Scratch;
    use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

    #[test]
    fn a_network_goes_on_from_its_section() {
        let sizes = Sizes::of_refiner(6, 24, 1.0);
        let network = Network::new(&sizes);
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let samples: Vec<Sample> = (0..60)
            .map(|_| Sample {
                crop: (0..24 * 24).map(|_| rng.random_range(-1.5..1.5)).collect(),
                start: vec![[1.0, -2.0]; 6],
                truth: vec![[0.0; 2]; 6],
                weights: vec![1.0; 6],
            })
            .collect();
        let crops: Vec<_> = samples.iter().map(|s| s.crop.clone()).collect();
        let parameters = network.initial(&vec![[1.0, 2.0]; 6], &crops, &mut rng);
        let before = Trained {
            network,
            parameters,
        };
        let mut out = SectionWriter::new(*b"TEST");
        write_regressor(&before, &samples, &mut out).unwrap();
        let bytes = AlignedBytes::new(&blob(&[out]));
        let blob = Blob::open(&bytes).unwrap();
        let mut s = blob.section(b"TEST").unwrap();
        let after = Trained {
            network: before.network.clone(),
            parameters: super::parameters(&mut s, &sizes, 1).unwrap(),
        };
        let mut moved = 0.0f32;
        let mut most = 0.0f32;
        for sample in &samples {
            let [a, b] = [&before, &after].map(|t| {
                let mut maps = t.network.graph.maps();
                maps[0].copy_from_slice(&sample.crop);
                let (p, mut scratch) = (&t.parameters, Scratch::default());
                let still = || [0.0; 2];
                let network = &t.network;
                network
                    .forward(p, &mut maps, &mut scratch, &sample.start, still)
                    .shapes
            });
            for ((a, b), start) in a[1].iter().zip(&b[1]).zip(&sample.start) {
                most = most.max((a[0] - b[0]).hypot(a[1] - b[1]));
                moved = moved.max((a[0] - start[0]).hypot(a[1] - start[1]));
            }
        }
        assert!(most < 0.1 * moved, "{most} of {moved}");
    }
}
