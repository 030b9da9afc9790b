//! The 3D face of the person in the first frame: identity, pose and units from its landmarks.

use super::descriptor::BLUR_MM;
use super::face_model::FaceModel;
use super::picture::Picture;
use super::state::{SIZE, State, UNITS};
use anyhow::{Context, Result};
use glam::{Mat3, Vec3};
use image::GrayImage;
use nalgebra::{DMatrix, DVector};
use posewise::Intrinsics;
use posewise::align::Shape;
use posewise::shape::{LANDMARKS, Project, posit};
use posewise_metrics::landmarks::INNER;
use std::ops::Deref;

/// Standard deviation of a landmark in the first frame \[mm\].
const NOISE_MM: f64 = 1.5;
/// Standard deviation of a unit in the first frame.
const UNIT_SIGMA: f64 = 0.2;
/// Gauss–Newton iterations of the first frame.
const ITERATIONS: usize = 12;
/// Differences that the Jacobian is computed with: rad or weights, and mm.
const DELTA: f64 = 1e-3;
const DELTA_MM: f64 = 0.5;

/// Added to the diagonal of the normal equations.
const RIDGE: f64 = 1e-6;

/// The landmarks of a head with its identity, before a camera: what a fit to landmarks needs.
#[derive(Clone)]
pub struct Sketch<'m> {
    /// The head.
    pub model: &'m FaceModel,
    /// Neutral landmarks \[mm, head frame\].
    neutral: [Vec3; LANDMARKS],
    /// The camera.
    pub camera: Intrinsics,
}

/// A person: the head with its identity, and its surface.
pub struct Person<'m> {
    /// Its landmarks.
    pub sketch: Sketch<'m>,
    /// Neutral vertices \[mm, head frame\].
    neutral: Vec<Vec3>,
    /// Outward normals of the neutral face at the landmarks.
    normals: Vec<Vec3>,
}

impl FaceModel {
    /// The person whose landmarks these are \[px\], and the state of that frame.
    pub fn fit(
        &self,
        camera: Intrinsics,
        landmarks: &[[f32; 2]; LANDMARKS],
    ) -> Result<(Person<'_>, State)> {
        let (identity, state) = self.fit_identity(camera, landmarks)?;
        Ok((self.person(camera, &identity), state))
    }

    /// The weights of the identity modes of a person whose landmarks these are \[px\], and the
    /// state of that frame. POSIT finds the pose; Gauss–Newton with Gaussian priors then finds
    /// identity, pose and units together.
    pub fn fit_identity(
        &self,
        camera: Intrinsics,
        landmarks: &[[f32; 2]; LANDMARKS],
    ) -> Result<(Vec<f64>, State)> {
        let mean = |i: usize| self.landmark(&self.mesh.mean, i);
        let points = (INNER..LANDMARKS).map(|i| (mean(i), landmarks[i], 1.0));
        let pose = posit(&camera, points).context("no pose fits the landmarks")?;
        let mut state = State {
            rotation: pose.rotation,
            translation: pose.translation_mm,
            units: [0.0; UNITS.len()],
        };
        let mut identity = vec![0.0; self.identity.len()];
        let px_per_mm = f64::from(camera.fx / state.translation.z);
        let weight = 1.0 / (NOISE_MM * px_per_mm);
        for _ in 0..ITERATIONS {
            let residuals = |state: &State, identity: &[f64]| {
                let image = (INNER..LANDMARKS).flat_map(|i| {
                    let point = self.fitted(i, state, identity);
                    let [x, y] = camera.project(state.rotation * point + state.translation);
                    [x - landmarks[i][0], y - landmarks[i][1]]
                });
                let image = image.map(|d| f64::from(d) * weight);
                let units = state.units.iter().map(|u| f64::from(*u) / UNIT_SIGMA);
                let all = image.chain(units).chain(identity.iter().copied());
                DVector::from_iterator(2 * (LANDMARKS - INNER) + UNITS.len() + identity.len(), all)
            };
            let here = residuals(&state, &identity);
            let mut jacobian = DMatrix::zeros(here.len(), SIZE + identity.len());
            for k in 0..jacobian.ncols() {
                let delta = if (3..6).contains(&k) { DELTA_MM } else { DELTA };
                let there = match k.checked_sub(SIZE) {
                    None => {
                        let mut step = [0.0; SIZE];
                        step[k] = delta;
                        residuals(&state.moved(&step), &identity)
                    }
                    Some(mode) => {
                        let mut moved = identity.clone();
                        moved[mode] += delta;
                        residuals(&state, &moved)
                    }
                };
                jacobian.set_column(k, &((there - &here) / delta));
            }
            // Weights at their bound do not move.
            let ridge = DMatrix::identity(jacobian.ncols(), jacobian.ncols()) * RIDGE;
            let normal = jacobian.tr_mul(&jacobian) + ridge;
            let gradient = jacobian.tr_mul(&here);
            let factor = normal.cholesky().context("a singular fit")?;
            let step = -factor.solve(&gradient);
            state = state.moved(&step.as_slice()[..SIZE]);
            let changes = step.as_slice()[SIZE..].iter();
            identity.iter_mut().zip(changes).for_each(|(w, d)| *w += d);
        }
        Ok((identity, state))
    }

    /// The landmarks of a person with these weights of the identity modes.
    pub fn sketch(&self, camera: Intrinsics, identity: &[f64]) -> Sketch<'_> {
        Sketch {
            model: self,
            neutral: std::array::from_fn(|landmark| self.neutral(landmark, identity)),
            camera,
        }
    }

    fn person(&self, camera: Intrinsics, identity: &[f64]) -> Person<'_> {
        let weights: Vec<f32> = identity.iter().map(|w| *w as f32).collect();
        let neutral = self.mesh.vertices(&weights, &[]);
        let normals = self.mesh.normals(&neutral);
        let at = |v: &u32| normals[*v as usize];
        Person {
            sketch: self.sketch(camera, identity),
            normals: self.surface.iter().map(at).collect(),
            neutral,
        }
    }

    /// A landmark of identity and units \[mm, head frame\].
    fn fitted(&self, landmark: usize, state: &State, identity: &[f64]) -> Vec3 {
        let v = self.mesh.landmarks[landmark] as usize;
        let units = self.units.iter().zip(state.units);
        let neutral = self.neutral(landmark, identity);
        units.fold(neutral, |p, (unit, w)| p + unit[v] * w)
    }

    /// A landmark of the neutral face of an identity \[mm, head frame\].
    fn neutral(&self, landmark: usize, identity: &[f64]) -> Vec3 {
        let mean = self.landmark(&self.mesh.mean, landmark);
        let v = self.mesh.landmarks[landmark] as usize;
        let modes = self.identity.iter().zip(identity);
        modes.fold(mean, |p, (mode, w)| p + mode[v] * *w as f32)
    }
}

impl Sketch<'_> {
    /// A landmark in the camera frame \[mm\].
    pub fn landmark(&self, state: &State, landmark: usize) -> Vec3 {
        let v = self.model.mesh.landmarks[landmark] as usize;
        let units = self.model.units.iter().zip(state.units);
        let point = units.fold(self.neutral[landmark], |p, (unit, w)| p + unit[v] * w);
        state.rotation * point + state.translation
    }

    /// A landmark in the image \[px\].
    pub fn image(&self, state: &State, landmark: usize) -> [f32; 2] {
        self.camera.project(self.landmark(state, landmark))
    }

    /// All landmarks in the image \[px\].
    pub fn shape(&self, state: &State) -> Shape {
        std::array::from_fn(|i| self.image(state, i))
    }

    /// Image directions of the head's x and y axes at the pose's roll \[px/mm\]: what patches are
    /// read along.
    pub fn axes(&self, state: &State) -> [[f32; 2]; 2] {
        let scale = self.camera.fx / state.translation.z.max(1.0);
        let down = down_the_head(&state.rotation);
        [[down.y, -down.x], [down.x, down.y]].map(|axis| axis.map(|v| scale * v))
    }
}

impl<'m> Deref for Person<'m> {
    type Target = Sketch<'m>;

    fn deref(&self) -> &Sketch<'m> {
        &self.sketch
    }
}

impl Person<'_> {
    /// All vertices with these units \[mm, head frame\].
    pub fn vertices(&self, units: &[f32; UNITS.len()]) -> Vec<Vec3> {
        let mut out = self.neutral.clone();
        for (unit, w) in self
            .model
            .units
            .iter()
            .zip(units)
            .filter(|(_, w)| **w > 0.0)
        {
            out.iter_mut().zip(unit).for_each(|(o, d)| *o += *d * *w);
        }
        out
    }

    /// Cosine of the angle between a landmark's normal and the line of sight: above 0 where the
    /// skin faces the camera.
    pub fn facing(&self, state: &State, landmark: usize) -> f32 {
        let sight = self.landmark(state, landmark).normalize_or_zero();
        -(state.rotation * self.normals[landmark]).dot(sight)
    }

    /// A frame as descriptors of the head in this state are read from it.
    pub fn smoothed(&self, luma: &GrayImage, state: &State) -> Picture {
        Picture::of(luma).blurred(BLUR_MM * self.camera.fx / state.translation.z)
    }
}

/// Unit vector down the image that turns with the head's roll.
fn down_the_head(rotation: &Mat3) -> Vec3 {
    let roll = rotation.x_axis.y.atan2(rotation.y_axis.y);
    Vec3::new(-roll.sin(), roll.cos(), 0.0)
}
