//! Stage by stage: describe, learn a projection, regress, move on.
//!
//! Each stage is trained on out-of-fold outputs of the stages before it (folds by person), so that
//! later stages meet the errors that they will meet at work.

use super::basis::{Basis, flat};
use super::quantise::{ProjectionWeights, RegressorWeights, StageWeights, section};
use super::ridge::{Normal, error, predict};
use super::starts::{Jitter, StartShapes};
use crate::faces::Face;
use crate::pack::SectionWriter;
use anyhow::{Result, ensure};
use faer::Mat;
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use posewise::align::{Placement, Shape, Workspace, mirror, place};
use posewise::descriptor::{HogGrid, VALUES};
use posewise::shape::LANDMARKS;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// What one stage looks at.
#[derive(Clone, Copy, Debug)]
pub struct StageOptions {
    /// Side of the crop \[px\].
    pub side: usize,
    /// Crop px per canonical unit.
    pub zoom: f32,
    /// Distance between cells \[px\].
    pub spacing: i32,
    /// Half width of a cell \[px\].
    pub radius: i32,
    /// Features per landmark.
    pub features: usize,
}

/// How the cascade is trained.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of all randomness.
    pub seed: u64,
    /// Shape modes besides the similarity's four.
    pub modes: usize,
    /// Turns of the views, rising from 0.
    pub turns: Vec<f32>,
    /// The stages.
    pub stages: Vec<StageOptions>,
    /// First stage while tracking.
    pub track_from: usize,
    /// Starts per face as after a detection.
    pub detect_starts: usize,
    /// Starts per face as from the frame before.
    pub track_starts: usize,
    /// Errors of detections.
    pub detect_jitter: Jitter,
    /// Motion between frames.
    pub track_jitter: Jitter,
    /// Rounds of training on the cascade's own answers.
    pub closed_loop_rounds: usize,
    /// Such answers per tracked start.
    pub closed_loop_share: f32,
    /// Errors along the shape modes of tracked starts, in standard deviations.
    pub track_modes: f32,
}

impl Default for Options {
    fn default() -> Self {
        let stage = |zoom, spacing, radius| StageOptions {
            side: 112,
            zoom,
            spacing,
            radius,
            features: 24,
        };
        Options {
            seed: 1,
            modes: 60,
            turns: vec![0.0, 0.4, 0.8],
            stages: vec![stage(1.0, 8, 6), stage(1.0, 7, 6), stage(1.1, 6, 5)],
            track_from: 1,
            detect_starts: 6,
            track_starts: 3,
            detect_jitter: Jitter {
                shift: 0.05,
                log_size: 0.08,
                roll: 0.14,
            },
            track_jitter: Jitter {
                shift: 0.04,
                log_size: 0.03,
                roll: 0.05,
            },
            closed_loop_rounds: 1,
            closed_loop_share: 1.5,
            track_modes: 0.35,
        }
    }
}

/// One start on its way through the cascade.
#[derive(Clone)]
struct Sample {
    face: usize,
    fold: usize,
    /// First stage that it takes part in.
    from: usize,
    shape: Shape,
}

const FOLDS: usize = 4;
const RIDGES: [f32; 6] = [1e-3, 1e-2, 3e-2, 0.1, 0.5, 3.0];

/// Trains the cascade on these faces (mirrors included by the caller).
pub fn train(faces: &[Face], options: &Options) -> Result<SectionWriter> {
    let basis = Basis::fit(faces, options.modes);
    let starts = StartShapes::fit(faces, &basis, &options.turns);
    let mut samples = sample(faces, &basis, &starts, options);
    println!("{} faces, {} starts", faces.len(), samples.len());
    let mut stages = Vec::new();
    for (index, stage) in options.stages.iter().enumerate().take(options.track_from) {
        stages.push(train_stage(
            index,
            stage,
            faces,
            &basis,
            &starts,
            &mut samples,
        )?);
    }
    let detected: Vec<Sample> = samples.iter().filter(|s| s.from == 0).cloned().collect();
    for round in 0..=options.closed_loop_rounds {
        println!("closed-loop round {round}");
        if round > 0 {
            samples = closed_loop(&basis, &starts, options, round, &detected, samples);
        }
        stages.truncate(options.track_from);
        for (index, stage) in options.stages.iter().enumerate().skip(options.track_from) {
            stages.push(train_stage(
                index,
                stage,
                faces,
                &basis,
                &starts,
                &mut samples,
            )?);
        }
    }
    Ok(section(&basis, &starts, &stages, options.track_from))
}

/// Samples for another round: the detected starts where the first stages left them, and in place
/// of made-up tracked starts the cascade's own (out-of-fold) answers, moved on by a frame's motion.
/// What is trained on these does not drift when it is repeated.
fn closed_loop(
    basis: &Basis,
    starts: &StartShapes,
    options: &Options,
    round: usize,
    detected: &[Sample],
    answers: Vec<Sample>,
) -> Vec<Sample> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ ((round as u64) << 32));
    let mut samples = detected.to_vec();
    let keep = options.track_starts as f32 / (options.track_starts + options.detect_starts) as f32;
    for answer in answers {
        if rng.random_range(0.0..1.0) < keep * options.closed_loop_share {
            let jitter = motion(&options.track_jitter, &mut rng);
            let relaxed = starts.views().relaxed(&answer.shape);
            let shape = jitter.moved(&relaxed, basis, &mut rng);
            samples.push(Sample {
                shape,
                from: options.track_from,
                ..answer
            });
        }
    }
    samples
}

/// How far a face moves between two frames: mostly little, sometimes much.
fn motion(largest: &Jitter, rng: &mut ChaCha8Rng) -> Jitter {
    let amount = rng.random_range(0.0f32..1.0).powi(2) * 1.5;
    Jitter {
        shift: largest.shift * amount,
        log_size: largest.log_size * amount,
        roll: largest.roll * amount,
    }
}

fn sample(faces: &[Face], basis: &Basis, starts: &StartShapes, options: &Options) -> Vec<Sample> {
    let mut samples = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
        rng.set_stream(index as u64);
        // A multiplicative hash: neighbours in number spread over the folds.
        let fold = (face.person.wrapping_mul(0x9E37_79B9) >> 16) as usize % FOLDS;
        // Renders are many.
        let share = if face.yaw_deg.is_some() { 2 } else { 1 };
        for _ in 0..options.detect_starts / share {
            let shape = options.detect_jitter.detected(face, starts, &mut rng);
            samples.push(Sample {
                face: index,
                fold,
                from: 0,
                shape,
            });
        }
        for _ in 0..options.track_starts.div_ceil(share) {
            let jitter = motion(&options.track_jitter, &mut rng);
            let shape = jitter.tracked(face, basis, options.track_modes, &mut rng);
            let shape = starts.views().relaxed(&shape);
            samples.push(Sample {
                face: index,
                fold,
                from: options.track_from,
                shape,
            });
        }
    }
    samples
}

fn bar(len: usize, what: String) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:28} {bar:30} {pos}/{len} {eta}");
    ProgressBar::new(len as u64)
        .with_style(style.expect("a valid template"))
        .with_message(what)
}

/// A sample as a stage sees it.
struct Described {
    values: Box<[[u8; VALUES]; LANDMARKS]>,
    /// What the stage should answer.
    target: Vec<f32>,
    view: usize,
    placement: Box<Placement>,
}

/// Descriptors of all samples at their current shapes, and what the stage should answer.
fn describe(
    stage: &StageOptions,
    faces: &[Face],
    basis: &Basis,
    starts: &StartShapes,
    samples: &[&mut Sample],
    title: String,
) -> Vec<Described> {
    let grid = HogGrid {
        spacing: stage.spacing,
        radius: stage.radius,
    };
    samples
        .par_iter()
        .progress_with(bar(samples.len(), title))
        .map_init(
            || Box::new(Workspace::new()),
            |work, sample| {
                let face = &faces[sample.face];
                let view = starts
                    .views()
                    .of(&sample.shape)
                    .expect("training shapes have extent");
                let placed = place(
                    &basis.mean,
                    &sample.shape,
                    stage.zoom,
                    stage.side,
                    view.mirrored,
                );
                let placed = placed.expect("training shapes have extent");
                work.describe(&face.picture.frame(), &placed, stage.side, grid);
                let back = placed
                    .canonical_to_frame
                    .inverse()
                    .expect("a shape has extent");
                let truth = face.landmarks.map(|p| back.apply(p));
                let truth = flat(&if view.mirrored { mirror(&truth) } else { truth });
                let now = flat(&placed.canonical);
                let residual: Vec<f32> = truth.iter().zip(&now).map(|(t, n)| t - n).collect();
                Described {
                    values: Box::new(*work.values()),
                    target: basis.project(&residual),
                    view: view.index,
                    placement: Box::new(placed),
                }
            },
        )
        .collect()
}

fn train_stage(
    index: usize,
    stage: &StageOptions,
    faces: &[Face],
    basis: &Basis,
    starts: &StartShapes,
    samples: &mut [Sample],
) -> Result<StageWeights> {
    let started = std::time::Instant::now();
    let mut active: Vec<&mut Sample> = samples.iter_mut().filter(|s| s.from <= index).collect();
    let title = format!("stage {index}: describe");
    let described = describe(stage, faces, basis, starts, &active, title);
    let projection = learn_projection(&described, stage.features);
    let features = project_all(&described, &projection);
    let mut regressors = Vec::new();
    for view in 0..starts.turns.len() {
        let rows: Vec<Row<'_>> = described
            .iter()
            .zip(&features)
            .zip(&active)
            .enumerate()
            .filter(|(_, ((d, _), _))| d.view == view)
            .map(|(n, ((d, f), sample))| Row {
                sample: n,
                features: f,
                target: &d.target,
                weight: faces[sample.face].weight,
                fold: sample.fold,
            })
            .collect();
        let solved = regress(&rows, &format!("stage {index} view {view}"))?;
        for (n, delta) in solved.answers {
            active[n].shape = moved(basis, &described[n].placement, &delta);
        }
        regressors.push(RegressorWeights::quantise(&solved.weights));
    }
    println!("stage {index}: {:.0?}", started.elapsed());
    Ok(StageWeights {
        options: *stage,
        projection,
        regressors,
    })
}

/// One sample of a regression.
struct Row<'a> {
    sample: usize,
    features: &'a [i8],
    target: &'a [f32],
    weight: f32,
    fold: usize,
}

struct Solved {
    weights: Mat<f32>,
    /// Sample and out-of-fold answer.
    answers: Vec<(usize, Vec<f32>)>,
}

/// Ridge regression with the ridge that serves a held-out fold best.
fn regress(rows: &[Row<'_>], title: &str) -> Result<Solved> {
    ensure!(!rows.is_empty(), "{title}: no samples");
    faer::set_global_parallelism(faer::Par::Seq);
    let (inputs, outputs) = (rows[0].features.len(), rows[0].target.len());
    let of_fold = |fold: usize| -> (Vec<&[i8]>, Vec<&[f32]>, Vec<f32>) {
        let chosen = || rows.iter().filter(|r| r.fold == fold);
        (
            chosen().map(|r| r.features).collect(),
            chosen().map(|r| r.target).collect(),
            chosen().map(|r| r.weight).collect(),
        )
    };
    let folds: Vec<Normal> = (0..FOLDS)
        .map(|fold| {
            let (x, y, w) = of_fold(fold);
            let mut normal = Normal::new(inputs, outputs);
            normal.add(&x, &y, &w);
            normal
        })
        .collect();
    let sum_without = |fold: Option<usize>| {
        let mut sum = Normal::new(inputs, outputs);
        let kept = folds.iter().enumerate().filter(|(f, _)| Some(*f) != fold);
        kept.for_each(|(_, n)| sum.merge(n));
        sum
    };
    let (x, y, w) = of_fold(0);
    let held_out = sum_without(Some(0));
    let errors = RIDGES
        .par_iter()
        .map(|ridge| Ok((error(&held_out.solve(*ridge)?, &x, &y, &w), *ridge)))
        .collect::<Result<Vec<_>>>()?;
    let best = errors
        .into_iter()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("ridges to try");
    let squares = |y: &&[f32]| y.iter().map(|v| v * v).sum::<f32>() as f64;
    let before = y
        .iter()
        .zip(&w)
        .map(|(y, w)| squares(y) * *w as f64)
        .sum::<f64>()
        / w.iter().map(|w| *w as f64).sum::<f64>();
    let rms = |e: f64| (e / LANDMARKS as f64).sqrt() / 36.0 * 100.0;
    println!(
        "{title}: {} samples, ridge {}, held-out point error {:.2} → {:.2} (r.m.s., % of the inter-ocular distance)",
        rows.len(),
        best.1,
        rms(before),
        rms(best.0)
    );
    let out_of_fold = (0..FOLDS)
        .into_par_iter()
        .map(|fold| sum_without(Some(fold)).solve(best.1))
        .collect::<Result<Vec<_>>>()?;
    let answers = rows
        .par_iter()
        .map(|r| (r.sample, predict(&out_of_fold[r.fold], r.features)))
        .collect();
    Ok(Solved {
        weights: sum_without(None).solve(best.1)?,
        answers,
    })
}

/// Where a stage's answer moves a shape.
fn moved(basis: &Basis, placement: &Placement, answer: &[f32]) -> Shape {
    let mut delta = [[0.0; 2]; LANDMARKS];
    for (row, d) in basis.rows.iter().zip(answer) {
        for (i, p) in delta.iter_mut().enumerate() {
            *p = [p[0] + d * row[2 * i], p[1] + d * row[2 * i + 1]];
        }
    }
    placement.moved(&delta)
}

fn learn_projection(described: &[Described], features: usize) -> ProjectionWeights {
    // Every sample gives a few landmarks: 200,000 descriptors fix 72×72 covariances well.
    let step = (described.len() * LANDMARKS / 200_000).max(1);
    let chosen: Vec<[u8; VALUES]> = (0..described.len() * LANDMARKS)
        .step_by(step)
        .map(|k| described[k / LANDMARKS].values[(k + k / LANDMARKS) % LANDMARKS])
        .collect();
    ProjectionWeights::principal(&chosen, features)
}

fn project_all(described: &[Described], weights: &ProjectionWeights) -> Vec<Vec<i8>> {
    let features = weights.features();
    described
        .par_iter()
        .map(|Described { values, .. }| {
            let mut out = vec![0i8; LANDMARKS * features];
            for (v, out) in values.iter().zip(out.chunks_exact_mut(features)) {
                weights.project(v, out);
            }
            out
        })
        .collect()
}
