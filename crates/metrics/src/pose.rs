//! Errors of head pose over the frames of clips.

/// a − b of angles \[deg\], from −180 to 180.
pub fn angle_difference(a: f64, b: f64) -> f64 {
    (a - b + 180.0).rem_euclid(360.0) - 180.0
}

/// |a − b| of angles \[deg\], at most 180.
pub fn angle_error(a: f64, b: f64) -> f64 {
    angle_difference(a, b).abs()
}

/// Mean of the errors of yaw, pitch and roll.
pub fn mean_angle(errors: [f64; 3]) -> f64 {
    errors.iter().sum::<f64>() / 3.0
}

/// Errors of yaw, pitch and roll \[deg\] of the frames that count; `None` where the face was not
/// tracked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseErrors {
    frames: Vec<Option<[f64; 3]>>,
}

impl PoseErrors {
    /// One frame: its true angles, and what was tracked.
    pub fn push(&mut self, truth: [f64; 3], tracked: Option<[f64; 3]>) {
        let error = |angles: [f64; 3]| [0, 1, 2].map(|i| angle_error(truth[i], angles[i]));
        self.frames.push(tracked.map(error));
    }

    /// Adds the frames of another clip.
    pub fn extend(&mut self, other: &PoseErrors) {
        self.frames.extend(&other.frames);
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    fn tracked(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.frames.iter().flatten()
    }

    /// P_s: the share of frames that were tracked; `None` of none.
    pub fn success(&self) -> Option<f64> {
        (!self.is_empty()).then(|| self.tracked().count() as f64 / self.len() as f64)
    }

    /// E_yaw, E_pitch, E_roll: means over the tracked frames, however large; `None` of none.
    pub fn mean(&self) -> Option<[f64; 3]> {
        let count = self.tracked().count();
        let sum = |i: usize| self.tracked().map(|e| e[i]).sum::<f64>();
        (count > 0).then(|| [0, 1, 2].map(|i| sum(i) / count as f64))
    }

    /// E_m: the mean of the three; `None` of none.
    pub fn mean_angle(&self) -> Option<f64> {
        self.mean().map(mean_angle)
    }

    /// Mean of the three errors of each tracked frame, for a robustness curve.
    pub fn per_frame(&self) -> Vec<f64> {
        self.tracked().map(|errors| mean_angle(*errors)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_wrap() {
        assert_eq!(angle_difference(179.0, -179.0), -2.0);
        assert_eq!(angle_error(179.0, -179.0), 2.0);
        assert_eq!(angle_error(-10.0, 20.0), 30.0);
        assert_eq!(angle_error(0.0, 180.0), 180.0);
    }

    #[test]
    fn means_are_over_tracked_frames() {
        let mut errors = PoseErrors::default();
        assert_eq!((errors.success(), errors.mean_angle()), (None, None));
        errors.push([0.0, 0.0, 0.0], Some([3.0, -6.0, 0.0]));
        errors.push([0.0, 0.0, 0.0], None);
        errors.push([10.0, 0.0, 0.0], Some([11.0, 0.0, 2.0]));
        assert_eq!(errors.success(), Some(2.0 / 3.0));
        assert_eq!(errors.mean(), Some([2.0, 3.0, 1.0]));
        assert_eq!(errors.mean_angle(), Some(2.0));
        assert_eq!(errors.per_frame(), [3.0, 1.0]);
    }
}
