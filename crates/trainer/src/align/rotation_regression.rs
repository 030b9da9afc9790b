//! Trains section `ROTN`: ridge regressions, one per view, of the head's rotation on the cascade's
//! features and shape, from renders, whose rotations are known.

use super::cover::{covered, cut_off};
use super::each::each;
use super::evaluate::{mean_error, start_of};
use super::starts::{jittered_box, start_from_box};
use crate::faces::Face;
use crate::ridge::{Linear, Normal, predict};
use anyhow::Result;
use faer::Mat;
use glam::{Mat3, Vec3};
use posewise::align::{AlignModel, RotationRegression, Workspace, deviation, input_of};
use posewise::math::{HeadAngles, head_angles, head_rotation};
use posewise::shape::{LANDMARKS, rotation_vector};
use posewise_format::SectionWriter;
use posewise_metrics::BoxJitter;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Fits on each face.
const FITS: usize = 2;
/// Iterations that lead to them, at least; some get one more.
const ITERATIONS: usize = 3;
/// One face in this number has something before it, and one is cut off by the picture's edge.
const OCCLUDED: usize = 4;
const CUT_OFF: usize = 12;
/// Largest mean error of the visible landmarks of a fit \[% of the scale\]: a verifier accepts
/// hardly any other.
const FITTED_PERCENT: f32 = 10.0;
/// Weight of the squared norm beside the mean squared error \[deg²\]: of 0.003, 0.03, 0.3 and 3
/// the one with the least error on unseen people.
const RIDGE: f32 = 0.03;
/// Folds of people, to measure the error on people that a regression has not seen.
const FOLDS: usize = 4;
/// Least standard deviation \[rad\].
const LEAST_SIGMA_RAD: f32 = 0.02;

/// One fit on a render.
struct Row {
    /// Features, then coordinates of the shape.
    inputs: Vec<i8>,
    /// Head to crop.
    rotation: Mat3,
    view: usize,
    fold: usize,
}

/// Trains the section for a finished cascade.
pub fn train(model: &AlignModel<'_>, faces: &[Face], seed: u64) -> Result<SectionWriter> {
    let rows = rows(model, faces, seed);
    let mut out = SectionWriter::new(RotationRegression::TAG);
    let views = model.signed_views();
    out.scalar(model.features() as u32).scalar(views as u32);
    for view in 0..views {
        let rows: Vec<&Row> = rows.iter().filter(|r| r.view == view).collect();
        let folds: Vec<Normal> = (0..FOLDS).map(|fold| normal(model, &rows, fold)).collect();
        let without = |left_out: Option<usize>| {
            let mut sum = normal(model, &[], 0);
            let used = folds
                .iter()
                .enumerate()
                .filter(|(k, _)| Some(*k) != left_out);
            used.for_each(|(_, fold)| sum.merge(fold));
            sum.solve(RIDGE)
        };
        let of_folds = (0..FOLDS)
            .map(|fold| without(Some(fold)))
            .collect::<Result<Vec<_>>>()?;
        let sigma = sigmas(&rows, &of_folds);
        println!(
            "rotation: view {view}, {} fits, deviations on unseen people {:.1?} degrees",
            rows.len(),
            sigma.map(f32::to_degrees)
        );
        write(&without(None)?, sigma, &mut out);
    }
    Ok(out)
}

fn rows(model: &AlignModel<'_>, faces: &[Face], seed: u64) -> Vec<Row> {
    let renders: Vec<&Face> = faces.iter().filter(|f| f.is_render).collect();
    let rows = each(&renders, seed ^ 0x0520_7411, |_, face, rng, work| {
        let row = |_| row(model, &renders, face, rng, work);
        (0..FITS).filter_map(row).collect::<Vec<_>>()
    });
    rows.into_iter().flatten().collect()
}

/// One fit from a detector's box.
fn row(
    model: &AlignModel<'_>,
    faces: &[&Face],
    bare: &Face,
    rng: &mut ChaCha8Rng,
    work: &mut Workspace,
) -> Option<Row> {
    let mut face = match rng.random_bool(0.5) {
        true => bare.mirrored(),
        false => bare.clone(),
    };
    if rng.random_range(0..OCCLUDED) == 0 {
        face = covered(&face, faces[rng.random_range(0..faces.len())], rng);
    }
    if rng.random_range(0..CUT_OFF) == 0 {
        face = cut_off(&face, rng);
    }
    let (at, size, roll) = jittered_box(&model.views(), &face.landmarks, &BoxJitter::DETECTOR, rng);
    let mut shape = start_from_box(&start_of(model, face.turn()), at, size, roll);
    let iterations = ITERATIONS + rng.random_range(0..2);
    if !model.run(&face.picture.frame(), iterations, &mut shape, work) {
        return None;
    }
    let visible = (0..LANDMARKS).filter(|k| face.visible[*k]);
    if mean_error(&face, &shape, visible, face.scale()) > FITTED_PERCENT {
        return None;
    }
    let (to_frame, deviation) = deviation(model.mean(), &shape)?;
    let coordinates = deviation.as_flattened().iter().map(|v| input_of(*v));
    Some(Row {
        inputs: work.features().iter().copied().chain(coordinates).collect(),
        rotation: Mat3::from_rotation_z(-to_frame.angle()) * face.rotation?,
        view: work.view(),
        fold: (face.person.wrapping_mul(0x9E37_79B9) >> 16) as usize % FOLDS,
    })
}

/// The sums over the rows of a fold.
fn normal(model: &AlignModel<'_>, rows: &[&Row], fold: usize) -> Normal {
    let inputs = LANDMARKS * (model.features() + 2);
    let mut sum = Normal::new(inputs, 3);
    let rows: Vec<&&Row> = rows.iter().filter(|r| r.fold == fold).collect();
    let x: Vec<&[i8]> = rows.iter().map(|r| &r.inputs[..]).collect();
    let angles: Vec<[f32; 3]> = rows.iter().map(|r| angles_of(&r.rotation)).collect();
    let y: Vec<&[f32]> = angles.iter().map(|a| &a[..]).collect();
    sum.add(&x, &y, &vec![1.0; rows.len()]);
    sum
}

fn angles_of(rotation: &Mat3) -> [f32; 3] {
    let angles = head_angles(rotation);
    [angles.yaw_deg, angles.pitch_deg, angles.roll_deg]
}

/// Root mean squares of the rotation vectors, about the crop's axes, from what a regression without
/// a row's fold predicts to the truth \[rad\].
fn sigmas(rows: &[&Row], of_folds: &[Mat<f32>]) -> [f32; 3] {
    let mut squares = Vec3::ZERO;
    for row in rows {
        let angles = predict(&of_folds[row.fold], &row.inputs);
        let predicted = head_rotation(HeadAngles {
            yaw_deg: angles[0],
            pitch_deg: angles[1],
            roll_deg: angles[2],
        });
        let error = rotation_vector(&(row.rotation * predicted.transpose()));
        squares += error * error;
    }
    let n = rows.len().max(1) as f32;
    squares
        .to_array()
        .map(|s| (s / n).sqrt().max(LEAST_SIGMA_RAD))
}

fn write(solution: &Mat<f32>, sigma: [f32; 3], out: &mut SectionWriter) {
    let rows = solution.nrows();
    let angles: Vec<Linear> = (0..3)
        .map(|k| Linear::quantise(&Mat::from_fn(rows, 1, |i, _| solution[(i, k)])))
        .collect();
    let weights: Vec<i8> = angles.iter().flat_map(|a| a.weight.clone()).collect();
    out.array(&weights);
    out.array(&angles.iter().map(|a| a.scale).collect::<Vec<_>>());
    out.array(&angles.iter().map(|a| a.bias).collect::<Vec<_>>());
    out.array(&sigma);
}
