//! Small text in pictures, from the 8×8 bitmap font of the `font8x8` crate: no font files needed.

use font8x8::legacy::BASIC_LEGACY;

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
