//! Calibrates the outputs of a network of single eyes, and measures it.

use super::samples::{DARK, GAZE_UNIT, is_looking, is_open, is_visible, place_of};
use super::single::{SingleEye, WIDTH};
use crate::align::each;
use crate::render::eye_cache::Eye;
use crate::verifier::platt;
use anyhow::{Context, Result};
use glam::Mat3;
use posewise::align::{EyeModel, EyePlace, SeenEye, Workspace};
use posewise_format::{AlignedBytes, Blob, Section, SectionWriter, blob};
use posewise_metrics::auc;
use rayon::prelude::*;
use serde::Serialize;

/// Numbers of a coordinate of the gaze: by the network, by the iris \[mm\], by the nose's x and y,
/// constant.
const GAZE_INPUTS: usize = 5;

/// What the section holds before the network.
#[derive(Clone, Debug)]
pub struct Numbers {
    classes: [f32; 8],
    gaze: [[f32; GAZE_INPUTS]; 2],
    sigma: [f32; 4],
}

impl Numbers {
    /// Those by which outputs come out as they are.
    pub fn first(by_nose: f32) -> Numbers {
        Numbers {
            classes: [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
            gaze: [
                [1.0 / GAZE_UNIT, 0.0, by_nose, 0.0, 0.0],
                [1.0 / GAZE_UNIT, 0.0, 0.0, by_nose, 0.0],
            ],
            sigma: [0.0, 0.0, 0.0, -2.0],
        }
    }

    /// Begins the section.
    pub fn write(&self, out: &mut SectionWriter) {
        out.array(&self.classes);
        out.array(&self.gaze.concat());
        out.array(&self.sigma);
    }

    /// Reads over them.
    pub fn skip(section: &mut Section<'_>) -> Result<()> {
        let numbers = Numbers::first(0.0);
        section.f32s(numbers.classes.len())?;
        section.f32s(numbers.gaze.as_flattened().len())?;
        section.f32s(numbers.sigma.len())?;
        Ok(())
    }
}

/// An eye, where it was taken to be, and what the network says of it.
struct Looked<'a> {
    eye: &'a Eye,
    place: EyePlace,
    seen: SeenEye,
}

impl Looked<'_> {
    /// Angle between the gaze and the truth \[rad\].
    fn error(&self) -> f32 {
        self.seen
            .gaze
            .dot(self.eye.truth.gaze)
            .clamp(-1.0, 1.0)
            .acos()
    }

    /// Whether its gaze counts.
    fn looks(&self) -> bool {
        is_looking(self.eye) && is_open(self.eye) == Some(true)
    }
}

fn with_model<T>(section: &SectionWriter, run: impl FnOnce(&EyeModel<'_>) -> T) -> Result<T> {
    let bytes = AlignedBytes::new(&blob(std::slice::from_ref(section)));
    Ok(run(&EyeModel::open(&Blob::open(&bytes)?)?))
}

fn look<'a>(model: &EyeModel<'_>, eyes: &'a [Eye]) -> Vec<Looked<'a>> {
    let looked = each(eyes, 5, |_, eye, rng, work| {
        let place = place_of(eye, rng);
        let seen = model.run(&eye.picture.frame(), &place, eye.side == 1, work);
        seen.map(|seen| Looked { eye, place, seen })
    });
    looked.into_iter().flatten().collect()
}

fn logit(p: f32) -> f32 {
    (p.max(1e-12) / (1.0 - p).max(1e-7)).ln()
}

/// Slope and offset of a class.
fn class(looked: &[Looked<'_>], of: impl Fn(&Looked<'_>) -> Option<(f32, bool)>) -> [f32; 2] {
    let pairs: Vec<(f32, bool)> = looked.iter().filter_map(of).collect();
    let (scores, labels): (Vec<f32>, Vec<bool>) =
        pairs.into_iter().map(|(p, is)| (logit(p), is)).unzip();
    let ([slope, _], offset) = platt(&scores, &labels, None, None);
    [slope, offset]
}

/// Least squares.
fn solve<const N: usize>(rows: &[[f32; N]], truth: &[f32]) -> Result<[f32; N]> {
    let mut square = nalgebra::SMatrix::<f64, N, N>::identity() * 1e-6;
    let mut right = nalgebra::SVector::<f64, N>::zeros();
    for (row, t) in rows.iter().zip(truth) {
        let x = nalgebra::SVector::<f64, N>::from(row.map(f64::from));
        square += x * x.transpose();
        right += x * f64::from(*t);
    }
    let inverse = square
        .try_inverse()
        .context("numbers are not independent")?;
    let solved = inverse * right;
    Ok(std::array::from_fn(|k| solved[k] as f32))
}

/// The mean of the logarithm of a length whose two coordinates have the deviation 1.
const LOG_RAYLEIGH: f32 = 0.058;

/// The numbers of a section that has the first ones, by these eyes.
pub fn calibrate(first: &SectionWriter, eyes: &[Eye], by_nose: f32) -> Result<Numbers> {
    with_model(first, |model| {
        let mut looked = look(model, eyes);
        let open = class(&looked, |l| Some((l.seen.open, is_open(l.eye)?)));
        let glasses = class(&looked, |l| Some((l.seen.glasses, l.eye.truth.lens > 0.0)));
        let dark = class(&looked, |l| Some((l.seen.dark, l.eye.truth.lens > DARK)));
        let mut numbers = Numbers::first(by_nose);
        let visible = class(&looked, |l| Some((l.seen.visible, is_visible(l.eye)?)));
        numbers.classes = [open, glasses, dark, visible]
            .concat()
            .try_into()
            .expect("eight numbers");
        looked.retain(Looked::looks);
        for (k, numbers) in numbers.gaze.iter_mut().enumerate() {
            let in_crop = |l: &Looked<'_>, v: glam::Vec3| {
                let sign = if l.eye.side == 1 && k == 0 { -1.0 } else { 1.0 };
                sign * (l.place.to_camera.transpose() * v)[k]
            };
            let row = |l: &Looked<'_>| {
                let sign = if l.eye.side == 1 { -1.0 } else { 1.0 };
                let iris = l.place.to_frame.inverse().expect("an eye has extent");
                let iris = iris.apply(l.seen.iris);
                let iris = [sign * iris[0], iris[1]];
                let gaze = in_crop(l, l.seen.gaze);
                [gaze, iris[k], sign * l.place.nose.x, l.place.nose.y, 1.0]
            };
            let rows: Vec<[f32; GAZE_INPUTS]> = looked.iter().map(row).collect();
            let truth: Vec<f32> = (looked.iter())
                .map(|l| in_crop(l, l.eye.truth.gaze))
                .collect();
            let [by_gaze, more @ ..] = solve(&rows, &truth)?;
            let more = std::iter::once(0.0).chain(more);
            for (number, more) in numbers.iter_mut().zip(more) {
                *number = *number * by_gaze + more;
            }
        }
        let rows: Vec<[f32; 4]> = (looked.iter())
            .map(|l| {
                let shut = 1.0 - 1.0 / (1.0 + (-(open[0] * logit(l.seen.open) + open[1])).exp());
                [
                    l.place.to_frame.scale().ln(),
                    shut,
                    1.0 + l.place.nose.z,
                    1.0,
                ]
            })
            .collect();
        let lengths: Vec<f32> = looked
            .iter()
            .map(|l| l.error().max(1e-3).ln() - LOG_RAYLEIGH)
            .collect();
        numbers.sigma = solve(&rows, &lengths)?;
        Ok(numbers)
    })?
}

/// How well a section does on rendered and photographed eyes.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Mean error of the gaze of one eye within 30° of yaw \[deg\], by width of the face: below 90
    /// px, to 150 px, more; and of all.
    pub gaze_deg: [f32; 4],
    /// The same of both eyes together.
    pub both_deg: f32,
    /// Mean distance of the iris there \[mm\].
    pub iris_mm: f32,
    /// Area under the ROC of the lids, of glasses, of dark glasses and of visible eyes.
    pub auc: [Option<f64>; 4],
    /// The same of photographs of single eyes, and the share that is right at 0.5.
    pub single_auc: Option<f64>,
    pub single_right: Option<f32>,
}

/// Width of a face, roughly \[mm\].
const FACE_MM: f32 = 150.0;
/// Largest yaw of the figures of the gaze \[deg\].
const MOST_YAW_DEG: f32 = 30.0;

/// Measures a section.
pub fn figures(section: &SectionWriter, eyes: &[Eye], single: &[SingleEye]) -> Result<Figures> {
    with_model(section, |model| {
        let looked = look(model, eyes);
        let area = |of: &dyn Fn(&Looked<'_>) -> Option<(f32, bool)>| {
            let pairs = looked
                .iter()
                .filter_map(of)
                .map(|(p, is)| (f64::from(p), is));
            auc(&pairs.collect::<Vec<_>>())
        };
        let yaw = |r: &Mat3| (-r.z_axis.x).atan2(r.z_axis.z).to_degrees();
        let frontal: Vec<_> = (looked.iter())
            .filter(|l| l.looks() && yaw(&l.eye.rotation).abs() <= MOST_YAW_DEG)
            .collect();
        let mean = |from: f32, to: f32| {
            let width = |l: &Looked<'_>| FACE_MM * l.place.to_frame.scale();
            let chosen: Vec<f32> = (frontal.iter())
                .filter(|l| (from..to).contains(&width(l)))
                .map(|l| l.error().to_degrees())
                .collect();
            chosen.iter().sum::<f32>() / chosen.len().max(1) as f32
        };
        let pairs = frontal.windows(2).filter(|pair| {
            let [a, b] = [0, 1].map(|k| &pair[k].eye.picture);
            std::sync::Arc::ptr_eq(a, b)
        });
        let both: Vec<f32> = pairs
            .map(|pair| {
                let of = |gaze: &dyn Fn(&Looked<'_>) -> glam::Vec3| {
                    (gaze(pair[0]) + gaze(pair[1])).normalize()
                };
                let (seen, truth) = (of(&|l| l.seen.gaze), of(&|l| l.eye.truth.gaze));
                seen.dot(truth).clamp(-1.0, 1.0).acos().to_degrees()
            })
            .collect();
        let iris = frontal.iter().map(|l| {
            let [x, y] = l.seen.iris;
            let [tx, ty] = l.eye.truth.iris.to_array();
            (x - tx).hypot(y - ty) / l.place.to_frame.scale()
        });
        let opened = look_single(model, single, WIDTH);
        let right = opened
            .iter()
            .filter(|(p, open)| (*p > 0.5) == *open)
            .count();
        Ok(Figures {
            gaze_deg: [
                mean(0.0, 90.0),
                mean(90.0, 150.0),
                mean(150.0, f32::MAX),
                mean(0.0, f32::MAX),
            ],
            both_deg: both.iter().sum::<f32>() / both.len().max(1) as f32,
            iris_mm: iris.sum::<f32>() / frontal.len().max(1) as f32,
            auc: [
                area(&|l| Some((l.seen.open, is_open(l.eye)?))),
                area(&|l| Some((l.seen.glasses, l.eye.truth.lens > 0.0))),
                area(&|l| Some((l.seen.dark, l.eye.truth.lens > DARK))),
                area(&|l| Some((l.seen.visible, is_visible(l.eye)?))),
            ],
            single_auc: auc(&opened),
            single_right: (!single.is_empty()).then(|| right as f32 / single.len() as f32),
        })
    })?
}

/// Probability that each is open, and whether it is; `width` of an eye in that of its picture.
pub fn look_single(model: &EyeModel<'_>, single: &[SingleEye], width: f32) -> Vec<(f64, bool)> {
    let looked = single.par_iter().map_init(
        || Box::new(Workspace::new()),
        |work, eye| {
            let place = EyePlace {
                to_frame: eye.place_of_width(width),
                to_camera: Mat3::IDENTITY,
                nose: -glam::Vec3::Z,
            };
            let seen = model.run(&eye.picture.frame(), &place, false, work)?;
            Some((f64::from(seen.open), eye.open))
        },
    );
    looked.flatten().collect()
}
