//! Light that is hard for a camera in a car: at night and in low sun.

use super::super::clip::Set;
use super::plan::Condition;
use glam::{Mat3, Vec3};
use posewise_train::render::light::Bars;
use rand::Rng;
use std::f32::consts::PI;

/// How far a camera is turned about its axis \[deg\].
const TURNED_DEG: std::ops::Range<f32> = 16.0..24.0;
/// Speed of shadows over a face \[mm/s\]: of trees 10 m apart at 50 km/h there are one or two a
/// second.
const BARS_MM_S: std::ops::Range<f32> = 120.0..320.0;

/// Light that moves.
pub enum Moving {
    /// Shadows move on \[mm/s\].
    Bars(f32),
    /// Two lamps behind the driver, which come nearer.
    Lamps(Lamps),
}

/// Headlights that are seen beside the head.
pub struct Lamps {
    /// Where the pair is \[share of the width and height\], and how far apart they are.
    at: [f32; 2],
    apart: f32,
    /// How long a car takes to come near, and when the first one begins \[s\].
    period_s: f32,
    phase: f32,
    power: f32,
}

/// Puts lights, pupils and the camera where the condition has them.
pub fn dress(set: &mut Set, condition: Condition) {
    match condition {
        Condition::BrightPupils => {
            set.eyes.retro = set.rng.random_range(0.5..1.4);
            set.behind.iter_mut().for_each(|light| *light *= 0.2);
        }
        Condition::SunBars => {
            let side = if set.rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let lights = &mut set.lights;
            lights.key = Vec3::new(side * set.rng.random_range(0.2..0.9), -0.5, -0.7).normalize();
            lights.key_power = set.rng.random_range(1.6..3.0);
            lights.ambient = set.rng.random_range(0.2..0.4);
            let lean = Mat3::from_rotation_z(set.rng.random_range(-0.7..0.7f32));
            lights.bars = Some(Bars {
                across: lean * Vec3::X,
                period_mm: set.rng.random_range(110.0..260.0),
                moved_mm: 0.0,
            });
        }
        Condition::Headlights => {
            let lights = &mut set.lights;
            lights.ambient = set.rng.random_range(0.1..0.25);
            lights.key_power = set.rng.random_range(0.1..0.35);
            set.behind.iter_mut().for_each(|light| *light *= 0.06);
            set.camera.noise = set.camera.noise.max(set.rng.random_range(3.0..6.0));
        }
        Condition::TurnedCamera => {
            let side = if set.rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let angle = side * set.rng.random_range(TURNED_DEG).to_radians();
            set.turned = Mat3::from_rotation_z(angle);
        }
        _ => {}
    }
}

impl Moving {
    /// What moves in a condition.
    pub fn random(set: &mut Set, condition: Condition) -> Option<Moving> {
        let rng = &mut set.rng;
        match condition {
            Condition::SunBars => Some(Moving::Bars(rng.random_range(BARS_MM_S))),
            Condition::Headlights => Some(Moving::Lamps(Lamps {
                at: [
                    if rng.random_bool(0.5) { 0.16 } else { 0.84 },
                    rng.random_range(0.3..0.5),
                ],
                apart: rng.random_range(0.05..0.12),
                period_s: rng.random_range(5.0..9.0),
                phase: rng.random_range(0.0..1.0),
                power: rng.random_range(1.5..4.0) / set.camera.exposure.max(1e-3),
            })),
            _ => None,
        }
    }

    /// Sets the light of a time \[s\].
    pub fn shine(&self, set: &mut Set, t: f32) {
        match self {
            Moving::Bars(speed) => {
                if let Some(bars) = &mut set.lights.bars {
                    bars.moved_mm = speed * t;
                }
            }
            Moving::Lamps(lamps) => set.glare = lamps.glare(set.view.width, set.view.height, t),
        }
    }
}

impl Lamps {
    /// Light that the lens spreads around them, row by row.
    fn glare(&self, width: usize, height: usize, t: f32) -> Vec<f32> {
        // A car comes near, dazzles, and turns off.
        let near = (t / self.period_s + self.phase).fract();
        let power = self.power * (PI * near).sin().powi(2);
        let radius = (0.01 + 0.03 * near) * width as f32;
        let apart = self.apart * (0.4 + near) * width as f32;
        let [x, y] = [self.at[0] * width as f32, self.at[1] * height as f32];
        let light = |i: usize| {
            let (column, row) = ((i % width) as f32, (i / width) as f32);
            let of = |side: f32| {
                let (dx, dy) = (column - x - side * apart / 2.0, row - y);
                let far = (dx * dx + dy * dy) / (radius * radius);
                power * (6.0 / (1.0 + far * far) + 0.35 / (1.0 + 0.02 * far))
            };
            of(-1.0) + of(1.0)
        };
        (0..width * height).map(light).collect()
    }
}
