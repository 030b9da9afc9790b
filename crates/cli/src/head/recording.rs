//! Keyframes of the tracked head, in the frame of 3D programs.

use posewise::{ANIMATIONS, State, TrackResult};

use super::axes;

/// What is kept of a frame.
#[derive(Clone, Copy)]
pub struct Key {
    /// Of the head in the camera frame \[m\].
    pub translation: [f32; 3],
    /// Head to camera, as a quaternion x, y, z, w.
    pub rotation: [f32; 4],
    /// Of the animation.
    pub weights: [f32; ANIMATIONS],
}

/// A keyframe of each frame.
#[derive(Default)]
pub struct Recording {
    first_us: Option<i64>,
    /// Since the first frame \[s\], increasing.
    pub times: Vec<f32>,
    /// As many as times, once there was a face.
    pub keys: Vec<Key>,
}

impl Recording {
    /// Adds a frame. Without a face the head stays where it was last; before the first face it
    /// waits where that will be.
    pub fn add(&mut self, result: &TrackResult, timestamp_us: i64) {
        let first_us = *self.first_us.get_or_insert(timestamp_us);
        let time = (timestamp_us.saturating_sub(first_us) as f64 / 1e6) as f32;
        // After hours, two frames may be one number.
        if self.times.last().is_some_and(|last| *last >= time) {
            return;
        }
        self.times.push(time);
        let key = match result.state {
            State::Searching => self.keys.last().copied(),
            State::Tracking | State::Coasting => Some(self.key(result)),
        };
        if let Some(key) = key {
            self.keys.resize(self.times.len(), key);
        }
    }

    fn key(&self, result: &TrackResult) -> Key {
        let mut rotation = axes::rotation(result.rotation);
        // Of the two quaternions of a rotation, the one nearer to the last: all players then take
        // the short way.
        if let Some(last) = self.keys.last() {
            let dot: f32 = (last.rotation.iter().zip(rotation))
                .map(|(a, b)| a * b)
                .sum();
            if dot < 0.0 {
                rotation = rotation.map(|number| -number);
            }
        }
        Key {
            translation: axes::point(result.translation_mm),
            rotation,
            weights: result.animation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(state: State, x_mm: f32) -> TrackResult {
        let mut result = TrackResult::default();
        result.state = state;
        result.translation_mm = [x_mm, 0.0, 500.0];
        result.rotation = [0.0, 0.0, 0.0, x_mm.signum()];
        result
    }

    #[test]
    fn without_a_face_the_head_stays() {
        let mut recording = Recording::default();
        let frames = [
            (State::Searching, 0.0),
            (State::Tracking, 10.0),
            (State::Coasting, -20.0),
            (State::Searching, 0.0),
            (State::Tracking, 30.0),
        ];
        for (i, (state, x_mm)) in frames.into_iter().enumerate() {
            let timestamp_us = 1_000_000 + 40_000 * i as i64;
            recording.add(&result(state, x_mm), timestamp_us);
            // The same time again is no frame.
            recording.add(&result(State::Tracking, 77.0), timestamp_us);
        }
        let x: Vec<f32> = recording
            .keys
            .iter()
            .map(|key| key.translation[0])
            .collect();
        let expected = [0.01, 0.01, -0.02, -0.02, 0.03];
        assert_eq!(x.len(), expected.len());
        let apart = x
            .iter()
            .zip(expected)
            .map(|(x, e): (&f32, f32)| (x - e).abs());
        assert!(apart.fold(0.0, f32::max) < 1e-6, "{x:?}");
        assert_eq!(recording.times, [0.0, 0.04, 0.08, 0.12, 0.16]);
        assert!(recording.keys.iter().all(|key| key.rotation[3] == 1.0));
    }
}
