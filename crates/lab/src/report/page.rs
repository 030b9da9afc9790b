//! The page: a template into which style, scripts and data go.

use super::figures::{Figures, SystemFigures};
use super::pictures::{Crop, Geometry, Jpeg, Pictures};
use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPTS: [&str; 3] = [
    include_str!("charts.js"),
    include_str!("scrubber.js"),
    include_str!("page.js"),
];

/// What the scripts read.
#[derive(Serialize)]
struct Data<'a> {
    figures: &'a Figures,
    /// By system and worst frame.
    worst: Vec<Vec<Option<Shown>>>,
    scrubber: Option<Scrubber<'a>>,
}

/// A picture with true and found landmarks.
#[derive(Serialize)]
struct Shown {
    jpeg: String,
    truth: Points,
    found: Points,
}

/// x and y in turns, in tenths of a pixel of the picture; empty if they are not known.
type Points = Vec<i32>;

#[derive(Serialize)]
struct Scrubber<'a> {
    name: &'a str,
    #[serde(flatten)]
    geometry: &'a Geometry,
    jpegs: Vec<String>,
    frames: usize,
    /// By picture.
    truth: Vec<Points>,
    /// By system.
    systems: Vec<Track>,
}

#[derive(Serialize)]
struct Track {
    /// By frame: errors of yaw, pitch, roll \[deg\].
    errors: Vec<Option<[f64; 3]>>,
    /// By picture.
    points: Vec<Option<Points>>,
}

fn tenths(points: impl IntoIterator<Item = [f64; 2]>) -> Points {
    let known = points.into_iter().filter(|p| p[0].is_finite());
    let each = known.flatten();
    each.map(|v| (10.0 * v).round() as i32).collect()
}

fn data_url(jpeg: &Jpeg) -> String {
    format!("data:image/jpeg;base64,{}", STANDARD.encode(jpeg))
}

fn shown(crop: &Crop) -> Shown {
    Shown {
        jpeg: data_url(&crop.jpeg),
        truth: tenths(crop.points[0]),
        found: tenths(crop.points[1]),
    }
}

/// Landmarks of a clip in a picture of the scrubber.
fn pictured(points: &[[f64; 2]; 68], geometry: &Geometry) -> Points {
    let centre = |v: f64| (v + 0.5) * geometry.scale;
    tenths(points.map(|p| p.map(centre)))
}

fn track(system: &SystemFigures, geometry: &Geometry) -> Track {
    let points = system.frames.iter().step_by(geometry.every).map(|frame| {
        let found = frame.tracked.as_ref()?;
        Some(pictured(&found.points, geometry))
    });
    let rounded = |error: f64| (100.0 * error).round() / 100.0;
    Track {
        errors: (system.scrub.iter())
            .map(|e| e.map(|e| e.map(rounded)))
            .collect(),
        points: points.collect(),
    }
}

/// The whole page.
pub fn text(figures: &Figures, pictures: &Pictures) -> Result<String> {
    let scrubber = (!pictures.scrub.is_empty()).then(|| Scrubber {
        name: &figures.clips[figures.scrub],
        geometry: &pictures.geometry,
        jpegs: pictures.scrub.iter().map(data_url).collect(),
        frames: figures.systems.first().map_or(0, |s| s.scrub.len()),
        truth: (figures.truth.iter().step_by(pictures.geometry.every))
            .map(|points| pictured(points, &pictures.geometry))
            .collect(),
        systems: (figures.systems.iter())
            .map(|system| track(system, &pictures.geometry))
            .collect(),
    });
    let worst = pictures.worst.iter();
    let data = Data {
        figures,
        worst: worst
            .map(|all| all.iter().map(|crop| crop.as_ref().map(shown)).collect())
            .collect(),
        scrubber,
    };
    // Names must not end the element.
    let data = serde_json::to_string(&data)?.replace('<', "\\u003c");
    // The data come last: a name may read like a mark of the template.
    Ok(TEMPLATE
        .replace("/*STYLE*/", STYLE)
        .replace("/*SCRIPT*/", &SCRIPTS.concat())
        .replace("/*DATA*/", &data))
}
