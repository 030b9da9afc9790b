//! Random expressions and gazes.

use super::mesh::Mesh;
use glam::Vec3;
use posewise::shape::{FITTED, FITTED_NAMES};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Largest weight of lids that follow a lowered gaze. That of the kit's shapes is 1 at half a
/// radian, where they leave 46 % of the distance of the lids; 40° down they leave a quarter.
const LOWERED: f32 = 1.4;
/// How far eyes look down, and to a side, as at a mirror or a passenger \[rad\].
const LOWEST: f32 = 0.7;
const ASIDE: f32 = 0.75;

/// What [`Expression::mixed`] mixes: weights of two sides, and of none, which stand twice. Those
/// that are hard to see are there more often.
const MIXED: [[&str; 2]; 40] = [
    ["browDownLeft", "browDownRight"],
    ["browInnerUp", "browInnerUp"],
    ["browOuterUpLeft", "browOuterUpRight"],
    ["eyeBlinkLeft", "eyeBlinkRight"],
    ["eyeWideLeft", "eyeWideRight"],
    ["jawOpen", "jawOpen"],
    ["jawLeft", "jawRight"],
    ["mouthFunnel", "mouthFunnel"],
    ["mouthPucker", "mouthPucker"],
    ["mouthSmileLeft", "mouthSmileRight"],
    ["mouthFrownLeft", "mouthFrownRight"],
    ["mouthStretchLeft", "mouthStretchRight"],
    ["mouthUpperUpLeft", "mouthUpperUpRight"],
    ["mouthLowerDownLeft", "mouthLowerDownRight"],
    ["cheekSquintLeft", "cheekSquintRight"],
    ["jawOpen", "jawOpen"],
    ["mouthSmileLeft", "mouthSmileRight"],
    ["cheekPuff", "cheekPuff"],
    ["cheekPuff", "cheekPuff"],
    ["eyeSquintLeft", "eyeSquintRight"],
    ["eyeSquintLeft", "eyeSquintRight"],
    ["eyeSquintLeft", "eyeSquintRight"],
    ["jawForward", "jawForward"],
    ["jawForward", "jawForward"],
    ["mouthClose", "mouthClose"],
    ["mouthClose", "mouthClose"],
    ["mouthDimpleLeft", "mouthDimpleRight"],
    ["mouthDimpleLeft", "mouthDimpleRight"],
    ["mouthLeft", "mouthRight"],
    ["mouthLeft", "mouthRight"],
    ["mouthPressLeft", "mouthPressRight"],
    ["mouthPressLeft", "mouthPressRight"],
    ["mouthRollLower", "mouthRollLower"],
    ["mouthRollLower", "mouthRollLower"],
    ["mouthRollUpper", "mouthRollUpper"],
    ["mouthShrugLower", "mouthShrugLower"],
    ["mouthShrugLower", "mouthShrugLower"],
    ["mouthShrugUpper", "mouthShrugUpper"],
    ["noseSneerLeft", "noseSneerRight"],
    ["noseSneerLeft", "noseSneerRight"],
];

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
        let mut some = |chance: f64, most: f32| sometimes(rng, chance, most);
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
        let mut some = |chance: f64, most: f32| sometimes(rng, chance, most);
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
        let squint = sometimes(rng, 0.2, 0.8);
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
            wide * rng.random_range(-ASIDE..ASIDE),
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

    /// A random mixture of weights, mostly of a few, of one side or of both; one in six is neutral,
    /// and one in five is as [`Expression::random`] with one more weight. For training weights that
    /// are seen: any two of them occur together and apart.
    pub fn mixed(rng: &mut ChaCha8Rng) -> Expression {
        let mut face = Expression::default();
        let count = match rng.random_range(0..30) {
            0..5 => 0,
            5..11 => {
                face = Expression::random(rng);
                1
            }
            11..18 => 1,
            18..25 => rng.random_range(2..4),
            _ => rng.random_range(4..7),
        };
        for _ in 0..count {
            let names = MIXED[rng.random_range(0..MIXED.len())];
            let weight = rng.random_range(0.15..1.0f32);
            face.mix(rng, names, weight);
        }
        if face.gaze == (0.0, 0.0) {
            face.gaze = (rng.random_range(-0.3..0.3), rng.random_range(-0.2..0.25));
            face.follow_gaze(1.0);
        }
        face
    }

    /// Adds a weight, or that of one side or of both, where the face has none yet.
    fn mix(&mut self, rng: &mut ChaCha8Rng, names: [&'static str; 2], weight: f32) {
        if names.iter().any(|name| self.weight(name) > 0.0) {
            return;
        }
        let shut = 0.5 * (self.weight("eyeBlinkLeft") + self.weight("eyeBlinkRight"));
        let weight = match names[0] {
            "eyeSquintLeft" => weight * (1.0 - shut),
            "mouthClose" => {
                // Lips that meet although the jaw is open.
                if self.weight("jawOpen") == 0.0 {
                    self.add("jawOpen", weight);
                }
                self.weight("jawOpen") * rng.random_range(0.2..1.0f32)
            }
            _ => weight,
        };
        if names[0] == names[1] {
            return self.add(names[0], weight);
        }
        let is_opposed = ["jawLeft", "mouthLeft"].contains(&names[0]);
        match rng.random_range(0..5) {
            0 => self.add(names[0], weight),
            1 => self.add(names[1], weight),
            _ if is_opposed => self.add(names[rng.random_range(0..2)], weight),
            2 => self.pair(names, weight, rng.random_range(-0.6..0.6)),
            _ => self.pair(names, weight, 0.0),
        }
    }

    /// The weight of a name.
    pub fn weight(&self, name: &str) -> f32 {
        let of_name = self.named.iter().filter(|(n, _)| *n == name);
        of_name.map(|(_, w)| w).sum()
    }

    /// Leaves out weights.
    pub fn leave_out(&mut self, names: &[&str]) {
        self.named.retain(|(name, _)| !names.contains(name));
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

    /// Weights in the order of `posewise::shape::FITTED_NAMES`.
    pub fn animation(&self) -> [f32; FITTED] {
        FITTED_NAMES.map(|name| self.weight(name))
    }
}

/// A number up to `most` with this probability, else 0.
fn sometimes(rng: &mut ChaCha8Rng, probability: f64, most: f32) -> f32 {
    match rng.random_bool(probability) {
        true => rng.random_range(0.0..most),
        false => 0.0,
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
