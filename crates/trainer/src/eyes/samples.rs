//! Samples for the network of single eyes: crops as the tracker cuts them, disturbed, and what the
//! network is to say of them.

use super::cover;
use super::crop::{ROLL, turned};
use super::glint;
use super::lens;
use super::photographed::{self, PhotographedEye};
use super::single::SingleEye;
use crate::align::{Augment, Sample, Sizes, Source, disturb, normal, standardise};
use crate::head::{Labels, marks_px};
use crate::render::eye_cache::{Eye, FIRST};
use crate::render::glare::GLARE;
use glam::{EulerRot, Mat3};
use posewise::align::{EYE_OUTPUTS, EyePlace};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Units of a gaze's sine, and of a class, in the network's outputs: about what an error of a pixel
/// of the iris is worth.
pub const GAZE_UNIT: f32 = 11.0;
pub const CLASS_UNIT: f32 = 4.0;

/// Standard deviations of what the tracker errs by: middle of the eye \[mm\], logarithm of scale,
/// rotation of the head \[rad\].
const SHIFT_MM: f32 = 1.1;
const LOG_SCALE: f32 = 0.06;
const TURN: f32 = 0.05;

/// Least share of an iris that is seen for a label of its place and of the gaze.
const SEEN: f32 = 0.35;
/// Opacity from which a lens is dark.
pub const DARK: f32 = 0.5;
/// Mirrored light in which nothing is seen of an eye.
const BLINDING: f32 = 2.0 * GLARE;
/// Weights of the lids from which an eye is shut, and to which it is open.
const SHUT: f32 = 0.85;
const OPEN: f32 = 0.35;
/// Least share of an eye that is not hidden, for labels of the lids; and that from which nothing
/// hides it.
const VISIBLE: f32 = 0.5;
const WHOLE: f32 = 0.95;
/// How much the lids of photographs count.
const SINGLE_WEIGHT: f32 = 1.5;
/// How much lids count of which nothing is seen.
const UNSEEN_WEIGHT: f32 = 0.6;

/// What the network is trained on.
pub struct Eyes<'a> {
    /// Rendered eyes.
    pub rendered: &'a [Eye],
    /// Those of photographed faces, and their share among the samples.
    pub photographed: &'a [PhotographedEye],
    pub photographed_share: f32,
    /// Photographs of single eyes; none for a model without.
    pub single: &'a [SingleEye],
    /// Share of these among the samples.
    pub single_share: f32,
    /// The network.
    pub sizes: &'a Sizes,
    /// How crops are disturbed.
    pub augment: &'a Augment,
    /// As in [`super::EyeOptions`].
    pub by_nose: f32,
}

/// Where the tracker takes a render's eye to be.
pub fn place_of(eye: &Eye, rng: &mut ChaCha8Rng) -> EyePlace {
    let [x, y, z] = [TURN, TURN, ROLL].map(|sigma| sigma * normal(rng));
    let rotation = Mat3::from_euler(EulerRot::XYZ, x, y, z) * eye.rotation;
    let points = marked(eye);
    let middle = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f32>() / 6.0);
    let distance = eye.truth.centre.z;
    let place = EyePlace::new(&points, middle, &eye.camera, &rotation, distance)
        .expect("a rendered eye has extent");
    let mut noise = |sigma: f32| sigma * normal(rng);
    let jitter = turned(noise(LOG_SCALE), 0.0, [noise(SHIFT_MM), noise(SHIFT_MM)]);
    EyePlace {
        to_frame: jitter.then(&place.to_frame),
        ..place
    }
}

/// A render's lids where people mark them, as the tracker's are \[px\].
fn marked(eye: &Eye) -> [[f32; 2]; 6] {
    let scale = eye.camera.fx / eye.truth.centre.z;
    let marks = &marks_px(Labels::Convention, eye.rotation, scale)[FIRST[eye.side]..];
    std::array::from_fn(|i| (eye.landmarks[i] + marks[i]).to_array())
}

/// How much of an eye is left to be seen by what a lens mirrors before it, 0..1.
fn seen_through(eye: &Eye) -> f32 {
    (1.0 - eye.truth.glare / BLINDING).max(0.0)
}

/// Whether iris and gaze of a render are labels.
pub fn is_looking(eye: &Eye) -> bool {
    eye.truth.seen >= SEEN && eye.truth.lens < DARK && eye.truth.glare < GLARE
}

/// Share of a render's eye that nothing solid and no dark lens hides.
fn visible_share(eye: &Eye) -> f32 {
    match eye.truth.lens < DARK {
        true => 1.0 - eye.truth.hidden,
        false => 0.0,
    }
}

/// Whether a render's lids are seen.
fn has_lids(eye: &Eye) -> bool {
    visible_share(eye) >= VISIBLE && eye.truth.glare < BLINDING
}

/// Whether a render's lids are open or shut; `None` in between and where they are hidden.
pub fn is_open(eye: &Eye) -> Option<bool> {
    match eye.blink {
        SHUT.. => Some(false).filter(|_| has_lids(eye)),
        ..OPEN => Some(true).filter(|_| has_lids(eye)),
        _ => None,
    }
}

/// Whether nothing hides a render's eye; `None` where something hides a part.
pub fn is_visible(eye: &Eye) -> Option<bool> {
    match has_lids(eye) {
        false => Some(false),
        true => (visible_share(eye) >= WHOLE && eye.truth.glare < 0.5 * GLARE).then_some(true),
    }
}

/// What the network is to say of lids of which this share is seen, and how much that counts: their
/// opening, from the value of a shut eye's class to that of an open one, so that half-shut lids are
/// in between, and the middle where nothing is seen of them.
fn lids(opening: f32, seen: f32) -> (f32, f32) {
    match seen > 0.0 {
        true => (opening, (2.0 * seen).min(1.0)),
        false => (0.0, UNSEEN_WEIGHT),
    }
}

fn class(is: bool) -> f32 {
    if is { CLASS_UNIT } else { -CLASS_UNIT }
}

/// The sample of a photograph: of lids of this opening, of which this share is seen.
fn without_gaze(crop: Vec<f32>, opening: f32, seen: f32) -> Sample {
    let (lids, weight) = lids(opening, seen);
    Sample {
        crop,
        start: vec![[0.0; 2]; EYE_OUTPUTS],
        truth: vec![
            [0.0; 2],
            [0.0; 2],
            [lids, CLASS_UNIT * (2.0 * seen - 1.0)],
            [0.0; 2],
        ],
        weights: vec![0.0, 0.0, weight, 0.0],
    }
}

impl Eyes<'_> {
    fn rendered(&self, rng: &mut ChaCha8Rng) -> Sample {
        let eye = &self.rendered[rng.random_range(0..self.rendered.len())];
        let place = place_of(eye, rng);
        let mirror = eye.side == 1;
        let sign = if mirror { -1.0 } else { 1.0 };
        let to_frame = turned(-self.sizes.zoom.ln(), 0.0, [0.0; 2]).then(&place.to_frame);
        let back = to_frame.inverse().expect("a crop has extent");
        let [x, y] = back.apply(eye.truth.iris.to_array());
        let sine = place.to_camera.transpose() * eye.truth.gaze - self.by_nose * place.nose;
        let mut crop = eye.picture.crop(&to_frame, self.sizes.side, mirror);
        let drawn = match eye.truth.lens > 0.0 {
            true => None,
            false => lens::draw(&mut crop, self.sizes.side, self.sizes.zoom, rng),
        };
        let covered = cover::draw(&mut crop, self.sizes.side, self.sizes.zoom, rng);
        let seen = (1.0 - covered) * drawn.map_or(seen_through(eye), |lens| lens.leaves());
        let opening = CLASS_UNIT * (1.0 - 2.0 * eye.blink.clamp(0.0, 1.0));
        let (lids, lids_weight) = lids(opening, if has_lids(eye) { seen } else { 0.0 });
        let visible = visible_share(eye) * seen;
        let looking = f32::from(is_looking(eye)) * eye.truth.seen * seen;
        let glasses = [
            class(drawn.is_some() || eye.truth.lens > 0.0),
            class(drawn.is_some_and(|lens| lens.dark) || eye.truth.lens > DARK),
        ];
        Sample {
            crop,
            start: vec![[0.0; 2]; EYE_OUTPUTS],
            truth: vec![
                [sign * x, y],
                [GAZE_UNIT * sign * sine.x, GAZE_UNIT * sine.y],
                [lids, CLASS_UNIT * (2.0 * visible - 1.0)],
                glasses,
            ],
            weights: vec![looking, 2.0 * looking, lids_weight, 0.5],
        }
    }

    fn photographed(&self, rng: &mut ChaCha8Rng) -> Sample {
        let eye = &self.photographed[rng.random_range(0..self.photographed.len())];
        let (side, zoom) = (self.sizes.side, self.sizes.zoom);
        let photographed::Seen { mut crop, shut } = eye.draw(side, zoom, rng);
        let drawn = lens::draw(&mut crop, side, zoom, rng);
        let covered = cover::draw(&mut crop, side, zoom, rng);
        let seen = (1.0 - covered) * drawn.map_or(1.0, |lens| lens.leaves());
        let mut sample = without_gaze(crop, CLASS_UNIT * (1.0 - 2.0 * shut), seen);
        // Whether there are glasses nobody says but where they are drawn.
        if let Some(lens) = drawn {
            sample.truth[3] = [class(true), class(lens.dark)];
            sample.weights[3] = 0.5;
        }
        sample
    }

    fn single(&self, rng: &mut ChaCha8Rng) -> Sample {
        let eye = &self.single[rng.random_range(0..self.single.len())];
        let mut crop = eye.crop(self.sizes, rng);
        let covered = cover::draw(&mut crop, self.sizes.side, self.sizes.zoom, rng);
        let mut sample = without_gaze(crop, class(eye.open), 1.0 - covered);
        sample.weights[2] *= SINGLE_WEIGHT;
        sample
    }
}

impl Source for Eyes<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        let is_single = !self.single.is_empty() && rng.random_range(0.0..1.0) < self.single_share;
        let is_photographed =
            !self.photographed.is_empty() && rng.random_range(0.0..1.0) < self.photographed_share;
        let mut sample = match (is_single, is_photographed) {
            (true, _) => self.single(rng),
            (false, true) => self.photographed(rng),
            (false, false) => self.rendered(rng),
        };
        glint::draw(&mut sample.crop, self.sizes.side, self.sizes.zoom, rng);
        disturb(&mut sample.crop, self.sizes.side, self.augment, rng);
        standardise(&mut sample.crop);
        sample
    }

    fn aperture(&self, _: &crate::align::Aperture) -> Vec<([usize; 2], f32)> {
        vec![]
    }

    fn offset(&self) -> Vec<[f32; 2]> {
        vec![[0.0; 2]; EYE_OUTPUTS]
    }
}
