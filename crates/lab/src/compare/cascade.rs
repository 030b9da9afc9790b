//! Regression cascades on RBM features as trackers: alone (thesis 5.1), and followed by SVM
//! templates (5.2).
//!
//! A frame starts from the initial shape of the view, placed where the landmarks of the frame
//! before were; the cascade moves it, and the head is fitted to its inner landmarks. From the
//! landmarks themselves the cascade drifts within seconds.

use super::fit::{Free, Target, fit};
use super::follower::{Follower, Found};
use super::person::Person;
use super::state::State;
use super::svm::{REFINEMENT, Templates, picture};
use super::training::Trained;
use crate::features::cascade::Cascade;
use crate::video;
use anyhow::Result;
use image::GrayImage;
use posewise::Model;
use posewise::align::Shape;
use posewise::math::{Similarity, head_angles};
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::INNER;

/// Width of the fit's prior over that of the motion between frames: the cascade has seen the whole
/// face.
const WIDE: f64 = 4.0;
/// Weight of a landmark that the head hides: the cascade guesses it from the others.
const HIDDEN_WEIGHT: f32 = 0.3;

/// The cascade alone.
pub struct Regressed<'a> {
    person: &'a Person<'a>,
    cascade: &'a Cascade,
    /// Its initial shapes: no network is run.
    model: &'a Model<'a>,
    shape: Shape,
    state: State,
}

impl<'a> Regressed<'a> {
    /// Behind the first frame and its landmarks.
    pub fn new(
        person: &'a Person<'a>,
        first: &State,
        landmarks: &Shape,
        model: &'a Model<'a>,
        trained: &'a Trained,
    ) -> Result<Regressed<'a>> {
        Ok(Regressed {
            person,
            cascade: trained.cascade()?,
            model,
            shape: *landmarks,
            state: *first,
        })
    }

    /// Where the cascade starts.
    fn start(&self) -> Option<Shape> {
        let turn = head_angles(&self.state.rotation).yaw_deg / 90.0;
        let initial = self.model.align().views().initial_shape(turn)?;
        let placed = Similarity::fit(&initial, &self.shape)?;
        Some(initial.map(|p| placed.apply(p)))
    }

    fn projected(&self, state: &State) -> Shape {
        std::array::from_fn(|i| self.person.image(state, i))
    }
}

impl Follower for Regressed<'_> {
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
        let frame = video::frame(luma)?;
        let shape = self.start().and_then(|s| self.cascade.run(&frame, s));
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
        // The next frame starts from the head's landmarks, the jaw from the cascade's.
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
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
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
