//! Pictures turned about their middle, for `posewise-lab eval landmarks --roll`.

use image::imageops::interpolate_bilinear;
use image::{GrayImage, Luma};

use super::landmark_metrics::Points;

/// A turn of pictures of one size, clockwise, onto a canvas that holds all of them.
pub struct Turn {
    sin: f64,
    cos: f64,
    /// Middles of picture and canvas \[px\].
    from: [f64; 2],
    to: [f64; 2],
}

impl Turn {
    /// By this angle \[deg\].
    pub fn new(picture: &GrayImage, deg: f64) -> Turn {
        let (sin, cos) = deg.to_radians().sin_cos();
        let [w, h] = [picture.width(), picture.height()].map(f64::from);
        // A quarter's cosine is not quite zero.
        let across = |w: f64, h: f64| (w * cos.abs() + h * sin.abs() - 1e-9).ceil();
        let middle = |length: f64| (length - 1.0) / 2.0;
        Turn {
            sin,
            cos,
            from: [w, h].map(middle),
            to: [across(w, h), across(h, w)].map(middle),
        }
    }

    /// Where a point of the picture comes to lie.
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = [x - self.from[0], y - self.from[1]];
        [
            self.to[0] + self.cos * x - self.sin * y,
            self.to[1] + self.sin * x + self.cos * y,
        ]
    }

    /// Where landmarks come to lie.
    pub fn points(&self, points: &Points) -> Points {
        points.map(|p| self.point(p))
    }

    /// The picture turned; what it does not show repeats its edges.
    pub fn picture(&self, picture: &GrayImage) -> GrayImage {
        let [width, height] = self.to.map(|middle| (2.0 * middle + 1.0) as u32);
        let last = [picture.width(), picture.height()].map(|length| (length - 1) as f32);
        GrayImage::from_fn(width, height, |x, y| {
            let (right, down) = (f64::from(x) - self.to[0], f64::from(y) - self.to[1]);
            let x = (self.from[0] + self.cos * right + self.sin * down) as f32;
            let y = (self.from[1] + self.cos * down - self.sin * right) as f32;
            let inside =
                interpolate_bilinear(picture, x.clamp(0.0, last[0]), y.clamp(0.0, last[1]));
            inside.unwrap_or(Luma([0]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot() -> GrayImage {
        GrayImage::from_fn(9, 5, |x, y| Luma([if (x, y) == (7, 1) { 200 } else { 40 }]))
    }

    #[test]
    fn no_turn_changes_nothing() {
        assert_eq!(Turn::new(&dot(), 0.0).picture(&dot()), dot());
    }

    #[test]
    fn points_go_where_pixels_go() {
        let turn = Turn::new(&dot(), 90.0);
        let picture = turn.picture(&dot());
        assert_eq!(picture.dimensions(), (5, 9));
        // Right of the middle goes below it.
        let [x, y] = turn.point([7.0, 1.0]);
        assert!((x - 3.0).abs() < 1e-9 && (y - 7.0).abs() < 1e-9, "{x} {y}");
        assert_eq!((picture[(3, 7)].0, picture[(2, 4)].0), ([200], [40]));
        let slant = Turn::new(&dot(), 30.0);
        let [x, y] = slant.point([4.0, 2.0]);
        let size = slant.picture(&dot()).dimensions();
        assert_eq!(
            (2.0 * x + 1.0, 2.0 * y + 1.0),
            (f64::from(size.0), f64::from(size.1))
        );
    }
}
