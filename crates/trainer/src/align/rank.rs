//! Heads of lower rank than they were trained with: most dimensions hardly move a point, and each
//! costs as many bytes as the head reads features.

use super::graph::Scratch;
use super::network::{Network, Sizes};
use super::samples::Sample;
use super::train::Trained;
use nalgebra::{DMatrix, SymmetricEigen};

/// Rank of a shipped head, unless its points have fewer coordinates.
pub const RANK: usize = 24;

/// The network with heads of lower rank: of each head's outputs on these samples, the principal
/// components are kept and the rest is replaced by its mean.
pub fn reduce_rank(trained: &Trained, samples: &[Sample]) -> Trained {
    let Trained {
        network,
        parameters,
    } = trained;
    let sizes = &network.sizes;
    let rank = RANK.min(2 * sizes.points).min(sizes.rank);
    let inner = inner_values(trained, samples);
    let narrow = Network::new(&Sizes {
        rank,
        ..sizes.clone()
    });
    let mut out = vec![0.0; narrow.parameters];
    let trunk = network.graph.parameters;
    out[..trunk].copy_from_slice(&parameters[..trunk]);
    for ((from, to), inner) in network.heads.iter().zip(&narrow.heads).zip(inner) {
        let [project, bias, expand, outer] = from.split(parameters);
        let double = |rows, columns, values: &[f32]| {
            DMatrix::from_row_iterator(rows, columns, values.iter().map(|v| f64::from(*v)))
        };
        let project = double(from.rank, from.inputs, project);
        let bias = double(from.rank, 1, bias);
        let expand = double(from.outputs, from.rank, expand);
        let moved = &expand * inner;
        let mean = DMatrix::from_columns(&[moved.column_mean()]);
        let apart = &moved - &mean * DMatrix::from_element(1, samples.len(), 1.0);
        let basis = principal(&(&apart * apart.transpose()), rank);
        let onto = basis.transpose() * &expand;
        let rest = &mean - &basis * (basis.transpose() * &mean);
        let parts = [
            (&onto * project).transpose(),
            &onto * bias,
            basis.transpose(),
            double(from.outputs, 1, outer) + rest,
        ];
        // Column after column of a transpose is row after row.
        let values = parts.iter().flat_map(|m| m.iter());
        for (slot, v) in out[to.at..].iter_mut().zip(values) {
            *slot = *v as f32;
        }
    }
    Trained {
        network: narrow,
        parameters: out,
    }
}

/// Of each head the values between its two matrices, a column per sample.
fn inner_values(trained: &Trained, samples: &[Sample]) -> Vec<DMatrix<f64>> {
    let network = &trained.network;
    let (mut maps, mut scratch) = (network.graph.maps(), Scratch::default());
    let mut columns = vec![vec![]; network.heads.len()];
    for sample in samples {
        maps[0].copy_from_slice(&sample.crop);
        let prediction = network.forward(
            &trained.parameters,
            &mut maps,
            &mut scratch,
            &sample.start,
            || [0.0; 2],
        );
        for (columns, inner) in columns.iter_mut().zip(prediction.inner()) {
            columns.extend(inner.iter().map(|v| f64::from(*v)));
        }
    }
    columns
        .into_iter()
        .map(|values| DMatrix::from_vec(network.sizes.rank, samples.len(), values))
        .collect()
}

/// Eigenvectors of the largest eigenvalues.
fn principal(covariance: &DMatrix<f64>, count: usize) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(covariance.clone());
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let columns: Vec<_> = order[..count]
        .iter()
        .map(|k| eigen.eigenvectors.column(*k).into_owned())
        .collect();
    DMatrix::from_columns(&columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::align::{GLOBAL, SHAPE_INDEXED};
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// The outputs of six points have twelve dimensions.
    #[test]
    fn a_rank_of_all_coordinates_changes_no_prediction() {
        let sizes = Sizes {
            reads: vec![GLOBAL, GLOBAL | SHAPE_INDEXED],
            ..Sizes::of_refiner(6, 24, 1.0)
        };
        let network = Network::new(&sizes);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut samples: Vec<Sample> = (0..40)
            .map(|_| Sample {
                crop: (0..24 * 24).map(|_| rng.random_range(-1.0..1.0)).collect(),
                start: (0..6)
                    .map(|_| [0, 1].map(|_| rng.random_range(-8.0f32..8.0)))
                    .collect(),
                truth: vec![[0.0; 2]; 6],
                weights: vec![1.0; 6],
            })
            .collect();
        let crops: Vec<_> = samples.iter().map(|s| s.crop.clone()).collect();
        let parameters = network.initial(&vec![[1.0, 2.0]; 6], &crops, &mut rng);
        let trained = Trained {
            network,
            parameters,
        };
        let unseen = samples.split_off(30);
        let narrow = reduce_rank(&trained, &samples);
        assert_eq!(narrow.network.sizes.rank, 12);
        let predict = |trained: &Trained, sample: &Sample| {
            let mut maps = trained.network.graph.maps();
            maps[0].copy_from_slice(&sample.crop);
            let (mut scratch, p) = (Scratch::default(), &trained.parameters);
            let still = || [0.0; 2];
            let network = &trained.network;
            network.forward(p, &mut maps, &mut scratch, &sample.start, still)
        };
        for sample in &unseen {
            let [before, after] = [&trained, &narrow].map(|t| predict(t, sample).shapes);
            for (a, b) in before.iter().flatten().zip(after.iter().flatten()) {
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-3, "{a:?} {b:?}");
            }
        }
    }
}
