//! Random expressions and gazes.

use super::mesh::Mesh;
use glam::Vec3;
use posewise::shape::{ANIMATION_NAMES, ANIMATIONS};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Largest weight of lids that follow a lowered gaze. That of the kit's shapes is 1 at half a
/// radian, where they leave 46 % of the distance of the lids; 40° down they leave a quarter.
const LOWERED: f32 = 1.4;
/// How far eyes look down \[rad\].
const LOWEST: f32 = 0.7;

/// Named weights of a face.
#[derive(Clone, Debug, Default)]
pub struct Expression {
    named: Vec<(&'static str, f32)>,
    /// Gaze to the image right and down \[rad\].
    pub gaze: (f32, f32),
}

impl Expression {
    /// Adds a weight by ARKit name.
    pub fn add(&mut self, name: &'static str, weight: f32) {
        if weight != 0.0 {
            self.named.push((name, weight));
        }
    }

    /// Adds a weight to a left and a right shape; `lean` −1..1 favours a side.
    fn pair(&mut self, names: [&'static str; 2], weight: f32, lean: f32) {
        self.add(names[0], (weight * (1.0 + lean)).min(1.0));
        self.add(names[1], (weight * (1.0 - lean)).min(1.0));
    }

    /// A random face: often nearly neutral, sometimes talking, laughing, yawning, blinking.
    pub fn random(rng: &mut ChaCha8Rng) -> Expression {
        let mut face = Expression::default();
        face.mouth(rng);
        face.brows(rng);
        face.gaze = (
            rng.random_range(-0.5..0.5f32),
            rng.random_range(-0.3..0.35f32),
        );
        if rng.random_bool(0.5) {
            face.gaze = (0.3 * face.gaze.0, 0.3 * face.gaze.1);
        }
        face.lids(rng);
        face
    }

    fn mouth(&mut self, rng: &mut ChaCha8Rng) {
        let mut some = |chance: f64, most: f32| {
            if rng.random_bool(chance) {
                rng.random_range(0.0..most)
            } else {
                0.0
            }
        };
        let yawn = some(0.06, 1.0);
        let open = if yawn > 0.0 {
            0.6 + 0.35 * yawn
        } else {
            some(0.45, 0.55)
        };
        self.add("jawOpen", open);
        self.add("jawLeft", some(0.08, 0.5));
        self.add("jawRight", some(0.08, 0.5));
        self.add("mouthFunnel", some(0.15, 0.7));
        self.add("mouthPucker", some(0.15, 0.8));
        self.add("mouthClose", some(0.1, 0.3) * open);
        self.add("mouthRollLower", some(0.08, 0.6));
        self.add("mouthRollUpper", some(0.08, 0.6));
        self.add("mouthLeft", some(0.06, 0.6));
        self.add("mouthRight", some(0.06, 0.6));
        self.add("cheekPuff", some(0.04, 0.8));
        let lean = some(0.3, 0.8) - some(0.3, 0.8);
        let smile = some(0.45, 1.0);
        self.pair(["mouthSmileLeft", "mouthSmileRight"], smile, lean);
        self.pair(["cheekSquintLeft", "cheekSquintRight"], 0.6 * smile, lean);
        self.pair(["mouthFrownLeft", "mouthFrownRight"], some(0.15, 0.8), lean);
        self.pair(
            ["mouthStretchLeft", "mouthStretchRight"],
            some(0.12, 0.7),
            lean,
        );
        self.pair(
            ["mouthUpperUpLeft", "mouthUpperUpRight"],
            some(0.2, 0.7),
            lean,
        );
        self.pair(
            ["mouthLowerDownLeft", "mouthLowerDownRight"],
            some(0.2, 0.7),
            lean,
        );
        self.pair(["mouthPressLeft", "mouthPressRight"], some(0.1, 0.7), lean);
        self.pair(["noseSneerLeft", "noseSneerRight"], some(0.1, 0.8), lean);
    }

    fn brows(&mut self, rng: &mut ChaCha8Rng) {
        let mut some = |chance: f64, most: f32| {
            if rng.random_bool(chance) {
                rng.random_range(0.0..most)
            } else {
                0.0
            }
        };
        let lean = some(0.3, 0.6) - some(0.3, 0.6);
        self.pair(["browDownLeft", "browDownRight"], some(0.3, 0.9), lean);
        self.add("browInnerUp", some(0.3, 0.9));
        self.pair(
            ["browOuterUpLeft", "browOuterUpRight"],
            some(0.3, 0.9),
            lean,
        );
    }

    fn lids(&mut self, rng: &mut ChaCha8Rng) {
        let blink = match rng.random_range(0..10) {
            0..6 => rng.random_range(0.0..0.15),
            6..8 => rng.random_range(0.15..0.9),
            _ => 1.0,
        };
        let wink = rng.random_bool(0.05);
        self.add("eyeBlinkLeft", blink);
        self.add("eyeBlinkRight", if wink { 0.0 } else { blink });
        let squint = if rng.random_bool(0.2) {
            rng.random_range(0.0..0.8)
        } else {
            0.0
        };
        self.pair(["eyeSquintLeft", "eyeSquintRight"], squint, 0.0);
        if blink < 0.2 && rng.random_bool(0.2) {
            let wide = rng.random_range(0.0..0.9);
            self.pair(["eyeWideLeft", "eyeWideRight"], wide, 0.0);
        }
        self.follow_gaze(1.0 - blink);
    }

    /// The share of a squint that a lowered gaze leaves room for.
    pub fn squint_share(&self) -> f32 {
        let (_, down) = self.gaze;
        1.0 - (down / LOWEST).clamp(0.0, 1.0)
    }

    /// Moves the lids of both eyes to anywhere between open and shut.
    pub fn close(&mut self, rng: &mut ChaCha8Rng) {
        let blink = rng.random_range(0.0..=1.0f32);
        self.named
            .retain(|(name, _)| !name.starts_with("eyeBlink") && !name.starts_with("eyeWide"));
        self.pair(["eyeBlinkLeft", "eyeBlinkRight"], blink, 0.0);
    }

    /// Looks somewhere within what eyes reach, with lids that follow: open, drooping or shut.
    pub fn look(&mut self, rng: &mut ChaCha8Rng) {
        self.named.retain(|(name, _)| !name.starts_with("eye"));
        let wide = if rng.random_bool(0.6) { 1.0 } else { 0.4 };
        self.gaze = (
            wide * rng.random_range(-0.6..0.6f32),
            match rng.random_bool(0.3) {
                // Reading, cluster, lap.
                true => rng.random_range(0.2..LOWEST),
                false => wide * rng.random_range(-0.35..0.45f32),
            },
        );
        let blink = match rng.random_range(0..20) {
            0..9 => rng.random_range(0.0..0.15f32),
            9..15 => rng.random_range(0.15..0.95),
            _ => 1.0,
        };
        self.pair(["eyeBlinkLeft", "eyeBlinkRight"], blink, 0.0);
        if blink < 0.5 && rng.random_bool(0.3) {
            // Up to eyes that laugh; a smile raises the cheeks by itself. What a lowered gaze
            // leaves between the lids stays.
            let squint = rng.random_range(0.0..1.0) * self.squint_share();
            self.pair(["eyeSquintLeft", "eyeSquintRight"], squint, 0.0);
        }
        if blink < 0.2 && rng.random_bool(0.2) {
            let wide = rng.random_range(0.0..0.9);
            self.pair(["eyeWideLeft", "eyeWideRight"], wide, 0.0);
        }
        self.follow_gaze(1.0 - blink);
    }

    /// Lids follow the eyeballs (the kit's shapes have weight 1 at about half a radian).
    pub fn follow_gaze(&mut self, amount: f32) {
        let (x, y) = (2.0 * amount * self.gaze.0, 2.0 * amount * self.gaze.1);
        if y > 0.0 {
            for name in ["eyeLookDownLeft", "eyeLookDownRight"] {
                self.add(name, y.min(LOWERED));
            }
        } else {
            self.pair(["eyeLookUpLeft", "eyeLookUpRight"], (-y).min(1.0), 0.0);
        }
        let side = if x > 0.0 {
            ["eyeLookOutLeft", "eyeLookInRight"]
        } else {
            ["eyeLookInLeft", "eyeLookOutRight"]
        };
        self.pair(side, x.abs().min(1.0), 0.0);
    }

    /// Leaves out what a head cannot do.
    pub fn keep(&mut self, mesh: &Mesh) {
        self.named.retain(|(name, _)| mesh.shape(name).is_some());
    }

    /// Places in `mesh.shapes` and weights.
    pub fn weights(&self, mesh: &Mesh) -> Vec<(usize, f32)> {
        (self.named.iter())
            .filter_map(|(n, w)| Some((mesh.shape(n)?, *w)))
            .collect()
    }

    /// Weights in the order of `posewise::shape::ANIMATION_NAMES`.
    pub fn animation(&self) -> [f32; ANIMATIONS] {
        ANIMATION_NAMES.map(|name| {
            self.named
                .iter()
                .filter(|(n, _)| *n == name)
                .map(|(_, w)| w)
                .sum()
        })
    }
}

/// Unit gazes (head axes) of the image left's and right's eye for an expression.
pub fn gaze_directions(expression: &Expression, converge_rad: f32) -> [Vec3; 2] {
    let (x, y) = expression.gaze;
    [1.0, -1.0].map(|inwards| {
        let x = x + inwards * converge_rad;
        Vec3::new(x.sin() * y.cos(), y.sin(), -x.cos() * y.cos())
    })
}

/// The same with a random convergence.
pub fn random_gaze(rng: &mut ChaCha8Rng, expression: &Expression) -> [Vec3; 2] {
    gaze_directions(expression, rng.random_range(0.0..0.06))
}
