//! Comparators as scorers: how badly a hypothesis of pose and animation fits a frame.

use super::descriptor::Descriptor;
use super::person::Person;
use super::picture::Picture;
use super::state::State;
use super::synthesis::{FACING, POINTS};
use glam::Mat3;

/// A likelihood of the image (thesis, equation 3.2). Lower energies are better; that of a right
/// hypothesis is near 1.
pub trait Scorer {
    /// Before the hypotheses of a frame, which are near this state.
    fn prepare(&mut self, near: &State);
    /// The energy of a hypothesis.
    fn energy(&self, frame: &Picture, state: &State) -> f64;
    /// What was found in a frame.
    fn accept(&mut self, frame: &Picture, state: &State);
}

/// How far the surroundings of single landmarks are from what the person looks like.
pub trait LocalModel {
    /// Before the hypotheses of a frame.
    fn prepare(&mut self, _rotation: &Mat3) {}
    /// Energy of a descriptor at a landmark, by number into [`POINTS`]; `None` where it has no
    /// model.
    fn energy(&self, point: usize, descriptor: &[f32]) -> Option<f64>;
    /// A descriptor of the accepted state.
    fn accept(&mut self, _point: usize, _descriptor: &[f32]) {}
}

/// Landmarks that are seen less often than this share have little to say: the energy of a
/// hypothesis with fewer is that of a bad one.
const LEAST_POINTS: usize = 4;

/// The mean energy of the visible landmarks.
pub struct Local<'a, M> {
    /// The person.
    pub person: &'a Person<'a>,
    /// What is read at a landmark.
    pub descriptor: Descriptor,
    /// What it is compared with.
    pub model: M,
}

impl<M: LocalModel> Local<'_, M> {
    /// Descriptors at the landmarks that face the camera.
    fn each(&self, frame: &Picture, state: &State, mut found: impl FnMut(usize, &[f32])) {
        let axes = self.person.axes(state);
        let mut descriptor = vec![0.0; self.descriptor.len()];
        for (number, point) in POINTS.into_iter().enumerate() {
            if self.person.facing(state, point) > FACING {
                let at = self.person.image(state, point);
                self.descriptor.read(frame, at, axes, &mut descriptor);
                found(number, &descriptor);
            }
        }
    }
}

impl<M: LocalModel> Scorer for Local<'_, M> {
    fn prepare(&mut self, near: &State) {
        self.model.prepare(&near.rotation);
    }

    fn energy(&self, frame: &Picture, state: &State) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        self.each(frame, state, |point, descriptor| {
            if let Some(energy) = self.model.energy(point, descriptor) {
                sum += energy;
                count += 1;
            }
        });
        match count {
            0..LEAST_POINTS => f64::MAX.sqrt(),
            _ => sum / count as f64,
        }
    }

    fn accept(&mut self, frame: &Picture, state: &State) {
        let mut all = Vec::new();
        self.each(frame, state, |point, descriptor| {
            all.push((point, descriptor.to_vec()))
        });
        for (point, descriptor) in all {
            self.model.accept(point, &descriptor);
        }
    }
}
