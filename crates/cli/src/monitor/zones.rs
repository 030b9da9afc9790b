//! Zones of a driver monitor from a JSON file.

use std::path::Path;

use anyhow::{Context, Result, bail};
use posewise::monitor::{Zone, ZoneShape};
use serde::Deserialize;

use crate::bounded;

/// One zone of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// For people.
    #[serde(default, rename = "name")]
    _name: String,
    #[serde(default)]
    road: bool,
    /// Seconds of a stay that do not count as away; `null` in place of it: all of them.
    #[serde(default = "no_grace")]
    grace_s: Option<f64>,
    angles: Option<Angles>,
    #[serde(rename = "box")]
    cuboid: Option<Cuboid>,
    plane: Option<Plane>,
}

fn no_grace() -> Option<f64> {
    Some(0.0)
}

/// A range of directions from that of the road \[deg\].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Angles {
    yaw_deg: [f32; 2],
    pitch_deg: [f32; 2],
}

/// A box along the axes of the camera frame \[mm\].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cuboid {
    min_mm: [f32; 3],
    max_mm: [f32; 3],
}

/// A parallelogram in the camera frame \[mm\].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plane {
    centre_mm: [f32; 3],
    half_u_mm: [f32; 3],
    half_v_mm: [f32; 3],
}

/// Largest file of zones \[MB\].
const MOST_MB: u64 = 1;

/// Reads the zones of a file; the monitor checks their numbers.
pub fn read(path: &Path) -> Result<Vec<Zone>> {
    let text = bounded::read_text("zones", path, MOST_MB)?;
    parse(&text).with_context(|| format!("{} is no list of zones", path.display()))
}

fn parse(text: &str) -> Result<Vec<Zone>> {
    let entries: Vec<Entry> = serde_json::from_str(text)?;
    entries.iter().map(zone).collect()
}

fn zone(entry: &Entry) -> Result<Zone> {
    let shape = match (&entry.angles, &entry.cuboid, &entry.plane) {
        (Some(angles), None, None) => ZoneShape::Angles {
            yaw_deg: angles.yaw_deg,
            pitch_deg: angles.pitch_deg,
        },
        (None, Some(cuboid), None) => ZoneShape::Box {
            min_mm: cuboid.min_mm,
            max_mm: cuboid.max_mm,
        },
        (None, None, Some(plane)) => ZoneShape::Plane {
            centre_mm: plane.centre_mm,
            half_u_mm: plane.half_u_mm,
            half_v_mm: plane.half_v_mm,
        },
        _ => bail!("a zone has one of: angles, box, plane"),
    };
    let grace_us = match entry.grace_s {
        Some(seconds) if (0.0..4000.0).contains(&seconds) => (seconds * 1e6).round() as u32,
        Some(_) => bail!("grace_s is from 0 to 4000"),
        None => u32::MAX,
    };
    let zone = Zone::new(shape).with_grace(grace_us);
    Ok(if entry.road { zone.as_road() } else { zone })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_of_the_docs_are_read() {
        let docs = include_str!("../../../../docs/driver-monitor.md");
        let text = docs.split("```json\n").nth(1).expect("an example");
        let zones = parse(text.split("```").next().expect("its end")).unwrap();
        assert!(zones.len() >= 3 && zones[0].is_road);
        let monitor = posewise::monitor::Monitor::with_zones(
            &posewise::monitor::MonitorConfig::default(),
            &zones,
        );
        assert!(monitor.is_ok());
        assert!(zones.iter().any(|zone| zone.grace_us == 1_000_000));
    }

    #[test]
    fn what_is_no_zone_is_an_error() {
        for text in [
            "{}",
            "[{}]",
            r#"[{"angles": {"yaw_deg": [0, 1]}}]"#,
            r#"[{"cone": 1}]"#,
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
