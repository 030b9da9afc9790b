//! The cascade's model and one run of it. Sections: `ALGN` holds the global stage, `ENSM` its
//! second ensemble member, `RFIN` and `SREG` the local refiners and the shape regression.

use super::correction::Networks;
use super::ensemble::EnsembleMember;
use super::placement::place;
use super::refiners::Refiners;
use super::regressor::Regressor;
use super::shape::{Shape, is_finite, shapes_of};
use super::views::Views;
use super::weights::WeightModel;
use super::workspace::Workspace;
use crate::image::{Frame, warp};
use crate::math::Similarity;
use crate::shape::LANDMARKS;
use posewise_format::{Blob, ModelError};

/// Capacity: views of a model, mirror images not counted.
pub const MAX_VIEWS: usize = 4;

/// Most iterations after a detection.
const MAX_ITERATIONS: usize = 8;

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

    /// What makes weights of what the refiners see.
    pub fn weights(&self) -> &WeightModel<'m> {
        self.refiners.weights()
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
        let all = Networks::All;
        (0..iterations).all(|_| self.iterate(frame, shape, all, work))
            && self.refine(frame, shape, all, work)
    }

    /// Runs the refiners from the `shape` of the last iteration; false as in [`AlignModel::run`].
    pub fn refine(
        &self,
        frame: &Frame<'_>,
        shape: &mut Shape,
        networks: Networks,
        work: &mut Workspace,
    ) -> bool {
        if cfg!(feature = "refiners") {
            let (views, seen) = (self.weights().views(), &mut work.seen);
            let look = &mut |refiner, mirror, read: &[u8]| views.take(refiner, mirror, read, seen);
            let corrections = &mut work.corrections.refiners;
            let memory = (&mut work.crop, &mut work.memory, corrections);
            (self.refiners).run(frame, self.mean, shape, networks, memory, look);
        }
        is_finite(shape)
    }

    /// As [`AlignModel::refine`], and shows what the last heads of the refiners have read: the
    /// number of the refiner, whether the run was mirrored, and the numbers.
    #[cfg(feature = "unstable-internals")]
    pub fn refine_with(
        &self,
        frame: &Frame<'_>,
        shape: &mut Shape,
        work: &mut Workspace,
        look: &mut dyn FnMut(usize, bool, &[u8]),
    ) -> bool {
        let corrections = &mut work.corrections.refiners;
        let memory = (&mut work.crop, &mut work.memory, corrections);
        (self.refiners).run(frame, self.mean, shape, Networks::All, memory, look);
        is_finite(shape)
    }

    /// One iteration of the global stage: then features and view are known. False as
    /// in [`AlignModel::run`].
    pub fn iterate(
        &self,
        frame: &Frame<'_>,
        shape: &mut Shape,
        networks: Networks,
        work: &mut Workspace,
    ) -> bool {
        let (global, side) = (&self.global, self.global.side());
        let Some(placement) = place(self.mean, shape, global.zoom(), side) else {
            return false;
        };
        warp(frame, &placement.corner_to_frame, side, &mut work.crop);
        work.crop.standardise();
        // The first member runs last: the verifier reads its maps.
        let is_held = work.corrections.global.holds(networks);
        let second = match networks {
            Networks::First => None,
            Networks::Few if is_held => None,
            _ => self.second.run(&mut work.crop, &mut work.memory),
        };
        let mut points = [[0.0f32; 2]; LANDMARKS];
        global.run(&work.crop, &mut points, &mut work.memory);
        if is_held {
            (work.corrections.global).add_to(&mut points, &Similarity::IDENTITY);
        }
        if let Some(second) = second {
            let first = points;
            for (p, q) in points.iter_mut().zip(&second) {
                *p = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            }
            (work.corrections.global).keep(&first, &points, &Similarity::IDENTITY);
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
