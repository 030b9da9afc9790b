//! The cascade's model (section `ALGN`, `ENSM` for a second network, `RFIN` for the fine stages) and
//! one run through it.

use super::ensemble::EnsembleMember;
use super::refiners::Refiners;
use super::regressor::{Memory, Regressor};
use super::{Shape, Views, place};
use crate::image::{Crop, Frame, warp};
use crate::math::Similarity;
use crate::model::{Blob, ModelError};
use crate::network::MAX_FEATURES;
use crate::shape::LANDMARKS;

/// Most views.
pub const MAX_VIEWS: usize = 4;

/// Most features that are kept for the classifiers.
const DESCRIBED: usize = if cfg!(feature = "verifier") {
    LANDMARKS * MAX_FEATURES
} else {
    0
};

/// A checked view of section `ALGN`, with the fine stages that the model has.
#[derive(Clone, Debug)]
pub struct AlignModel<'m> {
    mean: &'m Shape,
    /// Shapes in the canonical frame, by view.
    starts: &'m [Shape],
    turns: &'m [f32],
    /// Passes after a detection.
    iterations: usize,
    /// The global stage.
    face: Regressor<'m>,
    /// What it is averaged with.
    second: EnsembleMember<'m>,
    /// The fine stages.
    parts: Refiners<'m>,
}

/// Working memory of a run; holds nothing between runs but what the last one ended with.
#[derive(Clone)]
pub struct Workspace {
    crop: Crop,
    memory: Memory,
    features: [i8; DESCRIBED],
    used: usize,
    view: usize,
    global_shape: Shape,
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Empty working memory.
    pub const fn new() -> Self {
        Workspace {
            crop: Crop::new(),
            memory: Memory::new(),
            features: [0; DESCRIBED],
            used: 0,
            view: 0,
            global_shape: [[0.0; 2]; LANDMARKS],
        }
    }

    /// Features at the landmarks where the global stage of the last run ended, landmark by landmark;
    /// none without the feature `experts`.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.used).unwrap_or(&[])
    }

    /// Where the global stage of the last run ended (frame px).
    pub fn global_shape(&self) -> &Shape {
        &self.global_shape
    }

    /// 96 KiB to use for something else between two runs; what is there afterwards does not matter.
    pub fn scratch(&mut self) -> &mut [u8] {
        self.memory.scratch()
    }

    /// View of the shape where that run ended: 0 towards the camera, then the model's views turned
    /// to the image right, then those turned left.
    pub fn view(&self) -> usize {
        self.view
    }
}

impl<'m> AlignModel<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ALGN";

    /// Reads and checks the global stage. Its second network and the fine stages are checked by
    /// themselves ([`EnsembleMember::open`], [`Refiners::open`]), so that they are not on the stack at the same time.
    ///
    /// # Errors
    /// When the section is missing, too short, or a number is out of range.
    #[inline(never)]
    pub fn open(
        blob: &Blob<'m>,
        second: EnsembleMember<'m>,
        parts: Refiners<'m>,
    ) -> Result<Self, ModelError> {
        let s = &mut blob.section(&Self::TAG)?;
        let views = s.count(1, MAX_VIEWS, "number of views")?;
        let iterations = s.count(1, 8, "number of iterations")?;
        let missing = s.error("it lacks a shape");
        let mean = shapes_of(s.f32s(2 * LANDMARKS)?);
        let model = AlignModel {
            mean: mean.first().ok_or(missing)?,
            starts: shapes_of(s.f32s(views * 2 * LANDMARKS)?),
            turns: s.f32s(views)?,
            iterations,
            face: Regressor::read(s, LANDMARKS)?,
            second,
            parts,
        };
        model.second.require_crops_of(&model.face)?;
        let extent = |shape: &Shape| Similarity::fit(shape, shape).is_some();
        let sound = extent(model.mean) && model.starts.iter().all(extent);
        s.require(sound, "a shape has no extent")?;
        Ok(model)
    }

    /// The mean shape, in the canonical frame.
    pub fn mean(&self) -> &Shape {
        self.mean
    }

    /// Start shapes by turn.
    pub fn views(&self) -> Views<'m> {
        Views {
            starts: self.starts,
            turns: self.turns,
        }
    }

    /// Number of views, turns to the left counted apart: what [`Workspace::view`] stays below.
    pub fn signed_views(&self) -> usize {
        2 * self.starts.len() - 1
    }

    /// Features per landmark.
    pub fn features(&self) -> usize {
        self.face.features()
    }

    /// Passes to run after a detection; one is enough from the frame before.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Runs the global stage `iterations` times and then the fine ones; `shape` (frame px) says where
    /// to look and is moved in place. Returns false, with the shape wherever it was then, when it
    /// lost its extent.
    pub fn run(
        &self,
        frame: &Frame<'_>,
        iterations: usize,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        if !(0..iterations).all(|_| self.iterate(frame, shape, work)) {
            return false;
        }
        let Some(view) = self.views().of(shape) else {
            return false;
        };
        work.view = match view.mirrored {
            false => view.index,
            true => self.starts.len() + view.index - 1,
        };
        work.global_shape = *shape;
        if cfg!(feature = "refiners") {
            let Workspace { crop, memory, .. } = work;
            self.parts.run(frame, self.mean, shape, crop, memory);
        }
        finite(shape)
    }

    /// One pass of the global stage; false as in [`AlignModel::run`].
    pub fn iterate(&self, frame: &Frame<'_>, shape: &mut Shape, work: &mut Workspace) -> bool {
        let (face, side) = (&self.face, self.face.side());
        let Some(placed) = place(self.mean, shape, face.zoom(), side) else {
            return false;
        };
        warp(frame, &placed.corner_to_frame, side, &mut work.crop);
        // Before the first, whose maps the classifiers read.
        let other = self.second.run(&mut work.crop, &mut work.memory);
        let mut points = [[0.0f32; 2]; LANDMARKS];
        face.run(&work.crop, &mut points, &mut work.memory);
        for (p, q) in points.iter_mut().zip(other.iter().flatten()) {
            *p = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        }
        if cfg!(feature = "verifier") {
            face.describe(&points, &mut work.memory, &mut work.features);
            work.used = LANDMARKS * face.features();
        }
        *shape = points.map(|p| placed.centred_to_frame.apply(p));
        finite(shape)
    }
}

fn finite(shape: &Shape) -> bool {
    shape.iter().all(|p| p[0].is_finite() && p[1].is_finite())
}

fn shapes_of(coordinates: &[f32]) -> &[Shape] {
    coordinates.as_chunks::<2>().0.as_chunks::<LANDMARKS>().0
}
