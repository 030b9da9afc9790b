//! View-based appearance (thesis 4.3): a table from pose to descriptors. The descriptors of the
//! N_q nearest poses are averaged, and a Huber loss with threshold k_Hub bounds single landmarks.

use super::scorer::LocalModel;
use super::synthesis::{POINTS, Sample};
use glam::Mat3;

/// Parameters that the thesis cross-validates.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args, serde::Serialize)]
pub struct Views {
    /// Nearest poses that are averaged, N_q (`view-based`).
    #[arg(long, default_value_t = 4)]
    pub nearest: usize,
    /// Threshold of the Huber loss, k_Hub (`view-based`).
    #[arg(long, default_value_t = 0.4)]
    pub huber: f64,
}

/// The table, and the averages for the current frame.
pub struct ViewBased {
    rows: Vec<Sample>,
    options: Views,
    means: Vec<Option<Vec<f32>>>,
}

impl ViewBased {
    /// A table of synthesised views.
    pub fn new(rows: Vec<Sample>, options: Views) -> ViewBased {
        ViewBased {
            rows,
            options,
            means: vec![None; POINTS.len()],
        }
    }
}

/// ρ(d) = d²/2 up to the threshold k, k·d − k²/2 beyond.
fn huber(distance: f64, k: f64) -> f64 {
    match distance <= k {
        true => distance * distance / 2.0,
        false => k * distance - k * k / 2.0,
    }
}

/// Cosine of the angle between two rotations, times 2, plus 1: falls with the angle.
fn closeness(a: &Mat3, b: &Mat3) -> f32 {
    a.x_axis.dot(b.x_axis) + a.y_axis.dot(b.y_axis) + a.z_axis.dot(b.z_axis)
}

impl LocalModel for ViewBased {
    fn prepare(&mut self, rotation: &Mat3) {
        let mut order: Vec<(f32, &Sample)> = (self.rows.iter())
            .map(|row| (closeness(&row.rotation, rotation), row))
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (point, mean) in self.means.iter_mut().enumerate() {
            // Of poses that show the landmark; near profile these are fewer.
            let near = order.iter().take(2 * self.options.nearest);
            let near = near.filter_map(|(_, row)| row.positive[point].as_ref());
            let near: Vec<_> = near.take(self.options.nearest).collect();
            *mean = near.first().map(|first| {
                let mut sum = vec![0.0; first.len()];
                for descriptor in &near {
                    sum.iter_mut().zip(*descriptor).for_each(|(s, v)| *s += v);
                }
                sum.iter_mut().for_each(|s| *s /= near.len() as f32);
                sum
            });
        }
    }

    fn energy(&self, point: usize, descriptor: &[f32]) -> Option<f64> {
        let mean = self.means[point].as_ref()?;
        let terms = mean.iter().zip(descriptor);
        let squared: f32 = terms.map(|(m, v)| (m - v).powi(2)).sum();
        Some(huber(f64::from(squared).sqrt(), self.options.huber))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huber_is_smooth_at_its_threshold() {
        assert!((huber(0.3, 0.4) - 0.045).abs() < 1e-12);
        assert!((huber(0.4, 0.4) - huber(0.400001, 0.4)).abs() < 1e-6);
        assert!((huber(1.0, 0.4) - 0.32).abs() < 1e-12);
    }

    #[test]
    fn the_nearest_poses_count() {
        let row = |yaw: f32, value: f32| Sample {
            rotation: Mat3::from_rotation_y(yaw),
            positive: vec![Some(vec![value, 0.0]); POINTS.len()],
            negative: Vec::new(),
        };
        let rows = vec![row(-0.8, 9.0), row(0.0, 1.0), row(0.2, 2.0), row(0.8, 9.0)];
        let options = Views {
            nearest: 2,
            huber: 0.4,
        };
        let mut model = ViewBased::new(rows, options);
        assert_eq!(model.energy(0, &[1.5, 0.0]), None);
        model.prepare(&Mat3::from_rotation_y(0.1));
        assert_eq!(model.energy(0, &[1.5, 0.0]), Some(0.0));
    }
}
