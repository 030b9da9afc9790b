//! Pose-wise SVM templates (thesis 4.4): around the landmarks of the predicted state, templates of
//! the nearest view on intensity, squared gradient and local binary patterns give a response map
//! each. The heuristic fit first moves the pose to the maps' peaks, then pose and animation to
//! their mean shifts. A face that is lost is matched with keyframes (4.2).

use super::fit::{Free, Target, fit};
use super::follower::{Follower, Found};
use super::keyframes::Keyframes;
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

/// Energy above which the face is lost, of `svm` and of `hybrid`, whose cascade seldom loses it.
/// Tuned on videos of `render-u3pt --seed 2` (docs/dev/lab.md).
const LOST: f64 = 0.8;
const LOST_BEHIND_CASCADE: f64 = 0.86;

/// The tracker.
pub struct Templates<'a> {
    person: &'a Person<'a>,
    /// Its views and its mean shape: no network is run.
    model: &'a Model<'a>,
    bank: &'a Bank,
    /// What a frame is matched with where the face is lost.
    keyframes: Option<Keyframes<'a>>,
    /// Energy above which it is.
    lost: f64,
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
        keyframes: Option<Keyframes<'a>>,
    ) -> Result<Templates<'a>> {
        Ok(Templates {
            person,
            model,
            bank: trained.bank()?,
            keyframes,
            lost: LOST,
            state: *first,
            motion: [0.0; SIZE],
        })
    }

    /// As the second step behind a cascade.
    pub fn behind_cascade(self) -> Templates<'a> {
        Templates {
            lost: LOST_BEHIND_CASCADE,
            ..self
        }
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

    /// The state of a frame in which `find` finds the head from `start`. Where the templates hardly
    /// respond there, it is what it finds from where keyframes place the head; where they do not
    /// respond there either, the head stays where it was seen last.
    pub fn recovered(
        &mut self,
        luma: &GrayImage,
        picture: &Picture,
        start: &State,
        find: impl Fn(&Self, &State) -> State,
    ) -> State {
        let found = find(self, start);
        let Some(keyframes) = &self.keyframes else {
            return found;
        };
        let smoothed = self.person.smoothed(luma, &self.state);
        let mut best = (self.energy(picture, &found), found);
        if best.0 > self.lost {
            let matched = keyframes.find(&smoothed, &self.state);
            let matched = matched.map(|start| find(self, &start));
            let matched = matched.map(|state| (self.energy(picture, &state), state));
            match matched.filter(|matched| matched.0 <= self.lost) {
                Some(matched) => best = matched,
                None => return self.state,
            }
        }
        let (energy, state) = best;
        if let Some(keyframes) = &mut self.keyframes {
            keyframes.offer(&smoothed, &state, energy);
        }
        state
    }

    /// The head was found there.
    pub fn stay_at(&mut self, state: &State) {
        self.state = *state;
    }

    /// How little the templates respond at a state: 1 less the mean of the descriptors' responses,
    /// over the landmarks that face the camera.
    fn energy(&self, picture: &Picture, state: &State) -> f64 {
        let shape: Shape = std::array::from_fn(|i| self.person.image(state, i));
        let Some(placement) = Placement::of(self.model.align(), &shape) else {
            return 1.0;
        };
        let patches = Patches::cut(picture, &placement);
        let points = placement.points(&shape);
        let faces = |k: &usize| {
            let landmark = placement.landmark(*k);
            landmark >= INNER && self.person.facing(state, landmark) >= FACING
        };
        let facing = (0..LANDMARKS).filter(faces);
        let responses = facing.map(|k| {
            let response = (self.bank).response(placement.view, k, &patches, points[k]);
            f64::from(response.max(0.0).cbrt())
        });
        1.0 - mean(responses)
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

/// Mean; 0 of nothing.
fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0), |(sum, count), n| (sum + n, count + 1));
    sum / f64::from(count.max(1))
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
        let picture = picture(luma);
        let find = |templates: &Self, start: &State| templates.fitted(&picture, start, &ROUNDS);
        let state = self.recovered(luma, &picture, &predicted, find);
        self.motion = state.motion_since(&self.state).map(|v| DAMPING * v);
        self.stay_at(&state);
        Ok(Found {
            state,
            landmarks: None,
        })
    }
}
