//! Batch normalisation (Ioffe and Szegedy, ICML 2015) of every layer with a ReLU, over the tiles of
//! one part of a batch. A trained network has none: its factors go into weights and biases.
//!
//! What is done to a tile's map before and after a layer is done while the map is in the cache.

use super::layer::{Layer, Op};
use super::network::{Network, Work};

const EPSILON: f32 = 1e-5;

/// Mean and 1/deviation of each layer's sums by channel.
pub type Moments = Vec<[Vec<f32>; 2]>;

/// Place of each normalised layer's factors, behind the network's parameters; the end of all last.
pub fn places(network: &Network) -> Vec<usize> {
    let mut at = network.parameters;
    let mut all = vec![at];
    for l in &network.layers {
        at += if l.has_relu() { l.channels } else { 0 };
        all.push(at);
    }
    all
}

/// Maps of several tiles, and the moments that they were normalised by.
pub fn forward(network: &Network, p: &[f32], works: &mut [Work]) -> Moments {
    pulp::Arch::new().dispatch(Forward { network, p, works })
}

/// [`forward`], to be compiled for the processor's vectors.
struct Forward<'a> {
    network: &'a Network,
    p: &'a [f32],
    works: &'a mut [Work],
}

impl pulp::WithSimd for Forward<'_> {
    type Output = Moments;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Moments {
        let Forward { network, p, works } = self;
        let places = places(network);
        let mut all: Moments = vec![];
        for k in 0..=network.layers.len() {
            let mut sums = Sums::new(network.layers.get(k));
            for work in works.iter_mut() {
                if let Some(before) = k.checked_sub(1) {
                    let l = &network.layers[before];
                    normalise(l, before, p, places[before], &all[before], work);
                }
                if let Some(l) = network.layers.get(k) {
                    network.sums(k, p, work, l.op == Op::Head);
                    sums.add(l, &work.maps[k + 1]);
                }
            }
            if let Some(l) = network.layers.get(k) {
                all.push(sums.moments(works.len() * l.side * l.side));
            }
        }
        all
    }
}

/// Sums of values and of squares by channel; empty for layers that are not normalised.
struct Sums([Vec<f64>; 2]);

impl Sums {
    fn new(layer: Option<&Layer>) -> Sums {
        let channels = layer.filter(|l| l.has_relu()).map_or(0, |l| l.channels);
        Sums([vec![0.0; channels], vec![0.0; channels]])
    }

    #[inline(always)]
    fn add(&mut self, l: &Layer, map: &[f32]) {
        if !l.has_relu() {
            return;
        }
        let mut own = [vec![0.0f32; l.channels], vec![0.0f32; l.channels]];
        let [first, second] = &mut own;
        for pixel in map.chunks_exact(l.channels) {
            for ((a, b), v) in first.iter_mut().zip(&mut *second).zip(pixel) {
                *a += v;
                *b = v.mul_add(*v, *b);
            }
        }
        for (sum, own) in self.0.iter_mut().zip(&own) {
            sum.iter_mut()
                .zip(own)
                .for_each(|(s, v)| *s += f64::from(*v));
        }
    }

    fn moments(&self, count: usize) -> [Vec<f32>; 2] {
        let n = count as f64;
        let inverse = |(sum, squares): (&f64, &f64)| {
            let variance = (squares / n - (sum / n).powi(2)).max(0.0);
            1.0 / (variance as f32 + EPSILON).sqrt()
        };
        let [sums, squares] = &self.0;
        let mean = sums.iter().map(|v| (v / n) as f32).collect();
        [mean, sums.iter().zip(squares).map(inverse).collect()]
    }
}

/// Normalises a layer's sums in place, then its ReLU.
#[inline(always)]
fn normalise(
    l: &Layer,
    k: usize,
    p: &[f32],
    place: usize,
    [mean, inverse]: &[Vec<f32>; 2],
    work: &mut Work,
) {
    if !l.has_relu() {
        return;
    }
    let c = l.channels;
    let (factors, (_, biases)) = (&p[place..][..c], l.parameters(p));
    let (map, hats) = (&mut work.maps[k + 1], &mut work.hats[k]);
    hats.resize(map.len(), 0.0);
    let (mean, inverse, biases) = (&mean[..c], &inverse[..c], &biases[..c]);
    for (v, hat) in map.chunks_exact_mut(c).zip(hats.chunks_exact_mut(c)) {
        for i in 0..c {
            hat[i] = (v[i] - mean[i]) * inverse[i];
            v[i] = hat[i].mul_add(factors[i], biases[i]).max(0.0);
        }
    }
}

/// Adds the gradient of [`forward`], given that by the last maps.
pub fn backward(
    network: &Network,
    p: &[f32],
    works: &mut [Work],
    moments: &Moments,
    gradient: &mut [f32],
) {
    let last = network.layers.len();
    for work in works.iter_mut() {
        work.by_maps[..last].iter_mut().for_each(|m| m.fill(0.0));
    }
    pulp::Arch::new().dispatch(Backward {
        network,
        p,
        works,
        moments,
        gradient,
    });
}

/// [`backward`], to be compiled for the processor's vectors.
struct Backward<'a> {
    network: &'a Network,
    p: &'a [f32],
    works: &'a mut [Work],
    moments: &'a Moments,
    gradient: &'a mut [f32],
}

impl pulp::WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Backward {
            network,
            p,
            works,
            moments,
            gradient,
        } = self;
        let places = places(network);
        // Of the layer that comes next, backwards.
        let mut next = [vec![], vec![]];
        for (k, l) in network.layers.iter().enumerate().rev() {
            let [by_bias, by_factor] = std::mem::take(&mut next);
            let n = (works.len() * l.side * l.side) as f32;
            if l.has_relu() {
                add(l.parameters_mut(gradient).1, &by_bias);
                add(&mut gradient[places[k]..], &by_factor);
            }
            let before = k.checked_sub(1).map(|b| (b, &network.layers[b]));
            let before = before.filter(|(_, b)| b.has_relu());
            if let Some((_, b)) = before {
                next = [vec![0.0; b.channels], vec![0.0; b.channels]];
            }
            let factors = &p[places[k]..places[k + 1]];
            for work in works.iter_mut() {
                if l.has_relu() {
                    let sums = [&by_bias[..], &by_factor[..]];
                    by_normalised(l, k, factors, &moments[k][1], sums, n, work);
                }
                network.by_sums(k, p, work, gradient);
                if let Some((b, layer)) = before {
                    by_relu(layer, b, &mut next, work);
                }
            }
        }
    }
}

fn add(to: &mut [f32], from: &[f32]) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
}

/// The gradient before a ReLU, and its sums by channel, alone and times the normalised values.
#[inline(always)]
fn by_relu(l: &Layer, k: usize, sums: &mut [Vec<f32>; 2], work: &mut Work) {
    let c = l.channels;
    let [by_bias, by_factor] = sums;
    let (by_bias, by_factor) = (&mut by_bias[..c], &mut by_factor[..c]);
    let rows = work.by_maps[k + 1].chunks_exact_mut(c);
    let maps = work.maps[k + 1].chunks_exact(c);
    for ((by, map), hat) in rows.zip(maps).zip(work.hats[k].chunks_exact(c)) {
        for i in 0..c {
            by[i] = if map[i] > 0.0 { by[i] } else { 0.0 };
            by_bias[i] += by[i];
            by_factor[i] = by[i].mul_add(hat[i], by_factor[i]);
        }
    }
}

/// The gradient by a layer's sums, given that by what they are normalised to.
#[inline(always)]
fn by_normalised(
    l: &Layer,
    k: usize,
    factors: &[f32],
    inverse: &[f32],
    [by_bias, by_factor]: [&[f32]; 2],
    n: f32,
    work: &mut Work,
) {
    let c = l.channels;
    let scale: Vec<f32> = factors.iter().zip(inverse).map(|(f, s)| f * s).collect();
    let mean: Vec<f32> = by_bias.iter().map(|v| v / n).collect();
    let slope: Vec<f32> = by_factor.iter().map(|v| v / n).collect();
    let (scale, mean, slope) = (&scale[..c], &mean[..c], &slope[..c]);
    let rows = work.by_maps[k + 1].chunks_exact_mut(c);
    for (by, hat) in rows.zip(work.hats[k].chunks_exact(c)) {
        for i in 0..c {
            by[i] = scale[i] * (by[i] - mean[i] - hat[i] * slope[i]);
        }
    }
}

/// The parameters of the same network without normalisation.
pub fn folded(network: &Network, p: &[f32], moments: &Moments) -> Vec<f32> {
    let places = places(network);
    let mut all = p[..network.parameters].to_vec();
    for (k, l) in network
        .layers
        .iter()
        .enumerate()
        .filter(|(_, l)| l.has_relu())
    {
        let [mean, inverse] = &moments[k];
        let (weights, biases) = l.parameters_mut(&mut all);
        for i in 0..l.channels {
            let factor = p[places[k] + i] * inverse[i];
            let column = weights.iter_mut().skip(i).step_by(l.channels);
            column.for_each(|w| *w *= factor);
            biases[i] -= factor * mean[i];
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::options::rng_for;

    fn noise(k: usize) -> f32 {
        ((k * 7919 + 13) % 1009) as f32 / 504.5 - 1.0
    }

    fn loss(network: &Network, p: &[f32], works: &mut [Work]) -> f64 {
        forward(network, p, works);
        let lasts = works.iter().map(|w| w.maps.last().expect("maps"));
        let values = lasts.flatten().enumerate();
        values.map(|(k, v)| f64::from(v * noise(k + 99))).sum()
    }

    #[test]
    fn gradients_agree_with_finite_differences() {
        let network = Network::new([8, 16, 24], 1);
        let mut p = network.initial(&mut rng_for(1, 1, 1));
        p.resize(*places(&network).last().expect("places"), 1.0);
        let mut works = [network.work(), network.work()];
        for (t, work) in works.iter_mut().enumerate() {
            let map = work.maps[0].iter_mut().enumerate();
            map.for_each(|(k, v)| *v = noise(k + 31 * t) * (1.0 + t as f32));
        }
        let moments = forward(&network, &p, &mut works);
        for (t, work) in works.iter_mut().enumerate() {
            let by = work.by_maps.last_mut().expect("maps");
            let start = t * by.len() + 99;
            by.iter_mut()
                .enumerate()
                .for_each(|(k, v)| *v = noise(k + start));
        }
        let mut gradient = vec![0.0; p.len()];
        backward(&network, &p, &mut works, &moments, &mut gradient);
        let (mut wrong, mut tried) = (0, 0);
        for k in (0..p.len()).step_by(31) {
            // Small, because normalised sums near 0 cross the kink of the ReLU.
            let (kept, h) = (p[k], 1e-3);
            p[k] = kept + h;
            let above = loss(&network, &p, &mut works);
            p[k] = kept - h;
            let below = loss(&network, &p, &mut works);
            p[k] = kept;
            let slope = ((above - below) / (2.0 * f64::from(h))) as f32;
            wrong += usize::from((slope - gradient[k]).abs() > 0.05 * gradient[k].abs().max(1.0));
            tried += 1;
        }
        assert!(wrong * 20 <= tried, "{wrong} of {tried} slopes differ");
    }

    #[test]
    fn a_folded_network_gives_the_same_maps() {
        let network = Network::new([8, 16, 24], 1);
        let mut p = network.initial(&mut rng_for(1, 1, 1));
        p.resize(*places(&network).last().expect("places"), 0.7);
        let mut works = [network.work()];
        let map = works[0].maps[0].iter_mut().enumerate();
        map.for_each(|(k, v)| *v = noise(k));
        let moments = forward(&network, &p, &mut works);
        let wanted = works[0].maps.last().expect("maps").clone();
        network.forward(&folded(&network, &p, &moments), &mut works[0]);
        let found = works[0].maps.last().expect("maps");
        let differences = wanted.iter().zip(found).map(|(a, b)| (a - b).abs());
        let most = differences.fold(0.0, f32::max);
        assert!(most < 1e-3, "{most}");
    }
}
