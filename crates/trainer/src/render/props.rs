//! Props built from tubes and rings: a torso, hands and other occluders.

use super::draw::Prop;
use glam::{Mat3, Vec3};
use posewise::math::{HeadAngles, head_rotation};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

impl Prop {
    /// A prop without vertices that lets no light pass.
    pub fn opaque(gloss: f32) -> Prop {
        Prop {
            gloss,
            opacity: 1.0,
            ..Prop::default()
        }
    }

    /// Joins rings of equally many vertices into a skin; `closed` joins the last to the first.
    pub fn skin(&mut self, rings: &[Vec<Vec3>], albedo: f32, closed: bool) {
        let n = rings.first().map_or(0, Vec::len) as u32;
        let base = self.vertices.len() as u32;
        let bands = rings.len() as u32 - u32::from(!closed);
        for ring in rings {
            self.vertices.extend(ring);
        }
        self.albedo.resize(self.vertices.len(), albedo);
        for k in 0..bands {
            let (a, b) = (base + k * n, base + (k + 1) % rings.len() as u32 * n);
            for i in 0..n {
                let j = (i + 1) % n;
                self.triangles.push([a + i, b + i, a + j]);
                self.triangles.push([a + j, b + i, b + j]);
            }
        }
    }

    /// Closes the last ring, of `ring` vertices, with a fan around a middle.
    pub fn fill(&mut self, ring: usize, middle: Vec3) {
        let (hub, n) = (self.vertices.len() as u32, ring as u32);
        self.vertices.push(middle);
        self.albedo.extend(self.albedo.last().copied());
        let first = hub - n;
        let fan = (0..n).map(|i| [first + i, hub, first + (i + 1) % n]);
        self.triangles.extend(fan);
    }

    /// Joins rows of equally many vertices into an open sheet.
    pub fn sheet(&mut self, rows: &[Vec<Vec3>], albedo: f32) {
        let n = rows.first().map_or(0, Vec::len) as u32;
        let base = self.vertices.len() as u32;
        rows.iter().for_each(|row| self.vertices.extend(row));
        self.albedo.resize(self.vertices.len(), albedo);
        for k in 1..rows.len() as u32 {
            let (a, b) = (base + (k - 1) * n, base + k * n);
            for i in 1..n {
                self.triangles.push([a + i - 1, b + i - 1, a + i]);
                self.triangles.push([a + i, b + i - 1, b + i]);
            }
        }
    }

    /// A tube along points with a radius at each, six-sided and rounded at its ends.
    pub fn tube(&mut self, points: &[(Vec3, f32)], albedo: f32, closed: bool) {
        const SIDES: usize = 6;
        let n = points.len();
        let mut rings = Vec::new();
        for (k, (p, r)) in points.iter().enumerate() {
            let (before, after) = if closed {
                (points[(k + n - 1) % n].0, points[(k + 1) % n].0)
            } else {
                (points[k.saturating_sub(1)].0, points[(k + 1).min(n - 1)].0)
            };
            let along = (after - before).normalize_or_zero();
            // A fixed reference keeps neighbouring rings from twisting.
            let side = along.cross(Vec3::new(0.13, 0.21, 0.97)).normalize_or_zero();
            let up = side.cross(along);
            let ring = (0..SIDES).map(|i| {
                let (s, c) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                *p + (side * c + up * s) * *r
            });
            rings.push(ring.collect());
        }
        self.skin(&rings, albedo, closed);
    }

    /// Turns the vertices about the origin and moves them.
    pub fn transform(&mut self, rotation: Mat3, at: Vec3) {
        let place = |v: &mut Vec3| *v = rotation * *v + at;
        let centres = self.mirror.iter_mut().flat_map(|m| &mut m.centres);
        self.vertices.iter_mut().chain(centres).for_each(place);
    }
}

/// Shoulders and chest. They follow the head's turns only in part. Neck and shoulders are as wide
/// and as high as the seed says.
pub fn torso(angles: HeadAngles, rotation: Mat3, at: Vec3, albedo: f32, seed: u32) -> Prop {
    // (down from the neck's base, half width, half depth) in mm
    const RINGS: [(f32, f32, f32); 9] = [
        (-12.0, 62.0, 58.0),
        (4.0, 72.0, 66.0),
        (18.0, 100.0, 74.0),
        (32.0, 145.0, 82.0),
        (50.0, 185.0, 90.0),
        (80.0, 212.0, 100.0),
        (140.0, 225.0, 112.0),
        (300.0, 230.0, 125.0),
        (600.0, 220.0, 125.0),
    ];
    const SIDES: usize = 40;
    let mut prop = Prop::opaque(0.0);
    let [wide, high, neck] = [0, 8, 16].map(|bit| (seed >> bit & 0xff) as f32 / 255.0 - 0.5);
    let rings: Vec<Vec<Vec3>> = RINGS
        .iter()
        .map(|(y, half, deep)| {
            // A neck is as wide as the first rings, shoulders begin below.
            let grow = 1.0 + if *y < 20.0 { 0.35 * neck } else { 0.4 * wide };
            let point = |i: usize| {
                let (s, c) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                Vec3::new(half * grow * c, *y + 30.0 * high, deep * grow * s)
            };
            (0..SIDES).map(point).collect()
        })
        .collect();
    prop.skin(&rings, albedo, false);
    for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
        *a *= 1.0 + 0.4 * super::noise::fractal(*v * 0.02, 3, seed);
    }
    let own = head_rotation(HeadAngles {
        yaw_deg: 0.3 * angles.yaw_deg,
        pitch_deg: 0.15 * angles.pitch_deg,
        roll_deg: 0.3 * angles.roll_deg,
    });
    prop.transform(own, rotation * Vec3::new(0.0, 165.0, 62.0) + at);
    prop
}

/// A hand with a forearm, the palm's middle at the origin, the fingers up.
pub fn upright_hand(rng: &mut ChaCha8Rng, albedo: f32) -> Prop {
    let mut prop = Prop::opaque(0.05);
    let spread = rng.random_range(0.0..0.16f32);
    let curl = rng.random_range(0.0..0.5f32);
    for k in 0..4 {
        finger(&mut prop, k, spread, curl, albedo);
    }
    let thumb = [
        (Vec3::new(-25.0, 35.0, 4.0), 15.0),
        (Vec3::new(-48.0, 5.0, 2.0), 12.0),
        (Vec3::new(-60.0, -28.0, 0.0), 10.0),
        (Vec3::new(-64.0, -44.0, 0.0), 6.0),
    ];
    prop.tube(&thumb, albedo, false);
    let sleeve = if rng.random_bool(0.5) {
        rng.random_range(0.03..0.6)
    } else {
        albedo
    };
    prop.tube(
        &[
            (Vec3::new(0.0, 40.0, 0.0), 27.0),
            (Vec3::new(0.0, 75.0, 0.0), 26.0),
        ],
        albedo,
        false,
    );
    prop.tube(
        &[
            (Vec3::new(0.0, 70.0, 0.0), 33.0),
            (Vec3::new(0.0, 320.0, 60.0), 46.0),
        ],
        sleeve,
        false,
    );
    prop
}

/// A hand with a forearm that covers a point from the camera's side.
pub fn hand(rng: &mut ChaCha8Rng, over: Vec3, albedo: f32) -> Prop {
    let mut prop = upright_hand(rng, albedo);
    let scale = rng.random_range(0.8..1.15);
    let mirror = if rng.random_bool(0.5) { -scale } else { scale };
    let lean = head_rotation(HeadAngles {
        yaw_deg: rng.random_range(-35.0..35.0),
        pitch_deg: rng.random_range(-25.0..25.0),
        roll_deg: rng.random_range(-80.0..80.0),
    });
    let size = Mat3::from_diagonal(Vec3::new(mirror, scale, scale));
    prop.transform(lean * size, over);
    prop
}

/// Adds a finger of a hand, 0 to 3 from the index finger on.
fn finger(hand: &mut Prop, k: usize, spread: f32, curl: f32, albedo: f32) {
    let across = k as f32 - 1.5;
    let (s, c) = (across * spread).sin_cos();
    let long = [72.0, 82.0, 77.0, 60.0][k];
    let root = Vec3::new(across * 19.0, -45.0, 0.0);
    let joint = |t: f32, bend: f32| {
        let reach = t * long;
        root + Vec3::new(
            s * reach,
            -c * reach * (1.0 - 0.3 * bend),
            bend * reach * 0.6,
        )
    };
    let bones = [
        (0.0, 0.0),
        (0.45, 0.4 * curl),
        (0.8, 0.9 * curl),
        (1.0, 1.4 * curl),
    ];
    let radii = [10.5, 9.5, 8.5, 5.0];
    let points: Vec<(Vec3, f32)> = bones
        .iter()
        .zip(radii)
        .map(|((t, b), r)| (joint(*t, *b), r))
        .collect();
    hand.tube(&points, albedo, false);
    // Its part of the palm.
    hand.tube(
        &[(root, 12.0), (Vec3::new(across * 14.0, 45.0, 0.0), 15.0)],
        albedo,
        false,
    );
}

/// A lump or a slab: a cup, a phone, a scarf's fold.
pub fn lump(rng: &mut ChaCha8Rng, over: Vec3) -> Prop {
    let mut prop = Prop::opaque(rng.random_range(0.0..0.4));
    let half = Vec3::new(
        rng.random_range(18.0..60.0),
        rng.random_range(18.0..60.0),
        12.0,
    );
    let power = if rng.random_bool(0.5) { 0.25 } else { 1.0 };
    let seed = rng.random();
    let albedo = rng.random_range(0.02..0.7);
    let round = |v: f32| v.signum() * v.abs().powf(power);
    let rings: Vec<Vec<Vec3>> = (0..=10)
        .map(|i| {
            let (s, c) = (i as f32 / 10.0 * std::f32::consts::PI).sin_cos();
            let point = |j: usize| {
                let (t, u) = (j as f32 / 24.0 * std::f32::consts::TAU).sin_cos();
                half * Vec3::new(round(u) * s, round(t) * s, c)
            };
            (0..24).map(point).collect()
        })
        .collect();
    prop.skin(&rings, albedo, false);
    for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
        *a *= (1.0 + 0.9 * super::noise::fractal(*v * 0.05, 3, seed)).max(0.05);
    }
    let lean = head_rotation(HeadAngles {
        yaw_deg: rng.random_range(-30.0..30.0),
        pitch_deg: rng.random_range(-30.0..30.0),
        roll_deg: rng.random_range(-90.0..90.0),
    });
    prop.transform(lean, over);
    prop
}
