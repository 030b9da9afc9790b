//! `posewise-lab eval deviations`: whether the standard deviations of a pose are true, and the
//! constants of `src/shape/deviation.rs` that make them so.

use anyhow::Result;
use glam::Vec3;
use nalgebra::{SMatrix, SVector};
use posewise::math::{HeadAngles, head_rotation};
use posewise::shape::{Pose, rotation_vector};
use serde_json::{Map, Value, json};

use super::pairs::{ClipsArgs, clips_of};
use crate::table::Table;
use crate::truth::Truth;
use crate::{output, truth};

/// Options of `posewise-lab eval deviations`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub clips: ClipsArgs,
    /// Print the constants of src/shape/deviation.rs that suit these clips, whose focal length was
    /// given
    #[arg(long)]
    pub fit: bool,
}

/// What has a deviation, in the order of [`Frame::errors`].
const NAMES: [&str; 9] = ["R x", "R y", "R z", "yaw", "pitch", "roll", "x", "y", "z"];

/// Share of the landmarks that are covered on a covered face.
const COVERED: f64 = 0.15;
/// Longer side of the box of a small face \[px\].
const SMALL_PX: f64 = 60.0;

/// One tracked frame.
struct Frame {
    clip: usize,
    /// Rotation vector about the camera's axes \[deg\], facing angles \[deg\], position \[mm\].
    errors: [f64; 9],
    sigmas: [f64; 9],
    /// Size of the true facing yaw \[deg\].
    yaw_deg: f64,
    covered: f64,
    box_px: f64,
    /// What the constants are multiplied by: see `SYSTEMATIC` of the core.
    terms: [f64; TERMS],
    /// Errors of the rotation about axes to the right, down and along the line of sight \[deg\],
    /// across that line \[mm\], and of the distance as a share.
    systematic: [f64; 6],
}

const TERMS: usize = 6;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let mut frames = Vec::new();
    for (clip, (truth, csv)) in clips_of(&args.clips)?.enumerate() {
        let truths = truth::whole(&Table::read(truth)?)?;
        frames.extend(read(clip, &truths, &Table::read(csv)?)?);
    }
    output::show(&figures(&frames), args.clips.json.as_deref())?;
    if args.fit {
        print_constants(&frames);
    }
    Ok(())
}

/// The tracked frames of a clip.
fn read(clip: usize, truths: &[Truth], csv: &Table) -> Result<Vec<Frame>> {
    let names = [
        "frame",
        "success",
        "yaw_deg",
        "pitch_deg",
        "roll_deg",
        "pose_Tx",
        "pose_Ty",
        "pose_Tz",
        "R_sigma_x",
        "R_sigma_y",
        "R_sigma_z",
        "facing_yaw_sigma",
        "facing_pitch_sigma",
        "facing_roll_sigma",
        "T_sigma_x",
        "T_sigma_y",
        "T_sigma_z",
        "visible_share",
        "confidence",
        "focal_px",
        "box_w",
        "box_h",
    ];
    let columns: Vec<usize> = names.iter().map(|n| csv.column(n)).collect::<Result<_>>()?;
    let mut frames = Vec::new();
    for row in 0..csv.len() {
        let values: Vec<f64> = columns
            .iter()
            .map(|c| csv.number(row, *c))
            .collect::<Result<_>>()?;
        // The truth counts frames from 0.
        let found = truths.iter().find(|t| t.frame + 1 == values[0] as usize);
        let Some((truth, eye_mid)) = found.and_then(|t| Some((t, t.eye_mid?))) else {
            continue;
        };
        if values[1] < 0.5 || truth.in_frame < 0.5 {
            continue;
        }
        let is = pose(truth.angles, eye_mid);
        let said = pose(three(&values[2..]), three(&values[5..]));
        frames.push(Frame {
            clip,
            errors: errors(&said, &is),
            sigmas: std::array::from_fn(|i| values[8 + i]),
            yaw_deg: f64::from(is.facing_angles().yaw_deg.abs()),
            covered: share(&truth.covered.unwrap_or([false; 68])),
            box_px: values[20].max(values[21]),
            terms: terms(&said, &values),
            systematic: systematic(&said, &is),
        });
    }
    Ok(frames)
}

fn share(marks: &[bool; 68]) -> f64 {
    marks.iter().filter(|mark| **mark).count() as f64 / 68.0
}

fn three(values: &[f64]) -> [f64; 3] {
    [values[0], values[1], values[2]]
}

fn pose([yaw, pitch, roll]: [f64; 3], place: [f64; 3]) -> Pose {
    let angles = HeadAngles {
        yaw_deg: yaw as f32,
        pitch_deg: pitch as f32,
        roll_deg: roll as f32,
    };
    Pose {
        rotation: head_rotation(angles),
        translation_mm: Vec3::from(place.map(|v| v as f32)),
    }
}

/// Facing angles less the true ones \[deg\].
fn facing_errors(said: &Pose, is: &Pose) -> [f64; 3] {
    let [a, b] = [said, is].map(|pose| {
        let a = pose.facing_angles();
        [a.yaw_deg, a.pitch_deg, a.roll_deg]
    });
    std::array::from_fn(|i| f64::from((a[i] - b[i] + 540.0).rem_euclid(360.0) - 180.0))
}

fn errors(said: &Pose, is: &Pose) -> [f64; 9] {
    let turn = rotation_vector(&(said.rotation * is.rotation.transpose()));
    let turn = turn.to_array().map(|v| f64::from(v.to_degrees()));
    let place = (said.translation_mm - is.translation_mm).to_array();
    let all = turn.into_iter().chain(facing_errors(said, is));
    let mut all = all.chain(place.map(f64::from));
    std::array::from_fn(|_| all.next().unwrap_or(0.0))
}

fn systematic(said: &Pose, is: &Pose) -> [f64; 6] {
    let turn = rotation_vector(&(said.facing() * is.facing().transpose()));
    let [over, aside, round] = turn.to_array().map(|v| f64::from(v.to_degrees()));
    let (at, off) = (said.translation_mm, said.translation_mm - is.translation_mm);
    let range = off.z / at.z;
    let across = off - at * range;
    [
        over,
        aside,
        round,
        across.x.into(),
        across.y.into(),
        range.into(),
    ]
}

/// As `systematic` of `src/shape/deviation.rs` has them.
fn terms(said: &Pose, values: &[f64]) -> [f64; TERMS] {
    let turn = f64::from(said.facing_angles().yaw_deg.abs()) / 90.0;
    let (visible, confidence, focal_px) = (values[17], values[18], values[19]);
    let small = (f64::from(said.translation_mm.z) / focal_px)
        .ln()
        .clamp(0.0, 2.5);
    let doubt = (-confidence.clamp(1e-6, 1.0).ln()).min(0.7);
    [1.0, turn, turn * turn, 1.0 - visible, small, doubt]
}

/// A band's name, and whether a frame is in it.
type Band = (&'static str, fn(&Frame) -> bool);

const BANDS: [Band; 6] = [
    ("all", |_| true),
    ("to 30°", |f| f.yaw_deg < 30.0),
    ("30–60°", |f| (30.0..60.0).contains(&f.yaw_deg)),
    ("from 60°", |f| f.yaw_deg >= 60.0),
    ("covered", |f| f.covered >= COVERED),
    ("small", |f| f.box_px < SMALL_PX),
];

fn figures(frames: &[Frame]) -> Value {
    let mut bands = Map::new();
    for (name, is_in) in BANDS {
        let band: Vec<&Frame> = frames.iter().filter(|f| is_in(f)).collect();
        if band.is_empty() {
            continue;
        }
        let n = band.len() as f64;
        let mean = |value: &dyn Fn(&Frame) -> f64| band.iter().map(|f| value(f)).sum::<f64>() / n;
        let mut values = Map::from_iter([("frames".to_string(), band.len().into())]);
        for (i, quantity) in NAMES.iter().enumerate() {
            let within = |f: &Frame| f64::from(f.errors[i].abs() <= 2.0 * f.sigmas[i]);
            let (within, sigma) = (100.0 * mean(&within), mean(&|f| f.sigmas[i]));
            let rms = mean(&|f| f.errors[i] * f.errors[i]).sqrt();
            let numbers = json!({"within_2_sigma_%": within, "sigma": sigma, "rms": rms,
                "sigma_over_rms": sigma / rms});
            values.insert(quantity.to_string(), numbers);
        }
        bands.insert(name.into(), values.into());
    }
    bands.into()
}

/// The distance: how large a head is does not depend on where it is turned.
const RANGE: usize = 5;
/// What holds a factor at 0 where the frames say little of it.
const PRIOR: f64 = 20.0;
/// Frames that each clip counts as, however long it is.
const CLIP_FRAMES: f64 = 100.0;
/// Share of the errors that lie within two of the fitted deviations.
const WITHIN: f64 = 0.955;
/// Newton steps, and their greatest length.
const STEPS: usize = 200;
const LONGEST_STEP: f64 = 0.3;
/// Keeps a step finite where no error is near its limit.
const LEAST_CURVATURE: f64 = 1e-3;
/// Width of the step between within and without \[natural logarithm of an error\]. It is wide, so
/// that deviations come out up to a third larger than these frames ask for: other people err more.
const SMOOTHING: f64 = 0.2;

fn print_constants(frames: &[Frame]) {
    println!("\nconst SYSTEMATIC: [Terms; 6] = [");
    for quantity in 0..6 {
        let [base, a, b, c, d, e]: [f64; TERMS] = fit(frames, quantity).into();
        println!("    terms({base:.2}, [{a:.2}, {b:.2}], [{c:.2}, {d:.2}, {e:.2}]),");
    }
    println!("];");
}

/// The factors of the logarithm of a deviation with which [`WITHIN`] of the errors lie within two
/// of it, whatever the terms, none of which makes it smaller: a smoothed quantile regression
/// (Koenker and Bassett 1978) by Newton's method. How far off a lost face is does not count, as in
/// a variance.
fn fit(frames: &[Frame], quantity: usize) -> SVector<f64, TERMS> {
    let clips = frames
        .iter()
        .map(|f| f.clip)
        .max()
        .map_or(0, |last| last + 1);
    let mut counts = vec![0.0; clips];
    frames.iter().for_each(|f| counts[f.clip] += 1.0);
    let weight = |f: &Frame| CLIP_FRAMES / counts[f.clip];
    let mut factors = SVector::<f64, TERMS>::zeros();
    for _ in 0..STEPS {
        let mut slope = factors * -PRIOR;
        let mut curvature = SMatrix::<f64, TERMS, TERMS>::identity() * PRIOR;
        (slope[0], curvature[(0, 0)]) = (0.0, LEAST_CURVATURE);
        for frame in frames {
            let mut terms = SVector::from(frame.terms);
            if quantity == RANGE {
                (terms[1], terms[2]) = (0.0, 0.0);
            }
            let error = frame.systematic[quantity].abs().max(1e-9);
            let beyond = (error / 2.0).ln() - factors.dot(&terms);
            let outside = 1.0 / (1.0 + (-beyond / SMOOTHING).exp());
            slope += terms * (weight(frame) * (outside - (1.0 - WITHIN)));
            let bend = (outside * (1.0 - outside)).max(LEAST_CURVATURE) / SMOOTHING;
            curvature += terms * terms.transpose() * (weight(frame) * bend);
        }
        // What would go below 0 stays there, and the others do without it.
        for i in (1..TERMS).filter(|i| factors[*i] <= 0.0) {
            if slope[i] < 0.0 {
                slope[i] = 0.0;
                curvature.row_mut(i).fill(0.0);
                curvature.column_mut(i).fill(0.0);
                curvature[(i, i)] = 1.0;
            }
        }
        let Some(step) = curvature.cholesky().map(|c| c.solve(&slope)) else {
            break;
        };
        factors += step.cap_magnitude(LONGEST_STEP);
        factors.iter_mut().skip(1).for_each(|f| *f = f.max(0.0));
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames whose errors have deviations of 2, and of 4 where half is hidden.
    fn frames() -> Vec<Frame> {
        let mut random = crate::random::Random::of(3);
        let mut unit = move || random.below(1 << 20) as f64 / f64::from(1 << 20);
        let mut normal = move || (0..12).map(|_| unit()).sum::<f64>() - 6.0;
        let mut frame = |i: usize| {
            let hidden = f64::from(i as u32 % 2) * 0.5;
            let sigma = 2.0 * f64::exp(2.0 * hidden * 2f64.ln());
            let error = sigma * normal();
            Frame {
                // Many, beside which the prior weighs little.
                clip: i % 60,
                errors: [error; 9],
                sigmas: [sigma; 9],
                yaw_deg: 10.0,
                covered: 0.0,
                box_px: 100.0,
                terms: [1.0, 0.0, 0.0, hidden, 0.0, 0.0],
                systematic: [error; 6],
            }
        };
        (0..6000).map(&mut frame).collect()
    }

    #[test]
    fn the_fit_finds_the_deviations() {
        let fitted = fit(&frames(), 0);
        for hidden in [0.0, 0.5] {
            let sigma = (fitted[0] + fitted[3] * hidden).exp();
            let of = frames().into_iter().filter(|f| f.terms[3] == hidden);
            let errors: Vec<f64> = of.map(|f| f.systematic[0].abs()).collect();
            let within = errors.iter().filter(|e| **e <= 2.0 * sigma).count();
            let share = within as f64 / errors.len() as f64;
            assert!(
                (WITHIN..0.995).contains(&share),
                "{hidden}: {share} {fitted}"
            );
        }
    }

    #[test]
    fn true_deviations_are_reported_as_such() {
        let bands = figures(&frames());
        let all = &bands["all"]["yaw"];
        let within = all["within_2_sigma_%"].as_f64().unwrap();
        assert!((within - 95.4).abs() < 1.0, "{bands}");
        assert!(bands["small"].is_null());
    }
}
