//! Faces with their boxes: photographs and renders with 68 landmarks.

use std::sync::Arc;

use posewise::detect::Detection;
use posewise::shape::MIRROR;

use crate::align::{self, StartShapes};
use crate::picture::Picture;

/// A picture with one labelled face.
pub struct Face {
    pub picture: Picture,
    /// The face's box by the rule of [`Detection`]; `yaw` from the nose's position between the
    /// eyes.
    pub truth: Detection,
}

/// Photographs whose labels differ by more between annotators are left out: their weight is below
/// this.
const LEAST_WEIGHT: f32 = 0.2;
/// Turn (-1 … 1) from which on a photographed face counts as one in profile.
const PROFILE_TURN: f32 = 0.6;

/// Photographs as faces with boxes.
pub fn of_photographs(mut faces: Vec<crate::faces::Face>) -> Vec<Face> {
    faces.retain(|face| face.weight >= LEAST_WEIGHT);
    let starts = (!faces.is_empty()).then(|| {
        let turns = align::Options::default().turns;
        StartShapes::fit(&faces, &align::mean_shape(&faces), &turns)
    });
    let face = |face: crate::faces::Face| {
        // The eye line of a face in profile has no length.
        let starts = starts.as_ref().filter(|_| face.turn().abs() > PROFILE_TURN);
        let roll = starts
            .and_then(|s| s.views().of(&face.landmarks))
            .map(|of| of.roll);
        let yaw = roll.map(|_| face.turn() * std::f32::consts::FRAC_PI_2);
        Face {
            truth: face_box(&face.landmarks, roll, yaw),
            picture: Arc::unwrap_or_clone(face.picture),
        }
    };
    faces.into_iter().map(face).collect()
}

/// Renders as faces with boxes: the first `most` of those whose roll follows from the eye line and
/// whose sides towards the camera are not covered. Others look like no face in a tile.
pub fn fronts(renders: &[crate::faces::Face], most: usize) -> Vec<Face> {
    const MOST_YAW_DEG: f32 = 60.0;
    const BOTH_SIDES_DEG: f32 = 15.0;
    let chosen = renders.iter().filter_map(|face| {
        let yaw_deg = face.yaw_deg.filter(|yaw| yaw.abs() <= MOST_YAW_DEG)?;
        let both = yaw_deg.abs() <= BOTH_SIDES_DEG;
        let bare = is_bare(face, yaw_deg) && (!both || is_bare(face, -yaw_deg));
        bare.then(|| of_render(face, yaw_deg, None))
    });
    chosen.take(most).collect()
}

/// Renders near profile, which photographs hardly show, with boxes: the first `most` of them whose
/// side towards the camera is not covered. Their roll is that of the most similar initial shape, at
/// which the cascade starts.
pub fn profiles(renders: &[crate::faces::Face], most: usize) -> Vec<Face> {
    const LEAST_YAW_DEG: f32 = 50.0;
    let turns = align::Options::default().turns;
    let starts = StartShapes::fit(renders, &align::mean_shape(renders), &turns);
    let chosen = renders.iter().filter_map(|face| {
        let yaw_deg = face.yaw_deg.filter(|yaw| yaw.abs() >= LEAST_YAW_DEG)?;
        let roll = starts.views().of(&face.landmarks)?.roll;
        is_bare(face, yaw_deg).then(|| of_render(face, yaw_deg, Some(roll)))
    });
    chosen.take(most).collect()
}

fn of_render(face: &crate::faces::Face, yaw_deg: f32, roll: Option<f32>) -> Face {
    Face {
        picture: Picture::clone(&face.picture),
        truth: face_box(&face.landmarks, roll, Some(yaw_deg.to_radians())),
    }
}

/// Whether nothing covers the side of a turned face that the camera sees.
fn is_bare(face: &crate::faces::Face, yaw_deg: f32) -> bool {
    // The subject's right brow, outer eye corner, corner of the mouth.
    let right = [17, 18, 19, 20, 21, 36, 48];
    let near = |k: usize| if yaw_deg > 0.0 { k } else { MIRROR[k] };
    right.into_iter().all(|k| face.visible[near(k)])
}

/// The box of 68 landmarks. Roll and yaw \[rad\] where they are known, else from the points.
pub fn face_box(points: &[[f32; 2]], roll: Option<f32>, yaw: Option<f32>) -> Detection {
    let mean = |range: std::ops::Range<usize>| {
        let n = range.len() as f32;
        let sum = points[range]
            .iter()
            .fold([0.0, 0.0], |s, p| [s[0] + p[0], s[1] + p[1]]);
        [sum[0] / n, sum[1] / n]
    };
    let (right, left) = (mean(36..42), mean(42..48));
    let roll = roll.unwrap_or_else(|| (left[1] - right[1]).atan2(left[0] - right[0]));
    let (sin, cos) = roll.sin_cos();
    let upright = |p: &[f32; 2]| [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0]];
    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
    for p in points.iter().map(upright) {
        for axis in 0..2 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let centre = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
    // The nose tip is in front of the outer eye corners by about half their distance.
    let (nose, a, b) = (
        upright(&points[30]),
        upright(&points[36]),
        upright(&points[45]),
    );
    let shift = nose[0] - (a[0] + b[0]) / 2.0;
    let yaw = yaw.unwrap_or_else(|| (2.0 * shift).atan2((b[0] - a[0]).max(1e-3)));
    Detection {
        x: cos * centre[0] - sin * centre[1],
        y: sin * centre[0] + cos * centre[1],
        size: (high[0] - low[0]).max(high[1] - low[1]),
        roll,
        yaw: (yaw / std::f32::consts::FRAC_PI_2).clamp(-1.0, 1.0),
        score: 0.0,
    }
}
