//! Brings the channels of a trained network to equal ranges, which changes nothing in `f32`: a ReLU
//! may be scaled before or after it. All channels of a map are rounded with one unit, so a channel
//! of small values would keep few levels.

use super::layer::{ADDEND_BACK, Op};
use super::network::Network;
use super::tile::standardise;

/// Quantile of a channel's largest values over tiles that counts as its range.
pub const UNCLIPPED: f32 = 0.98;
/// Largest factor of a channel: one that is hardly ever active need not fill the range.
const MOST: f32 = 16.0;

/// The same network with channels of equal ranges on these tiles.
pub fn equalised(network: &Network, p: &[f32], tiles: &[Vec<u8>]) -> Vec<f32> {
    let ranges = ranges(network, p, tiles);
    let factors = factors(network, &ranges);
    let mut out = p.to_vec();
    for (k, l) in network
        .layers
        .iter()
        .enumerate()
        .filter(|(_, l)| l.weights > 0)
    {
        let (weights, biases) = l.parameters_mut(&mut out);
        let (from, to) = (&factors[k], &factors[k + 1]);
        let is_depthwise = matches!(l.op, Op::Depthwise { .. });
        for (row, weights) in weights.chunks_exact_mut(l.channels).enumerate() {
            for (c, w) in weights.iter_mut().enumerate() {
                let input = match l.op {
                    Op::First => 1.0,
                    _ if is_depthwise => from[c],
                    _ => from[row],
                };
                *w *= to[c] / input;
            }
        }
        biases.iter_mut().zip(to).for_each(|(b, f)| *b *= f);
    }
    out
}

/// Range of each channel of each map.
fn ranges(network: &Network, p: &[f32], tiles: &[Vec<u8>]) -> Vec<Vec<f32>> {
    let mut work = network.work();
    let channels = |map: usize| map.checked_sub(1).map_or(1, |k| network.layers[k].channels);
    let maps = network.layers.len() + 1;
    let mut largest: Vec<Vec<Vec<f32>>> = (0..maps).map(|m| vec![vec![]; channels(m)]).collect();
    for tile in tiles {
        standardise(tile, &mut work.maps[0]);
        network.forward(p, &mut work);
        for (largest, map) in largest.iter_mut().zip(&work.maps) {
            let count = largest.len();
            for (c, largest) in largest.iter_mut().enumerate() {
                let values = map.iter().skip(c).step_by(count);
                largest.push(values.fold(0.0, |m: f32, v| m.max(*v)));
            }
        }
    }
    let quantiles = |channels: Vec<Vec<f32>>| channels.into_iter().map(quantile).collect();
    largest.into_iter().map(quantiles).collect()
}

/// The value that a share of [`UNCLIPPED`] of these does not exceed.
pub fn quantile(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    let at = (values.len() as f32 * UNCLIPPED) as usize;
    values[at.min(values.len() - 1)].max(1e-6)
}

/// Factor of each channel of each map; 1 for the tile and the outputs. Maps that are added to each
/// other have the same.
fn factors(network: &Network, ranges: &[Vec<f32>]) -> Vec<Vec<f32>> {
    // Maps that are added up are a group, named by its first map. Any other map is its own group.
    let mut group: Vec<usize> = (0..ranges.len()).collect();
    for (k, l) in network
        .layers
        .iter()
        .enumerate()
        .filter(|(_, l)| l.op == Op::Add)
    {
        let added_to = group[k - ADDEND_BACK];
        debug_assert_eq!(l.channels, ranges[added_to].len());
        (group[k], group[k + 1]) = (added_to, added_to);
    }
    let outputs = ranges.len() - 1;
    (0..ranges.len())
        .map(|map| {
            if map == 0 || map == outputs {
                return vec![1.0; ranges[map].len()];
            }
            let maps = || (0..ranges.len()).filter(|m| group[*m] == group[map]);
            let range = |c: usize| maps().map(|m| ranges[m][c]).fold(1e-6, f32::max);
            let of_group: Vec<f32> = (0..ranges[map].len()).map(range).collect();
            let widest = of_group.iter().copied().fold(0.0, f32::max);
            of_group.iter().map(|v| (widest / v).min(MOST)).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::options::rng_for;

    #[test]
    fn nothing_changes_but_the_ranges() {
        let network = Network::new([8, 16, 24], 2);
        let mut p = network.initial(&mut rng_for(3, 1, 1));
        // One channel of the first map is small.
        let (weights, _) = network.layers[0].parameters_mut(&mut p);
        weights.iter_mut().step_by(8).for_each(|w| *w *= 0.1);
        let noise = |k: usize| (k * 7919 % 251) as u8;
        let tiles: Vec<Vec<u8>> = (0..3)
            .map(|t| (0..128 * 128).map(|k| noise(k * (t + 1) / 9)).collect())
            .collect();
        let mut work = network.work();
        standardise(&tiles[0], &mut work.maps[0]);
        network.forward(&p, &mut work);
        let before = work.maps.last().expect("maps").clone();
        let equal = equalised(&network, &p, &tiles);
        network.forward(&equal, &mut work);
        let after = work.maps.last().expect("maps");
        let most = before
            .iter()
            .zip(after)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(most < 1e-3, "{most}");
        let spread = |p: &[f32]| {
            let own = &ranges(&network, p, &tiles)[1];
            let (low, high) = own
                .iter()
                .fold((f32::MAX, 0.0f32), |(l, h), v| (l.min(*v), h.max(*v)));
            high / low
        };
        assert!(
            spread(&equal) < 0.5 * spread(&p),
            "{} {}",
            spread(&equal),
            spread(&p)
        );
    }
}
