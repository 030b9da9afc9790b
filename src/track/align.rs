//! First part of an attempt: from a start to landmarks, and what the classifiers say of them.

use super::follow::Appearance;
use super::geometry::{centre, initial_shape};
use super::policy::{
    ACCEPT_CONFIDENCE, DISCARD_CONFIDENCE, FIT_WEIGHT_HIDDEN, FIT_WEIGHT_MIN, ITERATION_UNITS,
    REFINE_UNITS, ROTATION_PRIOR_WEIGHT, TRUST_CONFIDENCE,
};
use super::search::Excluded;
use super::step::Step;
use crate::align::{Shape, Workspace};
use crate::detect::Detection;
use crate::shape::{LANDMARKS, Observed, RotationPrior};
use crate::verifier::Confidence;

/// Where a face on this frame comes from: what is known of it when the 3D face is fitted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// A new identity: nothing is known.
    NewFace,
    /// The target, lost for a while: its identity is known, its pose is not.
    Reacquired,
    /// The target, tracked from the frame before: identity and pose are known.
    Tracked,
}

/// Confidence that an alignment needs to go on.
#[derive(Clone, Copy)]
pub(super) struct Needed {
    /// After an iteration, for the next one.
    pub(super) to_iterate: f32,
    /// After the last iteration.
    pub(super) to_refine: f32,
}

impl Needed {
    /// All iterations are run, unless the candidate is discarded.
    pub(super) fn to_refine(confidence: f32) -> Needed {
        Needed {
            to_iterate: DISCARD_CONFIDENCE.min(confidence),
            to_refine: confidence,
        }
    }
}

/// Where an alignment starts, and what it needs.
pub(super) struct Start {
    pub(super) shape: Shape,
    /// Iterations of the cascade.
    pub(super) iterations: usize,
    pub(super) needed: Needed,
    pub(super) origin: Origin,
    /// Whether a rejected candidate is worth another attempt.
    pub(super) may_retry: bool,
}

impl Start {
    /// A start near a face: one iteration.
    pub(super) fn near(shape: Shape, origin: Origin) -> Start {
        Start {
            shape,
            iterations: 1,
            needed: Needed::to_refine(ACCEPT_CONFIDENCE),
            origin,
            may_retry: false,
        }
    }

    /// The start at a detection; `None` where no shape fits into its box.
    #[inline(never)]
    pub(super) fn at(
        step: &Step<'_>,
        face: &Detection,
        origin: Origin,
        needed: Needed,
    ) -> Option<Start> {
        let align = &step.model.align;
        let canonical = align.views().initial_shape(face.yaw)?;
        Some(Start {
            shape: initial_shape(&canonical, face)?,
            iterations: align.iterations(),
            needed,
            origin,
            may_retry: true,
        })
    }
}

/// How the target looked before, with which an alignment of it is compared. The appearance does not
/// follow a face that belongs to another tracker.
pub(super) struct Known<'a> {
    pub(super) appearance: &'a mut Appearance,
    pub(super) excluded: &'a Excluded,
}

/// Landmarks aligned on a frame, and not yet fitted.
pub(super) struct Aligned {
    /// Where it started.
    pub(super) start: Shape,
    /// Its landmarks.
    pub(super) shape: Shape,
    /// The landmarks after the global stage, before the refiners.
    pub(super) global_shape: Shape,
    /// The landmarks where a pinhole camera would show them, if they are refined.
    pub(super) undistorted: Shape,
    /// Their weights in the 3D fit.
    weights: [f32; LANDMARKS],
    /// False where a landmark is not finite: the rest has no meaning then, and no confidence.
    pub(super) is_finite: bool,
    /// The rotation by what it has seen.
    pub(super) rotation: Option<RotationPrior>,
    pub(super) confidence: Confidence,
    /// Landmarks that are visible and match the target's appearance.
    pub(super) recognised: u32,
    /// Iterations that were not run, because the confidence was too low.
    pub(super) iterations_left: usize,
    /// What it has cost \[units of the detector\].
    pub(super) units: u32,
}

impl Aligned {
    /// What the 3D face is fitted to.
    pub(super) fn observed(&self) -> Observed<'_> {
        Observed {
            points: &self.undistorted,
            weights: &self.weights,
        }
    }
}

/// A run of the cascade.
pub(super) struct Run {
    pub(super) shape: Shape,
    is_finite: bool,
    /// Whether it came to its end, with the confidence that it needs.
    pub(super) is_refined: bool,
    pub(super) confidence: Confidence,
    iterations_left: usize,
    pub(super) units: u32,
}

impl Run {
    pub(super) fn new(start: &Start) -> Run {
        Run {
            shape: start.shape,
            is_finite: false,
            is_refined: false,
            confidence: Confidence::NONE,
            iterations_left: start.iterations,
            units: 0,
        }
    }

    /// Runs the global stage and verifies each iteration. A candidate ends where it has less
    /// confidence than is needed to go on. Any other is refined.
    #[inline(never)]
    pub(super) fn run(&mut self, step: &Step<'_>, needed: &Needed, work: &mut Workspace) {
        if self.iterate(step, needed, work) {
            self.units += REFINE_UNITS;
            self.is_finite = (step.model.align).refine(step.frame, &mut self.shape, work);
            self.is_refined = self.is_finite;
        }
    }

    /// Whether all iterations were run, and the last one has the confidence that is needed.
    #[inline(never)]
    fn iterate(&mut self, step: &Step<'_>, needed: &Needed, work: &mut Workspace) -> bool {
        let (cascade, verifier) = (&step.model.align, &step.model.verifier);
        while self.iterations_left > 0 {
            self.units += ITERATION_UNITS;
            self.is_finite = cascade.iterate(step.frame, &mut self.shape, work);
            if !self.is_finite {
                return false;
            }
            self.confidence = verifier.evaluate(work.features(), work.view());
            self.iterations_left -= 1;
            let least = match self.iterations_left {
                0 => needed.to_refine,
                _ => needed.to_iterate,
            };
            if self.confidence.face < least {
                return false;
            }
        }
        true
    }
}

/// Aligns a face from a start; what is refined is compared with what is known of it.
#[inline(never)]
pub(super) fn align(
    step: &Step<'_>,
    start: &Start,
    known: Option<Known<'_>>,
    work: &mut Workspace,
) -> Aligned {
    let mut run = Run::new(start);
    run.run(step, &start.needed, work);
    aligned(step, start, &run, known, work)
}

/// What a run has come to. Apart from the run, whose working memory is not on the stack any more.
#[inline(never)]
fn aligned(
    step: &Step<'_>,
    start: &Start,
    run: &Run,
    known: Option<Known<'_>>,
    work: &Workspace,
) -> Aligned {
    let shape = &run.shape;
    let mut confidence = match run.is_finite {
        true => run.confidence,
        false => Confidence::NONE,
    };
    let rotation = match run.is_refined {
        true => rotation_prior(step, shape, &confidence, work),
        false => None,
    };
    let is_own = |known: &Known<'_>| run.is_refined && !known.excluded.contains(centre(shape));
    let recognised = known.filter(is_own).map_or(0, |known| {
        let is_trusted = confidence.face >= TRUST_CONFIDENCE;
        (known.appearance).update(work.features(), is_trusted, &mut confidence)
    });
    Aligned {
        start: start.shape,
        shape: *shape,
        global_shape: *work.global_shape(),
        undistorted: match run.is_refined {
            true => step.camera.undistorted(shape),
            false => *shape,
        },
        weights: fit_weights(&confidence),
        is_finite: run.is_finite,
        rotation,
        confidence,
        recognised,
        iterations_left: run.iterations_left,
        units: run.units,
    }
}

/// Weights of the landmarks in the 3D fit.
fn fit_weights(confidence: &Confidence) -> [f32; LANDMARKS] {
    let mut weights = confidence.landmarks;
    for (weight, visibility) in weights.iter_mut().zip(&confidence.visibility) {
        let shown = FIT_WEIGHT_HIDDEN + (1.0 - FIT_WEIGHT_HIDDEN) * visibility;
        *weight = FIT_WEIGHT_MIN + *weight * shown;
    }
    weights
}

/// The rotation by what the alignment has seen. Landmarks that are hidden are estimates whose
/// errors are alike: the more there are, the more the prior counts.
fn rotation_prior(
    step: &Step<'_>,
    shape: &Shape,
    confidence: &Confidence,
    work: &Workspace,
) -> Option<RotationPrior> {
    let (regression, mean) = (&step.model.rotation, step.model.align.mean());
    let (features, view) = (work.features(), work.view());
    let prior = regression.predict(features, view, mean, shape, &step.camera)?;
    Some(RotationPrior {
        weight: ROTATION_PRIOR_WEIGHT * (1.0 - confidence.visible_share()),
        ..prior
    })
}
