//! Windows and lamps that lenses mirror.

use super::noise::smoothstep;
use glam::{Mat3, Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Share of spectacles that mirror something, and most of what they mirror.
const SHARE: f64 = 0.6;
const MOST: usize = 3;
/// Where a pane is: to the image right and up from the camera \[rad\].
const ACROSS: std::ops::Range<f32> = -1.3..1.3;
const UP: std::ops::Range<f32> = -0.3..0.9;
/// How far it is turned about its middle \[rad\].
const ROLL: std::ops::Range<f32> = -0.3..0.3;
/// Half its width and height, tangents.
const HALF: [std::ops::Range<f32>; 2] = [0.04..0.6, 0.04..0.4];
/// Light that comes back of it, where lit white paper returns about 1.
const LIGHT: std::ops::Range<f32> = 0.03..0.9;
/// Share of its half width over which its edge is soft.
const SOFT: f32 = 0.1;

/// A bright rectangle far away.
#[derive(Clone, Debug)]
struct Pane {
    /// Camera axes to its own: across, along, towards it.
    axes: Mat3,
    /// Half its width and height, tangents.
    half: Vec2,
    /// Light that a lens returns of it.
    light: f32,
}

impl Pane {
    fn random(rng: &mut ChaCha8Rng) -> Pane {
        let (across, up) = (rng.random_range(ACROSS), rng.random_range(UP));
        let turn = Mat3::from_rotation_y(-across) * Mat3::from_rotation_x(-up);
        let roll = Mat3::from_rotation_z(rng.random_range(ROLL));
        Pane {
            axes: (turn * Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)) * roll).transpose(),
            half: Vec2::from_array(HALF.map(|range| rng.random_range(range))),
            light: rng.random_range(LIGHT),
        }
    }

    /// Light from a direction.
    fn light(&self, direction: Vec3) -> f32 {
        let seen = self.axes * direction;
        if seen.z <= 0.0 {
            return 0.0;
        }
        let off = (seen.truncate() / seen.z / self.half).abs().max_element();
        self.light * (1.0 - smoothstep(1.0 - SOFT, 1.0 + SOFT, off))
    }
}

/// What two lenses mirror.
#[derive(Clone, Debug)]
pub struct Mirror {
    panes: Vec<Pane>,
    /// Middles of the spheres that they are parts of \[mm\].
    pub centres: [Vec3; 2],
}

impl Mirror {
    /// What random spectacles mirror, if they do.
    pub fn random(rng: &mut ChaCha8Rng, centres: [Vec3; 2]) -> Option<Mirror> {
        let count = match rng.random_bool(SHARE) {
            true => rng.random_range(1..=MOST),
            false => 0,
        };
        let panes: Vec<Pane> = (0..count).map(|_| Pane::random(rng)).collect();
        (count > 0).then_some(Mirror { panes, centres })
    }

    /// Light that a lens mirrors at a point of its surface (camera axes).
    pub fn light(&self, lens: usize, point: Vec3) -> f32 {
        let normal = (point - self.centres[lens]).normalize_or_zero();
        let view = point.normalize_or_zero();
        let direction = view - 2.0 * view.dot(normal) * normal;
        self.panes.iter().map(|pane| pane.light(direction)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pane_is_seen_where_it_is() {
        let pane = Pane {
            axes: Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)),
            half: Vec2::new(0.2, 0.1),
            light: 0.5,
        };
        let point = Vec3::new(0.0, 0.0, 600.0);
        let mirror = |away: f32| Mirror {
            panes: vec![pane.clone()],
            centres: [point + 130.0 * Vec3::new(-away.sin(), 0.0, away.cos()); 2],
        };
        // A lens square to the view mirrors what is at the camera.
        assert_eq!(mirror(0.0).light(0, point), 0.5);
        // Turned by 0.2 rad it mirrors what is 0.4 rad away.
        assert_eq!(mirror(0.2).light(1, point), 0.0);
    }
}
