//! The training set of the thesis' trackers: descriptors at the landmarks of the person in the
//! first frame, drawn at a grid of poses.

use super::descriptor::{BLUR_MM, Descriptor};
use super::person::Person;
use super::picture::Picture;
use super::render::Texture;
use super::state::State;
use glam::Mat3;
use posewise::math::{HeadAngles, head_angles, head_rotation};
use rayon::prelude::*;

/// The 26 landmarks whose surroundings are compared, as many as the thesis': brows, nose, eyes,
/// mouth, chin.
pub const POINTS: [usize; 26] = [
    17, 19, 21, 22, 24, 26, 27, 30, 31, 33, 35, 36, 37, 39, 41, 42, 44, 45, 46, 48, 51, 54, 57, 62,
    66, 8,
];

/// Cosine of the angle to the line of sight from which on a landmark is used.
pub const FACING: f32 = 0.15;

/// Poses that are drawn \[deg\].
#[derive(Clone, Debug, clap::Args, serde::Serialize)]
pub struct Grid {
    /// Largest yaw of the synthesised views \[deg\].
    #[arg(long, default_value_t = 60.0)]
    pub max_yaw: f32,
    /// Largest pitch of the synthesised views \[deg\].
    #[arg(long, default_value_t = 20.0)]
    pub max_pitch: f32,
    /// Step between synthesised views \[deg\].
    #[arg(long, default_value_t = 10.0)]
    pub grid_step: f32,
}

/// Descriptors of one view, by number into [`POINTS`]; `None` where the landmark is hidden.
pub struct Sample {
    /// Rotation of the view.
    pub rotation: Mat3,
    /// At the landmarks.
    pub positive: Vec<Option<Vec<f32>>>,
    /// Beside them.
    pub negative: Vec<Vec<Vec<f32>>>,
}

/// Shifts of negative samples \[mm\], by view in turn.
const BESIDE_MM: [[f32; 2]; 8] = [
    [5.0, 0.0],
    [-5.0, 5.0],
    [0.0, 8.0],
    [8.0, -8.0],
    [-8.0, 0.0],
    [5.0, 5.0],
    [0.0, -5.0],
    [-8.0, -8.0],
];

impl Grid {
    fn angles(&self, most: f32) -> Vec<f32> {
        let count = (most / self.grid_step).floor() as i32;
        (-count..=count)
            .map(|k| k as f32 * self.grid_step)
            .collect()
    }

    /// The poses: the first frame's roll and place, with these yaws and pitches.
    fn poses(&self, first: &State) -> Vec<State> {
        let roll_deg = head_angles(&first.rotation).roll_deg;
        let yaws = self.angles(self.max_yaw);
        let pitches = self.angles(self.max_pitch);
        let all = yaws
            .iter()
            .flat_map(|yaw| pitches.iter().map(move |pitch| (*yaw, *pitch)));
        all.map(|(yaw_deg, pitch_deg)| State {
            rotation: head_rotation(HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            }),
            ..*first
        })
        .collect()
    }
}

/// Draws all views and reads their descriptors.
pub fn samples(
    person: &Person<'_>,
    frame: &Picture,
    first: &State,
    grid: &Grid,
    kind: Descriptor,
) -> Vec<Sample> {
    let texture = Texture::new(person, frame, first);
    let sample = |(number, pose): (usize, &State)| {
        let view = texture.render(pose);
        let shows = |point| view.shows(person, pose, point);
        let shifts = [number % 8, (number + 3) % 8].map(|k| BESIDE_MM[k]);
        sample(person, &view.picture, pose, shows, &shifts, kind)
    };
    let poses = grid.poses(first);
    poses.par_iter().enumerate().map(sample).collect()
}

/// Descriptors of the first frame itself, with all of its surroundings.
pub fn first_sample(
    person: &Person<'_>,
    frame: &Picture,
    first: &State,
    kind: Descriptor,
) -> Sample {
    sample(person, frame, first, |_| true, &BESIDE_MM, kind)
}

fn sample(
    person: &Person<'_>,
    picture: &Picture,
    pose: &State,
    shows: impl Fn(usize) -> bool,
    shifts: &[[f32; 2]],
    kind: Descriptor,
) -> Sample {
    let axes = person.axes(pose);
    let scale = person.camera.fx / pose.translation.z;
    let picture = picture.blurred(BLUR_MM * scale);
    let read = |[x, y]: [f32; 2]| {
        let mut out = vec![0.0; kind.len()];
        kind.read(&picture, [x, y], axes, &mut out);
        out
    };
    let seen = |point: &usize| {
        let is_seen = person.facing(pose, *point) > FACING && shows(*point);
        is_seen.then(|| person.image(pose, *point))
    };
    let places: Vec<Option<[f32; 2]>> = POINTS.iter().map(seen).collect();
    let beside = |place: &Option<[f32; 2]>| -> Vec<Vec<f32>> {
        let shifted = |[x, y]: [f32; 2]| {
            let shifts = shifts.iter();
            shifts
                .map(|[dx, dy]| read([x + scale * dx, y + scale * dy]))
                .collect()
        };
        place.map(shifted).unwrap_or_default()
    };
    Sample {
        rotation: pose.rotation,
        negative: places.iter().map(beside).collect(),
        positive: places.iter().map(|place| place.map(read)).collect(),
    }
}
