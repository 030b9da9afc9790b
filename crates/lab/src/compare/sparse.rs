//! Sparse reconstruction (thesis 3.3): each landmark has a codebook of descriptors at it and beside
//! it. Orthogonal matching pursuit writes a descriptor as a combination of a few of them; the
//! energy is what the ones at the landmark leave of it.

use super::scorer::LocalModel;
use super::synthesis::{POINTS, Sample};
use nalgebra::{DMatrix, DVector};

/// Descriptors of each kind in a codebook.
const CODES: usize = 50;
/// Most codes in a combination.
const MOST: usize = 6;
/// Squared residual at which the combination is good enough, of a descriptor of length 1.
const ENOUGH: f64 = 0.02;

/// Codebooks of all landmarks.
pub struct Sparse {
    points: Vec<Option<Codebook>>,
}

struct Codebook {
    /// Columns of unit length, those at the landmark first.
    codes: DMatrix<f64>,
    /// How many of them are at the landmark.
    positives: usize,
    /// codesᵀ·codes.
    gram: DMatrix<f64>,
}

impl Codebook {
    fn new(positives: &[&Vec<f32>], negatives: &[&Vec<f32>]) -> Option<Codebook> {
        if positives.is_empty() || negatives.is_empty() {
            return None;
        }
        let (positives, negatives) = (evenly(positives), evenly(negatives));
        let columns: Vec<DVector<f64>> = positives
            .iter()
            .chain(&negatives)
            .map(|code| {
                let numbers = code.iter().map(|v| f64::from(*v));
                let column = DVector::from_iterator(code.len(), numbers);
                let length = column.norm().max(1e-6);
                column / length
            })
            .collect();
        let codes = DMatrix::from_columns(&columns);
        Some(Codebook {
            gram: codes.tr_mul(&codes),
            codes,
            positives: positives.len(),
        })
    }

    /// Codes and their weights, by orthogonal matching pursuit (Pati et al. 1993) on the Gram
    /// matrix.
    fn combination(&self, descriptor: &DVector<f64>) -> Vec<(usize, f64)> {
        let products = self.codes.tr_mul(descriptor);
        let energy = descriptor.norm_squared();
        let mut chosen: Vec<usize> = Vec::new();
        let mut weights = DVector::zeros(0);
        while chosen.len() < MOST {
            let residual = |code: usize| {
                let explained = chosen.iter().zip(&weights);
                products[code]
                    - explained
                        .map(|(c, w)| w * self.gram[(code, *c)])
                        .sum::<f64>()
            };
            let free = (0..products.len()).filter(|code| !chosen.contains(code));
            let best = free.max_by(|a, b| residual(*a).abs().total_cmp(&residual(*b).abs()));
            let Some(best) = best else { break };
            chosen.push(best);
            let gram = DMatrix::from_fn(chosen.len(), chosen.len(), |r, c| {
                self.gram[(chosen[r], chosen[c])] + if r == c { 1e-6 } else { 0.0 }
            });
            let right = DVector::from_iterator(chosen.len(), chosen.iter().map(|c| products[*c]));
            let Some(factor) = gram.cholesky() else {
                chosen.pop();
                break;
            };
            weights = factor.solve(&right);
            if energy - weights.dot(&right) < ENOUGH {
                break;
            }
        }
        chosen.into_iter().zip(weights.iter().copied()).collect()
    }

    fn energy(&self, descriptor: &[f32]) -> f64 {
        let numbers = descriptor.iter().map(|v| f64::from(*v));
        let mut rest = DVector::from_iterator(descriptor.len(), numbers);
        for (code, weight) in self.combination(&rest.clone()) {
            if code < self.positives {
                rest.axpy(-weight, &self.codes.column(code), 1.0);
            }
        }
        rest.norm_squared()
    }
}

/// At most [`CODES`] of a list, evenly.
fn evenly<'a>(list: &[&'a Vec<f32>]) -> Vec<&'a Vec<f32>> {
    let count = list.len().min(CODES);
    (0..count).map(|k| list[k * list.len() / count]).collect()
}

impl Sparse {
    /// Codebooks from synthesised views.
    pub fn new(samples: &[Sample]) -> Sparse {
        let point = |point: usize| {
            let positives = samples.iter().filter_map(|s| s.positive[point].as_ref());
            let negatives = samples.iter().flat_map(|s| &s.negative[point]);
            Codebook::new(
                &positives.collect::<Vec<_>>(),
                &negatives.collect::<Vec<_>>(),
            )
        };
        Sparse {
            points: (0..POINTS.len()).map(point).collect(),
        }
    }
}

impl LocalModel for Sparse {
    fn energy(&self, point: usize, descriptor: &[f32]) -> Option<f64> {
        self.points[point].as_ref().map(|c| c.energy(descriptor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_of_positives_cost_nothing() {
        let positives = [vec![1.0, 0.0, 0.0, 0.0], vec![0.0, 1.0, 0.0, 0.0]];
        let negatives = [vec![0.0, 0.0, 1.0, 0.0]];
        let book = Codebook::new(
            &positives.iter().collect::<Vec<_>>(),
            &negatives.iter().collect::<Vec<_>>(),
        )
        .unwrap();
        assert!(book.energy(&[0.6, 0.8, 0.0, 0.0]) < 1e-6);
        assert!((book.energy(&[0.0, 0.0, 1.0, 0.0]) - 1.0).abs() < 1e-6);
        assert!((book.energy(&[0.6, 0.0, 0.8, 0.0]) - 0.64).abs() < 1e-3);
    }
}
