//! A frame as the page receives it: the length of a JSON text (32 bits, little-endian), the text,
//! and the picture as a JPEG. The text is `Tracked` of `web/worker.js`.

use std::time::Duration;

use anyhow::{Context, Result};
use image::codecs::jpeg::JpegEncoder;
use posewise::{ANIMATION_NAMES, EyeUnknown, Eyes, Intrinsics, TrackResult};
use serde_json::{Value, json};
use tungstenite::Bytes;

use crate::jsonl::{number, numbers};
use crate::picture::Picture;
use crate::session::Session;

/// Quality of the JPEG. Source: chosen; the demo clip at 640×480 takes 16 KB a picture.
const QUALITY: u8 = 75;

/// Makes messages.
pub struct Encoder {
    most_width: u32,
}

impl Encoder {
    /// Wider pictures are made smaller.
    pub fn new(most_width: u32) -> Self {
        Encoder { most_width }
    }

    /// The message of a frame. `times` are those of its step and of the last picture's encoding.
    pub fn message(
        &self,
        picture: &Picture,
        session: &Session<'_>,
        times: [Duration; 2],
    ) -> Result<Bytes> {
        let jpeg = self.jpeg(picture)?;
        let frame = picture.frame()?;
        let (result, smoothed) = (session.result(), session.smoothed());
        let [step_ms, pixels_ms] = times.map(|t| t.as_secs_f64() * 1e3);
        let text = json!({
            "animationNames": ANIMATION_NAMES,
            "width": frame.width(),
            "height": frame.height(),
            "camera": camera(&session.intrinsics()),
            "stepMs": step_ms,
            "pixelsMs": pixels_ms,
            "result": result_of(result),
            "smoothed": result_of(smoothed),
            "landmarks": landmarks_of(result),
            "smoothedLandmarks": landmarks_of(smoothed),
            "animation": numbers(&result.animation),
            "smoothedAnimation": numbers(&smoothed.animation),
            "events": [],
        })
        .to_string();
        let length = u32::try_from(text.len())?.to_le_bytes();
        Ok([&length[..], text.as_bytes(), &jpeg].concat().into())
    }

    fn jpeg(&self, picture: &Picture) -> Result<Vec<u8>> {
        let mut rgb = picture.upright_rgb()?;
        let (width, height) = rgb.dimensions();
        if width > self.most_width {
            let scale = f64::from(self.most_width) / f64::from(width);
            let height = (f64::from(height) * scale).round().max(1.0) as u32;
            rgb = image::imageops::thumbnail(&rgb, self.most_width, height);
        }
        let mut out = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut out, QUALITY);
        rgb.write_with_encoder(encoder)
            .context("cannot encode the picture")?;
        Ok(out)
    }
}

/// `Result` of `web/layout.js`.
fn result_of(r: &TrackResult) -> Value {
    let mut out = pose_of(r);
    if let (Value::Object(all), Value::Object(eyes)) = (&mut out, eyes_of(&r.eyes)) {
        all.extend(eyes);
    }
    out
}

fn eyes_of(eyes: &Eyes) -> Value {
    let [left, right] = &eyes.each;
    let gazes = [&left.gaze, &right.gaze, &eyes.gaze];
    let status = [left.unknown, right.unknown].map(EyeUnknown::name_of);
    json!({
        "eyeOpenProbability": numbers(&[left.open, right.open]),
        "eyeStatus": status,
        "irisLeft": numbers(&left.iris),
        "irisRight": numbers(&right.iris),
        "gazeStatus": gazes.map(|gaze| EyeUnknown::name_of(gaze.unknown)),
        "gazeSigmaDeg": numbers(&gazes.map(|gaze| gaze.sigma_deg)),
        "gazeLeft": numbers(&left.gaze.camera),
        "gazeRight": numbers(&right.gaze.camera),
        "gaze": numbers(&eyes.gaze.camera),
        "gazeHead": numbers(&eyes.gaze.head),
        "glasses": number(eyes.glasses),
        "darkGlasses": number(eyes.dark_glasses),
        "eyeLook": numbers(&eyes.look),
    })
}

fn pose_of(r: &TrackResult) -> Value {
    json!({
        "state": r.state.name(),
        "timestampUs": r.timestamp_us,
        "ageUs": r.age_us,
        "landmarkCount": r.landmarks.len(),
        "confidence": number(r.confidence),
        "faceBox": numbers(&r.face_box),
        "rotation": numbers(&r.rotation),
        "yawDeg": number(r.yaw_deg),
        "pitchDeg": number(r.pitch_deg),
        "rollDeg": number(r.roll_deg),
        "translationMm": numbers(&r.translation_mm),
        "eyeOpen": numbers(&r.eye_open),
        "loss": r.loss.name(),
        "visibleShare": number(r.visible_share),
        "rotationSigmaDeg": numbers(&r.rotation_sigma_deg),
        "translationSigmaMm": numbers(&r.translation_sigma_mm),
        "facingYawDeg": number(r.facing_yaw_deg),
        "facingPitchDeg": number(r.facing_pitch_deg),
        "facingRollDeg": number(r.facing_roll_deg),
        "facingSigmaDeg": numbers(&r.facing_sigma_deg),
        "focalPx": number(r.focal_px),
        "cameraAssumed": u32::from(r.camera_assumed),
    })
}

/// `Landmark`s of `web/layout.js`.
fn landmarks_of(r: &TrackResult) -> Value {
    let landmarks = r.landmarks.iter().zip(&r.points_mm);
    landmarks
        .map(|(l, [x, y, z])| {
            json!({
                "x": number(l.x),
                "y": number(l.y),
                "confidence": number(l.confidence),
                "visibility": number(l.visibility),
                "xMm": number(*x),
                "yMm": number(*y),
                "zMm": number(*z),
            })
        })
        .collect()
}

fn camera(c: &Intrinsics) -> Value {
    let [fx, fy, cx, cy] = [c.fx, c.fy, c.cx, c.cy].map(number);
    json!({ "fx": fx, "fy": fy, "cx": cx, "cy": cy })
}
