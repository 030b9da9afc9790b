//! Grey pictures in floating point, with smooth reading between pixels.

use image::GrayImage;

/// A grey picture, 0 to 255.
#[derive(Clone, Debug)]
pub struct Picture {
    /// \[px\].
    pub width: usize,
    /// \[px\].
    pub height: usize,
    /// Row by row.
    pub pixels: Vec<f32>,
}

impl Picture {
    /// From a frame.
    pub fn of(luma: &GrayImage) -> Picture {
        Picture {
            width: luma.width() as usize,
            height: luma.height() as usize,
            pixels: luma.as_raw().iter().map(|v| f32::from(*v)).collect(),
        }
    }

    /// Value at a point, between pixels too; beyond the edge that of the edge.
    pub fn at(&self, [x, y]: [f32; 2]) -> f32 {
        let inside = |v: f32, len: usize| v.clamp(0.0, len as f32 - 1.001).max(0.0);
        let (x, y) = (inside(x, self.width), inside(y, self.height));
        let (left, top) = (x as usize, y as usize);
        let (fx, fy) = (x - left as f32, y - top as f32);
        let (right, below) = (
            (left + 1).min(self.width - 1),
            (top + 1).min(self.height - 1) * self.width,
        );
        let row = |start: usize| {
            let (a, b) = (self.pixels[start + left], self.pixels[start + right]);
            a + fx * (b - a)
        };
        let (upper, lower) = (row(top * self.width), row(below));
        upper + fy * (lower - upper)
    }

    /// Smoothed by a Gaussian of this standard deviation \[px\].
    pub fn blurred(&self, sigma: f32) -> Picture {
        let radius = (2.5 * sigma).ceil() as usize;
        if radius == 0 {
            return self.clone();
        }
        let weight = |d: usize| (-0.5 * (d as f32 / sigma).powi(2)).exp();
        let total = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f32>();
        let weights: Vec<f32> = (0..=radius).map(|d| weight(d) / total).collect();
        self.filtered(&weights).filtered(&weights)
    }

    /// Filters the rows and swaps rows and columns: twice is a filter in both directions.
    fn filtered(&self, weights: &[f32]) -> Picture {
        let mut out = Picture {
            width: self.height,
            height: self.width,
            pixels: vec![0.0; self.pixels.len()],
        };
        for (y, row) in self.pixels.chunks_exact(self.width).enumerate() {
            for x in 0..self.width {
                let pair = |d: usize| row[x.saturating_sub(d)] + row[(x + d).min(self.width - 1)];
                let rest = weights.iter().enumerate().skip(1);
                let sum: f32 = rest.map(|(d, w)| w * pair(d)).sum();
                out.pixels[x * out.width + y] = weights[0] * row[x] + sum;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Picture {
        let at = |i: usize| (i % 8) as f32 * 10.0 + (i / 8) as f32;
        Picture {
            width: 8,
            height: 6,
            pixels: (0..48).map(at).collect(),
        }
    }

    #[test]
    fn values_between_pixels() {
        let picture = ramp();
        assert!((picture.at([2.5, 3.25]) - 28.25).abs() < 1e-4);
        assert!((picture.at([-5.0, 2.0]) - 2.0).abs() < 1e-4);
        assert!((picture.at([99.0, 99.0]) - 75.0).abs() < 0.1);
    }

    #[test]
    fn blur_keeps_ramps() {
        let blurred = ramp().blurred(0.8);
        assert_eq!((blurred.width, blurred.height), (8, 6));
        assert!((blurred.at([4.0, 3.0]) - 43.0).abs() < 1e-3);
    }
}
