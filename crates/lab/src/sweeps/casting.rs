//! Who and what is before the camera: looks, hair, shoulders, lights and the camera's place.

use super::motion::Moment;
use super::plan::{Hair, Sweep};
use glam::{Mat3, Vec3};
use posewise::math::HeadAngles;
use posewise::shape::Intrinsics;
use posewise_train::render::draw::{Prop, View};
use posewise_train::render::light::Lights;
use posewise_train::render::mesh::Mesh;
use posewise_train::render::skin::Looks;
use posewise_train::render::{accessories, props};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Width of the frames that faces' sizes are chosen for \[px\].
const WIDTH: f32 = 640.0;
/// Width of a face that the distance is chosen for \[mm\].
const FACE_MM: f32 = 140.0;

/// How far shoulders follow the head, and how they stand of themselves.
pub struct Torso {
    follows: f32,
    own: HeadAngles,
    seed: u32,
}

impl Torso {
    /// Random ones.
    pub fn random(rng: &mut ChaCha8Rng) -> Torso {
        Torso {
            follows: rng.random_range(0.0..0.6),
            own: HeadAngles {
                yaw_deg: rng.random_range(-22.0..22.0),
                pitch_deg: rng.random_range(-5.0..8.0),
                roll_deg: rng.random_range(-6.0..6.0),
            },
            seed: rng.random(),
        }
    }

    /// Drawn below a head.
    pub fn prop(&self, moment: &Moment, rotation: Mat3, at: Vec3, cloth: f32) -> Prop {
        // `props::torso` turns the shoulders by 0.3 of the yaw and roll that it is given, and by
        // 0.15 of the pitch.
        let head = moment.angles;
        let angles = HeadAngles {
            yaw_deg: (self.own.yaw_deg + self.follows * head.yaw_deg) / 0.3,
            pitch_deg: self.own.pitch_deg / 0.15,
            roll_deg: (self.own.roll_deg + 0.3 * self.follows * head.roll_deg) / 0.3,
        };
        props::torso(angles, rotation, at, cloth, self.seed)
    }
}

/// A random person's looks with the hair that the plan wants.
pub fn looks(rng: &mut ChaCha8Rng, sweep: &Sweep) -> Looks {
    let mut looks = Looks::random(rng);
    looks.hair_mm = match sweep.hair {
        Hair::Short => rng.random_range(3.0..14.0),
        Hair::Long => rng.random_range(8.0..16.0),
        Hair::Bald => 0.0,
        Hair::Cap => rng.random_range(1.0..4.0),
        Hair::Big => rng.random_range(26.0..40.0),
    };
    looks
}

/// Lights that are harder than most of training's: little of it comes from everywhere.
pub fn lights(rng: &mut ChaCha8Rng) -> Lights {
    let infrared = rng.random_bool(0.12);
    let mut lights = Lights::random(rng, infrared);
    lights.ambient *= rng.random_range(0.6..1.0f32);
    lights
}

/// Long hair and caps, in head axes.
pub fn worn(
    rng: &mut ChaCha8Rng,
    hair: Hair,
    mesh: &Mesh,
    neutral: &[Vec3],
    albedo: f32,
) -> Vec<Prop> {
    let at = |i: usize| neutral[mesh.landmarks[i] as usize];
    match hair {
        Hair::Long => vec![accessories::long_hair(rng, [at(0), at(16)], albedo)],
        Hair::Cap => {
            let mut cap = accessories::cap(rng);
            // Caps are made for the mean head; this one may be larger.
            let reach = |points: &[Vec3]| {
                let upper = points.iter().filter(|p| p.y < -45.0);
                upper.fold(Vec3::ZERO, |m, p| {
                    m.max(Vec3::new(p.x.abs(), -p.y, (p.z - 72.0).abs()))
                })
            };
            let size = (reach(neutral) + 5.0) / (reach(&mesh.mean) + 1.0);
            let size = size.max(Vec3::ONE);
            let middle = Vec3::new(0.0, 0.0, 72.0);
            for v in &mut cap.vertices {
                *v = middle + (*v - middle) * size;
            }
            vec![cap]
        }
        _ => Vec::new(),
    }
}

/// A camera of this field of view, and where the head is before it.
pub fn framing(rng: &mut ChaCha8Rng, view_deg: f32, [width, height]: [usize; 2]) -> (View, Vec3) {
    let focal = width as f32 / 2.0 / (view_deg / 2.0).to_radians().tan();
    let face_px = rng.random_range(105.0..185.0f32) * width as f32 / WIDTH;
    let far = focal * FACE_MM / face_px;
    let aside = rng.random_range(-70.0..70.0f32);
    let above = rng.random_range(-75.0..-5.0f32);
    let middle = [width, height].map(|n| (n - 1) as f32 / 2.0);
    let view = View {
        width,
        height,
        camera: Intrinsics::new(focal, focal, middle[0], middle[1]),
    };
    (view, Vec3::new(aside, above, focal) * far / focal)
}
