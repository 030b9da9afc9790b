//! The One-Euro filter (Casiez, Roussel and Vogel, CHI 2012) over a tracker's results: little
//! jitter where the face is still, little delay where it moves.
//!
//! Every quantity x is low-passed as x̂ ← x̂ + a (x − x̂), a = 1 / (1 + 1 / (2π f Δt)), with the
//! cutoff f = `cutoff_hz` + `beta` · speed. Speeds are low-passed too. Their units are widths of
//! the face, radians and whole weights per second, of which a moving head reaches a few, so that
//! one `beta` suits all quantities.

use super::{State, TrackResult};
use crate::math::rotation_from_quaternion;
use crate::shape::{ANIMATIONS, LANDMARKS, Pose};
use crate::track::config::Smoothing;
use crate::track::geometry::bounds;
use crate::track::policy::{FACE_WIDTH_MM, MAX_SMOOTHING_GAP_US, SPEED_CUTOFF_HZ};

/// Filtered results; all zero before the first.
#[derive(Clone, Debug)]
pub struct Smoother {
    result: TrackResult,
    fitted_us: i64,
    landmark_speed: [[f32; 2]; LANDMARKS],
    point_speed: [[f32; 3]; LANDMARKS],
    position_speed: [f32; 3],
    rotation_speed: [f32; 4],
    eye_speed: [f32; 2],
    animation_speed: [f32; ANIMATIONS],
}

impl Smoother {
    pub const EMPTY: Smoother = Smoother {
        result: TrackResult::EMPTY,
        fitted_us: 0,
        landmark_speed: [[0.0; 2]; LANDMARKS],
        point_speed: [[0.0; 3]; LANDMARKS],
        position_speed: [0.0; 3],
        rotation_speed: [0.0; 4],
        eye_speed: [0.0; 2],
        animation_speed: [0.0; ANIMATIONS],
    };

    /// As [`Smoother::EMPTY`], of zero bytes only; see [`TrackResult::ZERO`].
    pub const ZERO: Smoother = Smoother {
        result: TrackResult::ZERO,
        ..Smoother::EMPTY
    };

    /// The last result, filtered.
    pub fn result(&self) -> &TrackResult {
        &self.result
    }

    /// Filters the next result.
    #[inline(never)]
    pub fn follow(&mut self, raw: &TrackResult, smoothing: &Smoothing) {
        match raw.state {
            State::Searching => self.result = *raw,
            State::Coasting => {
                self.result.state = raw.state;
                self.result.timestamp_us = raw.timestamp_us;
                self.result.age_us = raw.age_us;
                self.result.loss = raw.loss;
                self.result.eyes = raw.eyes;
            }
            State::Tracking => {
                let elapsed_us = raw.timestamp_us.saturating_sub(self.fitted_us);
                let is_continued = self.result.state != State::Searching;
                if is_continued && (1..=MAX_SMOOTHING_GAP_US).contains(&elapsed_us) {
                    self.advance(raw, smoothing, elapsed_us as f32 * 1e-6);
                } else {
                    *self = Smoother::EMPTY;
                    self.result = *raw;
                }
                self.fitted_us = raw.timestamp_us;
            }
        }
    }

    fn advance(&mut self, raw: &TrackResult, smoothing: &Smoothing, elapsed_s: f32) {
        let [_, _, width, height] = raw.face_box;
        let face_px = width.max(height).max(1.0);
        let filter = |unit: f32| Filter {
            smoothing: *smoothing,
            elapsed_s,
            unit,
        };
        let before = core::mem::replace(&mut self.result, *raw);
        let to = &mut self.result;
        let landmarks = to.landmarks.iter_mut().zip(&before.landmarks);
        for ((to, from), speed) in landmarks.zip(&mut self.landmark_speed) {
            [to.x, to.y] = filter(face_px).filtered([from.x, from.y], [to.x, to.y], speed);
        }
        let points = to.points_mm.iter_mut().zip(&before.points_mm);
        for ((to, from), speed) in points.zip(&mut self.point_speed) {
            *to = filter(FACE_WIDTH_MM).filtered(*from, *to, speed);
        }
        let animation = to.animation.iter_mut().zip(&before.animation);
        for ((to, from), speed) in animation.zip(&mut self.animation_speed) {
            *to = filter(1.0).filtered_one(*from, *to, speed);
        }
        let eyes = to.eye_open.iter_mut().zip(&before.eye_open);
        for ((to, from), speed) in eyes.zip(&mut self.eye_speed) {
            match (to, from) {
                (Some(to), Some(from)) => *to = filter(1.0).filtered_one(*from, *to, speed),
                // An unknown eye has no value to filter.
                _ => *speed = 0.0,
            }
        }
        to.translation_mm = filter(FACE_WIDTH_MM).filtered(
            before.translation_mm,
            to.translation_mm,
            &mut self.position_speed,
        );
        let from = before.rotation;
        // q and −q are the same rotation: the one on this side of `from`.
        let dot: f32 = from.iter().zip(&to.rotation).map(|(a, b)| a * b).sum();
        let near = to.rotation.map(|v| if dot < 0.0 { -v } else { v });
        // A quaternion moves half as far as the head turns.
        let between = filter(0.5).filtered(from, near, &mut self.rotation_speed);
        to.rotation = unit(between);
        write_angles(to);
        let shape: [[f32; 2]; LANDMARKS] = to.landmarks.map(|l| [l.x, l.y]);
        to.face_box = bounds(&shape);
    }
}

/// The angles of a result whose rotation and position are filtered.
fn write_angles(to: &mut TrackResult) {
    let pose = Pose {
        rotation: rotation_from_quaternion(to.rotation),
        translation_mm: to.translation_mm.into(),
    };
    let (angles, facing) = (pose.angles(), pose.facing_angles());
    (to.yaw_deg, to.pitch_deg, to.roll_deg) = (angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    (to.facing_yaw_deg, to.facing_pitch_deg, to.facing_roll_deg) =
        (facing.yaw_deg, facing.pitch_deg, facing.roll_deg);
    to.facing_angle_deg = pose.facing_angle_deg();
}

/// The unit quaternion along this one, with w ≥ 0.
fn unit(q: [f32; 4]) -> [f32; 4] {
    let square: f32 = q.iter().map(|v| v * v).sum();
    let scale = 1.0 / libm::sqrtf(square).max(1e-6);
    let [.., w] = q;
    q.map(|v| if w < 0.0 { -v * scale } else { v * scale })
}

/// The filter of one step for a quantity whose speed is counted in `unit`s per second.
#[derive(Clone, Copy)]
struct Filter {
    smoothing: Smoothing,
    elapsed_s: f32,
    unit: f32,
}

impl Filter {
    fn low_pass(&self, cutoff_hz: f32) -> f32 {
        let reach = core::f32::consts::TAU * cutoff_hz * self.elapsed_s;
        reach / (1.0 + reach)
    }

    /// Share of the distance to a new value that the filter moves.
    fn share(&self, distance: f32, speed: &mut f32) -> f32 {
        let now = distance / self.unit / self.elapsed_s;
        *speed += self.low_pass(SPEED_CUTOFF_HZ) * (now - *speed);
        self.low_pass(self.smoothing.cutoff_hz + self.smoothing.beta * speed.abs())
    }

    fn filtered_one(&self, from: f32, to: f32, speed: &mut f32) -> f32 {
        from + self.share(to - from, speed) * (to - from)
    }

    /// A point: one cutoff for all of its coordinates.
    fn filtered<const N: usize>(
        &self,
        from: [f32; N],
        to: [f32; N],
        speed: &mut [f32; N],
    ) -> [f32; N] {
        let keep = self.low_pass(SPEED_CUTOFF_HZ);
        let mut square = 0.0;
        for ((from, to), speed) in from.iter().zip(&to).zip(speed) {
            let now = (to - from) / self.unit / self.elapsed_s;
            *speed += keep * (now - *speed);
            square += *speed * *speed;
        }
        let cutoff_hz = self.smoothing.cutoff_hz + self.smoothing.beta * libm::sqrtf(square);
        let share = self.low_pass(cutoff_hz);
        let mut out = from;
        for (out, to) in out.iter_mut().zip(&to) {
            *out += share * (to - *out);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME_US: i64 = 33_333;

    fn raw_result(i: i64, x: f32, yaw_deg: f32) -> TrackResult {
        let half = yaw_deg.to_radians() / 2.0;
        let mut raw = TrackResult {
            state: State::Tracking,
            timestamp_us: i * FRAME_US,
            face_box: [0.0, 0.0, 100.0, 100.0],
            // A rotation by −yaw about y.
            rotation: [0.0, -half.sin(), 0.0, half.cos()],
            yaw_deg,
            eye_open: [Some(1.0), None],
            ..TrackResult::EMPTY
        };
        raw.landmarks.iter_mut().for_each(|l| l.x = x);
        raw
    }

    /// Filters 60 results. Returns the range of a quantity over the last half, and its last value.
    fn run(raw: impl Fn(i64) -> TrackResult, of: fn(&TrackResult) -> f32) -> (f32, f32) {
        let mut smoother = Smoother::EMPTY;
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for i in 0..60 {
            smoother.follow(&raw(i), &Smoothing::default());
            if i >= 30 {
                let value = of(smoother.result());
                (low, high) = (low.min(value), high.max(value));
            }
        }
        (high - low, of(smoother.result()))
    }

    #[test]
    fn little_jitter_where_still_and_little_delay_where_moving() {
        let still = |i: i64| {
            let noise = if i % 2 == 0 { 0.5 } else { -0.5 };
            raw_result(i, 50.0 + noise, noise)
        };
        assert!(run(still, |r| r.landmarks[0].x).0 < 0.4, "of 1 px");
        assert!(run(still, |r| r.yaw_deg).0 < 0.4, "of 1 degree");
        // A face that moves by its own width and turns by 90 degrees in a second.
        let moving = |i: i64| raw_result(i, i as f32 * 3.3, i as f32 * 3.0 - 90.0);
        let (_, x) = run(moving, |r| r.landmarks[0].x);
        assert!((x - 59.0 * 3.3).abs() < 5.0, "{x}");
        let (_, yaw) = run(moving, |r| r.yaw_deg);
        assert!((yaw - 87.0).abs() < 5.0, "{yaw}");
    }

    #[test]
    fn starts_anew_after_a_gap_and_keeps_unknown_eyes() {
        let mut smoother = Smoother::EMPTY;
        smoother.follow(&raw_result(0, 10.0, 0.0), &Smoothing::default());
        let raw = TrackResult {
            eye_open: [None, Some(0.25)],
            ..raw_result(1, 12.0, 5.0)
        };
        smoother.follow(&raw, &Smoothing::default());
        assert_eq!(smoother.result().eye_open, [None, Some(0.25)]);
        let far = raw_result(60, 90.0, 40.0);
        smoother.follow(&far, &Smoothing::default());
        assert_eq!(*smoother.result(), far);
        smoother.follow(&TrackResult::EMPTY, &Smoothing::default());
        assert_eq!(*smoother.result(), TrackResult::EMPTY);
    }
}
