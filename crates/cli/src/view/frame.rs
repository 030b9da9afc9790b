//! A frame as the page receives it: the length of a JSON text (32 bits, little-endian), the text,
//! and the picture as a JPEG. The text is `Tracked` of `web/worker.js`.

use std::time::Duration;

use anyhow::{Context, Result};
use image::codecs::jpeg::JpegEncoder;
use posewise::{ANIMATION_NAMES, Intrinsics, TrackResult};
use serde_json::{Map, Value, json};
use tungstenite::Bytes;

use crate::fields::FIELDS;
use crate::monitor::watch::Watch;
use crate::picture::Picture;
use crate::session::Session;
use crate::value::{Value as Of, number, numbers};

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
        watch: Option<&mut Watch>,
    ) -> Result<Bytes> {
        let jpeg = self.jpeg(picture)?;
        let frame = picture.frame()?;
        let (result, smoothed) = (session.result(), session.smoothed());
        let [step_ms, pixels_ms] = times.map(|t| t.as_secs_f64() * 1e3);
        let mut text = json!({
            "animationNames": ANIMATION_NAMES.as_slice(),
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
        });
        if let Some(watch) = watch {
            (text["monitor"], text["zones"]) = watch.message();
        }
        let text = text.to_string();
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
    let fields = FIELDS.iter().map(|field| {
        let value = match (field.value)(r) {
            Of::Flag(value) => u32::from(value).into(),
            value => value.json(),
        };
        (camel(field.name), value)
    });
    let mut out: Map<String, Value> = fields.collect();
    out.insert("landmarkCount".into(), r.landmarks.len().into());
    out.into()
}

/// `faceBox` of `face_box`.
fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |out, word| {
        let (start, rest) = word.split_at(word.len().min(1));
        out + &start.to_uppercase() + rest
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
