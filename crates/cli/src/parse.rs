//! Values of options, each with the range that the library accepts.

use std::fmt::Display;
use std::str::FromStr;

use posewise::monitor::{Preset, ZonesBy};
use posewise::{Config, Roi};

/// Most frames per second: timestamps are whole microseconds.
pub const MAX_FPS: f64 = 1e6;

/// Parses a number from `least` to `most`, in the precision of these.
pub fn within<T>(least: T, most: T) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Copy,
{
    move |text| match text.parse() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("not a number from {least} to {most}")),
    }
}

/// Parses a whole number from `least` to `most`.
pub fn whole(least: u32, most: u32) -> impl Fn(&str) -> Result<u32, String> + Clone {
    move |text| match text.parse() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("not a whole number from {least} to {most}")),
    }
}

/// Parses a frame rate: timestamps are whole microseconds, and each is after the last one.
pub fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(fps) if fps > 0.0 && fps <= MAX_FPS => Ok(fps),
        _ => Err(format!("not a number above 0, up to {MAX_FPS}")),
    }
}

/// Checks the form of a host and a port; the host is looked up later.
pub fn host_port(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse().is_ok_and(|n: u16| n > 0) => {
            Ok(text.to_string())
        }
        _ => Err("not HOST:PORT with a port from 1 to 65535".into()),
    }
}

/// Parses the name of a preset.
pub fn preset(text: &str) -> Result<Preset, String> {
    let known = Preset::ALL.into_iter().find(|preset| preset.name() == text);
    known.ok_or_else(|| {
        let names = Preset::ALL.map(Preset::name);
        format!("not one of {}", names.join(", "))
    })
}

/// Parses what zones are met by.
pub fn zones_by(text: &str) -> Result<ZonesBy, String> {
    let known = [ZonesBy::Gaze, ZonesBy::Head].into_iter();
    let mut known = known.filter(|by| by.name() == text);
    known.next().ok_or_else(|| "not gaze or head".into())
}

/// Where the driver sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriverPlace {
    /// Where a face is seen for most of the first minute.
    Learnt,
    /// Every face is the driver's.
    Any,
    /// Midway between the eyes, camera frame \[mm\].
    At([f32; 3]),
}

/// Parses it.
pub fn place(text: &str) -> Result<DriverPlace, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match (text, numbers.as_deref()) {
        ("learnt", _) => Ok(DriverPlace::Learnt),
        ("any", _) => Ok(DriverPlace::Any),
        (_, Ok(&[x, y, z])) if z > 0.0 => Ok(DriverPlace::At([x, y, z])),
        _ => Err("not learnt, any or X,Y,Z in mm".into()),
    }
}

/// Parses a region of interest.
pub fn roi(text: &str) -> Result<Roi, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let Ok([x, y, width, height]) = numbers.as_deref() else {
        return Err("not four whole numbers X,Y,W,H [px]".into());
    };
    let roi = Roi::new(*x, *y, *width, *height);
    match Config::default().with_roi(roi).check() {
        Ok(()) => Ok(roi),
        Err(error) => Err(error.to_string()),
    }
}
