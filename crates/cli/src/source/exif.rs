//! The focal length that a picture's EXIF says.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exif::{Exif, In, Reader, Tag, Value};

/// Diagonal of a film frame of 36 × 24 mm \[mm\].
const FILM_DIAGONAL_MM: f64 = 43.27;

/// Focal length of a picture of this size \[px\]; `None` where its file does not say it.
pub fn focal_px(path: &Path, width: u32, height: u32) -> Option<f32> {
    let file = File::open(path).ok()?;
    let exif = Reader::new()
        .read_from_container(&mut BufReader::new(file))
        .ok()?;
    focal_of(&exif, f64::from(width), f64::from(height))
}

/// By the sensor's resolution, or by the focal length of a film camera with the same diagonal
/// field of view.
fn focal_of(exif: &Exif, width: f64, height: f64) -> Option<f32> {
    let number = |tag| number(exif, tag).filter(|v| v.is_finite() && *v > 0.0);
    let by_sensor = || {
        let unit_mm = match number(Tag::FocalPlaneResolutionUnit) {
            Some(3.0) => 10.0,
            _ => 25.4,
        };
        // The resolution is that of the picture as it was taken.
        let scale = number(Tag::PixelXDimension)
            .zip(number(Tag::PixelYDimension))
            .map_or(1.0, |(x, y)| width.max(height) / x.max(y));
        let focal_mm = number(Tag::FocalLength)?;
        Some(focal_mm * number(Tag::FocalPlaneXResolution)? / unit_mm * scale)
    };
    let by_film =
        || Some(number(Tag::FocalLengthIn35mmFilm)? / FILM_DIAGONAL_MM * width.hypot(height));
    let focal = by_film().or_else(by_sensor)? as f32;
    // From 170° to 1° across: others are wrong.
    let shares = 0.04..60.0;
    shares.contains(&(focal / width as f32)).then_some(focal)
}

fn number(exif: &Exif, tag: Tag) -> Option<f64> {
    let field = exif.get_field(tag, In::PRIMARY)?;
    match &field.value {
        Value::Rational(values) => values.first().map(|v| v.to_f64()),
        value => value.get_uint(0).map(f64::from),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A TIFF with these short (type 3) and rational (type 5) fields in its EXIF.
    fn exif(shorts: &[(u16, u16)], rationals: &[(u16, [u32; 2])]) -> Exif {
        let mut fields: Vec<(u16, Result<u16, [u32; 2]>)> = shorts
            .iter()
            .map(|(tag, v)| (*tag, Ok(*v)))
            .chain(rationals.iter().map(|(tag, v)| (*tag, Err(*v))))
            .collect();
        fields.sort_by_key(|(tag, _)| *tag);
        let u32s = |v: u32| v.to_le_bytes().to_vec();
        let mut bytes = b"II*\0\x08\0\0\0".to_vec();
        // The first directory has the pointer to the EXIF directory only.
        bytes.extend([1, 0]);
        bytes.extend([0x69, 0x87, 4, 0, 1, 0, 0, 0, 26, 0, 0, 0]);
        bytes.extend(u32s(0));
        bytes.extend((fields.len() as u16).to_le_bytes());
        let (mut more, start) = (Vec::new(), bytes.len() + 12 * fields.len() + 4);
        for (tag, value) in &fields {
            bytes.extend(tag.to_le_bytes());
            match value {
                Ok(short) => {
                    bytes.extend([3, 0, 1, 0, 0, 0]);
                    bytes.extend(u32s(u32::from(*short)));
                }
                Err([a, b]) => {
                    bytes.extend([5, 0, 1, 0, 0, 0]);
                    bytes.extend(u32s((start + more.len()) as u32));
                    more.extend([u32s(*a), u32s(*b)].concat());
                }
            }
        }
        bytes.extend(u32s(0));
        bytes.extend(more);
        Reader::new().read_raw(bytes).expect("a TIFF")
    }

    #[test]
    fn film_equivalents_are_of_the_diagonal() {
        let of = exif(&[(0xA405, 43)], &[]);
        let focal = focal_of(&of, 4000.0, 3000.0).unwrap();
        assert!((focal - 5000.0 * 43.0 / 43.27).abs() < 1.0);
    }

    #[test]
    fn a_sensor_has_pixels_per_length() {
        // 20 mm, 5000 px/inch on a picture of 6000 px that was reduced to 1500 px.
        let rationals = [(0x920A, [200, 10]), (0xA20E, [5000, 1])];
        let of = exif(&[(0xA002, 6000), (0xA003, 4000), (0xA210, 2)], &rationals);
        let focal = focal_of(&of, 1500.0, 1000.0).unwrap();
        assert!((focal - 20.0 * 5000.0 / 25.4 / 4.0).abs() < 0.1);
    }

    #[test]
    fn what_is_missing_or_absurd_is_unknown() {
        assert_eq!(
            focal_of(&exif(&[], &[(0x920A, [50, 1])]), 640.0, 480.0),
            None
        );
        assert_eq!(focal_of(&exif(&[(0xA405, 0)], &[]), 640.0, 480.0), None);
        assert_eq!(
            focal_of(&exif(&[(0xA405, 60_000)], &[]), 640.0, 480.0),
            None
        );
    }
}
