//! What covers a face, in head axes or before the camera.

use super::body::{Front, grain};
use glam::{Mat3, Vec3};
use posewise::math::{HeadAngles, head_rotation};
use posewise_train::render::accessories;
use posewise_train::render::draw::{Posed, Prop};
use posewise_train::render::mesh::Mesh;
use posewise_train::render::noise::fractal;
use posewise_train::render::props;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// A cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Cover {
    /// A hand across both eyes.
    HandOnEyes,
    /// A hand across the mouth.
    HandOnMouth,
    /// A phone across both eyes.
    PhoneOnEyes,
    /// A phone across the mouth.
    PhoneOnMouth,
    /// Dark sunglasses, all the time.
    Sunglasses,
    /// The same, pushed up above the brows.
    PushedUp,
    /// A scarf that is pulled up to the nose.
    Scarf,
    /// Hair over the half at the image left of a frontal face.
    HairRight,
    /// Hair over the other half.
    HairLeft,
    /// A cloth mask over nose, mouth and chin.
    Mask,
    /// The rim of a steering wheel between camera and face, all the time.
    Wheel,
}

impl Cover {
    /// Name in the clips' names.
    pub fn name(self) -> &'static str {
        match self {
            Cover::HandOnEyes => "hand-on-eyes",
            Cover::HandOnMouth => "hand-on-mouth",
            Cover::PhoneOnEyes => "phone-on-eyes",
            Cover::PhoneOnMouth => "phone-on-mouth",
            Cover::Sunglasses => "sunglasses",
            Cover::PushedUp => "pushed-up",
            Cover::Scarf => "scarf",
            Cover::HairRight => "hair-right",
            Cover::HairLeft => "hair-left",
            Cover::Mask => "mask",
            Cover::Wheel => "wheel",
        }
    }

    /// Whether it is there from the first frame to the last.
    pub fn is_worn_throughout(self) -> bool {
        matches!(self, Cover::Sunglasses | Cover::PushedUp | Cover::Wheel)
    }
}

/// A cover of one clip: what stays the same from frame to frame.
pub struct Covering {
    cover: Cover,
    seed: u64,
    albedo: f32,
    hair: f32,
    /// Where hands and phones come from \[mm, camera axes\].
    from: Vec3,
    lean: Mat3,
    front: Front,
    /// Half the width between the uppermost jaw landmarks \[mm\].
    half: f32,
}

/// A head at a moment.
pub struct Wearer<'a> {
    /// Topology.
    pub mesh: &'a Mesh,
    /// Vertices \[mm, head axes\].
    pub head: &'a [Vec3],
    /// The same before the camera.
    pub posed: &'a Posed,
    /// The head's origin \[mm, camera axes\].
    pub at: Vec3,
}

/// Distance of hands and phones from the landmarks that they cover \[mm\].
const HELD_MM: f32 = 52.0;

impl Covering {
    /// A random one for a head; `skin` and `hair` are the person's albedos.
    pub fn new(
        rng: &mut ChaCha8Rng,
        cover: Cover,
        mesh: &Mesh,
        neutral: &[Vec3],
        skin: f32,
        hair: f32,
    ) -> Covering {
        let at = |i: usize| neutral[mesh.landmarks[i] as usize];
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let across = rng.random_range(65.0..105.0f32) * side;
        let lean = HeadAngles {
            yaw_deg: rng.random_range(-15.0..15.0),
            pitch_deg: rng.random_range(-12.0..12.0),
            // Fingers point to a side.
            roll_deg: across,
        };
        Covering {
            cover,
            seed: rng.random(),
            albedo: match cover {
                Cover::HandOnEyes | Cover::HandOnMouth => skin * rng.random_range(0.75..1.2f32),
                Cover::PhoneOnEyes | Cover::PhoneOnMouth => rng.random_range(0.02..0.5),
                _ => rng.random_range(0.03..0.6),
            },
            hair,
            from: Vec3::new(-side * 260.0, 330.0, -20.0),
            lean: head_rotation(lean),
            front: Front::new(neutral),
            half: (at(16).x - at(0).x) / 2.0,
        }
    }

    /// The cover when it has come so far (0..1), before the camera.
    pub fn props(&self, wearer: &Wearer, amount: f32) -> Vec<Prop> {
        if amount <= 0.0 {
            return Vec::new();
        }
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        match self.cover {
            Cover::HandOnEyes | Cover::HandOnMouth | Cover::PhoneOnEyes | Cover::PhoneOnMouth => {
                return self.held(&mut rng, wearer, amount);
            }
            Cover::Wheel => return vec![wheel(&mut rng, self.albedo)],
            _ => {}
        }
        let mut worn = match self.cover {
            Cover::Sunglasses => sunglasses(&mut rng, wearer),
            Cover::PushedUp => pushed_up(sunglasses(&mut rng, wearer), wearer),
            Cover::Scarf => vec![self.scarf(&mut rng, amount)],
            Cover::HairRight => vec![self.curtain(&mut rng, -1.0, amount)],
            Cover::HairLeft => vec![self.curtain(&mut rng, 1.0, amount)],
            _ => {
                let mut mask = accessories::mask(&mut rng, wearer.mesh, wearer.head);
                // It comes from below.
                let away = 1.0 - amount;
                mask.transform(Mat3::IDENTITY, away * Vec3::new(0.0, 130.0, -25.0));
                vec![mask]
            }
        };
        accessories::wear(&mut worn, wearer.posed.rotation, wearer.at);
        worn
    }

    /// A hand or a phone between face and camera.
    fn held(&self, rng: &mut ChaCha8Rng, wearer: &Wearer, amount: f32) -> Vec<Prop> {
        let range = match self.cover {
            Cover::HandOnEyes | Cover::PhoneOnEyes => 36..48,
            _ => 48..60,
        };
        let count = range.len() as f32;
        let landmarks = range.map(|i| wearer.posed.vertices[wearer.mesh.landmarks[i] as usize]);
        let over = landmarks.sum::<Vec3>() / count;
        let over = over - over.normalize() * HELD_MM + (1.0 - amount) * self.from;
        match self.cover {
            Cover::HandOnEyes | Cover::HandOnMouth => {
                let mut hand = props::upright_hand(rng, self.albedo);
                // The middle between palm and finger tips.
                let middle = self.lean * Vec3::new(0.0, -38.0, 0.0);
                hand.transform(self.lean, over - middle);
                vec![hand]
            }
            _ => phone(rng, self.albedo)
                .into_iter()
                .map(|mut part| {
                    part.transform(self.lean, over);
                    part
                })
                .collect(),
        }
    }

    /// Cloth round the lower face; its upper edge rises from the neck to the nose.
    fn scarf(&self, rng: &mut ChaCha8Rng, amount: f32) -> Prop {
        const ROWS: usize = 22;
        let seed: u32 = rng.random();
        let top = 150.0 + amount * (rng.random_range(16.0..30.0f32) - 150.0);
        let mut prop = Prop::opaque(0.0);
        let half = self.half + 4.0;
        let rows: Vec<Vec<Vec3>> = (0..ROWS)
            .map(|k| {
                let y = top + (172.0 - top) * k as f32 / (ROWS - 1) as f32;
                let fold = 3.0 * (0.35 * y + 4.0 * fractal(Vec3::splat(0.02 * y), 2, seed)).sin();
                let ahead = (-12..=12).map(|i| {
                    let x = half * i as f32 / 12.0;
                    let z = self.front.at(x, y).min(45.0) - 10.0 - fold;
                    Vec3::new(x, y, z)
                });
                let mut row: Vec<Vec3> = ahead.collect();
                for side in [-1.0, 1.0] {
                    let back = [(9.0, 25.0), (14.0, 70.0), (-8.0, 120.0)];
                    for (out, z) in back {
                        let p = Vec3::new(side * (half + out + fold), y - 0.1 * z, z);
                        if side < 0.0 {
                            row.insert(0, p);
                        } else {
                            row.push(p);
                        }
                    }
                }
                row
            })
            .collect();
        prop.sheet(&rows, self.albedo);
        for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
            let stripes = 1.0 + 0.3 * (0.5 * v.y).sin();
            *a *= (stripes * (1.0 + 0.5 * grain(*v, seed))).max(0.1);
        }
        prop
    }

    /// Hair that falls over one half of the face; its inner edge moves to the middle.
    fn curtain(&self, rng: &mut ChaCha8Rng, side: f32, amount: f32) -> Prop {
        const ROWS: usize = 30;
        const ACROSS: usize = 18;
        let seed: u32 = rng.random();
        let outer = self.half + 12.0;
        let inner = outer + amount * (rng.random_range(-4.0..4.0f32) - outer);
        let mut prop = Prop::opaque(0.08);
        let rows: Vec<Vec<Vec3>> = (0..ROWS)
            .map(|k| {
                let t = k as f32 / (ROWS - 1) as f32;
                let y = -88.0 + 215.0 * t;
                // It parts at the top and opens a little at its end.
                let edge = inner + 10.0 * (1.0 - t).powi(2) + 12.0 * t.powi(3);
                let mut row: Vec<Vec3> = (0..=ACROSS)
                    .map(|i| {
                        let x = edge + (outer - edge) * i as f32 / ACROSS as f32;
                        let z = self.front.at(side * x, y).min(30.0);
                        let ripple = 2.0 * fractal(Vec3::new(0.2 * x, 0.02 * y, 0.0), 2, seed);
                        Vec3::new(side * x, y, z - 9.0 - ripple)
                    })
                    .collect();
                row.push(Vec3::new(side * (outer + 8.0), y, 62.0));
                row
            })
            .collect();
        prop.sheet(&rows, self.hair);
        for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
            let strands = fractal(Vec3::new(0.5 * v.x, 0.01 * v.y, 0.0), 3, seed ^ 1);
            *a *= (1.0 + 0.8 * strands).max(0.25);
        }
        prop
    }
}

/// The depth of a steering wheel's rim, and where its upper edge is seen \[share of the depth\].
pub const WHEEL_MM: f32 = 330.0;
pub const WHEEL_AT: f32 = 0.09;

/// The rim of a steering wheel before the camera, in camera axes.
fn wheel(rng: &mut ChaCha8Rng, albedo: f32) -> Prop {
    const SIDES: usize = 64;
    let (radius, thick) = (rng.random_range(175.0..195.0), rng.random_range(13.0..17.0));
    let tilt = Mat3::from_rotation_x(rng.random_range(0.2..0.5f32));
    let top = tilt * Vec3::new(0.0, -radius, 0.0);
    let aside = rng.random_range(-40.0..40.0);
    let to = Vec3::new(aside, WHEEL_AT * WHEEL_MM, WHEEL_MM) - top;
    let at = |i: usize| {
        let (s, c) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
        (tilt * Vec3::new(radius * s, -radius * c, 0.0) + to, thick)
    };
    let mut rim = Prop::opaque(0.2);
    let points: Vec<(Vec3, f32)> = (0..SIDES).map(at).collect();
    rim.tube(&points, 0.3 * albedo, true);
    rim
}

/// Large dark lenses in a frame, in head axes.
fn sunglasses(rng: &mut ChaCha8Rng, wearer: &Wearer) -> Vec<Prop> {
    const SIDES: usize = 28;
    let at = |i: usize| wearer.head[wearer.mesh.landmarks[i] as usize];
    let half = (
        rng.random_range(27.0..32.0f32),
        rng.random_range(20.0..26.0f32),
    );
    let power = rng.random_range(2.0..4.0f32);
    let mut frame = Prop::opaque(0.5);
    let mut lens = Prop::opaque(rng.random_range(0.03..0.3));
    // They sit on the bridge of the nose and clear the brows.
    let front = at(27).z.min(at(19).z).min(at(24).z) - 5.0;
    let round = |v: f32| v.signum() * v.abs().powf(2.0 / power);
    for (side, eye, ear) in [
        (-1.0, at(36).lerp(at(39), 0.5), at(0)),
        (1.0, at(42).lerp(at(45), 0.5), at(16)),
    ] {
        let centre = Vec3::new(side * eye.x.abs().max(half.0 + 4.0), eye.y + 3.0, 0.0);
        let bent = |x: f32, y: f32| Vec3::new(x, y, front + 0.003 * x * x);
        let rim: Vec<Vec3> = (0..SIDES)
            .map(|i| {
                let (s, c) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                bent(centre.x + half.0 * round(c), centre.y + half.1 * round(s))
            })
            .collect();
        let ring: Vec<(Vec3, f32)> = rim.iter().map(|p| (*p, 1.6)).collect();
        frame.tube(&ring, 0.02, true);
        lens.skin(&[rim, vec![bent(centre.x, centre.y); SIDES]], 0.012, false);
        let hinge = bent(centre.x + side * half.0, centre.y - 0.4 * half.1);
        let ear = ear + Vec3::new(side * 6.0, -4.0, 40.0);
        frame.tube(
            &[(hinge, 2.0), (hinge.lerp(ear, 0.5), 2.0), (ear, 2.0)],
            0.02,
            false,
        );
        let inner = bent(centre.x - side * half.0, centre.y - 0.3 * half.1);
        let middle = Vec3::new(0.0, inner.y - 1.5, front - 1.0);
        frame.tube(&[(inner, 1.8), (middle, 1.8)], 0.02, false);
    }
    vec![frame, lens]
}

/// Glasses that are turned about the ears until the lenses are above the brows, in head axes.
fn pushed_up(mut glasses: Vec<Prop>, wearer: &Wearer) -> Vec<Prop> {
    let at = |i: usize| wearer.head[wearer.mesh.landmarks[i] as usize];
    let ear = at(0).lerp(at(16), 0.5) + Vec3::new(0.0, -4.0, 40.0);
    let turned = Mat3::from_rotation_x(-0.55);
    for part in &mut glasses {
        part.transform(turned, ear - turned * ear);
    }
    glasses
}

/// A phone with its camera, held by two fingers and a thumb; its back to the camera.
fn phone(rng: &mut ChaCha8Rng, albedo: f32) -> Vec<Prop> {
    const HALF: Vec3 = Vec3::new(37.0, 77.0, 4.5);
    let mut body = Prop::opaque(rng.random_range(0.05..0.4));
    let row = |y: f32, z: f32| -> Vec<Vec3> {
        (0..=8)
            .map(|i| Vec3::new(HALF.x * (i as f32 / 4.0 - 1.0), y, z))
            .collect()
    };
    for z in [-HALF.z, HALF.z] {
        let rows: Vec<Vec<Vec3>> = (0..=14)
            .map(|k| row(HALF.y * (k as f32 / 7.0 - 1.0), z))
            .collect();
        body.sheet(&rows, albedo);
    }
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let ring = |z: f32| -> Vec<Vec3> {
        let at = |(x, y): &(f32, f32)| Vec3::new(x * HALF.x, y * HALF.y, z);
        corners.iter().map(at).collect()
    };
    body.skin(&[ring(-HALF.z), ring(HALF.z)], 0.8 * albedo, false);
    let mut lens = Prop::opaque(0.6);
    for y in [-62.0, -44.0] {
        let disc = |r: f32| -> Vec<Vec3> {
            (0..16)
                .map(|i| {
                    let (s, c) = (i as f32 / 16.0 * std::f32::consts::TAU).sin_cos();
                    Vec3::new(-22.0 + r * c, y + r * s, -HALF.z - 1.0)
                })
                .collect()
        };
        lens.skin(&[disc(7.0), disc(0.1)], 0.01, false);
    }
    let mut fingers = Prop::opaque(0.05);
    let skin = rng.random_range(0.15..0.45);
    for y in [20.0, 42.0, 63.0] {
        let bones = [
            (Vec3::new(70.0, y + 14.0, 14.0), 10.5),
            (Vec3::new(44.0, y + 3.0, -9.0), 9.5),
            (Vec3::new(18.0, y, -13.0), 8.0),
        ];
        fingers.tube(&bones, skin, false);
    }
    vec![body, lens, fingers]
}
