//! Regression cascades on RBM features as trackers: alone (thesis 5.1), and followed by SVM
//! templates (5.2).
//!
//! A frame starts from the head's landmarks in the frame before; the cascade moves them, and the
//! head is fitted to the inner ones.

use super::fit::{Free, Target, fit};
use super::follower::{Follower, Found};
use super::person::Person;
use super::state::State;
use super::svm::{INNER, REFINEMENT, Templates, picture};
use super::training::Trained;
use crate::features::cascade::Cascade;
use crate::video::Luma;
use anyhow::Result;
use posewise::align::Shape;
use posewise::shape::LANDMARKS;

/// Width of the fit's prior over that of the motion between frames: the cascade has seen the whole
/// face.
const WIDE: f64 = 4.0;
/// Weight of a landmark that the head hides: the cascade guesses it from the others.
const HIDDEN_WEIGHT: f32 = 0.3;

/// The cascade alone.
pub struct Regressed<'a> {
    person: &'a Person<'a>,
    cascade: &'a Cascade,
    shape: Shape,
    state: State,
}

impl<'a> Regressed<'a> {
    /// Behind the first frame and its landmarks.
    pub fn new(
        person: &'a Person<'a>,
        first: &State,
        landmarks: &Shape,
        trained: &'a Trained,
    ) -> Result<Regressed<'a>> {
        Ok(Regressed {
            person,
            cascade: trained.cascade()?,
            shape: *landmarks,
            state: *first,
        })
    }

    fn projected(&self, state: &State) -> Shape {
        std::array::from_fn(|i| self.person.image(state, i))
    }
}

impl Follower for Regressed<'_> {
    fn step(&mut self, luma: &Luma) -> Result<Found> {
        let shape = self.cascade.follow(&luma.frame()?, self.shape);
        // A shape that has burst starts anew.
        let shape = shape.unwrap_or_else(|| self.projected(&self.state));
        let target = |landmark: usize| Target {
            landmark,
            at: shape[landmark],
            weight: match self.person.facing(&self.state, landmark) > 0.0 {
                true => 1.0,
                false => HIDDEN_WEIGHT,
            },
        };
        let targets: Vec<Target> = (INNER..LANDMARKS).map(target).collect();
        let fitted = |prior: &State, free| fit(self.person, prior, &targets, free, WIDE);
        let pose = fitted(&self.state, Free::Pose).unwrap_or(self.state);
        self.state = fitted(&pose, Free::All).unwrap_or(pose);
        // The head's landmarks, the jaw from the cascade: shapes alone drift.
        let projected = self.projected(&self.state);
        self.shape = shape;
        self.shape[INNER..].copy_from_slice(&projected[INNER..]);
        Ok(Found {
            state: self.state,
            landmarks: Some(shape),
        })
    }
}

/// Cascade, then templates.
pub struct Hybrid<'a> {
    cascade: Regressed<'a>,
    templates: Templates<'a>,
}

impl<'a> Hybrid<'a> {
    /// From both.
    pub fn new(cascade: Regressed<'a>, templates: Templates<'a>) -> Hybrid<'a> {
        Hybrid { cascade, templates }
    }
}

impl Follower for Hybrid<'_> {
    fn step(&mut self, luma: &Luma) -> Result<Found> {
        let found = self.cascade.step(luma)?;
        let state = self
            .templates
            .fitted(&picture(luma), &found.state, REFINEMENT);
        // The next frame starts from the head's landmarks, the jaw from the cascade's.
        let projected = self.cascade.projected(&state);
        self.cascade.shape[INNER..].copy_from_slice(&projected[INNER..]);
        self.cascade.state = state;
        Ok(Found {
            state,
            landmarks: Some(self.cascade.shape),
        })
    }
}
