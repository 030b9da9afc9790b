//! How a patch of a picture moves to another: registration by its intensities, which knows nothing
//! of landmarks (Lucas and Kanade 1981), robust and blind to a change of exposure.

use image::GrayImage;
use nalgebra::{SMatrix, SVector};

/// Places across and down at which the patch is read.
const GRID: [usize; 2] = [40, 30];
const ROUNDS: usize = 15;
/// A step this small ends the search \[px\].
const SETTLED: f64 = 1e-4;
/// Differences of so many grey levels count half: eyes blink while heads move.
const OUTLIER: f64 = 8.0;

/// Blurred a little, so that slopes hold for a pixel around.
pub struct Luma {
    size: [usize; 2],
    values: Vec<f64>,
}

impl Luma {
    /// 5×5 binomial blur; edges are repeated.
    pub fn of(image: &GrayImage) -> Self {
        let size = [image.width() as usize, image.height() as usize];
        let read = |values: &[f64], x: i64, y: i64| {
            let at = |v: i64, len: usize| v.clamp(0, len as i64 - 1) as usize;
            values[at(y, size[1]) * size[0] + at(x, size[0])]
        };
        let mut values: Vec<f64> = image.as_raw().iter().map(|v| f64::from(*v)).collect();
        for [dx, dy] in [[1, 0], [0, 1]] {
            let smooth = |i: usize| {
                let (x, y) = ((i % size[0]) as i64, (i / size[0]) as i64);
                let tap = |k: i64| read(&values, x + k * dx, y + k * dy);
                (6.0 * tap(0) + 4.0 * (tap(-1) + tap(1)) + tap(-2) + tap(2)) / 16.0
            };
            values = (0..values.len()).map(smooth).collect();
        }
        Luma { size, values }
    }

    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let split = |v: f64, len: usize| {
            let v = v.clamp(0.0, len as f64 - 1.0);
            let whole = (v as usize).min(len.saturating_sub(2));
            (whole, v - whole as f64)
        };
        let ((x, u), (y, v)) = (split(x, self.size[0]), split(y, self.size[1]));
        let right = (x + 1).min(self.size[0] - 1);
        let below = (y + 1).min(self.size[1] - 1);
        let row = |y: usize| {
            let (a, b) = (
                self.values[y * self.size[0] + x],
                self.values[y * self.size[0] + right],
            );
            a + u * (b - a)
        };
        row(y) + v * (row(below) - row(y))
    }
}

/// An upright patch \[px\].
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    pub centre: [f64; 2],
    /// Half of its width and height.
    pub reach: [f64; 2],
}

/// A similarity: growth and turn about a centre, and its shift \[px\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    centre: [f64; 2],
    grow: f64,
    turn: f64,
    shift: [f64; 2],
}

impl Motion {
    /// As points move, in the sense of least squares.
    pub fn of_points(from: &[[f64; 2]], to: &[[f64; 2]]) -> Self {
        let (centre, goal) = (mean(from), mean(to));
        let (mut extent, mut along, mut across) = (1e-9, 0.0, 0.0);
        for (p, q) in from.iter().zip(to) {
            let (p, q) = (less(*p, centre), less(*q, goal));
            extent += p[0] * p[0] + p[1] * p[1];
            along += p[0] * q[0] + p[1] * q[1];
            across += p[0] * q[1] - p[1] * q[0];
        }
        Motion {
            centre,
            grow: along / extent,
            turn: across / extent,
            shift: less(goal, centre),
        }
    }

    /// Where a point goes.
    pub fn apply(&self, p: [f64; 2]) -> [f64; 2] {
        let Motion {
            centre,
            grow,
            turn,
            shift,
        } = self;
        let [x, y] = less(p, *centre);
        [
            centre[0] + shift[0] + grow * x - turn * y,
            centre[1] + shift[1] + grow * y + turn * x,
        ]
    }
}

/// Mean of points.
pub fn mean(points: &[[f64; 2]]) -> [f64; 2] {
    let n = points.len().max(1) as f64;
    [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n)
}

fn less(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

/// Where the patch of one picture is in another, searched from a first guess; `None` where it shows
/// too little to tell.
pub fn register(from: &Luma, to: &Luma, patch: &Patch, guess: Motion) -> Option<Motion> {
    let mut motion = guess;
    for _ in 0..ROUNDS {
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for k in 0..GRID[0] * GRID[1] {
            let along = |k: usize, n: usize| 2.0 * k as f64 / (n - 1) as f64 - 1.0;
            let place = [
                patch.centre[0] + patch.reach[0] * along(k % GRID[0], GRID[0]),
                patch.centre[1] + patch.reach[1] * along(k / GRID[0], GRID[1]),
            ];
            let [x, y] = less(place, motion.centre);
            let at = motion.apply(place);
            let beside = |dx: f64, dy: f64| to.at([at[0] + dx, at[1] + dy]);
            let slope = [
                beside(0.5, 0.0) - beside(-0.5, 0.0),
                beside(0.0, 0.5) - beside(0.0, -0.5),
            ];
            let value = to.at(at);
            let row = SVector::from([
                slope[0] * x + slope[1] * y,
                slope[1] * x - slope[0] * y,
                slope[0],
                slope[1],
                value,
                1.0,
            ]);
            let off = from.at(place) - value;
            let weight = 1.0 / (1.0 + off.abs() / OUTLIER);
            normal += weight * row * row.transpose();
            right += weight * off * row;
        }
        let step = normal.cholesky()?.solve(&right);
        motion.grow += step[0];
        motion.turn += step[1];
        motion.shift[0] += step[2];
        motion.shift[1] += step[3];
        if step[2].abs() + step[3].abs() < SETTLED {
            break;
        }
    }
    let Motion {
        grow, turn, shift, ..
    } = motion;
    let finite = [grow, turn, shift[0], shift[1]]
        .iter()
        .all(|v| v.is_finite());
    finite.then_some(motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(at: impl Fn(f64, f64) -> f64) -> Luma {
        let value = |x: u32, y: u32| image::Luma([at(f64::from(x), f64::from(y)).round() as u8]);
        Luma::of(&GrayImage::from_fn(120, 100, value))
    }

    fn texture(x: f64, y: f64) -> f64 {
        128.0 + 50.0 * (0.21 * x).sin() * (0.17 * y).cos() + 30.0 * (0.13 * (x + y)).cos()
    }

    const PATCH: Patch = Patch {
        centre: [60.0, 50.0],
        reach: [25.0, 20.0],
    };
    const STILL: Motion = Motion {
        centre: [60.0, 50.0],
        grow: 1.0,
        turn: 0.0,
        shift: [0.0; 2],
    };

    #[test]
    fn finds_a_known_motion_under_another_exposure() {
        let motion = Motion {
            grow: 1.01,
            turn: 0.02,
            shift: [1.3, -0.7],
            ..STILL
        };
        let inverse = |x: f64, y: f64| {
            let Motion {
                grow, turn, shift, ..
            } = motion;
            let [x, y] = [x - 60.0 - shift[0], y - 50.0 - shift[1]];
            let over = grow * grow + turn * turn;
            [
                60.0 + (grow * x + turn * y) / over,
                50.0 + (grow * y - turn * x) / over,
            ]
        };
        let before = picture(texture);
        let after = picture(|x, y| {
            let [x, y] = inverse(x, y);
            0.9 * texture(x, y) + 10.0
        });
        let found = register(&before, &after, &PATCH, STILL).expect("enough to see");
        for p in [[40.0, 40.0], [60.0, 50.0], [80.0, 65.0]] {
            let (a, b) = (found.apply(p), motion.apply(p));
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.02, "{found:?}");
        }
    }

    #[test]
    fn a_blank_patch_tells_nothing() {
        for value in [0.0, 100.0] {
            let blank = picture(|_, _| value);
            assert_eq!(register(&blank, &blank, &PATCH, STILL), None);
        }
    }

    #[test]
    fn the_motion_of_points() {
        let motion = Motion {
            grow: 0.97,
            turn: -0.05,
            shift: [3.0, 4.0],
            ..STILL
        };
        let from = [[40.0, 30.0], [70.0, 35.0], [66.0, 70.0]];
        let to = from.map(|p| motion.apply(p));
        let found = Motion::of_points(&from, &to);
        for (p, q) in from.iter().zip(to) {
            let r = found.apply(*p);
            assert!((r[0] - q[0]).hypot(r[1] - q[1]) < 1e-6, "{found:?}");
        }
    }
}
