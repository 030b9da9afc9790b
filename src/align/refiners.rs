//! Fine stages: eyes with their brows, the mouth, and the eyes alone for their lids, each seen in a
//! closer crop of its own.
//!
//! The global stage sees an eye in some fifteen pixels; lids and lips need more. A part's network
//! starts from where the stages before it put the part's landmarks and moves all of them by what it
//! reads around each of them and in the part as a whole (correlative regression, thesis 5.1). Both
//! eyes share one network, the subject's left eye is seen in a mirror. The mouth is its own mirror
//! image: what its network says of both is averaged.

use super::Shape;
use super::regressor::{Memory, Regressor};
use super::shape_regression::ShapeRegression;
use crate::image::{Crop, Frame, warp};
use crate::math::Similarity;
use crate::model::{Blob, ModelError, Section};
use crate::shape::{LANDMARKS, MIRROR};

/// Most networks.
pub const MAX_REFINERS: usize = 3;
/// Most landmarks of a part.
pub const MAX_POINTS: usize = 24;

/// Section `RFIN` with what follows the fine stages (`SREG`), checked; no parts where the model lacks
/// the first, or the build its feature (`fine-stages`).
///
/// A part's network is read anew whenever it runs, which takes a microsecond: all of them would make
/// a model too large for small stacks.
#[derive(Clone, Debug, Default)]
pub struct Refiners<'m> {
    /// How many.
    count: usize,
    /// What follows that number.
    content: Option<Section<'m>>,
    /// What comes after the last of them.
    correction: Option<ShapeRegression<'m>>,
}

#[derive(Clone, Copy, Debug)]
struct Refiner<'m> {
    /// Which landmarks, in the order of the network's points.
    landmarks: &'m [u32],
    /// Whether the landmarks' mirror images are a part of their own; else they are the same part.
    twin: bool,
    regressor: Regressor<'m>,
}

impl<'m> Refiners<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"RFIN";

    /// Reads and checks the sections. `RFIN` holds `parts: u32`, then for each `points, twin: u32, landmarks:
    /// u32[points]` and its regressor.
    ///
    /// # Errors
    /// When one is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        if !cfg!(feature = "refiners") {
            return Ok(Refiners::default());
        }
        let mut s = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(Refiners::default()),
            other => other?,
        };
        let parts = Refiners {
            count: s.count(1, MAX_REFINERS, "number of parts")?,
            content: Some(s.clone()),
            correction: ShapeRegression::open(blob)?,
        };
        for _ in 0..parts.count {
            Refiner::check(&mut s)?;
        }
        Ok(parts)
    }

    /// Moves the parts' landmarks of a shape that is nearly right.
    #[inline(never)]
    pub(super) fn run(
        &self,
        frame: &Frame<'_>,
        mean: &Shape,
        shape: &mut Shape,
        crop: &mut Crop,
        memory: &mut Memory,
    ) {
        let Some(face) = Similarity::fit(mean, shape) else {
            return;
        };
        let Some(mut content) = self.content.clone() else {
            return;
        };
        for _ in 0..self.count {
            // It was checked when the model was opened.
            let Ok(part) = Refiner::read(&mut content) else {
                return;
            };
            let mut other = *shape;
            part.run(frame, &face, false, shape, crop, memory);
            if part.twin {
                part.run(frame, &face, true, shape, crop, memory);
                continue;
            }
            part.run(frame, &face, true, &mut other, crop, memory);
            for (p, q) in shape.iter_mut().zip(&other) {
                *p = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            }
        }
        if let Some(correction) = &self.correction {
            correction.run(mean, shape);
        }
    }
}

impl<'m> Refiner<'m> {
    /// As [`Refiner::read`], without the part on the caller's stack.
    #[inline(never)]
    fn check(s: &mut Section<'m>) -> Result<(), ModelError> {
        let (landmarks, _) = Self::landmarks(s)?;
        Regressor::read(s, landmarks.len()).map(|_| ())
    }

    fn read(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let (landmarks, twin) = Self::landmarks(s)?;
        Ok(Refiner {
            landmarks,
            twin,
            regressor: Regressor::read(s, landmarks.len())?,
        })
    }

    fn landmarks(s: &mut Section<'m>) -> Result<(&'m [u32], bool), ModelError> {
        let points = s.count(1, MAX_POINTS, "number of points")?;
        let twin = s.count(0, 1, "mark of a twin")? == 1;
        let landmarks = s.u32s(points)?;
        let sound = landmarks.iter().all(|k| (*k as usize) < LANDMARKS);
        s.require(sound, "no such landmark")?;
        let image = |k: &u32| MIRROR.get(*k as usize).map(|m| *m as u32);
        let has_image = |k: &u32| image(k).is_some_and(|m| landmarks.contains(&m));
        let whole = twin || landmarks.iter().all(has_image);
        s.require(whole, "a landmark's mirror image is missing")?;
        Ok((landmarks, twin))
    }

    /// `face`: canonical frame → frame px.
    fn run(
        &self,
        frame: &Frame<'_>,
        face: &Similarity,
        mirrored: bool,
        shape: &mut Shape,
        crop: &mut Crop,
        memory: &mut Memory,
    ) {
        let index = |k: u32| match mirrored {
            false => k as usize,
            true => MIRROR.get(k as usize).copied().unwrap_or(0),
        };
        let mut points = [[0.0f32; 2]; MAX_POINTS];
        let Some(points) = points.get_mut(..self.landmarks.len()) else {
            return;
        };
        for (p, k) in points.iter_mut().zip(self.landmarks) {
            *p = shape.get(index(*k)).copied().unwrap_or([0.0; 2]);
        }
        let regressor = &self.regressor;
        let Some(to_frame) = placed(face, points, regressor.zoom()) else {
            return;
        };
        let Some(to_crop) = to_frame.inverse() else {
            return;
        };
        let centre = (regressor.side() as f32 - 1.0) / 2.0;
        let [tx, ty] = to_frame.apply([-centre, -centre]);
        warp(
            frame,
            &Similarity { tx, ty, ..to_frame },
            regressor.side(),
            crop,
        );
        if mirrored {
            crop.mirror();
        }
        let side = if mirrored { -1.0 } else { 1.0 };
        for p in points.iter_mut() {
            let [x, y] = to_crop.apply(*p);
            *p = [side * x, y];
        }
        regressor.run(crop, points, memory);
        for (p, k) in points.iter().zip(self.landmarks) {
            if let Some(to) = shape.get_mut(index(*k)) {
                *to = to_frame.apply([side * p[0], p[1]]);
            }
        }
    }
}

/// Crop px from the crop's centre → frame px, for a part whose landmarks lie at `points` of a face
/// that `face` (canonical frame → frame px) places: as upright and large as the face, the landmarks'
/// centroid in the middle.
pub fn placed(face: &Similarity, points: &[[f32; 2]], zoom: f32) -> Option<Similarity> {
    let n = points.len().max(1) as f32;
    let sum = points
        .iter()
        .fold([0.0f32; 2], |s, p| [s[0] + p[0], s[1] + p[1]]);
    let placed = Similarity {
        a: face.a / zoom,
        b: face.b / zoom,
        tx: sum[0] / n,
        ty: sum[1] / n,
    };
    placed.inverse().map(|_| placed)
}
