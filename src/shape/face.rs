//! The 3D face model (section `FACE`): a linear model of shape, with identity and animation modes
//! (thesis 5.2), and points evaluated from it. The head frame is that of `include/posewise.h`.

use super::modes::{Factors, scaled};
use super::{Animation, FITTED, Identity, LANDMARKS, MAX_IDENTITIES, Pose};
use crate::math::head_angles;
use glam::Vec3;
use posewise_format::{ModelError, Section, Tag};

/// Name of the section.
pub const FACE_TAG: Tag = *b"FACE";

/// Number of jaw landmarks, 0 to 16. In the image they follow the visible contour.
pub const JAW: usize = 17;

/// Capacity: contour candidates of a jaw landmark beside the landmark itself.
pub const MAX_EXTRA: usize = 7;

/// Capacity: points of a face model, the landmarks and then the contour candidates in jaw order.
pub const MAX_POINTS: usize = LANDMARKS + JAW * MAX_EXTRA;

/// Azimuths of the visibility table: −120..120° in steps of [`VIEW_STEP_DEG`].
pub const VIEW_AZIMUTHS: usize = 33;
/// Elevations of the visibility table: −60..60° in steps of [`VIEW_STEP_DEG`].
pub const VIEW_ELEVATIONS: usize = 17;
/// Distance of neighbouring view directions of the visibility table \[deg\].
pub const VIEW_STEP_DEG: f32 = 7.5;
/// One landmark's row of the visibility table: bit `azimuth · VIEW_ELEVATIONS + elevation`, least
/// significant bit first \[bytes\].
pub const VIEW_BYTES: usize = (VIEW_AZIMUTHS * VIEW_ELEVATIONS).div_ceil(8);

/// Largest valid coordinate of a mean face \[mm\].
const LARGEST_MM: f32 = 1000.0;

/// What multiplies the identity modes of a person.
pub(super) type IdentityFactors = Factors<{ MAX_IDENTITIES / 4 }>;

/// A checked view of section `FACE`.
///
/// Content, in this order: `points, identities: u32`; `extra: u8[17]`, contour candidates of each
/// jaw landmark; `mean: f32[points·3]` \[mm\]; `identity_scale: f32[identities]`;
/// `identity: i8[points·identities·3]`; `animation_scale: f32[24]`; `animation: i8[points·24·3]`;
/// `outward: f32[17·2]`; `noise_mm: f32[68]`; `animation_sigma: f32[24]`;
/// `visible: u8[68·VIEW_BYTES]`.
#[derive(Clone, Copy, Debug)]
pub struct FaceModel<'m> {
    /// Number of identity modes.
    identities: usize,
    /// Number of contour candidates of each jaw landmark.
    extra: &'m [u8],
    /// Mean face, head frame \[mm\].
    mean: &'m [[f32; 3]],
    /// By identity mode: mm per standard deviation for a value of 1 in `identity`.
    identity_scale: &'m [f32],
    /// Identity modes, `[points][identities][3]`.
    identity: &'m [i8],
    /// By animation mode: mm at weight 1 for a value of 1 in `animation`.
    animation_scale: &'m [f32],
    /// Animation modes, `[points][24]`.
    animation: &'m [[i8; 3]],
    /// See [`FaceModel::outward`].
    outward: &'m [[f32; 2]],
    /// See [`FaceModel::noise_mm`].
    noise_mm: &'m [f32],
    /// See [`FaceModel::animation_sigma`].
    animation_sigma: &'m [f32],
    /// The visibility table, `[68][VIEW_BYTES]`.
    visible: &'m [u8],
}

impl<'m> FaceModel<'m> {
    /// Reads and checks the section.
    ///
    /// # Errors
    /// [`ModelError::Section`] when it is too short or a number is out of range.
    pub fn open(mut section: Section<'m>) -> Result<Self, ModelError> {
        let s = &mut section;
        let points = s.count(LANDMARKS, MAX_POINTS, "the number of points")?;
        let identities = s.count(0, MAX_IDENTITIES, "the number of identity modes")?;
        let extra = s.u8s(JAW)?;
        let total: usize = extra.iter().map(|e| *e as usize).sum();
        s.require(
            extra.iter().all(|e| *e as usize <= MAX_EXTRA) && LANDMARKS + total == points,
            "the number of contour candidates does not match",
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
        let animation_scale = s.f32s(FITTED)?;
        let animation = s.i8s(points * FITTED * 3)?;
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
        let animation_sigma = s.f32s(FITTED)?;
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

    /// Standard deviation of each landmark's image position, measured on the face \[mm\].
    pub(super) fn noise_mm(&self) -> &'m [f32] {
        self.noise_mm
    }

    /// Standard deviation of each animation weight.
    pub(super) fn animation_sigma(&self) -> &'m [f32] {
        self.animation_sigma
    }

    /// Outward directions of the jaw landmarks in the frontal view: unit vectors, x right, y down.
    pub(super) fn outward(&self) -> &'m [[f32; 2]] {
        self.outward
    }

    /// Contour candidates of each jaw landmark, as ranges into a [`Shape`].
    pub(super) fn candidates(&self) -> impl Iterator<Item = core::ops::Range<usize>> + 'm {
        self.extra.iter().scan(LANDMARKS, |at, extra| {
            let start = *at;
            *at += *extra as usize;
            Some(start..*at)
        })
    }

    /// A number by which 3D faces with another mean or other identity modes are told apart: FNV-1a,
    /// 32 bits.
    pub(crate) fn checksum(&self) -> u32 {
        let hashed = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        let modes = self.identity.iter().map(|mode| *mode as u8);
        let numbers = self.mean.as_flattened().iter().chain(self.identity_scale);
        let numbers = numbers.flat_map(|number| number.to_bits().to_le_bytes());
        modes.chain(numbers).fold(0x811c_9dc5, hashed)
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

    /// Animation modes of one point \[mm at weight 1\], four by four; `None` for four that do not
    /// move it.
    pub(super) fn animation_fours(
        &self,
        point: usize,
    ) -> impl Iterator<Item = Option<[Vec3; 4]>> + '_ {
        let modes = self.animation.as_chunks::<FITTED>().0.get(point);
        let fours = modes.map_or(&[][..], |modes| modes.as_chunks::<4>().0);
        let scales = self.animation_scale.as_chunks::<4>().0;
        fours.iter().zip(scales).map(|(deltas, scales)| {
            let moves = *deltas != [[0; 3]; 4];
            moves.then(|| core::array::from_fn(|k| scaled(&deltas[k], scales[k])))
        })
    }

    /// An animation mode at one point \[mm at weight 1\]; nothing where there is none.
    pub(super) fn animation_mode(&self, point: usize, mode: usize) -> Vec3 {
        let deltas = self.animation.as_chunks::<FITTED>().0.get(point);
        let delta = deltas.and_then(|deltas| deltas.get(mode));
        let scale = self.animation_scale.get(mode);
        let both = delta.zip(scale);
        both.map_or(Vec3::ZERO, |(delta, scale)| scaled(delta, *scale))
    }

    /// The neutral face of a person: all points, head frame.
    pub fn neutral(&self, identity: &Identity) -> Shape {
        let factors = &self.identity_factors(identity);
        let mut shape = Shape::EMPTY;
        let points = shape.points_mm.iter_mut().take(self.mean.len());
        for (i, out) in points.enumerate() {
            *out = self.neutral_point(i, factors);
        }
        shape
    }

    /// What multiplies the identity modes of a person.
    pub(super) fn identity_factors(&self, identity: &Identity) -> IdentityFactors {
        IdentityFactors::new(self.identity_scale, identity)
    }

    /// One point of the neutral face of a person, head frame.
    pub(super) fn neutral_point(&self, point: usize, factors: &IdentityFactors) -> Vec3 {
        let mean = self.mean.get(point).copied().unwrap_or_default();
        let size = self.identities * 3;
        let modes = self.identity.get(point * size..(point + 1) * size);
        Vec3::from_array(mean) + factors.sum(modes.unwrap_or(&[]))
    }

    /// A neutral face with animation weights applied.
    #[cfg(feature = "unstable-internals")]
    pub fn animated(&self, neutral: &Shape, animation: &Animation) -> Shape {
        let mut shape = *neutral;
        self.animate(&mut shape, animation);
        shape
    }

    /// Applies animation weights to a neutral face, in place.
    pub(crate) fn animate(&self, shape: &mut Shape, animation: &Animation) {
        let factors = Factors::<{ FITTED / 4 }>::new(self.animation_scale, animation);
        let points = shape.points_mm.iter_mut().take(self.mean.len());
        for (point, modes) in points.zip(self.animation.as_chunks::<FITTED>().0) {
            *point += factors.sum(modes.as_flattened());
        }
    }

    /// Which landmarks the head itself does not hide from the camera: a table lookup by the view
    /// direction, computed from the mean head. Jaw landmarks count as fixed 3D points.
    pub fn visibility(&self, pose: &Pose) -> [bool; LANDMARKS] {
        // The camera's position in the head frame.
        let view = pose.rotation.transpose() * -pose.translation_mm;
        let length = view.length().max(1e-6);
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

/// All points of one face in the head frame \[mm\]: landmarks, then contour candidates.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    points_mm: [Vec3; MAX_POINTS],
}

/// For each jaw landmark, the index of the point of a [`Shape`] on the visible contour.
pub type Contour = [u8; JAW];

/// The contour without candidates: the jaw landmarks themselves.
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
    pub(super) const EMPTY: Shape = Shape {
        points_mm: [Vec3::ZERO; MAX_POINTS],
    };

    /// The 68 landmarks as fixed vertices \[mm\].
    pub fn landmarks(&self) -> &[Vec3; LANDMARKS] {
        self.points_mm
            .first_chunk()
            .unwrap_or(&[Vec3::ZERO; LANDMARKS])
    }

    /// The point at an index; the origin if there is none.
    pub fn at(&self, index: usize) -> Vec3 {
        self.points_mm.get(index).copied().unwrap_or(Vec3::ZERO)
    }

    /// Index of the point that represents a landmark in the image.
    pub(super) fn image_point(landmark: usize, contour: &Contour) -> usize {
        contour.get(landmark).map_or(landmark, |p| *p as usize)
    }

    /// For each jaw landmark, the candidate that is outermost in the image at this pose.
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

/// Outward directions of the jaw landmarks in the image: the frontal ones, rotated by the head's
/// roll.
pub(super) fn contour_directions(face: &FaceModel<'_>, pose: &Pose) -> [[f32; 2]; JAW] {
    let roll = head_angles(&pose.rotation).roll_deg.to_radians();
    let (sin, cos) = (libm::sinf(roll), libm::cosf(roll));
    let mut out = [[1.0, 0.0]; JAW];
    for (o, d) in out.iter_mut().zip(face.outward()) {
        *o = [cos * d[0] - sin * d[1], sin * d[0] + cos * d[1]];
    }
    out
}
