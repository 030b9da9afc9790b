//! Writes trained networks as sections: parameters in `f32` become integers.

use super::graph::{Op, Scratch};
use super::head::Head;
use super::network::Network;
use super::rank::reduce_rank;
use super::samples::Sample;
use super::starts::StartShapes;
use super::train::Trained;
use crate::places::{Use, places};
use crate::quantized_layer::{INPUT_SCALE, INPUT_ZERO, Order, QuantizedLayer, fixed, write_header};
use anyhow::{Result, ensure};
use posewise::align::{AlignModel, EnsembleMember, SHAPE_INDEXED, Shape};
use posewise::network::{OP_ADD, OP_CONV, OP_DEPTHWISE, OP_INPUT, OP_LATERAL, OP_LINEAR};
use posewise_format::SectionWriter;

/// Share of example crops on which no value of a map is clipped.
const UNCLIPPED: f32 = 0.98;

/// Section `ALGN`, as [`AlignModel::open`] reads it; the samples give the maps' ranges
/// and the principal components of the heads' outputs.
pub fn face_section(
    trained: &Trained,
    mean: &Shape,
    starts: &StartShapes,
    iterations: usize,
    samples: &[Sample],
) -> Result<SectionWriter> {
    let mut out = SectionWriter::new(AlignModel::TAG);
    out.scalar(starts.turns.len() as u32)
        .scalar(iterations as u32);
    let flat = |shape: &Shape| shape.iter().flatten().copied().collect::<Vec<f32>>();
    out.array(&flat(mean));
    out.array(&starts.shapes.iter().flat_map(flat).collect::<Vec<_>>());
    out.array(&starts.turns);
    write_regressor(trained, samples, &mut out)?;
    Ok(out)
}

/// Section `ENSM`, as [`posewise::align::EnsembleMember::open`] reads it.
pub fn ensemble_section(trained: &Trained, samples: &[Sample]) -> Result<SectionWriter> {
    let mut out = SectionWriter::new(EnsembleMember::TAG);
    write_regressor(trained, samples, &mut out)?;
    Ok(out)
}

/// A refiner of section `RFIN`, as [`posewise::align::Refiners::open`] reads it.
pub fn write_refiner(
    trained: &Trained,
    landmarks: &[usize],
    mirrored: bool,
    samples: &[Sample],
    out: &mut SectionWriter,
) -> Result<()> {
    out.scalar(landmarks.len() as u32)
        .scalar(u32::from(mirrored));
    out.array(&landmarks.iter().map(|k| *k as u32).collect::<Vec<_>>());
    write_regressor(trained, samples, out)
}

/// A regressor by itself.
pub fn write_regressor(
    trained: &Trained,
    samples: &[Sample],
    out: &mut SectionWriter,
) -> Result<()> {
    let Trained {
        network,
        parameters,
    } = &reduce_rank(trained, samples);
    let sizes = &network.sizes;
    out.scalar(sizes.side as u32).scalar(sizes.zoom);
    out.scalar(network.fine as u32).scalar(network.last as u32);
    out.scalar(network.heads.len() as u32)
        .scalar(sizes.rank as u32);
    let scales = scales(network, parameters, samples);
    let places = places(&uses(network)?)?;
    out.scalar(network.graph.nodes.len() as u32);
    for index in 0..network.graph.nodes.len() {
        write_node(network, parameters, &scales, &places, index, out);
    }
    for head in &network.heads {
        let local = if head.reads & SHAPE_INDEXED != 0 {
            sizes.points * sizes.fine
        } else {
            0
        };
        let scale_of = |k: usize| {
            scales[if k < local {
                network.fine
            } else {
                network.last
            }]
        };
        write_head(head, parameters, scale_of, out);
    }
    Ok(())
}

/// The value of one unit of each map's bytes.
fn scales(network: &Network, parameters: &[f32], samples: &[Sample]) -> Vec<f32> {
    let graph = &network.graph;
    let mut maps = graph.maps();
    let mut scratch = Scratch::default();
    let mut largest = vec![Vec::with_capacity(samples.len()); graph.nodes.len()];
    for sample in samples {
        maps[0].copy_from_slice(&sample.crop);
        graph.forward(parameters, &mut maps, &mut scratch);
        for (largest, map) in largest.iter_mut().zip(&maps) {
            largest.push(map.iter().fold(0.0f32, |m, v| m.max(*v)));
        }
    }
    let mut scales: Vec<f32> = largest
        .iter_mut()
        .map(|values| {
            values.sort_by(f32::total_cmp);
            let at = (values.len() as f32 * UNCLIPPED) as usize;
            values[at.min(values.len() - 1)].max(1e-6) / 255.0
        })
        .collect();
    scales[0] = INPUT_SCALE;
    // A lateral sum adds its second map in units of twice its own.
    for (index, node) in graph.nodes.iter().enumerate() {
        if node.op == Op::Lateral {
            scales[node.other] = 2.0 * scales[index];
        }
    }
    scales
}

/// Use of every map. The fine and the last one are read by the heads.
fn uses(network: &Network) -> Result<Vec<Use>> {
    let nodes = &network.graph.nodes;
    let mut last_use: Vec<usize> = (0..nodes.len()).collect();
    for (index, node) in nodes.iter().enumerate().skip(1) {
        last_use[node.input] = index;
        if matches!(node.op, Op::Add | Op::Lateral) {
            last_use[node.other] = index;
        }
    }
    for kept in [network.fine, network.last] {
        last_use[kept] = nodes.len();
    }
    let uses = nodes.iter().enumerate().map(|(index, node)| {
        let replaces = (node.op == Op::Add).then_some(node.input);
        ensure!(
            replaces.is_none_or(|input| last_use[input] == index),
            "an input of a sum is read again later"
        );
        Ok(Use {
            bytes: node.dims.iter().product(),
            last: last_use[index],
            replaces,
        })
    });
    uses.collect()
}

fn write_node(
    network: &Network,
    parameters: &[f32],
    scales: &[f32],
    places: &[usize],
    index: usize,
    out: &mut SectionWriter,
) {
    let node = &network.graph.nodes[index];
    let channels = node.dims[2];
    let (op, kernel, stride) = match node.op {
        Op::Input => (OP_INPUT, 1, 1),
        Op::Conv { kernel, stride } => (OP_CONV, kernel, stride),
        Op::Depthwise { stride } => (OP_DEPTHWISE, 3, stride),
        Op::Add => (OP_ADD, 1, 1),
        Op::Lateral => (OP_LATERAL, 1, 1),
        Op::Linear => (OP_LINEAR, 1, 1),
    };
    let zero = if node.input == 0 && index > 0 {
        INPUT_ZERO
    } else {
        0
    };
    let numbers = [
        kernel,
        stride,
        node.input,
        node.other,
        channels,
        places[index],
    ];
    let [kernel, stride, input, other, channels, at] = numbers.map(|v| v as u32);
    let header = |out: &mut SectionWriter, before: u32, after: u32| {
        let op = u32::from(op);
        let numbers = [
            op, kernel, stride, input, other, channels, at, zero, before, after,
        ];
        write_header(numbers, out);
    };
    match node.op {
        Op::Input => {
            header(out, 0, 1);
            out.array::<i8>(&[]).array::<i32>(&[]).array::<i32>(&[]);
        }
        Op::Add => {
            let shares = [node.input, node.other].map(|k| scales[k] / scales[index]);
            let (factors, after) = fixed(&shares);
            header(out, 0, after);
            out.array::<i8>(&[]).array(&[0i32; 2]).array(&factors);
        }
        _ => {
            let order = match node.op {
                Op::Depthwise { .. } => Order::Plain,
                _ => Order::Interleaved,
            };
            let own = &parameters[node.at..][..node.weights + node.dims[2]];
            let (weights, biases) = own.split_at(node.weights);
            let to = vec![scales[index]; biases.len()];
            let layer = QuantizedLayer::new(weights, biases, order, scales[node.input], &to);
            header(out, layer.pre_shift, layer.post_shift);
            layer.write(out);
        }
    }
}

fn write_head(
    head: &Head,
    parameters: &[f32],
    scale_of: impl Fn(usize) -> f32,
    out: &mut SectionWriter,
) {
    let [project, inner, expand, outer] = head.split(parameters);
    let (mut weights, mut scale) = (vec![], vec![]);
    let (mut rows, mut row_scale) = (vec![], vec![]);
    let to_bytes = |values: &[f32], bytes: &mut Vec<i8>| {
        let step = values.iter().fold(1e-9f32, |m, v| m.max(v.abs())) / 127.0;
        bytes.extend(values.iter().map(|v| (v / step).round() as i8));
        step
    };
    for (k, row) in project.chunks_exact(head.inputs).enumerate() {
        let row: Vec<f32> = row
            .iter()
            .enumerate()
            .map(|(i, w)| w * scale_of(i))
            .collect();
        scale.push(to_bytes(&row, &mut weights));
        let column: Vec<f32> = (0..head.outputs)
            .map(|i| expand[i * head.rank + k])
            .collect();
        row_scale.push(to_bytes(&column, &mut rows));
    }
    out.scalar(head.reads);
    out.array(&weights).array(&scale).array(inner);
    out.array(&rows).array(&row_scale).array(outer);
}
