//! The cascade's model and one run of it. Sections: `ALGN` holds the global stage, `ENSM` its
//! second ensemble member, `RFIN` and `SREG` the local refiners and the shape regression.

use super::ensemble::EnsembleMember;
use super::placement::place;
use super::refiners::Refiners;
use super::regressor::{Memory, Regressor};
use super::shape::{Shape, is_finite, shapes_of};
use super::views::Views;
use crate::image::{Crop, Frame, warp};
use crate::math::Similarity;
use crate::network::{Activations, MAX_FEATURES};
use crate::shape::LANDMARKS;
use posewise_format::{Blob, ModelError};

/// Capacity: views of a model, mirror images not counted.
pub const MAX_VIEWS: usize = 4;

/// Most iterations after a detection.
const MAX_ITERATIONS: usize = 8;

/// Capacity: features that are kept for the verifier.
const VERIFIER_FEATURES: usize = LANDMARKS * MAX_FEATURES;

/// A checked view of section `ALGN`, with the model's second ensemble member and local refiners.
#[derive(Clone, Debug)]
pub struct AlignModel<'m> {
    mean: &'m Shape,
    views: Views<'m>,
    /// Iterations after a detection.
    iterations: usize,
    /// The global stage's first ensemble member.
    global: Regressor<'m>,
    second: EnsembleMember<'m>,
    refiners: Refiners<'m>,
}

/// Working memory of a run, and the outputs of the last run beside its shape.
#[derive(Clone)]
pub struct Workspace {
    crop: Crop,
    memory: Memory,
    features: [i8; VERIFIER_FEATURES],
    feature_count: usize,
    /// Those of a run before the last, while two are compared.
    kept_features: [i8; VERIFIER_FEATURES],
    view: usize,
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
            features: [0; VERIFIER_FEATURES],
            feature_count: 0,
            kept_features: [0; VERIFIER_FEATURES],
            view: 0,
        }
    }

    /// Features of the last iteration for the verifier, `[68][features]`, 0..127: the fine map at
    /// the landmarks of the global stage. Empty before the first.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.feature_count).unwrap_or(&[])
    }

    /// Keeps the features of a run while another follows, or exchanges those of both runs.
    pub fn exchange_features(&mut self) {
        core::mem::swap(&mut self.features, &mut self.kept_features);
    }

    /// 80 KiB of the working memory, for other use between two runs. A run overwrites it and does
    /// not read it.
    pub fn scratch(&mut self) -> &mut [u8] {
        self.memory.scratch()
    }

    /// A crop and the memory of a network's maps, for a network of another module between two runs.
    /// A run overwrites both and does not read them.
    pub fn network_memory(&mut self) -> (&mut Crop, &mut Activations) {
        (&mut self.crop, self.memory.maps())
    }

    /// The same crop, and all of the memory of a regressor.
    pub(super) fn eye_memory(&mut self) -> (&mut Crop, &mut Memory) {
        (&mut self.crop, &mut self.memory)
    }

    /// Signed view of the global shape: 0 is frontal, then the model's views turned to the
    /// image right, then those turned left. Below [`AlignModel::signed_views`].
    pub fn view(&self) -> usize {
        self.view
    }
}

impl<'m> AlignModel<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ALGN";

    /// Reads and checks the global stage: `views: u32, iterations: u32, mean: f32[136], initial
    /// shapes: f32[views·136], yaws: f32[views]` and a regressor. The caller opens the other
    /// sections before ([`EnsembleMember::open`], [`Refiners::open`]), so that the stack never
    /// holds the working memory of all three.
    ///
    /// # Errors
    /// When the section is missing or too short, or a number is out of range.
    #[inline(never)]
    pub fn open(
        blob: &Blob<'m>,
        second: EnsembleMember<'m>,
        refiners: Refiners<'m>,
    ) -> Result<Self, ModelError> {
        let s = &mut blob.section(&Self::TAG)?;
        let views = s.count(1, MAX_VIEWS, "number of views")?;
        let iterations = s.count(1, MAX_ITERATIONS, "number of iterations")?;
        let missing = s.error("it lacks a shape");
        let mean = shapes_of(s.f32s(2 * LANDMARKS)?);
        let model = AlignModel {
            mean: mean.first().ok_or(missing)?,
            views: Views {
                shapes: shapes_of(s.f32s(views * 2 * LANDMARKS)?),
                yaws: s.f32s(views)?,
            },
            iterations,
            global: Regressor::open(s, LANDMARKS)?,
            second,
            refiners,
        };
        model.second.require_crops_of(&model.global)?;
        let has_extent = |shape: &Shape| Similarity::fit(shape, shape).is_some();
        let valid = has_extent(model.mean) && model.views.shapes.iter().all(has_extent);
        s.require(valid, "a shape has no extent")?;
        Ok(model)
    }

    /// The mean shape, in the canonical frame.
    pub fn mean(&self) -> &Shape {
        self.mean
    }

    /// The initial shapes by yaw.
    pub fn views(&self) -> Views<'m> {
        self.views
    }

    /// Number of views with mirror images counted: the frontal view has none.
    pub fn signed_views(&self) -> usize {
        2 * self.views.shapes.len() - 1
    }

    /// Features per landmark.
    pub fn features(&self) -> usize {
        self.global.features()
    }

    /// Iterations to run after a detection; one is enough from the shape of the previous frame.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Multiply-adds of one iteration of the global stage.
    #[cfg(feature = "unstable-internals")]
    pub fn iteration_multiply_adds(&self) -> usize {
        self.global.multiply_adds() + self.second.multiply_adds()
    }

    /// Multiply-adds of the refiners.
    #[cfg(feature = "unstable-internals")]
    pub fn refiner_multiply_adds(&self) -> usize {
        self.refiners.multiply_adds()
    }

    /// Runs `iterations` iterations of the global stage and then the refiners, from the initial
    /// `shape` (frame px), which is updated in place. Returns false when the shape collapsed or is
    /// not finite; it is undefined then.
    #[cfg(feature = "unstable-internals")]
    pub fn run(
        &self,
        frame: &Frame<'_>,
        iterations: usize,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        (0..iterations).all(|_| self.iterate(frame, shape, work)) && self.refine(frame, shape, work)
    }

    /// Runs the refiners from the `shape` of the last iteration; false as in [`AlignModel::run`].
    pub fn refine(&self, frame: &Frame<'_>, shape: &mut Shape, work: &mut Workspace) -> bool {
        if cfg!(feature = "refiners") {
            let Workspace { crop, memory, .. } = work;
            self.refiners.run(frame, self.mean, shape, crop, memory);
        }
        is_finite(shape)
    }

    /// One iteration of the global stage: then features and view are known. False as
    /// in [`AlignModel::run`].
    pub fn iterate(&self, frame: &Frame<'_>, shape: &mut Shape, work: &mut Workspace) -> bool {
        let (global, side) = (&self.global, self.global.side());
        let Some(placement) = place(self.mean, shape, global.zoom(), side) else {
            return false;
        };
        warp(frame, &placement.corner_to_frame, side, &mut work.crop);
        work.crop.standardise();
        // The first member runs last: the verifier reads its maps.
        let second = self.second.run(&mut work.crop, &mut work.memory);
        let mut points = [[0.0f32; 2]; LANDMARKS];
        global.run(&work.crop, &mut points, &mut work.memory);
        for (p, q) in points.iter_mut().zip(second.iter().flatten()) {
            *p = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        }
        global.describe(&points, &mut work.memory, &mut work.features);
        work.feature_count = LANDMARKS * global.features();
        *shape = points.map(|p| placement.centred_to_frame.apply(p));
        let Some(view) = self.views().of(shape) else {
            return false;
        };
        work.view = match view.mirrored {
            false => view.index,
            true => self.views.shapes.len() + view.index - 1,
        };
        is_finite(shape)
    }
}
