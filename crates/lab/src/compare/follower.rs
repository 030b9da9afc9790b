//! What all comparators are: something that follows one face from frame to frame.

use super::bayes::Loop;
use super::keyframes::Keyframes;
use super::person::Person;
use super::scorer::Scorer;
use super::state::State;
use anyhow::Result;
use image::GrayImage;
use posewise::align::Shape;

/// What a frame shows.
pub struct Found {
    /// Pose and animation.
    pub state: State,
    /// Landmarks \[px\], where they are not those of the head in that state.
    pub landmarks: Option<Shape>,
}

/// A comparator behind its first frame.
pub trait Follower {
    /// The next frame.
    fn step(&mut self, luma: &GrayImage) -> Result<Found>;
}

/// The methods that minimise an energy in the Bayesian loop.
pub struct ByEnergy<'a> {
    /// The person.
    pub person: &'a Person<'a>,
    /// The loop.
    pub tracker: Loop,
    /// The energy.
    pub scorer: Box<dyn Scorer + 'a>,
    /// Where each frame also starts, if the method matches keyframes.
    pub keyframes: Option<Keyframes<'a>>,
}

impl Follower for ByEnergy<'_> {
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
        let before = *self.tracker.state();
        let picture = self.person.smoothed(luma, &before);
        let matched = self.keyframes.as_ref();
        let matched = matched.and_then(|k| k.find(&picture, &before));
        let state = self.tracker.step(self.scorer.as_mut(), &picture, matched)?;
        if let Some(keyframes) = &mut self.keyframes {
            let energy = self.scorer.energy(&picture, &state);
            keyframes.offer(&picture, &state, energy);
        }
        Ok(Found {
            state,
            landmarks: None,
        })
    }
}
