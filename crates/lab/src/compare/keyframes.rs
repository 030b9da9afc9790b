//! Wide-baseline matching (thesis 4.2): keypoints of the frame are matched with those of keyframes
//! of other poses, whose points on the mesh are known. RANSAC over POSIT finds the rigid pose.
//!
//! Keypoints are FAST corners of the smoothed frame; descriptors are gradients by cell and
//! direction as SIFT's, at the scale and the roll of the face in the frame before.

use super::descriptor::Descriptor;
use super::person::Person;
use super::picture::Picture;
use super::render::surface;
use super::state::State;
use glam::{Mat3, Vec3};
use image::GrayImage;
use imageproc::corners::corners_fast9;
use imageproc::suppress::local_maxima;
use posewise::shape::{Pose, Project, posit};
use rand::SeedableRng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

/// Contrast of a corner \[grey levels\], and distance between corners \[px\].
const CONTRAST: u8 = 5;
const APART: u32 = 4;
/// Most keypoints of a frame and of a keyframe, the strongest ones.
const KEYPOINTS: usize = 400;
const KEPT_POINTS: usize = 200;
/// Keypoints of a frame are at most so far from the head's last place \[mm\].
const AROUND_MM: f32 = 250.0;
/// Part of the mesh that is the rigid face \[mm, head frame\]: up to the forehead, down to the
/// chin, back to before the ears.
const FACE_MM: [f32; 3] = [-75.0, 95.0, 60.0];
/// Lowe's ratio of the distances to the best and the second-best match.
const RATIO: f32 = 0.8;
/// Keyframes that are matched with a frame, the nearest ones.
const MATCHED: usize = 3;
/// RANSAC: samples of four pairs, distance of an inlier \[mm\], least number of inliers.
const SAMPLES: usize = 300;
const SAMPLE: usize = 4;
const INLIER_MM: f32 = 4.0;
const LEAST_INLIERS: usize = 10;
/// A keyframe is added where all others are further away \[rad\] and the energy is at most
/// [`GOOD`] times the mean of the frames before.
const FAR: f32 = 0.22;
const GOOD: f64 = 1.2;
/// Most keyframes.
const MOST: usize = 16;
/// Share of a frame in the mean energy.
const RATE: f64 = 0.05;

/// Keypoints of one frame in which the head was found.
struct Keyframe {
    rotation: Mat3,
    points: Vec<(Vec3, Vec<f32>)>,
}

/// The keyframes of a person.
pub struct Keyframes<'a> {
    person: &'a Person<'a>,
    kept: Vec<Keyframe>,
    mean_energy: Option<f64>,
}

/// A pair: point of the head \[mm\] and of the frame \[px\].
type Pair = (Vec3, [f32; 2]);

impl<'a> Keyframes<'a> {
    /// None yet.
    pub fn new(person: &'a Person<'a>) -> Keyframes<'a> {
        Keyframes {
            person,
            kept: Vec::new(),
            mean_energy: None,
        }
    }

    /// The head in a smoothed frame, with the units that it had before.
    pub fn find(&self, frame: &Picture, before: &State) -> Option<State> {
        let mut near: Vec<(f32, &Keyframe)> = (self.kept.iter())
            .map(|k| (angle(&k.rotation, &before.rotation), k))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let keypoints = self.keypoints(frame, before, KEYPOINTS);
        let nearest = near.iter().take(MATCHED);
        let pairs: Vec<Pair> = nearest
            .flat_map(|(_, keyframe)| pairs(&keyframe.points, &keypoints))
            .collect();
        let pose = self.ransac(&pairs, before)?;
        Some(State {
            rotation: pose.rotation,
            translation: pose.translation_mm,
            units: before.units,
        })
    }

    /// A smoothed frame in which the head was found with this energy.
    pub fn offer(&mut self, frame: &Picture, state: &State, energy: f64) {
        let mean = self.mean_energy.unwrap_or(energy);
        let is_new = |k: &Keyframe| angle(&k.rotation, &state.rotation) > FAR;
        if energy > GOOD * mean {
            return;
        }
        self.mean_energy = Some(mean + RATE * (energy - mean));
        if self.kept.len() >= MOST || !self.kept.iter().all(is_new) {
            return;
        }
        let keypoints = self.keypoints(frame, state, KEYPOINTS);
        let at: Vec<[f32; 2]> = keypoints.iter().map(|(at, _)| *at).collect();
        let solid = surface(self.person, state, [frame.width, frame.height], &at);
        let [top, bottom, back] = FACE_MM;
        let on_face = |p: &Vec3| (top..bottom).contains(&p.y) && p.z < back;
        let points = solid.into_iter().zip(keypoints);
        let points = points.filter_map(|(p, (_, d))| Some((p.filter(on_face)?, d)));
        self.kept.push(Keyframe {
            rotation: state.rotation,
            points: points.take(KEPT_POINTS).collect(),
        });
    }

    /// Keypoints around the head with their descriptors, the strongest first.
    fn keypoints(&self, frame: &Picture, near: &State, most: usize) -> Vec<([f32; 2], Vec<f32>)> {
        let luma = frame.pixels.iter().map(|v| v.round() as u8).collect();
        let image = GrayImage::from_raw(frame.width as u32, frame.height as u32, luma);
        let Some(image) = image else {
            return Vec::new();
        };
        let corners = corners_fast9(&image, CONTRAST);
        let mut corners = local_maxima(&corners, APART);
        corners.sort_by(|a, b| b.score.total_cmp(&a.score));
        let camera = &self.person.camera;
        let [x, y] = camera.project(near.translation);
        let reach = AROUND_MM * camera.fx / near.translation.z;
        let axes = self.person.axes(near);
        let kind = Descriptor::Gradients;
        let at = corners.iter().map(|c| [c.x as f32, c.y as f32]);
        at.filter(|at| (at[0] - x).hypot(at[1] - y) < reach)
            .take(most)
            .map(|at| {
                let mut descriptor = vec![0.0; kind.len()];
                kind.read(frame, at, axes, &mut descriptor);
                (at, descriptor)
            })
            .collect()
    }

    /// The pose that most pairs agree on.
    fn ransac(&self, pairs: &[Pair], before: &State) -> Option<Pose> {
        if pairs.len() < LEAST_INLIERS {
            return None;
        }
        let camera = &self.person.camera;
        let pose_of = |pairs: &[Pair]| posit(camera, pairs.iter().map(|(p, at)| (*p, *at, 1.0)));
        let limit = INLIER_MM * camera.fx / before.translation.z;
        let inliers = |pose: &Pose| -> Vec<Pair> {
            let is_near = |(p, at): &&Pair| {
                let [x, y] = camera.project(pose.rotation * *p + pose.translation_mm);
                (x - at[0]).hypot(y - at[1]) < limit
            };
            pairs.iter().filter(is_near).copied().collect()
        };
        let mut rng = ChaCha8Rng::seed_from_u64(pairs.len() as u64);
        let mut best: Vec<Pair> = Vec::new();
        for _ in 0..SAMPLES {
            let sample: Vec<Pair> = pairs.choose_multiple(&mut rng, SAMPLE).copied().collect();
            let Some(pose) = pose_of(&sample) else {
                continue;
            };
            let agreeing = inliers(&pose);
            if agreeing.len() > best.len() {
                best = agreeing;
            }
        }
        if best.len() < LEAST_INLIERS {
            return None;
        }
        let refined = inliers(&pose_of(&best)?);
        if refined.len() < LEAST_INLIERS {
            return None;
        }
        pose_of(&refined)
    }
}

/// Pairs whose descriptors are near, and much nearer than the second-best.
fn pairs(known: &[(Vec3, Vec<f32>)], found: &[([f32; 2], Vec<f32>)]) -> Vec<Pair> {
    let distance = |a: &[f32], b: &[f32]| -> f32 {
        let terms = a.iter().zip(b);
        terms.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let pair = |(point, descriptor): &(Vec3, Vec<f32>)| {
        let (mut best, mut second, mut at) = (f32::MAX, f32::MAX, [0.0; 2]);
        for (place, other) in found {
            let d = distance(descriptor, other);
            if d < best {
                (best, second, at) = (d, best, *place);
            } else if d < second {
                second = d;
            }
        }
        (best < RATIO * RATIO * second).then_some((*point, at))
    };
    known.iter().filter_map(pair).collect()
}

/// Angle between two rotations \[rad\].
fn angle(a: &Mat3, b: &Mat3) -> f32 {
    let turn = glam::Quat::from_mat3(&(*a * b.transpose()));
    turn.to_scaled_axis().length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_distinct_matches_are_pairs() {
        let known = [(Vec3::X, vec![1.0, 0.0]), (Vec3::Y, vec![0.0, 1.0])];
        let found = [
            ([3.0, 4.0], vec![0.9, 0.1]),
            ([5.0, 6.0], vec![0.1, 1.1]),
            ([7.0, 8.0], vec![-0.1, 1.1]),
        ];
        assert_eq!(pairs(&known, &found), [(Vec3::X, [3.0, 4.0])]);
    }

    #[test]
    fn angles_between_rotations() {
        let turn = Mat3::from_rotation_y(0.3) * Mat3::from_rotation_x(1.0);
        assert!((angle(&turn, &Mat3::from_rotation_x(1.0)) - 0.3).abs() < 1e-4);
    }
}
