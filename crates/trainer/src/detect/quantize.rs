//! Writes section `DTCT`, in the order in which `posewise::detect::DetectorModel` reads it: the
//! parameters in `f32` become integers.

use super::equalise::quantile;
use super::layer::{ADDEND_BACK, FIRST_KERNEL, OUTPUTS, Op};
use super::network::Network;
use super::options::Options;
use super::tile::{MIDDLE_SIZE, UNITS, standardise};
use crate::places::{Use, places};
use crate::quantized_layer::{INPUT_SCALE, INPUT_ZERO, Order, QuantizedLayer, fixed, write_header};
use anyhow::Result;
use posewise::detect::{TAG, TILE};
use posewise::network::{OP_ADD, OP_CONV, OP_DEPTHWISE, OP_INPUT, OP_LINEAR};
use posewise_format::SectionWriter;

/// Largest magnitude of each output: logit, and the others in [`UNITS`].
const RANGE: [f32; OUTPUTS] = [12.0, 1.6, 1.6, 2.0, 2.0, 2.0, 1.0, 1.0];
/// The outputs are 128 at 0 and use this much to either side.
const OUTPUT_STEPS: f32 = 127.0;

/// The section; the tiles show how large the maps' values grow.
pub fn section(
    network: &Network,
    p: &[f32],
    tiles: &[Vec<u8>],
    options: &Options,
) -> Result<SectionWriter> {
    let unit = output_unit;
    let logit = (options.threshold / (1.0 - options.threshold)).ln();
    let mut out = SectionWriter::new(TAG);
    out.scalar((256.0 * options.smallest) as u32);
    out.scalar((256.0 * options.largest) as u32);
    out.scalar(options.overlap);
    out.scalar((128.0 + logit / unit(0)).round() as u32);
    let units = UNITS.iter().enumerate().map(|(k, u)| u * unit(k + 1));
    out.array(&[unit(0)].into_iter().chain(units).collect::<Vec<_>>());
    out.scalar(MIDDLE_SIZE);
    write_network(network, p, tiles, &mut out)?;
    Ok(out)
}

/// The value of a unit of an output.
pub fn output_unit(output: usize) -> f32 {
    RANGE[output] / OUTPUT_STEPS
}

fn write_network(
    network: &Network,
    p: &[f32],
    tiles: &[Vec<u8>],
    out: &mut SectionWriter,
) -> Result<()> {
    let scales = scales(network, p, tiles);
    let places = places(&uses(network))?;
    out.scalar(network.layers.len() as u32 + 1);
    let at = places[0] as u32;
    write_header([u32::from(OP_INPUT), 1, 1, 0, 0, 1, at, 0, 0, 1], out);
    out.array::<i8>(&[]).array::<i32>(&[]).array::<i32>(&[]);
    for (k, l) in network.layers.iter().enumerate() {
        let (op, kernel, stride, other) = match l.op {
            Op::First => (OP_CONV, FIRST_KERNEL, 2, 0),
            Op::Depthwise { stride } => (OP_DEPTHWISE, 3, stride, 0),
            Op::Pointwise => (OP_CONV, 1, 1, 0),
            Op::Head => (OP_LINEAR, 1, 1, 0),
            Op::Add => (OP_ADD, 1, 1, k - ADDEND_BACK),
        };
        let zero = if k == 0 { INPUT_ZERO } else { 0 };
        let head = |before: u32, after: u32| {
            let v = [kernel, stride, k, other, l.channels, places[k + 1]].map(|v| v as u32);
            [
                u32::from(op),
                v[0],
                v[1],
                v[2],
                v[3],
                v[4],
                v[5],
                zero,
                before,
                after,
            ]
        };
        if l.op == Op::Add {
            let shares = [k, k - ADDEND_BACK].map(|m| scales[m] / scales[k + 1]);
            let (factors, after) = fixed(&shares);
            write_header(head(0, after), out);
            out.array::<i8>(&[]).array(&[0i32; 2]).array(&factors);
            continue;
        }
        let to = match l.op {
            Op::Head => RANGE.map(|r| r / OUTPUT_STEPS).to_vec(),
            _ => vec![scales[k + 1]; l.channels],
        };
        let order = match l.op {
            Op::Depthwise { .. } => Order::Plain,
            _ => Order::Interleaved,
        };
        let (weights, biases) = l.parameters(p);
        let layer = QuantizedLayer::new(weights, biases, order, scales[k], &to);
        write_header(head(layer.pre_shift, layer.post_shift), out);
        layer.write(out);
    }
    Ok(())
}

/// The value of one unit of each map's bytes.
fn scales(network: &Network, p: &[f32], tiles: &[Vec<u8>]) -> Vec<f32> {
    let mut work = network.work();
    let mut largest = vec![vec![]; network.layers.len() + 1];
    for tile in tiles {
        standardise(tile, &mut work.maps[0]);
        network.forward(p, &mut work);
        for (largest, map) in largest.iter_mut().zip(&work.maps) {
            largest.push(map.iter().fold(0.0f32, |m, v| m.max(*v)));
        }
    }
    let mut scales: Vec<f32> = largest.into_iter().map(|v| quantile(v) / 255.0).collect();
    scales[0] = INPUT_SCALE;
    scales
}

/// Use of every map: a layer reads the one before, a sum one of an earlier layer too.
fn uses(network: &Network) -> Vec<Use> {
    let layers = &network.layers;
    let mut uses = vec![Use {
        bytes: TILE * TILE,
        last: 1,
        replaces: None,
    }];
    uses.extend(layers.iter().enumerate().map(|(k, l)| Use {
        bytes: l.side.pow(2) * l.channels,
        last: k + 2,
        replaces: (l.op == Op::Add).then_some(k),
    }));
    for (k, _) in layers.iter().enumerate().filter(|(_, l)| l.op == Op::Add) {
        uses[k - ADDEND_BACK].last = k + 1;
    }
    uses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::options::rng_for;
    use posewise::detect::DetectorModel;
    use posewise::image::{Crop, Frame, FrameLayout, reduce};
    use posewise::network::{Activations, Network as Integer};
    use posewise_format::{AlignedBytes, Blob, blob};

    #[test]
    fn the_integer_network_answers_as_the_float_one() {
        let options = Options::default();
        let network = Network::new(options.channels, options.depth);
        let p = network.initial(&mut rng_for(5, 1, 1));
        let noise = |k: usize, t: usize| (k * 7919 / (7 + t) % 251) as u8;
        let tile = |t: usize| (0..TILE * TILE).map(|k| noise(k, t)).collect();
        let tiles: Vec<Vec<u8>> = (0..6).map(tile).collect();
        let section = section(&network, &p, &tiles, &options).unwrap();
        let bytes = AlignedBytes::new(&blob(&[section]));
        let blob = Blob::open(&bytes).unwrap();
        let model = DetectorModel::open(blob.section(&TAG).unwrap()).unwrap();
        // The core counts a weight of 0 that pads the first layer.
        let more = model.multiply_adds() - network.multiply_adds();
        assert_eq!(more, 64 * 64 * options.channels[0]);
        // The same with the network alone, behind the numbers before it.
        let mut s = blob.section(&TAG).unwrap();
        (0..4).for_each(|_| assert!(s.u32().unwrap() > 0));
        s.f32s(6).unwrap();
        s.f32().unwrap();
        let integer = Integer::read(&mut s, TILE).unwrap();
        let (mut crop, mut maps) = (Box::new(Crop::new()), Box::new(Activations::new()));
        let frame = Frame::new(&FrameLayout::grey(TILE as u32, TILE as u32), &tiles[0]).unwrap();
        reduce(&frame, [0, 0], 256, TILE, &mut crop);
        crop.standardise();
        integer.run(&crop, &mut maps);
        let mut work = network.work();
        standardise(&tiles[0], &mut work.maps[0]);
        network.forward(&p, &mut work);
        let expected = work.maps.last().expect("maps");
        let found = maps.values(&integer.output());
        let errors = expected.iter().zip(found).enumerate().map(|(k, (e, f))| {
            (e - (f32::from(*f) - 128.0) * RANGE[k % OUTPUTS] / OUTPUT_STEPS).abs()
        });
        let mean = errors.sum::<f32>() / found.len() as f32;
        assert!(mean < 0.1, "{mean}");
    }
}
