//! Local refiners: networks that see eyes with brows, the mouth, and the eyes alone for their lids,
//! each in a closer crop of its own.
//!
//! An eye covers some fifteen pixels of the global stage's crop; lids and lips need more. A refiner
//! starts from the landmarks of the stages before it and moves its own by the features around each
//! of them and by those of its whole crop (correlative regression, thesis 5.1). Both eyes share one
//! network, which sees the person's left eye mirrored. The mouth is its own mirror image: the
//! predictions for the crop and for its mirror image are averaged.

use super::correction::{Correction, Networks};
use super::regressor::{Memory, Regressor};
use super::shape::Shape;
use super::shape_regression::ShapeRegression;
use super::weights::{MAX_REFINERS, WeightModel};
use crate::image::{Crop, Frame, warp};
use crate::math::Similarity;
use crate::shape::{LANDMARKS, MIRROR};
use posewise_format::{Blob, ModelError, Section};

/// Capacity: landmarks of a refiner.
pub const MAX_POINTS: usize = 24;

/// A checked view of section `RFIN` and of `SREG` and `WGHT`, which follow the refiners; empty
/// where the model lacks `RFIN` or the build lacks feature `refiners`.
///
/// A refiner is parsed again for each run, which takes a microsecond: the tables of all networks
/// would make a model too large for small stacks.
#[derive(Clone, Debug, Default)]
pub struct Refiners<'m> {
    /// Number of refiners.
    count: usize,
    /// The section behind that number.
    content: Option<Section<'m>>,
    /// The shape regression that runs after the last refiner.
    shape_regression: Option<ShapeRegression<'m>>,
    /// What makes weights of what the refiners see.
    weights: WeightModel<'m>,
}

#[derive(Clone, Copy, Debug)]
struct Refiner<'m> {
    /// iBUG 68 numbers of its landmarks, in the order of the network's points.
    landmarks: &'m [u32],
    /// Whether it runs a second time, mirrored, on the landmarks of the other side. Otherwise its
    /// landmarks are their own mirror images, and the mirrored run is averaged with the first.
    mirrored: bool,
    regressor: Regressor<'m>,
}

/// What all refiners of a run share.
struct Run<'a> {
    frame: &'a Frame<'a>,
    /// Canonical frame → frame px, of the face.
    face: Similarity,
    crop: &'a mut Crop,
    memory: &'a mut Memory,
    look: Look<'a>,
}

/// Is shown what the last head of a refiner has read: the number of the refiner, whether the run
/// was mirrored, and the numbers.
pub(super) type Look<'a> = &'a mut dyn FnMut(usize, bool, &[u8]);

impl<'m> Refiners<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"RFIN";

    /// Reads and checks the sections. `RFIN` holds `refiners: u32`, then for each refiner
    /// `points: u32, mirrored: u32, landmarks: u32[points]` and a regressor.
    ///
    /// # Errors
    /// When a section is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        if !cfg!(feature = "refiners") {
            return Ok(Refiners::default());
        }
        let mut s = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(Refiners::default()),
            other => other?,
        };
        let count = s.count(1, MAX_REFINERS, "number of refiners")?;
        let content = Some(s.clone());
        let mut heads = [0; MAX_REFINERS];
        for inputs in heads.iter_mut().take(count) {
            *inputs = Refiner::check(&mut s)?;
        }
        Ok(Refiners {
            count,
            content,
            shape_regression: ShapeRegression::open(blob)?,
            weights: WeightModel::open(blob, &heads)?,
        })
    }

    /// What makes weights of what the refiners see.
    pub(super) fn weights(&self) -> &WeightModel<'m> {
        &self.weights
    }

    /// Multiply-adds of one run: each refiner runs twice.
    #[cfg(feature = "unstable-internals")]
    pub(super) fn multiply_adds(&self) -> usize {
        let Some(mut content) = self.content.clone() else {
            return 0;
        };
        let read = (0..self.count).map_while(|_| Refiner::read(&mut content).ok());
        read.map(|refiner| 2 * refiner.regressor.multiply_adds())
            .sum()
    }

    /// Refines a nearly right shape (frame px) in place; leaves it where it has no extent.
    #[inline(never)]
    pub(super) fn run(
        &self,
        frame: &Frame<'_>,
        mean: &Shape,
        shape: &mut Shape,
        networks: Networks,
        (crop, memory, correction): (&mut Crop, &mut Memory, &mut Correction),
        look: Look<'_>,
    ) {
        let Some(face) = Similarity::fit(mean, shape) else {
            return;
        };
        let to_canonical = face.inverse().unwrap_or(Similarity::IDENTITY);
        let Some(mut content) = self.content.clone() else {
            return;
        };
        let run = &mut Run {
            frame,
            face,
            crop,
            memory,
            look,
        };
        let is_held = correction.holds(networks);
        for number in 0..self.count {
            // Reading cannot fail: `open` checked the section.
            let Ok(refiner) = Refiner::read(&mut content) else {
                return;
            };
            let mut other = *shape;
            refiner.run(run, number, false, shape);
            if refiner.mirrored {
                refiner.run(run, number, true, shape);
                continue;
            }
            if is_held {
                correction.add_to(shape, &face);
                continue;
            }
            refiner.run(run, number, true, &mut other);
            let once = *shape;
            for (p, q) in shape.iter_mut().zip(&other) {
                *p = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            }
            // Models have one such refiner; of more, the corrections would be that of the last.
            correction.keep(&once, shape, &to_canonical);
        }
        if let Some(regression) = &self.shape_regression {
            regression.run(mean, shape);
        }
    }
}

impl<'m> Refiner<'m> {
    /// As [`Refiner::read`], without the refiner on the caller's stack: how many numbers its last
    /// head reads.
    #[inline(never)]
    fn check(s: &mut Section<'m>) -> Result<usize, ModelError> {
        let (landmarks, _) = Self::read_landmarks(s)?;
        Regressor::open(s, landmarks.len()).map(|regressor| regressor.last_inputs())
    }

    fn read(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let (landmarks, mirrored) = Self::read_landmarks(s)?;
        Ok(Refiner {
            landmarks,
            mirrored,
            regressor: Regressor::read(s, landmarks.len())?,
        })
    }

    fn read_landmarks(s: &mut Section<'m>) -> Result<(&'m [u32], bool), ModelError> {
        let points = s.count(1, MAX_POINTS, "number of points")?;
        let mirrored = s.count(0, 1, "mirrored")? == 1;
        let landmarks = s.u32s(points)?;
        let in_range = landmarks.iter().all(|k| (*k as usize) < LANDMARKS);
        s.require(in_range, "no such landmark")?;
        let image = |k: &u32| MIRROR.get(*k as usize).map(|m| *m as u32);
        let has_image = |k: &u32| image(k).is_some_and(|m| landmarks.contains(&m));
        let closed = mirrored || landmarks.iter().all(has_image);
        s.require(closed, "a landmark's mirror image is missing")?;
        Ok((landmarks, mirrored))
    }

    /// Moves the landmarks of `shape` (frame px) of the refiner of this number, or with `mirror`
    /// their mirror images.
    fn run(&self, run: &mut Run<'_>, number: usize, mirror: bool, shape: &mut Shape) {
        let index = |k: u32| match mirror {
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
        let Some(to_frame) = place_refiner(&run.face, points, regressor.zoom()) else {
            return;
        };
        let Some(to_crop) = to_frame.inverse() else {
            return;
        };
        let centre = (regressor.side() as f32 - 1.0) / 2.0;
        let [tx, ty] = to_frame.apply([-centre, -centre]);
        let corner_to_frame = Similarity { tx, ty, ..to_frame };
        warp(run.frame, &corner_to_frame, regressor.side(), run.crop);
        run.crop.standardise();
        if mirror {
            run.crop.mirror();
        }
        let sign = if mirror { -1.0 } else { 1.0 };
        for p in points.iter_mut() {
            let [x, y] = to_crop.apply(*p);
            *p = [sign * x, y];
        }
        regressor.run(run.crop, points, run.memory);
        let read = regressor.last_read(run.memory);
        (run.look)(number, mirror, read);
        for (p, k) in points.iter().zip(self.landmarks) {
            if let Some(to) = shape.get_mut(index(*k)) {
                *to = to_frame.apply([sign * p[0], p[1]]);
            }
        }
    }
}

/// Crop px relative to the crop's centre → frame px, for a refiner whose landmarks are at `points`
/// (frame px): centred on the mean of the points, with the rotation and scale of the face (`face`:
/// canonical frame → frame px), at `zoom` crop px per canonical unit. `None` when the face has no
/// extent.
pub fn place_refiner(face: &Similarity, points: &[[f32; 2]], zoom: f32) -> Option<Similarity> {
    let n = points.len().max(1) as f32;
    let sum = points
        .iter()
        .fold([0.0f32; 2], |s, p| [s[0] + p[0], s[1] + p[1]]);
    let placement = Similarity {
        a: face.a / zoom,
        b: face.b / zoom,
        tx: sum[0] / n,
        ty: sum[1] / n,
    };
    placement.inverse().map(|_| placement)
}
