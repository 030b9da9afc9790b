//! First part of an attempt: from a start to landmarks, and what the classifiers say of them.

use super::follow::Appearance;
use super::geometry::{centre, initial_shape};
use super::policy::{
    ACCEPT_CONFIDENCE, DISCARD_CONFIDENCE, FIRST_UNITS, FIT_WEIGHT_HIDDEN, FIT_WEIGHT_MIN,
    ITERATION_UNITS, LOOKS, ROTATION_PRIOR_WEIGHT, TRUST_CONFIDENCE,
};
use super::search::{Excluded, Seen};
use super::step::Step;
use crate::align::{Networks, Shape, Workspace};
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
    /// The detection that it comes from.
    pub(super) seen: Seen,
    /// Those of the last iteration; all before have the first only.
    pub(super) networks: Networks,
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
            seen: Seen::NONE,
            networks: Networks::All,
        }
    }

    /// The last iteration with these networks.
    pub(super) fn with(self, networks: Networks) -> Start {
        Start { networks, ..self }
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
            seen: Seen {
                face: *face,
                looks: LOOKS,
            },
            networks: Networks::All,
        })
    }
}

/// Landmarks as the global stage sees them, and what the classifiers say of them.
pub(super) struct Candidate {
    /// Where it started.
    pub(super) start: Shape,
    /// Its landmarks.
    pub(super) shape: Shape,
    /// See [`Workspace::view`].
    view: usize,
    /// False where a landmark is not finite: the rest has no meaning then, and no confidence.
    pub(super) is_finite: bool,
    pub(super) confidence: Confidence,
    /// Mean visibility by the classifiers alone.
    visible_share: f32,
    /// Landmarks that are visible and match the target's appearance.
    pub(super) recognised: u32,
    /// Iterations that were not run, because the confidence was too low.
    pub(super) iterations_left: usize,
    /// What it has cost \[units of the detector\].
    pub(super) units: u32,
    /// As of its start.
    networks: Networks,
}

/// A candidate whose landmarks are refined, and not yet fitted.
pub(super) struct Aligned {
    /// Where it started.
    pub(super) start: Shape,
    /// Its landmarks.
    pub(super) shape: Shape,
    /// The landmarks before the refiners.
    pub(super) global_shape: Shape,
    /// The landmarks where a pinhole camera would show them.
    pub(super) undistorted: Shape,
    /// Their weights in the 3D fit.
    weights: [f32; LANDMARKS],
    /// The rotation by what it has seen.
    pub(super) rotation: Option<RotationPrior>,
    pub(super) confidence: Confidence,
    /// As in the candidate.
    pub(super) recognised: u32,
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

impl Candidate {
    /// Runs the global stage from a start and verifies each iteration. It ends where the candidate
    /// has less confidence than it needs for the next one.
    #[inline(never)]
    pub(super) fn new(step: &Step<'_>, start: &Start, work: &mut Workspace) -> Candidate {
        let mut candidate = Candidate {
            start: start.shape,
            shape: start.shape,
            view: 0,
            is_finite: false,
            confidence: Confidence::NONE,
            visible_share: 0.0,
            recognised: 0,
            iterations_left: start.iterations,
            units: 0,
            networks: start.networks,
        };
        while candidate.iterations_left > 0 {
            let is_next = candidate.iterate(step, work);
            if !is_next || candidate.confidence.face < start.needed.to_iterate {
                break;
            }
        }
        candidate
    }

    /// One iteration; false where a landmark is not finite.
    fn iterate(&mut self, step: &Step<'_>, work: &mut Workspace) -> bool {
        let (cascade, verifier) = (&step.model.align, &step.model.verifier);
        let networks = match self.iterations_left {
            1 => self.networks,
            _ => Networks::First,
        };
        self.units += match networks {
            Networks::First => FIRST_UNITS,
            _ => ITERATION_UNITS,
        };
        self.is_finite = cascade.iterate(step.frame, &mut self.shape, networks, work);
        self.confidence = match self.is_finite {
            true => verifier.evaluate(work.features(), work.view()),
            false => Confidence::NONE,
        };
        self.visible_share = self.confidence.visible_share();
        self.view = work.view();
        self.iterations_left -= 1;
        self.is_finite
    }

    /// Compares it with how the target looked before: visibilities change, and those that match are
    /// counted. The appearance does not follow a face that belongs to another tracker.
    pub(super) fn recognise(
        &mut self,
        appearance: &mut Appearance,
        excluded: &Excluded,
        work: &Workspace,
    ) {
        if self.is_finite && !excluded.contains(centre(&self.shape)) {
            let is_trusted = self.confidence.face >= TRUST_CONFIDENCE;
            self.recognised = appearance.update(work.features(), is_trusted, &mut self.confidence);
        }
    }

    /// Refines the landmarks of the last candidate, or of one whose features the working memory has
    /// again, where all of them are finite.
    #[inline(never)]
    pub(super) fn refine(
        &self,
        step: &Step<'_>,
        work: &mut Workspace,
        aligned: &mut Option<Aligned>,
    ) {
        let mut shape = self.shape;
        if !self.is_finite
            || !(step.model.align).refine(step.frame, &mut shape, self.networks, work)
        {
            return;
        }
        *aligned = Some(Aligned {
            start: self.start,
            shape,
            global_shape: self.shape,
            undistorted: step.camera.undistorted(&shape),
            weights: fit_weights(&self.confidence),
            rotation: self.rotation_prior(step, &shape, work),
            confidence: self.confidence,
            recognised: self.recognised,
        });
    }

    /// The rotation by what was seen. Landmarks that are hidden are estimates whose errors are
    /// alike: the more there are, the more the prior counts.
    fn rotation_prior(
        &self,
        step: &Step<'_>,
        shape: &Shape,
        work: &Workspace,
    ) -> Option<RotationPrior> {
        let (regression, mean) = (&step.model.rotation, step.model.align.mean());
        let features = work.features();
        let prior = regression.predict(features, self.view, mean, shape, &step.camera)?;
        Some(RotationPrior {
            weight: ROTATION_PRIOR_WEIGHT * (1.0 - self.visible_share),
            ..prior
        })
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
