//! Learns the cascade's last step (section `SREG`): ridge regression from where the stages before
//! it end on the training faces to what they lack there.

use super::options::LIDS;
use super::refiners::starts::ends;
use crate::faces::Face;
use anyhow::{Result, anyhow};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use posewise::align::{AlignModel, Shape, ShapeRegression, deviation, mirror};
use posewise::shape::LANDMARKS;
use posewise_format::SectionWriter;

/// Weight of a render that is seen whole over that of a photograph: the labels of the two lie apart
/// by more than the step corrects, and it is photographs that users have.
const RENDERED: f64 = 0.12;
/// Ridge, in shares of the coordinates' mean variance.
const RIDGE: f64 = 1e-3;

const COORDINATES: usize = 2 * LANDMARKS;

/// One answer on one face, in the canonical frame.
struct Row {
    /// From the mean shape.
    answer: Shape,
    /// From the answer to the label.
    lacks: Shape,
    weight: f64,
}

/// Trains section `SREG` for a cascade, whose fine stages are the last so far. Mirrored rows make
/// the map symmetric, whatever the faces are. An upper lid and the lower one below it move as one:
/// the rest of a face does not tell how far its eyes are open.
pub fn train(model: &AlignModel<'_>, faces: &[Face]) -> Result<SectionWriter> {
    let mut rows = vec![];
    for (face, ends) in faces.iter().zip(ends(model, faces)) {
        for end in ends.into_iter().flatten() {
            rows.extend(Row::new(model.mean(), face, &end));
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
    fn new(mean: &Shape, face: &Face, end: &Shape) -> Option<Row> {
        let (to_frame, answer) = deviation(mean, end)?;
        let back = to_frame.inverse()?;
        let lacks = std::array::from_fn(|i| {
            let [label, at] = [face.landmarks[i], end[i]].map(|p| back.apply(p));
            [label[0] - at[0], label[1] - at[1]]
        });
        let weight = f64::from(face.weight);
        Some(Row {
            answer,
            lacks,
            weight: match face.yaw_deg {
                Some(_) => RENDERED * weight,
                None => weight,
            },
        })
    }

    fn mirrored(&self) -> Row {
        Row {
            answer: mirror(&self.answer),
            lacks: mirror(&self.lacks),
            ..*self
        }
    }
}

/// Coordinates × coordinates, and below them the bias, that minimise the weighted mean of what is
/// left plus the ridge.
fn solve(rows: &[Row]) -> Result<Mat<f64>> {
    let total: f64 = rows.iter().map(|r| r.weight).sum();
    let root: Vec<f64> = rows.iter().map(|r| (r.weight / total).sqrt()).collect();
    let x = Mat::from_fn(rows.len(), COORDINATES + 1, |n, i| {
        let flat = rows[n].answer.as_flattened();
        root[n] * flat.get(i).map_or(1.0, |v| f64::from(*v))
    });
    let y = Mat::from_fn(rows.len(), COORDINATES, |n, k| {
        root[n] * f64::from(rows[n].lacks.as_flattened()[k])
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
    fn what_is_linear_in_the_answer_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut point = || [0, 1].map(|_| rng.random_range(-1.0f32..1.0));
        let rows: Vec<Row> = (0..1000)
            .map(|_| {
                let answer: Shape = std::array::from_fn(|_| point());
                let mut lacks = [[0.5, 0.0]; LANDMARKS];
                lacks[7] = [0.0, 0.25 * answer[30][0]];
                Row {
                    answer,
                    lacks,
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
