//! How a patch of a picture moves to another: registration by its intensities, which knows nothing
//! of landmarks (Lucas and Kanade 1981), robust and blind to a change of exposure.

use image::GrayImage;
use image::imageops::interpolate_bilinear;
use imageproc::definitions::Image;
use imageproc::filter::separable_filter_equal;
use nalgebra::{SMatrix, SVector};
use posewise::math::Similarity;

/// Places across and down at which the patch is read.
const GRID: [usize; 2] = [40, 30];
const ROUNDS: usize = 15;
/// A step this small ends the search \[px\].
const SETTLED: f64 = 1e-4;
/// Difference \[grey levels\] that counts half: eyes blink while heads move.
const OUTLIER: f64 = 8.0;
/// Of a blur, so that slopes hold for a pixel around.
const BINOMIAL: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// A picture to be registered.
pub struct Luma(Image<image::Luma<f32>>);

impl Luma {
    /// Blurred a little.
    pub fn of(image: &GrayImage) -> Self {
        let values = image.as_raw().iter().map(|v| f32::from(*v)).collect();
        let (width, height) = image.dimensions();
        let plain = Image::from_raw(width, height, values).expect("a value for each pixel");
        Luma(separable_filter_equal(&plain, &BINOMIAL))
    }

    /// Edges are repeated.
    fn at(&self, [x, y]: [f32; 2]) -> f64 {
        let inside = |v: f32, len: u32| v.clamp(0.0, len.max(1) as f32 - 1.0);
        let (x, y) = (inside(x, self.0.width()), inside(y, self.0.height()));
        interpolate_bilinear(&self.0, x, y).map_or(0.0, |value| f64::from(value.0[0]))
    }
}

/// An upright patch \[px\].
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    pub centre: [f32; 2],
    /// Half of its width and height.
    pub reach: [f32; 2],
}

/// Where the patch of one picture is in another, searched from an initial motion; `None` where
/// it shows too little texture.
pub fn register(from: &Luma, to: &Luma, patch: &Patch, initial: Similarity) -> Option<Similarity> {
    let mut motion = initial;
    let [cx, cy] = patch.centre;
    for _ in 0..ROUNDS {
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for k in 0..GRID[0] * GRID[1] {
            let along = |k: usize, n: usize| 2.0 * k as f32 / (n - 1) as f32 - 1.0;
            let x = patch.reach[0] * along(k % GRID[0], GRID[0]);
            let y = patch.reach[1] * along(k / GRID[0], GRID[1]);
            let at = motion.apply([cx + x, cy + y]);
            let beside = |dx: f32, dy: f32| to.at([at[0] + dx, at[1] + dy]);
            let slope = [
                beside(0.5, 0.0) - beside(-0.5, 0.0),
                beside(0.0, 0.5) - beside(0.0, -0.5),
            ];
            let value = to.at(at);
            let (u, v) = (f64::from(x), f64::from(y));
            let row = SVector::from([
                slope[0] * u + slope[1] * v,
                slope[1] * u - slope[0] * v,
                slope[0],
                slope[1],
                value,
                1.0,
            ]);
            let off = from.at([cx + x, cy + y]) - value;
            let weight = 1.0 / (1.0 + off.abs() / OUTLIER);
            normal += weight * row * row.transpose();
            right += weight * off * row;
        }
        let step = normal.cholesky()?.solve(&right);
        // Growth and turn are about the patch's centre.
        let [grow, turn, dx, dy] = [step[0], step[1], step[2], step[3]].map(|v| v as f32);
        motion.a += grow;
        motion.b += turn;
        motion.tx += dx - (grow * cx - turn * cy);
        motion.ty += dy - (turn * cx + grow * cy);
        if step[2].abs() + step[3].abs() < SETTLED {
            break;
        }
    }
    let Similarity { a, b, tx, ty } = motion;
    [a, b, tx, ty]
        .iter()
        .all(|v| v.is_finite())
        .then_some(motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(at: impl Fn(f32, f32) -> f32) -> Luma {
        let value = |x: u32, y: u32| image::Luma([at(x as f32, y as f32).round() as u8]);
        Luma::of(&GrayImage::from_fn(120, 100, value))
    }

    fn texture(x: f32, y: f32) -> f32 {
        128.0 + 50.0 * (0.21 * x).sin() * (0.17 * y).cos() + 30.0 * (0.13 * (x + y)).cos()
    }

    const PATCH: Patch = Patch {
        centre: [60.0, 50.0],
        reach: [25.0, 20.0],
    };

    #[test]
    fn finds_a_known_motion_under_another_exposure() {
        let motion = Similarity {
            a: 1.01,
            b: 0.02,
            tx: 1.7,
            ty: -2.4,
        };
        let inverse = motion.inverse().expect("it grows");
        let before = picture(texture);
        let after = picture(|x, y| {
            let [x, y] = inverse.apply([x, y]);
            0.9 * texture(x, y) + 10.0
        });
        let found = register(&before, &after, &PATCH, Similarity::IDENTITY);
        let found = found.expect("enough to see");
        for p in [[40.0, 40.0], [60.0, 50.0], [80.0, 65.0]] {
            let (a, b) = (found.apply(p), motion.apply(p));
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.02, "{found:?}");
        }
    }

    #[test]
    fn a_blank_patch_tells_nothing() {
        for value in [0.0, 100.0] {
            let blank = picture(|_, _| value);
            let found = register(&blank, &blank, &PATCH, Similarity::IDENTITY);
            assert_eq!(found, None);
        }
    }
}
