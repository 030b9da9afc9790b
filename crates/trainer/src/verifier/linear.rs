//! Support vector machines with a squared hinge loss, fitted in the primal by Newton's method
//! (Chapelle, Training a support vector machine in the primal, 2007).

use crate::ridge::{Linear, Normal, predict};
use anyhow::Result;
use faer::Mat;
use rayon::prelude::*;

/// Folds of people: every score that calibrates is of a classifier that never saw the person.
pub const FOLDS: u32 = 4;
/// Most Newton steps; a handful is enough.
const MAX_STEPS: usize = 30;
/// The loss has converged when a step lowers it by less than this share.
const CONVERGED: f64 = 1e-5;
/// Shortest part of a Newton step that the line search tries.
const SHORTEST: f32 = 1e-3;

/// A labelled row of features.
#[derive(Clone, Copy)]
pub struct Example<'a> {
    pub features: &'a [i8],
    pub positive: bool,
    pub weight: f32,
    /// Below [`FOLDS`].
    pub fold: u32,
}

impl Example<'_> {
    fn target(&self) -> f32 {
        if self.positive { 1.0 } else { -1.0 }
    }
}

/// Fits a classifier to all examples, both classes of equal weight; also returns the score of each
/// example by a classifier that was fitted without the example's fold.
pub fn cross_fitted(examples: &[Example<'_>], ridge: f32) -> Result<(Linear, Vec<f32>)> {
    let examples = balanced(examples);
    let inputs = examples.first().map_or(0, |e| e.features.len());
    let all = support_vector_machine(&examples, ridge, Mat::zeros(inputs + 1, 1))?;
    let folds = (0..FOLDS)
        .map(|fold| {
            let others = examples.iter().filter(|e| e.fold != fold);
            let others = others.copied().collect::<Vec<_>>();
            support_vector_machine(&others, ridge, all.clone())
        })
        .collect::<Result<Vec<_>>>()?;
    let scores = examples
        .par_iter()
        .map(|e| predict(&folds[e.fold as usize], e.features)[0])
        .collect();
    Ok((Linear::quantise(&all), scores))
}

/// The examples, weighted so that both classes weigh the same.
fn balanced<'a>(examples: &[Example<'a>]) -> Vec<Example<'a>> {
    let total: f32 = examples.iter().map(|e| e.weight).sum();
    let positives = examples.iter().filter(|e| e.positive);
    let share = positives.map(|e| e.weight).sum::<f32>() / total;
    let of_class = |positive| 0.5 / if positive { share } else { 1.0 - share }.max(1e-3);
    let weighted = examples.iter().map(|e| Example {
        weight: e.weight * of_class(e.positive),
        ..*e
    });
    weighted.collect()
}

/// Weights (the last one the bias) that minimise the weighted mean of `max(0, 1 − margin)²`, the
/// margin being target times score, plus `ridge · |weights|²`, the bias aside.
///
/// A Newton step goes to the ridge solution of the support vectors, which are the examples whose
/// margin is below 1. From zero these are all examples.
fn support_vector_machine(
    examples: &[Example<'_>],
    ridge: f32,
    start: Mat<f32>,
) -> Result<Mat<f32>> {
    let objective = Objective::new(examples, ridge);
    let mut weights = start;
    let mut margins = objective.margins(&weights);
    let mut loss = objective.loss(&weights, &margins);
    for _ in 0..MAX_STEPS {
        let Some(goal) = objective.newton(&margins)? else {
            break;
        };
        let margins_there = objective.margins(&goal);
        let mut step = 1.0;
        let (next, next_margins, next_loss) = loop {
            let next = &weights * faer::Scale(1.0 - step) + &goal * faer::Scale(step);
            let along = margins.iter().zip(&margins_there);
            let next_margins: Vec<f32> = along.map(|(a, b)| a + step * (b - a)).collect();
            let next_loss = objective.loss(&next, &next_margins);
            if next_loss < loss || step < SHORTEST {
                break (next, next_margins, next_loss);
            }
            step /= 2.0;
        };
        if next_loss >= loss {
            break;
        }
        let gain = (loss - next_loss) / loss;
        (weights, margins, loss) = (next, next_margins, next_loss);
        if gain < CONVERGED {
            break;
        }
    }
    Ok(weights)
}

/// What a classifier minimises.
struct Objective<'e> {
    examples: &'e [Example<'e>],
    ridge: f64,
    /// Weight of all examples.
    total: f64,
}

impl<'e> Objective<'e> {
    fn new(examples: &'e [Example<'e>], ridge: f32) -> Self {
        let total = examples.iter().map(|e| f64::from(e.weight)).sum();
        Objective {
            examples,
            ridge: f64::from(ridge),
            total,
        }
    }

    /// Target times score of every example.
    fn margins(&self, weights: &Mat<f32>) -> Vec<f32> {
        let margin = |e: &Example<'_>| e.target() * predict(weights, e.features)[0];
        self.examples.par_iter().map(margin).collect()
    }

    fn loss(&self, weights: &Mat<f32>, margins: &[f32]) -> f64 {
        let inputs = weights.nrows() - 1;
        let squares = (0..inputs).map(|i| f64::from(weights[(i, 0)]).powi(2));
        let hinge = self.examples.iter().zip(margins).map(|(e, margin)| {
            let missing = (1.0 - f64::from(*margin)).max(0.0);
            f64::from(e.weight) * missing * missing
        });
        hinge.sum::<f64>() / self.total + self.ridge * squares.sum::<f64>()
    }

    /// Ridge solution of the support vectors; none where there are none.
    fn newton(&self, margins: &[f32]) -> Result<Option<Mat<f32>>> {
        let paired = self.examples.iter().zip(margins);
        let support: Vec<&Example<'_>> = paired.filter(|p| *p.1 < 1.0).map(|p| p.0).collect();
        let Some(inputs) = support.first().map(|e| e.features.len()) else {
            return Ok(None);
        };
        let features: Vec<&[i8]> = support.iter().map(|e| e.features).collect();
        let targets: Vec<[f32; 1]> = support.iter().map(|e| [e.target()]).collect();
        let targets: Vec<&[f32]> = targets.iter().map(|t| t.as_slice()).collect();
        let weights: Vec<f32> = support.iter().map(|e| e.weight).collect();
        let kept: f64 = weights.iter().map(|w| f64::from(*w)).sum();
        let mut sums = Normal::new(inputs, 1);
        sums.add(&features, &targets, &weights);
        // The sums' ridge is relative to their own weight.
        sums.solve((self.ridge * self.total / kept) as f32)
            .map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const INPUTS: usize = 4;

    /// Rows whose class is the sign of a known direction, one in ten mislabelled.
    fn rows() -> Vec<([i8; INPUTS], bool)> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let row = |_| {
            let x: [i8; INPUTS] = std::array::from_fn(|_| rng.random_range(-64..=64));
            let score = 2 * i32::from(x[0]) - i32::from(x[1]) + 30;
            (x, (score > 0) != (rng.random_range(0..10) == 0))
        };
        (0..600).map(row).collect()
    }

    fn examples(rows: &[([i8; INPUTS], bool)]) -> Vec<Example<'_>> {
        let example = |(k, row): (usize, _)| {
            let (features, positive): &([i8; INPUTS], bool) = row;
            Example {
                features,
                positive: *positive,
                weight: 1.0 + (k % 3) as f32,
                fold: k as u32 % FOLDS,
            }
        };
        rows.iter().enumerate().map(example).collect()
    }

    #[test]
    fn no_small_change_of_the_weights_lowers_the_loss() {
        let rows = rows();
        let examples = examples(&rows);
        let objective = Objective::new(&examples, 0.01);
        let start = Mat::zeros(INPUTS + 1, 1);
        let weights = support_vector_machine(&examples, 0.01, start).unwrap();
        let loss = |w: &Mat<f32>| objective.loss(w, &objective.margins(w));
        let least = loss(&weights);
        for i in 0..=INPUTS {
            for change in [-0.02, 0.02] {
                let mut other = weights.clone();
                other[(i, 0)] += change;
                assert!(loss(&other) > least, "weight {i}");
            }
        }
    }

    #[test]
    fn scores_of_unseen_folds_separate_the_classes() {
        let rows = rows();
        let (classifier, scores) = cross_fitted(&examples(&rows), 0.01).unwrap();
        let right = rows.iter().zip(&scores).filter(|(r, s)| (**s > 0.0) == r.1);
        let right = right.count();
        assert!(right > 460, "{right} of 600");
        let weight = &classifier.weight;
        assert_eq!(weight[0], 127);
        assert!((40..90).contains(&-weight[1]), "{weight:?}");
    }
}
