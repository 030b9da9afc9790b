//! Sparse reconstruction (thesis 3.3): each landmark has a codebook of descriptors at it, from
//! synthesised views and from the first frame. Orthogonal matching pursuit writes a descriptor as a
//! combination of a few of them. The energy is what that leaves, over the mean of what it leaves of
//! descriptors beside the landmark: 1 is as bad as the background.

use super::scorer::LocalModel;
use super::synthesis::{POINTS, Sample};
use nalgebra::{DMatrix, DVector};

/// Most descriptors of synthesised views in a codebook (R).
const CODES: usize = 50;
/// Most descriptors beside a landmark that its energy is normalised by.
const BACKGROUND: usize = 100;
/// Most codes in a combination (R).
const MOST: usize = 6;
/// Squared residual at which the combination is good enough, of a descriptor of length 1.
const ENOUGH: f64 = 0.02;

/// Codebooks of all landmarks.
pub struct Sparse {
    points: Vec<Option<Codebook>>,
}

struct Codebook {
    /// Columns of unit length.
    codes: DMatrix<f64>,
    /// codesᵀ·codes.
    gram: DMatrix<f64>,
    /// Mean squared residual of what lies beside the landmark.
    background: f64,
}

impl Codebook {
    fn new(positives: &[&Vec<f32>], negatives: &[&Vec<f32>]) -> Option<Codebook> {
        if positives.is_empty() || negatives.is_empty() {
            return None;
        }
        let columns = positives.iter().map(|code| {
            let column = vector(code);
            let length = column.norm().max(1e-6);
            column / length
        });
        let codes = DMatrix::from_columns(&columns.collect::<Vec<_>>());
        let mut book = Codebook {
            gram: codes.tr_mul(&codes),
            codes,
            background: 1.0,
        };
        let residuals = negatives.iter().map(|descriptor| book.energy(descriptor));
        book.background = (residuals.sum::<f64>() / negatives.len() as f64).max(ENOUGH);
        Some(book)
    }

    /// Squared residual of the combination that orthogonal matching pursuit (Pati et al. 1993, on
    /// the Gram matrix) finds, over that of the background.
    fn energy(&self, descriptor: &[f32]) -> f64 {
        let descriptor = vector(descriptor);
        let products = self.codes.tr_mul(&descriptor);
        let energy = descriptor.norm_squared();
        let mut rest = energy;
        // Products of the codes with the residual.
        let mut open = products.clone();
        let mut chosen: Vec<usize> = Vec::new();
        while chosen.len() < MOST && rest > ENOUGH {
            let free = (0..open.len()).filter(|code| !chosen.contains(code));
            let Some(best) = free.max_by(|a, b| open[*a].abs().total_cmp(&open[*b].abs())) else {
                break;
            };
            chosen.push(best);
            let gram = DMatrix::from_fn(chosen.len(), chosen.len(), |r, c| {
                self.gram[(chosen[r], chosen[c])] + if r == c { 1e-6 } else { 0.0 }
            });
            let right = DVector::from_iterator(chosen.len(), chosen.iter().map(|c| products[*c]));
            let Some(factor) = gram.cholesky() else {
                break;
            };
            let weights = factor.solve(&right);
            rest = (energy - weights.dot(&right)).max(0.0);
            open.copy_from(&products);
            for (code, weight) in chosen.iter().zip(&weights) {
                open.axpy(-weight, &self.gram.column(*code), 1.0);
            }
        }
        rest / self.background
    }
}

fn vector(numbers: &[f32]) -> DVector<f64> {
    DVector::from_iterator(numbers.len(), numbers.iter().map(|v| f64::from(*v)))
}

/// At most this many of a list, evenly.
fn evenly(list: Vec<&Vec<f32>>, most: usize) -> impl Iterator<Item = &Vec<f32>> {
    let count = list.len().min(most);
    (0..count).map(move |k| list[k * list.len() / count])
}

impl Sparse {
    /// Codebooks from synthesised views and from the first frame.
    pub fn new(views: &[Sample], first: &Sample) -> Sparse {
        let point = |point: usize| {
            let drawn = views.iter().filter_map(|s| s.positive[point].as_ref());
            let beside = views.iter().flat_map(|s| &s.negative[point]);
            let positives = evenly(drawn.collect(), CODES).chain(&first.positive[point]);
            let negatives = evenly(beside.collect(), BACKGROUND).chain(&first.negative[point]);
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
    fn the_background_costs_one_and_combinations_of_codes_nothing() {
        let positives = [vec![1.0, 0.0, 0.0, 0.0], vec![0.0, 1.0, 0.0, 0.0]];
        let negatives = [vec![0.0, 0.0, 1.0, 0.0], vec![0.0, 1.0, 0.0, 0.0]];
        let book = Codebook::new(
            &positives.iter().collect::<Vec<_>>(),
            &negatives.iter().collect::<Vec<_>>(),
        )
        .unwrap();
        assert!((book.background - 0.5).abs() < 1e-5);
        assert!(book.energy(&[0.6, 0.8, 0.0, 0.0]) < 1e-4);
        assert!((book.energy(&[0.6, 0.0, 0.8, 0.0]) - 1.28).abs() < 1e-3);
        let mean = negatives.iter().map(|n| book.energy(n)).sum::<f64>() / 2.0;
        assert!((mean - 1.0).abs() < 1e-3);
    }
}
