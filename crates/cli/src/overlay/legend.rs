//! The legend at the lower left of an overlay: what its colours mean.

use image::{Rgb, RgbImage};

use super::colors::{AXES, BOX, BOX_COASTING, MESH, confidence_color};
use crate::cli::Style;
use crate::text;

const GREY: Rgb<u8> = Rgb([220, 220, 220]);

/// A line: words in their colours.
type Line = Vec<(&'static str, Rgb<u8>)>;

fn line(style: Style) -> Line {
    match style {
        Style::Points => vec![
            ("confidence ", GREY),
            ("0 ", confidence_color(0.0)),
            ("half ", confidence_color(0.5)),
            ("1 ", confidence_color(1.0)),
            ("small: hidden", GREY),
        ],
        Style::Mesh => vec![("mesh ", MESH), ("between the landmarks", GREY)],
        Style::Axes => vec![
            ("axes: ", GREY),
            ("left ", AXES[0]),
            ("down ", AXES[1]),
            ("out of the face", AXES[2]),
        ],
        Style::Box => vec![
            ("box: ", GREY),
            ("tracked ", BOX),
            ("coasted", BOX_COASTING),
        ],
    }
}

/// Writes one line for each style, on dark strips, where the picture is large enough.
pub fn legend(image: &mut RgbImage, styles: &[Style]) {
    let strip = text::GLYPH as u32 + 3;
    let (width, height) = image.dimensions();
    let lines: Vec<Line> = styles.iter().map(|style| line(*style)).collect();
    let longest = lines.iter().map(length).max().unwrap_or(0) + 4;
    // It would hide a picture that is not much larger.
    if width < longest || height < 4 * strip * lines.len() as u32 {
        return;
    }
    let top = height - strip * lines.len() as u32;
    text::darken(image, longest, top..height);
    for (i, words) in (0..).zip(&lines) {
        let mut left = 2;
        for (word, color) in words {
            text::write(image, [left, top + i * strip + 1], word, *color);
            left += text::width(word) as u32;
        }
    }
}

fn length(line: &Line) -> u32 {
    line.iter().map(|(word, _)| text::width(word) as u32).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn it_stands_where_it_fits() {
        let mut image = RgbImage::new(640, 480);
        legend(&mut image, Style::value_variants());
        for color in [MESH, BOX, BOX_COASTING, AXES[0], confidence_color(0.5)] {
            assert!(image.pixels().any(|p| *p == color), "{color:?}");
        }
        let mut small = RgbImage::new(100, 100);
        legend(&mut small, Style::value_variants());
        assert!(small.pixels().all(|p| p.0 == [0; 3]));
    }
}
