//! Draws a driver and writes the truth.

use super::super::clip::{Set, Studio, write_clip};
use super::super::covers::{WHEEL_AT, WHEEL_MM};
use super::super::truth;
use super::night::{self, Moving};
use super::passenger::{self, Passenger};
use super::plan::{Clip, Condition};
use super::script::{Script, What};
use anyhow::Result;
use glam::Vec3;
use posewise::monitor::{Preset, ZoneShape};
use posewise::shape::Intrinsics;
use posewise_train::render::accessories;
use posewise_train::render::draw::{Prop, View};
use posewise_train::render::expression::gaze_directions;
use posewise_train::render::light::Lights;
use rand::Rng;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// Raised when clips of the same plan would come out otherwise.
const VERSION: u32 = 3;
/// Distance of a driver's face from the camera \[mm\].
const FAR_MM: std::ops::Range<f32> = 520.0..780.0;
/// How far below the eyes the wheel is seen in front of the face \[mm\].
const WHEEL_BELOW_MM: f32 = 95.0;
/// Most opacity and gloss of clear lenses: with more, a face in the shade has no eyes behind the
/// reflections.
const CLEAR: (f32, f32) = (0.1, 0.1);
/// Convergence of the eyes, as of someone who looks a metre ahead \[rad\].
const CONVERGE_RAD: f32 = 0.03;

/// What is written beside a clip.
#[derive(Serialize)]
struct Description<'a> {
    version: u32,
    width: usize,
    height: usize,
    backgrounds: usize,
    #[serde(flatten)]
    clip: &'a Clip,
}

/// Writes a clip unless it is there.
pub fn render(studio: &Studio, clip: &Clip, folder: &Path) -> Result<()> {
    let sweep = &clip.sweep;
    let beside = passenger::sweep(clip);
    let description = serde_json::to_string_pretty(&Description {
        version: VERSION,
        width: sweep.size[0],
        height: sweep.size[1],
        backgrounds: studio.background_count(),
        clip,
    })?;
    write_clip(sweep, folder, &description, columns(clip), || {
        let mut set = Set::cast(studio, sweep)?;
        dress(&mut set, clip);
        let script = Script::new(&mut set.rng, clip);
        set.expose(&script.at(0.0));
        let moving = Moving::random(&mut set, clip.condition);
        let mut passenger = match clip.condition {
            Condition::Passenger => Some(Passenger::beside(&mut set, studio, clip, &beside)?),
            _ => None,
        };
        Ok(move |number: usize| {
            let t = number as f32 / sweep.fps as f32;
            let nose = passenger
                .as_mut()
                .map(|other| other.draw_behind(&mut set, t));
            if let Some(moving) = &moving {
                moving.shine(&mut set, t);
            }
            let (luma, row) = set.frame(number, script.at(t));
            let mut text = row.text()?;
            write!(text, "{}", more(&row, clip, &script, t))?;
            if let Some([x, y]) = nose {
                write!(text, ",{x:.3},{y:.3}")?;
            }
            Ok((luma, text))
        })
    })
}

/// Puts the camera, the light and the glasses where the clip has them.
fn dress(set: &mut Set, clip: &Clip) {
    let [width, height] = clip.sweep.size;
    let focal = width as f32 / 2.0 / (clip.sweep.view_deg / 2.0).to_radians().tan();
    let middle = [width, height].map(|n| (n - 1) as f32 / 2.0);
    set.view = View {
        width,
        height,
        camera: Intrinsics::new(focal, focal, middle[0], middle[1]),
    };
    let far = set.rng.random_range(FAR_MM);
    let aside = set.rng.random_range(-60.0..60.0);
    let above = match clip.condition {
        Condition::Wheel => WHEEL_AT * far - WHEEL_BELOW_MM,
        _ => set.rng.random_range(-70.0..10.0),
    };
    set.at = Vec3::new(aside, above, far);
    let infrared = matches!(
        clip.condition,
        Condition::Infrared | Condition::InfraredGlasses | Condition::BrightPupils
    );
    if infrared {
        set.lights = Lights::random(&mut set.rng, true);
        set.camera.noise = set.camera.noise.max(set.rng.random_range(2.0..5.0));
    }
    if matches!(
        clip.condition,
        Condition::ClearGlasses | Condition::InfraredGlasses
    ) {
        let glasses = clear_glasses(set);
        set.worn.extend(glasses);
    }
    night::dress(set, clip.condition);
    debug_assert!(far > WHEEL_MM);
}

/// Spectacles with clear lenses, in head axes.
fn clear_glasses(set: &mut Set) -> Vec<Prop> {
    let (mesh, head) = (set.mesh(), set.neutral());
    loop {
        let glasses = accessories::glasses(&mut set.rng, mesh, &head);
        let is_clear = |part: &Prop| part.opacity < CLEAR.0 && part.gloss < CLEAR.1;
        if glasses.iter().any(is_clear) {
            return glasses;
        }
    }
}

/// Columns of a sweep's truth, and those of a driver: whether the head nods; the zone of the
/// default preset that the head is in; gaze as OpenFace has it (unit vectors of the image left's
/// and right's eye and the mean angles, camera frame \[rad\]), and in the head, to the image right
/// and up \[deg\]. For glances with the eyes alone also the zone that the gaze is in, and its yaw
/// and pitch from the road \[deg\]. With a passenger the tip of that nose \[px\].
fn columns(clip: &Clip) -> String {
    let mut names = truth::columns() + ",nod,zone";
    for eye in 0..2 {
        ["x", "y", "z"]
            .iter()
            .for_each(|axis| names += &format!(",gaze_{eye}_{axis}"));
    }
    names += ",gaze_angle_x,gaze_angle_y,gaze_head_yaw,gaze_head_pitch";
    match clip.condition {
        Condition::Glances => names + ",gaze_zone,road_gaze_yaw,road_gaze_pitch",
        Condition::Passenger => names + ",passenger_x,passenger_y",
        _ => names,
    }
}

fn more(row: &truth::Row, clip: &Clip, script: &Script, t: f32) -> String {
    let nods = u8::from(script.does(What::Nod, t));
    let mut text = format!(",{nods},{}", zone(script.off_road_deg(t)));
    let eyes = gaze_directions(&row.moment.expression(), CONVERGE_RAD);
    let eyes = eyes.map(|gaze| row.rotation * gaze);
    let both = eyes[0] + eyes[1];
    let angles = [both.x.atan2(-both.z), both.y.atan2(-both.z)];
    let (right, down) = row.moment.gaze;
    let values = eyes.iter().flat_map(|eye| eye.to_array()).chain(angles);
    let values = values.chain([right.to_degrees(), -down.to_degrees()]);
    values.for_each(|v| text += &format!(",{v:.5}"));
    if clip.condition == Condition::Glances {
        let ray = both.normalize();
        let yaw = ray.x.atan2(-ray.z).to_degrees() - clip.road_deg[0];
        let pitch = (-ray.y).asin().to_degrees() - clip.road_deg[1];
        text += &format!(",{},{yaw:.3},{pitch:.3}", zone([yaw, pitch]));
    }
    text
}

/// Index of the default zone that a direction is in; −2 outside of all.
fn zone([yaw, pitch]: [f32; 2]) -> i32 {
    let is_in = |[low, high]: [f32; 2], angle: f32| (low..=high).contains(&angle);
    let zones = Preset::default().zones();
    let found = zones.iter().position(|zone| match zone.shape {
        ZoneShape::Angles { yaw_deg, pitch_deg } => is_in(yaw_deg, yaw) && is_in(pitch_deg, pitch),
        _ => false,
    });
    found.map_or(-2, |index| index as i32)
}
