//! Small text in pictures, from the 8×8 bitmap font of the `font8x8` crate: no font files needed.

use font8x8::legacy::BASIC_LEGACY;
use image::{Rgb, RgbImage};

/// Side of a glyph \[px\].
pub const GLYPH: i32 = 8;

/// Calls `set` for every pixel of `text` with its upper left corner at (0, 0). Characters outside
/// ASCII become `?`, but for the degree sign.
pub fn each_pixel(text: &str, mut set: impl FnMut(i32, i32)) {
    for (i, c) in text.chars().enumerate() {
        for (y, bits) in (0..).zip(glyph(c)) {
            for x in (0..GLYPH).filter(|x| bits >> x & 1 == 1) {
                set(i as i32 * GLYPH + x, y);
            }
        }
    }
}

/// Writes text from an upper left corner on, as far as it is in the picture.
pub fn write(image: &mut RgbImage, [left, top]: [u32; 2], text: &str, color: Rgb<u8>) {
    each_pixel(text, |x, y| {
        if let Some(pixel) = image.get_pixel_mut_checked(left + x as u32, top + y as u32) {
            *pixel = color;
        }
    });
}

/// Makes a strip on which text can be read: from the left edge on, as far as it is in the picture.
pub fn darken(image: &mut RgbImage, width: u32, rows: std::ops::Range<u32>) {
    for y in rows.start..rows.end.min(image.height()) {
        for x in 0..width.min(image.width()) {
            let pixel = image.get_pixel_mut(x, y);
            pixel.0 = pixel.0.map(|v| v / 3);
        }
    }
}

fn glyph(c: char) -> [u8; 8] {
    match c {
        '°' => [0x0e, 0x0a, 0x0e, 0, 0, 0, 0, 0],
        // U+2212, the typographic minus.
        '−' => glyph('-'),
        c => {
            let index = if c.is_ascii() {
                c as usize
            } else {
                '?' as usize
            };
            BASIC_LEGACY.get(index).copied().unwrap_or_default()
        }
    }
}

/// Width of a text \[px\].
pub fn width(text: &str) -> i32 {
    text.chars().count() as i32 * GLYPH
}
