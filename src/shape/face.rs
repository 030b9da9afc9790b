//! The 3D face: section `FACE` of a model, and points evaluated from it.

use super::{ANIMATIONS, Animation, Identity, LANDMARKS, MAX_IDENTITIES, Pose};
use crate::math::head_angles;
use crate::model::{ModelError, Section, Tag};
use glam::Vec3;

/// Name of the section.
pub const FACE_TAG: Tag = *b"FACE";

/// Jaw landmarks (0–16), which follow the visible contour in the image.
pub const JAW: usize = 17;

/// Contour candidates of a jaw landmark beside the landmark itself, at most.
pub const MAX_EXTRA: usize = 7;

/// Most points of a face model: landmarks, then the extra contour candidates in jaw order.
pub const MAX_POINTS: usize = LANDMARKS + JAW * MAX_EXTRA;

/// View directions of the visibility table: azimuths −120..120° in these steps …
pub const VIEW_AZIMUTHS: usize = 33;
/// … elevations −60..60° …
pub const VIEW_ELEVATIONS: usize = 17;
/// … \[deg\].
pub const VIEW_STEP_DEG: f32 = 7.5;
/// Bytes of one landmark's bits: bit `azimuth · VIEW_ELEVATIONS + elevation`, least first.
pub const VIEW_BYTES: usize = (VIEW_AZIMUTHS * VIEW_ELEVATIONS).div_ceil(8);

/// Coordinates beyond this are not a face's \[mm\].
const LARGEST_MM: f32 = 1000.0;

/// A checked view of the section.
///
/// Content, in this order: u32 number of points, u32 number of identity modes K; arrays: u8 number
/// of extra candidates per jaw landmark (17); f32 mean (points × 3, mm); f32 identity scales (K);
/// i8 identity modes (points × K × 3, in scales); f32 animation scales (24); i8 animation modes
/// (points × 24 × 3); f32 outward directions of the jaw landmarks in the frontal view (17 × 2);
/// f32 landmark noise (68, mm); f32 animation standard deviations (24); u8 visibility bits
/// (68 × [`VIEW_BYTES`]).
#[derive(Clone, Copy, Debug)]
pub struct FaceModel<'m> {
    identities: usize,
    extra: &'m [u8],
    mean: &'m [[f32; 3]],
    identity_scale: &'m [f32],
    identity: &'m [i8],
    animation_scale: &'m [f32],
    animation: &'m [[i8; 3]],
    outward: &'m [[f32; 2]],
    noise_mm: &'m [f32],
    animation_sigma: &'m [f32],
    visible: &'m [u8],
}

impl<'m> FaceModel<'m> {
    /// Checks and views the section.
    ///
    /// # Errors
    /// [`ModelError::Section`] says what is wrong.
    pub fn open(mut section: Section<'m>) -> Result<Self, ModelError> {
        let s = &mut section;
        let points = s.count(LANDMARKS, MAX_POINTS, "the number of points")?;
        let identities = s.count(0, MAX_IDENTITIES, "the number of identity modes")?;
        let extra = s.u8s(JAW)?;
        let total: usize = extra.iter().map(|e| *e as usize).sum();
        s.require(
            extra.iter().all(|e| *e as usize <= MAX_EXTRA) && LANDMARKS + total == points,
            "the contour candidates do not add up",
        )?;
        let within =
            |values: &[f32], min: f32, max: f32| values.iter().all(|v| (min..=max).contains(v));
        let mean = s.f32s(points * 3)?;
        s.require(
            within(mean, -LARGEST_MM, LARGEST_MM),
            "the mean is too large",
        )?;
        let identity_scale = s.f32s(identities)?;
        let identity = s.i8s(points * identities * 3)?;
        let animation_scale = s.f32s(ANIMATIONS)?;
        let animation = s.i8s(points * ANIMATIONS * 3)?;
        s.require(
            within(identity_scale, 0.0, 10.0) && within(animation_scale, 0.0, 10.0),
            "a mode's scale is out of range",
        )?;
        let outward = s.f32s(JAW * 2)?;
        s.require(
            within(outward, -1.0, 1.0),
            "an outward direction is too long",
        )?;
        let noise_mm = s.f32s(LANDMARKS)?;
        let animation_sigma = s.f32s(ANIMATIONS)?;
        s.require(
            within(noise_mm, 0.1, 100.0) && within(animation_sigma, 0.01, 10.0),
            "a standard deviation is out of range",
        )?;
        let visible = s.u8s(LANDMARKS * VIEW_BYTES)?;
        Ok(FaceModel {
            identities,
            extra,
            mean: mean.as_chunks().0,
            identity_scale,
            identity,
            animation_scale,
            animation: animation.as_chunks().0,
            outward: outward.as_chunks().0,
            noise_mm,
            animation_sigma,
            visible,
        })
    }

    /// Number of identity modes; weights beyond it are ignored.
    pub fn identities(&self) -> usize {
        self.identities
    }

    /// Standard deviation of each landmark's image position, as a length on the face \[mm\].
    pub(super) fn noise_mm(&self) -> &'m [f32] {
        self.noise_mm
    }

    /// Standard deviation of each animation weight.
    pub(super) fn animation_sigma(&self) -> &'m [f32] {
        self.animation_sigma
    }

    /// Outward directions of the jaw landmarks in the frontal view.
    pub(super) fn outward(&self) -> &'m [[f32; 2]] {
        self.outward
    }

    /// Numbers of the extra candidates of each jaw landmark: ranges into a [`Shape`].
    pub(super) fn candidates(&self) -> impl Iterator<Item = core::ops::Range<usize>> + 'm {
        self.extra.iter().scan(LANDMARKS, |at, extra| {
            let start = *at;
            *at += *extra as usize;
            Some(start..*at)
        })
    }

    /// Identity modes of one point \[mm per standard deviation\].
    pub(super) fn identity_modes(&self, point: usize) -> impl Iterator<Item = Vec3> + '_ {
        let size = self.identities * 3;
        let start = point * size;
        let modes = self.identity.get(start..start + size).unwrap_or(&[]);
        modes
            .as_chunks()
            .0
            .iter()
            .zip(self.identity_scale)
            .map(|(delta, scale)| scaled(delta, *scale))
    }

    /// Animation modes of one point \[mm at weight 1\].
    pub(super) fn animation_modes(&self, point: usize) -> impl Iterator<Item = Vec3> + '_ {
        let start = point * ANIMATIONS;
        let modes = self.animation.get(start..start + ANIMATIONS).unwrap_or(&[]);
        modes
            .iter()
            .zip(self.animation_scale)
            .map(|(delta, scale)| scaled(delta, *scale))
    }

    /// All points of a person without expression, head frame.
    pub fn neutral(&self, identity: &Identity) -> Shape {
        let mut shape = Shape::EMPTY;
        for (i, (out, mean)) in shape.points_mm.iter_mut().zip(self.mean).enumerate() {
            let modes = self.identity_modes(i).zip(identity);
            *out = modes.fold(Vec3::from_array(*mean), |p, (m, w)| p + m * *w);
        }
        shape
    }

    /// A neutral shape with an expression.
    pub fn animated(&self, neutral: &Shape, animation: &Animation) -> Shape {
        let mut shape = *neutral;
        self.animate(&mut shape, animation);
        shape
    }

    /// Gives a neutral shape an expression, in place.
    pub(super) fn animate(&self, shape: &mut Shape, animation: &Animation) {
        for (i, out) in shape.points_mm.iter_mut().enumerate().take(self.mean.len()) {
            // Most weights rest at the bound 0.
            let modes = self
                .animation_modes(i)
                .zip(animation)
                .filter(|(_, w)| **w != 0.0);
            *out = modes.fold(*out, |p, (m, w)| p + m * *w);
        }
    }

    /// Which landmarks the mean head does not hide from the camera, by a table over view
    /// directions; jaw landmarks as the fixed 3D vertices that they are.
    pub fn visibility(&self, pose: &Pose) -> [bool; LANDMARKS] {
        // The camera as seen from the head's origin.
        let view = pose.rotation.transpose() * -pose.translation_mm;
        let length = libm::sqrtf(view.length_squared()).max(1e-6);
        let azimuth_deg = libm::atan2f(view.x, -view.z).to_degrees();
        let elevation_deg = libm::asinf((-view.y / length).clamp(-1.0, 1.0)).to_degrees();
        let cell = |deg: f32, cells: usize| {
            let middle = (cells / 2) as f32;
            libm::roundf((deg / VIEW_STEP_DEG + middle).clamp(0.0, (cells - 1) as f32)) as usize
        };
        let bit = cell(azimuth_deg, VIEW_AZIMUTHS) * VIEW_ELEVATIONS
            + cell(elevation_deg, VIEW_ELEVATIONS);
        let mut visible = [false; LANDMARKS];
        for (out, bits) in visible
            .iter_mut()
            .zip(self.visible.chunks_exact(VIEW_BYTES))
        {
            *out = bits.get(bit / 8).is_some_and(|b| b >> (bit % 8) & 1 == 1);
        }
        visible
    }
}

#[inline]
fn scaled(delta: &[i8; 3], scale: f32) -> Vec3 {
    Vec3::from_array(delta.map(|d| d as f32 * scale))
}

/// All points of one face in the head frame: landmarks, then contour candidates.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    points_mm: [Vec3; MAX_POINTS],
}

/// For each jaw landmark, the point of a [`Shape`] that lies on the visible contour.
pub type Contour = [u8; JAW];

/// The contour of nobody in particular: the landmarks themselves.
pub const FIXED_CONTOUR: Contour = {
    let mut contour = [0; JAW];
    let mut i = 0;
    while i < JAW {
        contour[i] = i as u8;
        i += 1;
    }
    contour
};

impl Shape {
    const EMPTY: Shape = Shape {
        points_mm: [Vec3::ZERO; MAX_POINTS],
    };

    /// The 68 landmarks as fixed vertices \[mm\].
    pub fn landmarks(&self) -> &[Vec3; LANDMARKS] {
        self.points_mm
            .first_chunk()
            .unwrap_or(&[Vec3::ZERO; LANDMARKS])
    }

    /// Point of this number; the origin if there is none.
    pub fn at(&self, index: usize) -> Vec3 {
        self.points_mm.get(index).copied().unwrap_or(Vec3::ZERO)
    }

    /// Number of the point that stands for a landmark in the image.
    pub(super) fn image_point(landmark: usize, contour: &Contour) -> usize {
        contour.get(landmark).map_or(landmark, |p| *p as usize)
    }

    /// For each jaw landmark the candidate that is outermost in the image at this pose.
    pub fn contour(&self, face: &FaceModel<'_>, pose: &Pose) -> Contour {
        let mut contour = FIXED_CONTOUR;
        let directions = contour_directions(face, pose);
        let candidates = face.candidates().zip(directions);
        for ((best, (range, out)), first) in
            contour.iter_mut().zip(candidates).zip(self.landmarks())
        {
            let reach = |point: Vec3| {
                let p = pose.apply(point);
                (p.x * out[0] + p.y * out[1]) / p.z.max(1.0)
            };
            let mut farthest = reach(*first);
            for index in range {
                let r = reach(self.at(index));
                if r > farthest {
                    farthest = r;
                    *best = index as u8;
                }
            }
        }
        contour
    }
}

/// Outward directions of the jaw landmarks in the image: the frontal ones, turned with the head.
pub(super) fn contour_directions(face: &FaceModel<'_>, pose: &Pose) -> [[f32; 2]; JAW] {
    let roll = head_angles(&pose.rotation).roll_deg.to_radians();
    let (sin, cos) = (libm::sinf(roll), libm::cosf(roll));
    let mut out = [[1.0, 0.0]; JAW];
    for (o, d) in out.iter_mut().zip(face.outward()) {
        *o = [cos * d[0] - sin * d[1], sin * d[0] + cos * d[1]];
    }
    out
}
