//! Trains the cascade's last step (section `SREG`): ridge regression from the results of the stages
//! before it on the training faces to their errors.

use super::options::LIDS;
use super::refiners::starts::ends;
use crate::faces::Face;
use anyhow::{Result, anyhow};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use posewise::align::{AlignModel, Shape, ShapeRegression, deviation, mirror};
use posewise::shape::LANDMARKS;
use posewise_format::SectionWriter;

/// Weight of a render without hidden landmarks relative to a photograph: the label conventions of
/// the two differ by more than the step corrects, and users have real images.
const RENDERED: f64 = 0.12;
/// Ridge, relative to the coordinates' mean variance.
const RIDGE: f64 = 1e-3;

const COORDINATES: usize = 2 * LANDMARKS;

/// One result on one face, in the canonical frame.
struct Row {
    /// The result minus the mean shape.
    result: Shape,
    /// The label minus the result.
    correction: Shape,
    weight: f64,
}

/// Trains section `SREG` for a cascade whose last stages are the refiners. Mirrored rows make the
/// map symmetric. An upper lid and the lower one below it get the same correction: the rest of a
/// face does not determine how far its eyes are open.
/// Faces end at `label`.
pub fn train(
    model: &AlignModel<'_>,
    faces: &[Face],
    label: &dyn Fn(&Face) -> Shape,
) -> Result<SectionWriter> {
    let mut rows = vec![];
    for (face, ends) in faces.iter().zip(ends(model, faces)) {
        let label = label(face);
        for end in ends.into_iter().flatten() {
            rows.extend(Row::new(model.mean(), face, &label, &end));
        }
    }
    let mirrored: Vec<Row> = rows.iter().map(Row::mirrored).collect();
    rows.extend(mirrored);
    let mut solution = solve(&rows)?;
    for [upper, lower] in LIDS {
        for k in [0, 1] {
            let [a, b] = [2 * upper + k, 2 * lower + k];
            for i in 0..=COORDINATES {
                let mean = 0.5 * (solution[(i, a)] + solution[(i, b)]);
                (solution[(i, a)], solution[(i, b)]) = (mean, mean);
            }
        }
    }
    let (mut weights, mut scales, mut biases) = (vec![], vec![], vec![]);
    for k in 0..COORDINATES {
        let column: Vec<f64> = (0..COORDINATES).map(|i| solution[(i, k)]).collect();
        let scale = column.iter().fold(1e-9f64, |m, w| m.max(w.abs())) / 127.0;
        weights.extend(column.iter().map(|w| (w / scale).round() as i8));
        scales.push(scale as f32);
        biases.push(solution[(COORDINATES, k)] as f32);
    }
    let mut out = SectionWriter::new(ShapeRegression::TAG);
    out.array(&weights).array(&scales).array(&biases);
    Ok(out)
}

impl Row {
    fn new(mean: &Shape, face: &Face, label: &Shape, end: &Shape) -> Option<Row> {
        let (to_frame, result) = deviation(mean, end)?;
        let back = to_frame.inverse()?;
        let correction = std::array::from_fn(|i| {
            let [label, at] = [label[i], end[i]].map(|p| back.apply(p));
            // Without a label nothing is known to be wrong.
            let known = if face.known[i] { 1.0 } else { 0.0 };
            [known * (label[0] - at[0]), known * (label[1] - at[1])]
        });
        let weight = f64::from(face.weight);
        Some(Row {
            result,
            correction,
            weight: match face.is_render {
                true => RENDERED * weight,
                false => weight,
            },
        })
    }

    fn mirrored(&self) -> Row {
        Row {
            result: mirror(&self.result),
            correction: mirror(&self.correction),
            ..*self
        }
    }
}

/// Coordinates × coordinates, and below them the bias, that minimise the weighted mean squared
/// error plus the ridge.
fn solve(rows: &[Row]) -> Result<Mat<f64>> {
    let total: f64 = rows.iter().map(|r| r.weight).sum();
    let root: Vec<f64> = rows.iter().map(|r| (r.weight / total).sqrt()).collect();
    let x = Mat::from_fn(rows.len(), COORDINATES + 1, |n, i| {
        let flat = rows[n].result.as_flattened();
        root[n] * flat.get(i).map_or(1.0, |v| f64::from(*v))
    });
    let y = Mat::from_fn(rows.len(), COORDINATES, |n, k| {
        root[n] * f64::from(rows[n].correction.as_flattened()[k])
    });
    let mut xx = x.transpose() * &x;
    let trace: f64 = (0..COORDINATES).map(|i| xx[(i, i)]).sum();
    for i in 0..COORDINATES {
        xx[(i, i)] += RIDGE * trace / COORDINATES as f64;
    }
    let llt = xx.llt(Side::Lower);
    let llt = llt.map_err(|e| anyhow!("ridge system: {e:?}"))?;
    Ok(llt.solve(x.transpose() * &y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_linear_correction_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut point = || [0, 1].map(|_| rng.random_range(-1.0f32..1.0));
        let rows: Vec<Row> = (0..1000)
            .map(|_| {
                let result: Shape = std::array::from_fn(|_| point());
                let mut correction = [[0.5, 0.0]; LANDMARKS];
                correction[7] = [0.0, 0.25 * result[30][0]];
                Row {
                    result,
                    correction,
                    weight: 1.0,
                }
            })
            .collect();
        let w = solve(&rows).unwrap();
        assert!((w[(60, 15)] - 0.25).abs() < 1e-3, "{}", w[(60, 15)]);
        assert!(w[(60, 14)].abs() < 1e-3 && w[(61, 15)].abs() < 1e-3);
        assert!((w[(COORDINATES, 0)] - 0.5).abs() < 1e-3);
    }
}
