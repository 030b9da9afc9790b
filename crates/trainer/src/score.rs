//! Trains the classifiers that tell truth from guess (section `VRFY`).
//!
//! Positives and negatives come from running the finished cascade: from jittered boxes on the
//! training faces (some of which fail), and on pictures without a face from random boxes and from
//! places that the detector takes for one. Some are fitted again and again, as what is tracked is.
//! One picture in three is as a poor camera shows it.

use crate::align::cover::covered;
use crate::align::evaluate::{mean_error, start_of};
use crate::align::{Jitter, jittered_box, normal, start_from_box};
use crate::faces::{Face, Picture};
use crate::render::effects::Camera;
use crate::ridge::{Linear, Normal, predict};
use anyhow::Result;
use faer::Mat;
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::detect::{Detection, DetectorModel, Scan, ScanOutcome, Sizes};
use posewise::image::Frame;
use posewise::shape::LANDMARKS;
use posewise::track::Config;
use posewise::verifier::{Verifier, first_prediction};
use posewise_format::SectionWriter;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Right means within this share of the inter-ocular distance \[%\].
const RIGHT_PERCENT: f32 = 10.0;
const FOLDS: u32 = 4;
/// Weight of all false alarms over that of the right fits, however many the detector tells: lest
/// doubtful faces drown.
const FALSE_ALARMS: f32 = 2.0 / 3.0;
/// Of so many pictures one is as a poor camera shows it.
const POOR: usize = 3;
/// Most false alarms taken from a picture in one orientation: poor ones have hundreds.
const ALARMS: usize = 40;
/// Width of the faces that would be seen where nobody is, for that camera's defects \[px\].
const NOBODY_PX: f32 = 100.0;
/// Of so many fits one has settled by so many further passes, and every false alarm once more: the
/// confidence is mostly asked for what has been tracked for a while.
const SETTLING: usize = 3;
const SETTLED: usize = 8;
/// Smallest face that false alarms are looked for at \[px\].
const MIN_FACE_PX: i32 = 30;

struct Row {
    features: Vec<i8>,
    /// Per landmark: right. Empty without a face.
    right: Vec<bool>,
    /// Per landmark: seen. Empty where it is not known.
    seen: Vec<bool>,
    face: bool,
    weight: f32,
    fold: u32,
    view: usize,
}

/// Trains the face's and the landmarks' classifiers.
pub fn train(
    model: &AlignModel<'_>,
    detector: &DetectorModel<'_>,
    faces: &[Face],
    empty: &[Picture],
    seed: u64,
) -> Result<SectionWriter> {
    let mut rows = on_faces(model, faces, seed);
    rows.extend(on_empty(model, empty, seed ^ 1, rows.len() / 4));
    let positives = rows.iter().filter(|r| r.face).count();
    let mut alarms = on_alarms(model, detector, empty, seed ^ 2);
    println!("score: {} false alarms of the detector", alarms.len());
    let weight = FALSE_ALARMS * positives as f32 / alarms.len().max(1) as f32;
    for alarm in &mut alarms {
        alarm.weight = weight;
    }
    rows.extend(alarms);
    println!(
        "score: {positives} right fits, {} others",
        rows.len() - positives
    );
    let views = model.signed_views();
    let mut out = SectionWriter::new(Verifier::TAG);
    out.scalar(model.features() as u32).scalar(views as u32);
    for view in 0..views {
        let rows: Vec<&Row> = rows.iter().filter(|r| r.view == view).collect();
        println!("score: view {view}, {} fits", rows.len());
        let logits = train_face(&rows, &mut out)?;
        train_landmarks(&rows, &logits, model.features(), &mut out)?;
        train_seen(&rows, model.features(), &mut out)?;
    }
    Ok(out)
}

/// The face's classifier of one view; returns out-of-fold logits.
fn train_face(rows: &[&Row], out: &mut SectionWriter) -> Result<Vec<f32>> {
    let (weight, scores) = linear(rows, |r| r.features.as_slice(), |r| r.face, 0.03)?;
    let labels: Vec<bool> = rows.iter().map(|r| r.face).collect();
    let weights: Vec<f32> = rows.iter().map(|r| r.weight).collect();
    let (slope, offset) = platt(&scores, &labels, Some(&weights), None);
    out.scalar(weight.scale * slope[0])
        .scalar(weight.bias * slope[0] + offset);
    out.array(&weight.weight);
    let logits: Vec<f32> = scores.iter().map(|s| s * slope[0] + offset).collect();
    report("face", &logits, &labels);
    Ok(logits)
}

/// The landmarks' classifiers of one view.
fn train_landmarks(
    rows: &[&Row],
    logits: &[f32],
    features: usize,
    out: &mut SectionWriter,
) -> Result<()> {
    let seen = || rows.iter().zip(logits).filter(|(r, _)| !r.right.is_empty());
    let chosen: Vec<&Row> = seen().map(|(r, _)| *r).collect();
    let face: Vec<f32> = seen().map(|(_, l)| l.clamp(-12.0, 12.0)).collect();
    let locals = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let own = landmark * features..(landmark + 1) * features;
            let right = |r: &Row| r.right[landmark];
            let (w, s) = linear(&chosen, |r| &r.features[own.clone()], right, 0.01)?;
            let labels: Vec<bool> = chosen.iter().map(|r| right(r)).collect();
            let (slope, offset) = platt(&s, &labels, None, Some(&face));
            let logits: Vec<f32> = s
                .iter()
                .zip(&face)
                .map(|(s, f)| s * slope[0] + f * slope[1] + offset)
                .collect();
            Ok((w, slope, offset, logits, labels))
        })
        .collect::<Result<Vec<_>>>()?;
    let pooled: (Vec<f32>, Vec<bool>) = locals
        .iter()
        .flat_map(|(_, _, _, logits, labels)| logits.iter().copied().zip(labels.iter().copied()))
        .unzip();
    report("landmarks", &pooled.0, &pooled.1);
    out.array(
        &locals
            .iter()
            .flat_map(|l| l.0.weight.clone())
            .collect::<Vec<i8>>(),
    );
    out.array(
        &locals
            .iter()
            .map(|l| l.0.scale * l.1[0])
            .collect::<Vec<f32>>(),
    );
    out.array(
        &locals
            .iter()
            .map(|l| l.0.bias * l.1[0] + l.2)
            .collect::<Vec<f32>>(),
    );
    out.array(&locals.iter().map(|l| l.1[1]).collect::<Vec<f32>>());
    Ok(())
}

/// The classifiers of what is seen, of one view: from a landmark's own features, then from all
/// landmarks' first answers.
fn train_seen(rows: &[&Row], features: usize, out: &mut SectionWriter) -> Result<()> {
    let chosen: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|r| !r.seen.is_empty())
        .collect();
    let first = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let own = landmark * features..(landmark + 1) * features;
            linear(
                &chosen,
                |r| &r.features[own.clone()],
                |r| r.seen[landmark],
                0.01,
            )
        })
        .collect::<Result<Vec<_>>>()?;
    let answers: Vec<Row> = chosen
        .iter()
        .enumerate()
        .map(|(k, row)| Row {
            features: first.iter().map(|(_, s)| first_prediction(s[k])).collect(),
            right: vec![],
            seen: row.seen.clone(),
            ..**row
        })
        .collect();
    let answers: Vec<&Row> = answers.iter().collect();
    let second = (0..LANDMARKS)
        .into_par_iter()
        .map(|landmark| {
            let label = |r: &Row| r.seen[landmark];
            let (w, s) = linear(&answers, |r| r.features.as_slice(), label, 0.01)?;
            let labels: Vec<bool> = answers.iter().map(|r| label(r)).collect();
            let (slope, offset) = platt(&s, &labels, None, None);
            let logits: Vec<f32> = s.iter().map(|s| s * slope[0] + offset).collect();
            Ok((w, slope[0], offset, logits, labels))
        })
        .collect::<Result<Vec<_>>>()?;
    let pooled: (Vec<f32>, Vec<bool>) = second
        .iter()
        .flat_map(|(_, _, _, logits, labels)| logits.iter().copied().zip(labels.iter().copied()))
        .unzip();
    report("seen", &pooled.0, &pooled.1);
    let weights = |all: Vec<&Linear>| {
        all.iter()
            .flat_map(|w| w.weight.clone())
            .collect::<Vec<i8>>()
    };
    out.array(&weights(first.iter().map(|f| &f.0).collect()));
    out.array(&first.iter().map(|f| f.0.scale).collect::<Vec<f32>>());
    out.array(&first.iter().map(|f| f.0.bias).collect::<Vec<f32>>());
    out.array(&weights(second.iter().map(|f| &f.0).collect()));
    out.array(&second.iter().map(|f| f.0.scale * f.1).collect::<Vec<f32>>());
    out.array(
        &second
            .iter()
            .map(|f| f.0.bias * f.1 + f.2)
            .collect::<Vec<f32>>(),
    );
    Ok(())
}

/// A picture as a poor camera shows it, with a face so many pixels wide or without one.
fn poor(picture: &Picture, face_px: f32, rng: &mut ChaCha8Rng) -> Picture {
    let camera = Camera::poor(rng, face_px);
    picture.through(&camera, rng)
}

/// The same, one time in [`POOR`].
fn sometimes_poor(picture: &Picture, face_px: f32, rng: &mut ChaCha8Rng) -> Option<Picture> {
    (rng.random_range(0..POOR) == 0).then(|| poor(picture, face_px, rng))
}

/// Runs the cascade on the faces, from boxes as good as a detector's to hopeless ones.
fn on_faces(model: &AlignModel<'_>, faces: &[Face], seed: u64) -> Vec<Row> {
    let per_face = (48_000 / faces.len().max(1)).clamp(1, 6);
    faces
        .par_iter()
        .enumerate()
        .map_init(
            || Box::new(Workspace::new()),
            |work, (index, face)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(index as u64);
                let mut rows = Vec::new();
                for k in 0..per_face {
                    // Every third start is far off.
                    let j = if (index + k) % 3 == 2 { 3.5 } else { 1.0 };
                    let jitter = Jitter {
                        shift: 0.05 * j,
                        log_size: 0.08 * j,
                        roll: 0.14 * j,
                    };
                    let views = model.views();
                    let (at, size, roll) = jittered_box(&views, &face.landmarks, &jitter, &mut rng);
                    let turn = face.turn() + 0.25 * normal(&mut rng);
                    let mut shape = start_from_box(&start_of(model, turn), at, size, roll);
                    // Of every four, one has something before it.
                    let hidden = (rng.random_range(0..4) == 0).then(|| {
                        let other = &faces[rng.random_range(0..faces.len())];
                        covered(face, other, &mut rng)
                    });
                    let (bare, face) = (face, hidden.as_ref().unwrap_or(face));
                    let poor = sometimes_poor(&face.picture, face.width(), &mut rng);
                    let frame = poor.as_ref().unwrap_or(&face.picture).frame();
                    if !model.run(&frame, model.iterations() + k % 2, &mut shape, work) {
                        continue;
                    }
                    if rng.random_range(0..SETTLING) == 0
                        && !settle(model, &frame, &mut shape, work)
                    {
                        continue;
                    }
                    let limit = RIGHT_PERCENT / 100.0 * face.scale();
                    let right = face.landmarks.iter().zip(&shape);
                    let right: Vec<bool> = right
                        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) <= limit)
                        .collect();
                    // Hidden landmarks are guesses: hardly a face in profile would be right if they
                    // counted.
                    let seen = (0..LANDMARKS).filter(|k| bare.visible[*k]);
                    let error = mean_error(bare, &shape, seen, bare.scale());
                    // Photographs say nothing of what turning hides.
                    let known = face.yaw_deg.is_some() || face.turn().abs() < 0.3;
                    rows.push(Row {
                        features: work.features().to_vec(),
                        right,
                        seen: if known && error < RIGHT_PERCENT {
                            face.visible.to_vec()
                        } else {
                            vec![]
                        },
                        face: error < RIGHT_PERCENT,
                        weight: 1.0,
                        fold: face.person.wrapping_mul(0x9E37_79B9) >> 16 & (FOLDS - 1),
                        view: work.view(),
                    });
                }
                rows
            },
        )
        .flatten()
        .collect()
}

/// The run that was last, on a picture without a face.
fn no_face(work: &Workspace, picture: usize) -> Row {
    Row {
        features: work.features().to_vec(),
        right: Vec::new(),
        seen: Vec::new(),
        face: false,
        weight: 1.0,
        fold: picture as u32 % FOLDS,
        view: work.view(),
    }
}

/// Runs the cascade on random boxes in pictures without a face.
fn on_empty(model: &AlignModel<'_>, empty: &[Picture], seed: u64, count: usize) -> Vec<Row> {
    if empty.is_empty() {
        return Vec::new();
    }
    (0..count)
        .into_par_iter()
        .map_init(
            || Box::new(Workspace::new()),
            |work, index| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(index as u64);
                let which = index % empty.len();
                let picture = &empty[which];
                let [w, h] = picture.size.map(|s| s as f32);
                let size = rng.random_range(40.0..0.9 * w.min(h));
                let at = [rng.random_range(0.0..w), rng.random_range(0.0..h)];
                let start = start_of(model, rng.random_range(-1.0..1.0));
                let mut shape = start_from_box(&start, at, size, 0.3 * normal(&mut rng));
                let passes = model.iterations() + index % 2;
                let poor = sometimes_poor(picture, size, &mut rng);
                let frame = poor.as_ref().unwrap_or(picture).frame();
                let ran = model.run(&frame, passes, &mut shape, work)
                    && (!(index / empty.len()).is_multiple_of(SETTLING)
                        || settle(model, &frame, &mut shape, work));
                ran.then(|| no_face(work, which))
            },
        )
        .flatten()
        .collect()
}

/// Goes on fitting, as tracking does on the frames that follow.
fn settle(
    model: &AlignModel<'_>,
    frame: &Frame<'_>,
    shape: &mut Shape,
    work: &mut Workspace,
) -> bool {
    (0..SETTLED).all(|_| model.run(frame, 1, shape, work))
}

/// Runs the cascade where the detector sees a face though there is none.
fn on_alarms(
    model: &AlignModel<'_>,
    detector: &DetectorModel<'_>,
    empty: &[Picture],
    seed: u64,
) -> Vec<Row> {
    empty
        .par_iter()
        .enumerate()
        .map_init(
            || Box::new(Workspace::new()),
            |work, (index, picture)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(index as u64);
                let mut rows = Vec::new();
                for (turn, mut picture) in picture.orientations().into_iter().enumerate() {
                    if turn % POOR == 1 {
                        picture = poor(&picture, NOBODY_PX, &mut rng);
                    }
                    let frame = picture.frame();
                    let alarms = alarms(detector, &frame);
                    let every = alarms.len().div_ceil(ALARMS).max(1);
                    for found in alarms.iter().step_by(every) {
                        let start = start_of(model, found.yaw);
                        let at = [found.x, found.y];
                        let mut shape = start_from_box(&start, at, found.size, found.roll);
                        if model.run(&frame, model.iterations(), &mut shape, work) {
                            rows.push(no_face(work, index));
                            if settle(model, &frame, &mut shape, work) {
                                rows.push(no_face(work, index));
                            }
                        }
                    }
                }
                rows
            },
        )
        .flatten()
        .collect()
}

/// All that the detector takes for a face in a picture, searched in slices of a camera's work: what
/// is met in one is told before it is complete, where larger boxes would show that it is none.
fn alarms(detector: &DetectorModel<'_>, frame: &Frame<'_>) -> Vec<Detection> {
    let (mut scan, mut all) = (Scan::new(), vec![]);
    let slice = Config::default().scan_budget;
    loop {
        match scan.advance(detector, frame, Sizes::from(MIN_FACE_PX), slice) {
            ScanOutcome::Candidate(found) => all.push(found),
            ScanOutcome::BudgetSpent => continue,
            ScanOutcome::Finished => return all,
        }
    }
}

/// Least squares to ±1 with both classes of equal weight; also the out-of-fold score of every row.
fn linear<'a>(
    rows: &[&'a Row],
    features: impl Fn(&'a Row) -> &'a [i8] + Sync,
    label: impl Fn(&Row) -> bool + Sync,
    ridge: f32,
) -> Result<(Linear, Vec<f32>)> {
    let inputs = features(rows[0]).len();
    let sum = |rows: &mut dyn Iterator<Item = &&Row>| rows.map(|r| r.weight).sum::<f32>();
    let share = sum(&mut rows.iter().filter(|r| label(r))) / sum(&mut rows.iter());
    let (w1, w0) = (0.5 / share.max(1e-3), 0.5 / (1.0 - share).max(1e-3));
    let fold_sum = |fold: u32| {
        let chosen: Vec<&Row> = rows.iter().copied().filter(|r| r.fold == fold).collect();
        let x: Vec<&[i8]> = rows
            .iter()
            .filter(|r| r.fold == fold)
            .map(|r| features(r))
            .collect();
        let y: Vec<[f32; 1]> = chosen
            .iter()
            .map(|r| [if label(r) { 1.0 } else { -1.0 }])
            .collect();
        let y: Vec<&[f32]> = y.iter().map(|v| v.as_slice()).collect();
        let w: Vec<f32> = chosen
            .iter()
            .map(|r| r.weight * if label(r) { w1 } else { w0 })
            .collect();
        let mut sum = Normal::new(inputs, 1);
        sum.add(&x, &y, &w);
        sum
    };
    let sums: Vec<Normal> = (0..FOLDS).map(fold_sum).collect();
    let solve = |without: Option<u32>| -> Result<Mat<f32>> {
        let mut sum = Normal::new(inputs, 1);
        let kept = sums
            .iter()
            .enumerate()
            .filter(|(f, _)| Some(*f as u32) != without);
        kept.for_each(|(_, s)| sum.merge(s));
        sum.solve(ridge)
    };
    let folds = (0..FOLDS)
        .map(|f| solve(Some(f)))
        .collect::<Result<Vec<_>>>()?;
    let scores = rows
        .par_iter()
        .map(|r| predict(&folds[r.fold as usize], features(r))[0])
        .collect();
    let linear = Linear::quantise(&solve(None)?);
    Ok((linear, scores))
}

/// Logistic fit of labels to score and a second input, if there is one, by Newton's method: slopes
/// and offset. Without weights all count the same.
pub fn platt(
    scores: &[f32],
    labels: &[bool],
    weights: Option<&[f32]>,
    second: Option<&[f32]>,
) -> ([f32; 2], f32) {
    let start = if second.is_some() { 0.2f32 } else { 0.0 };
    let mut w = nalgebra::Vector3::new(1.0f64, start as f64, 0.0);
    for _ in 0..30 {
        let mut gradient = nalgebra::Vector3::zeros();
        let mut hessian = nalgebra::Matrix3::identity() * 1e-3;
        for (k, (s, label)) in scores.iter().zip(labels).enumerate() {
            let (weight, t) = (weights.map_or(1.0, |w| w[k]), second.map_or(0.0, |t| t[k]));
            let x = nalgebra::Vector3::new(*s as f64, t as f64, 1.0);
            let p = 1.0 / (1.0 + (-w.dot(&x)).exp());
            let weight = weight as f64;
            gradient += x * weight * (p - if *label { 1.0 } else { 0.0 });
            hessian += x * x.transpose() * weight * (p * (1.0 - p)).max(1e-6);
        }
        let step = hessian
            .lu()
            .solve(&gradient)
            .unwrap_or_else(nalgebra::Vector3::zeros);
        w -= step.cap_magnitude(4.0);
    }
    ([w[0] as f32, w[1] as f32], w[2] as f32)
}

/// Prints how well probabilities hold: accuracy at a half, and the expected calibration error.
fn report(what: &str, logits: &[f32], labels: &[bool]) {
    let n = logits.len() as f32;
    let probability = |l: &f32| 1.0 / (1.0 + (-l).exp());
    let wrong = logits
        .iter()
        .zip(labels)
        .filter(|(l, y)| (**l > 0.0) != **y)
        .count() as f32;
    let mut bins = [(0.0f32, 0.0f32, 0.0f32); 10];
    for (l, y) in logits.iter().zip(labels) {
        let p = probability(l);
        let bin = &mut bins[((p * 10.0) as usize).min(9)];
        *bin = (bin.0 + p, bin.1 + f32::from(*y), bin.2 + 1.0);
    }
    let ece: f32 = bins.iter().map(|b| (b.0 - b.1).abs()).sum::<f32>() / n;
    println!(
        "score: {what}: wrong at one half {:.2} %, calibration error {ece:.3} (out of fold)",
        100.0 * wrong / n
    );
}
