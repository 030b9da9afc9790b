//! What a head is off that a cascade has tracked to the frame before: the starts that it is trained
//! from once more (thesis 5.2).

use super::face_model::FaceModel;
use super::head_cascade::HeadCascade;
use super::state::{State, UNITS};
use crate::truth;
use crate::video;
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Quat, Vec2, Vec3};
use posewise::Intrinsics;
use posewise::math::head_angles;
use rand::Rng;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Turn from the truth at which a tracked head is lost, and set back on the truth \[deg\].
const LOST_DEG: f32 = 40.0;
/// How far the true |yaw| of an error may be from that of the face that it is drawn for \[deg\].
const NEAR_DEG: f32 = 15.0;

/// What a start is off a frame's true head.
struct StartError {
    /// Of the true head \[deg\].
    yaw_deg: f32,
    /// About the camera's axes \[rad\].
    turn: Vec3,
    /// Over the true distance.
    distance: f32,
    /// Across the line of sight \[mm\].
    sideways: Vec2,
    units: [f32; UNITS.len()],
    identity: Vec<f64>,
}

/// Errors of a cascade's own starts.
pub struct OwnErrors(Vec<StartError>);

impl OwnErrors {
    /// Of all frames of clips that lie beside their truth.
    pub fn of(model: &FaceModel, cascade: &HeadCascade, clips: &[PathBuf]) -> Result<OwnErrors> {
        let of_clip = clips.par_iter().map(|clip| tracked(model, cascade, clip));
        let each: Vec<Vec<StartError>> = of_clip.collect::<Result<_>>()?;
        let all: Vec<StartError> = each.into_iter().flatten().collect();
        ensure!(!all.is_empty(), "clips without frames");
        let square = |k: usize| all.iter().map(|e| e.turn[k].powi(2)).sum::<f32>();
        let off = [0, 1, 2].map(|k| (square(k) / all.len() as f32).sqrt().to_degrees());
        eprintln!("  {} own starts, {off:.1?}° off about x, y, z", all.len());
        Ok(OwnErrors(all))
    }

    /// A start on a face whose true head this is: one of the errors at about its yaw, in a mirror
    /// where the face looks to the other side. What the identity is off comes with it.
    pub fn start(&self, truth: &State, rng: &mut impl Rng) -> (State, Vec<f64>) {
        let yaw_deg = head_angles(&truth.rotation).yaw_deg;
        let far = |error: &StartError| (error.yaw_deg.abs() - yaw_deg.abs()).abs();
        let near: Vec<&StartError> = self.0.iter().filter(|e| far(e) <= NEAR_DEG).collect();
        let error = match near.len() {
            0 => self.0.iter().min_by(|a, b| far(a).total_cmp(&far(b))),
            count => near.get(rng.random_range(0..count)).copied(),
        };
        let error = error.expect("there are errors");
        let side = (error.yaw_deg * yaw_deg).signum();
        let turn = error.turn * Vec3::new(1.0, side, side);
        let sideways = error.sideways * Vec2::new(side, 1.0);
        let start = State {
            rotation: Mat3::from_quat(Quat::from_scaled_axis(turn)) * truth.rotation,
            translation: truth.translation * error.distance + sideways.extend(0.0),
            units: std::array::from_fn(|k| (truth.units[k] + error.units[k]).clamp(0.0, 1.0)),
        };
        (start, error.identity.clone())
    }
}

/// A clip that a cascade tracks behind the true head of the first frame.
fn tracked(model: &FaceModel, cascade: &HeadCascade, clip: &Path) -> Result<Vec<StartError>> {
    let table = clip.with_extension("").with_extension("csv");
    let truth = truth::read(&table)?;
    let mut errors = Vec::new();
    let mut before = None;
    for (luma, truth) in video::frames(clip)?.zip(&truth) {
        let luma = luma?;
        let focal = truth.focal.context("a truth without a focal length")? as f32;
        let [x, y] = [luma.width(), luma.height()].map(|side| (side as f32 - 1.0) / 2.0);
        let camera = Intrinsics::new(focal, focal, x, y);
        let labels = truth.points.map(|p| p.map(|v| v as f32));
        let (identity, state) = model.fit_identity(camera, &labels)?;
        let Some((first, head, start)) = &mut before else {
            let head = model.sketch(camera, &identity);
            before = Some((identity, head, state));
            continue;
        };
        errors.push(error(first, start, &identity, &state));
        let found = cascade.run(&video::frame(&luma)?, head, start);
        *start = found.map_or(*start, |(found, _)| found);
        let turn: f64 = start.motion_since(&state)[..3].iter().map(|v| v * v).sum();
        if turn.sqrt().to_degrees() > f64::from(LOST_DEG) {
            *start = state;
        }
    }
    Ok(errors)
}

fn error(first: &[f64], start: &State, identity: &[f64], truth: &State) -> StartError {
    let motion = start.motion_since(truth);
    let turn = Vec3::from_array([0, 1, 2].map(|k| motion[k] as f32));
    let distance = start.translation.z / truth.translation.z;
    let pairs = first.iter().zip(identity);
    StartError {
        yaw_deg: head_angles(&truth.rotation).yaw_deg,
        turn,
        distance,
        sideways: (start.translation - truth.translation * distance).truncate(),
        units: std::array::from_fn(|k| start.units[k] - truth.units[k]),
        identity: pairs.map(|(a, b)| a - b).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::math::{HeadAngles, head_rotation};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn head(yaw_deg: f32, x: f32, z: f32) -> State {
        State {
            rotation: head_rotation(HeadAngles {
                yaw_deg,
                pitch_deg: 0.0,
                roll_deg: 0.0,
            }),
            translation: Vec3::new(x, 0.0, z),
            units: [0.5; UNITS.len()],
        }
    }

    #[test]
    fn starts_are_off_as_tracked_heads_were() {
        // Both are a tenth too far away, 5 mm to the right of it, and 4° short.
        let seen = [30.0, 60.0].map(|yaw| {
            let start = head(yaw - 4.0, 115.0, 550.0);
            error(&[0.5], &start, &[0.25], &head(yaw, 100.0, 500.0))
        });
        let errors = OwnErrors(seen.into());
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for (yaw, side) in [(32.0, 1.0), (-70.0, -1.0)] {
            let (start, identity) = errors.start(&head(yaw, -40.0, 800.0), &mut rng);
            let found = head_angles(&start.rotation).yaw_deg;
            assert!((found - (yaw - 4.0 * side)).abs() < 0.1, "{found}");
            let expected = Vec3::new(-44.0 + 5.0 * side, 0.0, 880.0);
            assert!(start.translation.abs_diff_eq(expected, 1e-2), "{start:?}");
            assert_eq!(identity, [0.25]);
        }
    }
}
