//! Pose-wise SVM templates (thesis 4.4): around the landmarks of the predicted state, templates of
//! the nearest view on intensity, squared gradient and local binary patterns give a response map
//! each. The heuristic fit first moves the pose to the maps' peaks, then pose and animation to
//! their mean shifts.

use super::fit::{Free, Target, fit};
use super::follower::{Follower, Found};
use super::person::Person;
use super::state::{DAMPING, SIZE, State, Step};
use super::synthesis::FACING;
use super::training::Trained;
use crate::templates::correct::Correction;
use crate::templates::descriptor::{Patches, Placement};
use crate::templates::svm::Bank;
use anyhow::Result;
use image::GrayImage;
use posewise::Model;
use posewise::align::Shape;
use posewise::shape::LANDMARKS;
use posewise_metrics::landmarks::INNER;
use posewise_train::picture::Picture;

/// The rounds of the fit in a frame.
const ROUNDS: [(Correction, Free); 4] = [
    (Correction::Peak, Free::Pose),
    (Correction::Peak, Free::Pose),
    (Correction::MeanShift, Free::All),
    (Correction::MeanShift, Free::All),
];
/// Width of the fit's prior over that of the motion between frames.
const WIDE: f64 = 1.5;

/// The tracker.
pub struct Templates<'a> {
    person: &'a Person<'a>,
    /// Its views and its mean shape: no network is run.
    model: &'a Model<'a>,
    bank: &'a Bank,
    state: State,
    motion: Step,
}

impl<'a> Templates<'a> {
    /// Behind the first frame.
    pub fn new(
        person: &'a Person<'a>,
        first: &State,
        model: &'a Model<'a>,
        trained: &'a Trained,
    ) -> Result<Templates<'a>> {
        Ok(Templates {
            person,
            model,
            bank: trained.bank()?,
            state: *first,
            motion: [0.0; SIZE],
        })
    }

    /// The state near `prior` that the templates respond to.
    pub fn fitted(&self, picture: &Picture, prior: &State, rounds: &[(Correction, Free)]) -> State {
        let mut state = *prior;
        for (correction, free) in rounds {
            let targets = self.targets(picture, &state, *correction);
            match fit(self.person, prior, &targets, *free, WIDE) {
                Some(found) => state = found,
                None => break,
            }
        }
        state
    }

    /// Where the response maps pull the landmarks that face the camera.
    fn targets(&self, picture: &Picture, state: &State, correction: Correction) -> Vec<Target> {
        let shape: Shape = std::array::from_fn(|i| self.person.image(state, i));
        let Some(placement) = Placement::of(self.model.align(), &shape) else {
            return Vec::new();
        };
        let patches = Patches::cut(picture, &placement);
        let mut points = placement.points(&shape);
        let mut weights = [0.0; LANDMARKS];
        for (k, point) in points.iter_mut().enumerate() {
            let landmark = placement.landmark(k);
            if landmark < INNER || self.person.facing(state, landmark) < FACING {
                continue;
            }
            let (shift, height) = correction.shift(self.bank, &placement, k, &patches, *point);
            *point = [point[0] + shift[0], point[1] + shift[1]];
            // The mean of the three descriptors' probabilities.
            weights[landmark] = height.cbrt();
        }
        let shape = placement.shape(&points);
        let target = |landmark: usize| Target {
            landmark,
            at: shape[landmark],
            weight: weights[landmark],
        };
        let all = (INNER..LANDMARKS).map(target);
        all.filter(|t| t.weight > 0.0).collect()
    }
}

/// A frame as templates read it.
pub fn picture(luma: &GrayImage) -> Picture {
    Picture {
        size: [luma.width(), luma.height()],
        luma: luma.as_raw().clone(),
    }
}

/// The second step alone, of a method that has found the pose.
pub const REFINEMENT: &[(Correction, Free)] = ROUNDS.split_at(2).1;

impl Follower for Templates<'_> {
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
        let predicted = self.state.moved(&self.motion);
        let state = self.fitted(&picture(luma), &predicted, &ROUNDS);
        self.motion = state.motion_since(&self.state).map(|v| DAMPING * v);
        self.state = state;
        Ok(Found {
            state,
            landmarks: None,
        })
    }
}
