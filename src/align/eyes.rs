//! A network that sees one eye at a time (section `EYES`): whether it is open, where the middle of
//! its iris is, where it looks, whether something hides it, and whether the person wears glasses.
//!
//! An eye is seen by a virtual camera that looks straight at it, rolled so that the head's vertical
//! axis is vertical, at a fixed number of pixels per millimetre; the person's left eye is mirrored.
//! An eyeball turns about a point behind the corners of the eye, so a gaze is a linear function of
//! where the iris is between them, which the network sees, and of how the head is turned, which the
//! pose says.

use super::regressor::Regressor;
use super::workspace::Workspace;
use crate::image::{Frame, warp};
use crate::math::{Similarity, sigmoid, towards};
use crate::shape::Intrinsics;
use glam::{Mat3, Vec3};
use posewise_format::{Blob, ModelError, Section};

/// Name of the section.
pub const EYES_TAG: [u8; 4] = *b"EYES";
/// Pairs of numbers that the network gives: iris, gaze, lids and visibility, glasses.
pub const EYE_OUTPUTS: usize = 4;

/// Classes of an eye: open, glasses, dark glasses, visible.
const CLASSES: usize = 4;
/// Numbers of a coordinate of the gaze: by the network, by the iris \[mm\], by the nose's x and y,
/// constant.
const GAZE: usize = 5;
/// Numbers of the logarithm of the gaze's deviation: by px per mm, by the lids, by the turn of the
/// head, constant.
const SIGMA: usize = 4;
/// Largest sine of an angle between gaze and line of sight.
const MOST_SINE: f32 = 0.99;
/// Luma from which a pixel is overexposed.
const OVEREXPOSED: u8 = 250;
/// Least part of the head's vertical axis that is seen across the line of sight.
const LEAST_DOWN: f32 = 1e-3;
/// An eye is not nearer.
const MOST_PX_PER_MM: f32 = 1e4;
/// Range of a gaze's standard deviation \[rad\].
const SIGMAS: (f32, f32) = (0.005, 1.5);

/// A checked view of section `EYES`; empty where the model lacks it.
#[derive(Clone, Debug, Default)]
pub struct EyeModel<'m> {
    numbers: Option<Numbers<'m>>,
}

/// What the section holds.
#[derive(Clone, Debug)]
struct Numbers<'m> {
    /// Slope and offset of the logarithm of odds of each class.
    classes: &'m [f32],
    gaze: &'m [f32],
    sigma: &'m [f32],
    /// The network, which is read again for each run.
    network: Section<'m>,
}

/// Where an eye is.
#[derive(Clone, Copy, Debug)]
pub struct EyePlace {
    /// Millimetres from the middle of the eye, in the crop's axes → frame px.
    pub to_frame: Similarity,
    /// The crop's axes → the camera's.
    pub to_camera: Mat3,
    /// Direction of the nose in the crop's axes.
    pub nose: Vec3,
}

/// What the network says of an eye.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenEye {
    /// Probability that it is open.
    pub open: f32,
    /// Probability of glasses before it.
    pub glasses: f32,
    /// Probability that they are dark.
    pub dark: f32,
    /// Probability that nothing hides it: no hand, rim or reflection.
    pub visible: f32,
    /// Middle of the iris \[frame px\].
    pub iris: [f32; 2],
    /// Unit gaze, camera axes.
    pub gaze: Vec3,
    /// Its standard deviation along each axis \[rad\].
    pub sigma_rad: f32,
    /// Share of the crop that is overexposed.
    pub glare: f32,
}

impl EyePlace {
    /// The place of the eye with these landmarks (frame px), so far away, on a head of this
    /// rotation; `undistorted` is their middle as a pinhole camera shows it. `None` where it has no
    /// extent.
    pub fn new(
        landmarks: &[[f32; 2]],
        undistorted: [f32; 2],
        camera: &Intrinsics,
        rotation: &Mat3,
        distance_mm: f32,
    ) -> Option<EyePlace> {
        let [x, y] = undistorted;
        let ray = Vec3::new(
            (x - camera.cx) / camera.fx,
            (y - camera.cy) / camera.fy,
            1.0,
        );
        let straight = towards(ray);
        let head = straight.transpose() * *rotation;
        let down = head.y_axis;
        let length = libm::sqrtf(down.x * down.x + down.y * down.y);
        let px_per_mm = camera.fx / distance_mm;
        // Not for a NaN.
        if !(length > LEAST_DOWN && (0.0..MOST_PX_PER_MM).contains(&px_per_mm)) {
            return None;
        }
        let (sin, cos) = (-down.x / length, down.y / length);
        let rolled = Mat3::from_cols(Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0), Vec3::Z);
        let n = landmarks.len().max(1) as f32;
        let sum = (landmarks.iter()).fold([0.0, 0.0], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        let to_frame = Similarity {
            a: px_per_mm * cos,
            b: px_per_mm * sin,
            tx: sum[0] / n,
            ty: sum[1] / n,
        };
        to_frame.inverse()?;
        Some(EyePlace {
            to_frame,
            to_camera: straight * rolled,
            nose: -(rolled.transpose() * head).z_axis,
        })
    }
}

impl<'m> EyeModel<'m> {
    /// Reads and checks the section: `classes: f32[8], gaze: f32[10], sigma: f32[4]`, and a
    /// regressor of [`EYE_OUTPUTS`] points whose `zoom` is in crop px per mm.
    ///
    /// # Errors
    /// When the section is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        let mut s = match blob.section(&EYES_TAG) {
            Err(ModelError::Missing(_)) => return Ok(EyeModel::default()),
            other => other?,
        };
        let (classes, gaze) = (s.f32s(2 * CLASSES)?, s.f32s(2 * GAZE)?);
        let sigma = s.f32s(SIGMA)?;
        let numbers = Numbers {
            classes,
            gaze,
            sigma,
            network: s.clone(),
        };
        Regressor::open(&mut s, EYE_OUTPUTS)?;
        Ok(EyeModel {
            numbers: Some(numbers),
        })
    }

    /// Whether the model has the section.
    pub fn is_present(&self) -> bool {
        self.numbers.is_some()
    }

    /// Multiply-adds for both eyes.
    #[cfg(feature = "unstable-internals")]
    pub fn multiply_adds(&self) -> usize {
        let network = self.numbers.as_ref().map(|numbers| numbers.network.clone());
        let read = network.map(|mut section| Regressor::read(&mut section, EYE_OUTPUTS));
        match read {
            Some(Ok(regressor)) => 2 * regressor.multiply_adds(),
            _ => 0,
        }
    }

    /// Looks at an eye, the person's left one with `mirror`. `None` where the model lacks the
    /// section.
    #[inline(never)]
    pub fn run(
        &self,
        frame: &Frame<'_>,
        place: &EyePlace,
        mirror: bool,
        work: &mut Workspace,
    ) -> Option<SeenEye> {
        let numbers = self.numbers.as_ref()?;
        // Reading cannot fail: `open` checked the section.
        let regressor = Regressor::read(&mut numbers.network.clone(), EYE_OUTPUTS).ok()?;
        let zoom = regressor.zoom();
        let crop_to_mm = Similarity {
            a: 1.0 / zoom,
            ..Similarity::IDENTITY
        };
        let to_frame = crop_to_mm.then(&place.to_frame);
        let centre = (regressor.side() as f32 - 1.0) / 2.0;
        let [tx, ty] = to_frame.apply([-centre, -centre]);
        let corner_to_frame = Similarity { tx, ty, ..to_frame };
        let (crop, memory) = work.eye_memory();
        warp(frame, &corner_to_frame, regressor.side(), crop);
        if mirror {
            crop.mirror();
        }
        let bright = crop.luma().iter().filter(|v| **v >= OVEREXPOSED).count();
        let glare = bright as f32 / crop.luma().len().max(1) as f32;
        crop.standardise();
        let mut outputs = [[0.0f32; 2]; EYE_OUTPUTS];
        regressor.run(crop, &mut outputs, memory);
        let [iris, gaze, [open, visible], [glasses, dark]] = outputs;
        let sign = if mirror { -1.0 } else { 1.0 };
        let class = |k: usize, value: f32| {
            let slope = numbers.classes.get(2 * k).copied().unwrap_or(0.0);
            sigmoid(slope * value + numbers.classes.get(2 * k + 1).copied().unwrap_or(0.0))
        };
        let open = class(0, open);
        let iris_mm = iris.map(|v| v / zoom);
        let (gaze, sigma_rad) = numbers.gaze([gaze, iris_mm], place, sign, open);
        Some(SeenEye {
            open,
            glasses: class(1, glasses),
            dark: class(2, dark),
            visible: class(3, visible),
            iris: to_frame.apply([sign * iris[0], iris[1]]),
            gaze,
            sigma_rad,
            glare,
        })
    }
}

impl Numbers<'_> {
    /// Gaze in camera axes and its standard deviation; `sign` is −1 for a mirrored eye.
    fn gaze(
        &self,
        [output, iris_mm]: [[f32; 2]; 2],
        place: &EyePlace,
        sign: f32,
        open: f32,
    ) -> (Vec3, f32) {
        let nose = [sign * place.nose.x, place.nose.y];
        let mut sine = [0.0f32; 2];
        let seen = output.into_iter().zip(iris_mm);
        let numbers = self.gaze.as_chunks::<GAZE>().0.iter();
        for ((sine, (output, iris)), numbers) in sine.iter_mut().zip(seen).zip(numbers) {
            let [by_output, by_iris, by_x, by_y, constant] = *numbers;
            let turned = by_x * nose[0] + by_y * nose[1];
            *sine = by_output * output + by_iris * iris + turned + constant;
        }
        let [x, y] = sine;
        let length = libm::sqrtf(x * x + y * y);
        let shorter = MOST_SINE / length.max(MOST_SINE);
        let (x, y) = (sign * shorter * x, shorter * y);
        let z = -libm::sqrtf((1.0 - x * x - y * y).max(0.0));
        let [by_size, by_lids, by_turn, constant] = self
            .sigma
            .first_chunk::<SIGMA>()
            .copied()
            .unwrap_or_default();
        let log_sigma = by_size * libm::logf(place.to_frame.scale().max(1e-3))
            + by_lids * (1.0 - open)
            + by_turn * (1.0 + place.nose.z)
            + constant;
        let sigma = libm::expf(log_sigma.clamp(-10.0, 10.0));
        let gaze = place.to_camera * Vec3::new(x, y, z);
        (gaze, sigma.clamp(SIGMAS.0, SIGMAS.1))
    }
}
