//! The network of a finished model as the parameters of a training that goes on.

use super::layer::{ADDEND_BACK, FIRST_KERNEL, Op};
use super::network::Network;
use super::quantize::output_unit;
use crate::dequantized::{UnitLayer, Units, read_layer};
use crate::quantized_layer::Order;
use anyhow::{Result, ensure};
use posewise_format::Section;

/// Numbers before the network: sizes, overlap, threshold; units of the outputs; the middle size.
const NUMBERS: usize = 4;
const OUTPUTS_READ: usize = 6;

/// The parameters of a section that [`section`](super::quantize::section) wrote, without
/// normalisation.
pub fn parameters(s: &mut Section<'_>, network: &Network) -> Result<Vec<f32>> {
    for _ in 0..NUMBERS {
        s.u32()?;
    }
    s.f32s(OUTPUTS_READ)?;
    s.f32()?;
    let count = s.u32()? as usize;
    ensure!(count == network.layers.len() + 1, "another network");
    read_layer(s, 0, 0, Order::Plain)?;
    let mut units = Units::new(count);
    let mut layers: Vec<UnitLayer> = vec![];
    // Layer k reads map k and makes map k + 1.
    for (k, l) in network.layers.iter().enumerate() {
        let layer = match l.op {
            Op::First => read_layer(
                s,
                FIRST_KERNEL * FIRST_KERNEL,
                l.channels,
                Order::Interleaved,
            ),
            Op::Depthwise { .. } => read_layer(s, 9, l.channels, Order::Plain),
            Op::Pointwise | Op::Head => read_layer(s, l.inputs, l.channels, Order::Interleaved),
            Op::Add => read_layer(s, 0, 2, Order::Plain),
        }?;
        if l.op == Op::Add {
            units.tie(k + 1, 1.0 / layer.shares[1], k - ADDEND_BACK);
            units.tie(k, layer.shares[0], k + 1);
        }
        layers.push(layer);
    }
    let mut parameters = vec![0.0; network.parameters];
    for (k, (l, layer)) in network.layers.iter().zip(&layers).enumerate() {
        if l.weights == 0 {
            continue;
        }
        let (weights, biases) = layer.values(units.of(k), |c| match l.op {
            Op::Head => output_unit(c),
            _ => units.of(k + 1),
        });
        let own = l.parameters_mut(&mut parameters);
        own.0.copy_from_slice(&weights);
        own.1.copy_from_slice(&biases);
    }
    Ok(parameters)
}
