//! Lens distortion: Brown–Conrady and Kannala–Brandt, with OpenCV's names and order of
//! coefficients.
//!
//! All positions here are on the plane at unit depth: x/z and y/z of a point, or of a pixel
//! (px − c)/f. A pinhole camera shows a point at radius r = tan θ, where θ is its angle from the
//! axis. A lens moves it to another radius, and a little sideways.
//!
//! The polynomials of both models turn back somewhere beyond the field of view that they were
//! calibrated in. There, and beyond [`FARTHEST`], a point is treated as one at the last good radius
//! in its direction. So both directions are defined and finite everywhere.

/// Largest angle from the axis at which points are distinguished \[rad\]: 80°. Chosen: at 90° a
/// pinhole camera shows nothing.
const FARTHEST: f32 = 1.396_263_4;

/// Largest radial coefficient of Brown–Conrady. Chosen: lenses with a narrow field of view have
/// large ones of high order, as their radii are small.
const BROWN_RADIAL: f32 = 1e4;
/// Largest tangential coefficient; those of real lenses are below 0.01.
const BROWN_TANGENTIAL: f32 = 0.1;
/// Largest coefficient of Kannala–Brandt; those of real lenses are below 1.
const KANNALA: f32 = 10.0;
/// A lens whose picture turns back nearer to the axis than this is refused \[radius at unit
/// depth\]: about 1°.
const LEAST_RADIUS: f32 = 0.0175;

/// Radii at which the slope is looked at: from this one, each a factor greater.
const FIRST_RADIUS: f32 = 0.01;
const RADIUS_FACTOR: f32 = 1.1;
/// Halvings of the interval in which the slope becomes 0.
const LIMIT_STEPS: usize = 16;
/// Most steps of Newton's method for a radius; it takes about five.
const RADIUS_STEPS: usize = 24;
/// Relative change of a radius at which it has converged: the precision of `f32`.
const CONVERGED: f32 = 1e-7;
/// Corrections of the tangential part: each reduces the error by a factor of about a hundred.
const TANGENTIAL_STEPS: usize = 6;

/// How a lens moves the points of a pinhole camera's picture. Coefficients have OpenCV's names and
/// order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Distortion {
    /// Not at all: a pinhole camera.
    #[default]
    None,
    /// Brown–Conrady, OpenCV's `calibrateCamera`: with s = x² + y² the factor
    /// 1 + k1·s + k2·s² + k3·s³ on x and y; then x moves by 2·p1·x·y + p2·(s + 2·x²) and y by
    /// p1·(s + 2·y²) + 2·p2·x·y.
    BrownConrady {
        /// Radial, −10,000 to 10,000, as all three.
        k1: f32,
        /// Radial.
        k2: f32,
        /// Tangential, −0.1 to 0.1, as both.
        p1: f32,
        /// Tangential.
        p2: f32,
        /// Radial.
        k3: f32,
    },
    /// Kannala–Brandt, OpenCV's `fisheye`: a point at the angle θ from the axis is at the radius
    /// θ·(1 + k1·θ² + k2·θ⁴ + k3·θ⁶ + k4·θ⁸).
    KannalaBrandt {
        /// −10 to 10, as all four.
        k1: f32,
        /// The next one.
        k2: f32,
        /// The next one.
        k3: f32,
        /// The last one.
        k4: f32,
    },
}

impl Distortion {
    /// Whether all coefficients are in their ranges, and the picture does not turn back within 1°
    /// of the axis.
    pub fn is_valid(&self) -> bool {
        // No comparison holds for a NaN.
        let within = |values: &[f32], most: f32| values.iter().all(|v| v.abs() <= most);
        let in_range = match *self {
            Distortion::None => true,
            Distortion::BrownConrady { k1, k2, p1, p2, k3 } => {
                within(&[k1, k2, k3], BROWN_RADIAL) && within(&[p1, p2], BROWN_TANGENTIAL)
            }
            Distortion::KannalaBrandt { k1, k2, k3, k4 } => within(&[k1, k2, k3, k4], KANNALA),
        };
        in_range && self.lens().is_none_or(|lens| lens.limit >= LEAST_RADIUS)
    }

    /// The lens, ready for points; `None` for a pinhole camera.
    pub(super) fn lens(&self) -> Option<Lens> {
        let (radial, tangential, is_fisheye, farthest) = match *self {
            Distortion::None => return None,
            Distortion::BrownConrady { k1, k2, p1, p2, k3 } => {
                ([k1, k2, k3, 0.0], [p1, p2], false, libm::tanf(FARTHEST))
            }
            Distortion::KannalaBrandt { k1, k2, k3, k4 } => {
                ([k1, k2, k3, k4], [0.0; 2], true, FARTHEST)
            }
        };
        let mut lens = Lens {
            radial,
            tangential,
            is_fisheye,
            limit: farthest,
        };
        lens.limit = lens.last_rising(farthest);
        Some(lens)
    }
}

/// A lens with what both directions need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    /// Coefficients of r², r⁴, r⁶, r⁸ in the radial factor.
    radial: [f32; 4],
    tangential: [f32; 2],
    /// Whether r in the factor is the angle from the axis, and not its tangent.
    is_fisheye: bool,
    /// Largest r: up to there the distorted radius rises.
    limit: f32,
}

impl Lens {
    /// The distorted radius of r.
    fn radius(&self, r: f32) -> f32 {
        let s = r * r;
        let sum = self.radial.iter().rev().fold(0.0, |sum, k| (sum + k) * s);
        r * (1.0 + sum)
    }

    /// Derivative of [`Lens::radius`].
    fn slope(&self, r: f32) -> f32 {
        let s = r * r;
        let [k1, k2, k3, k4] = self.radial;
        1.0 + (3.0 * k1 + (5.0 * k2 + (7.0 * k3 + 9.0 * k4 * s) * s) * s) * s
    }

    /// Where the radius stops rising with r, at most `farthest`.
    fn last_rising(&self, farthest: f32) -> f32 {
        let (mut rising, mut r) = (0.0, FIRST_RADIUS);
        while rising < farthest {
            r = r.min(farthest);
            if self.slope(r) <= 0.0 {
                return self.turn(rising, r);
            }
            (rising, r) = (r, r * RADIUS_FACTOR);
        }
        farthest
    }

    /// The greatest r that is known to rise, between one that does and one that does not.
    fn turn(&self, mut rising: f32, mut falling: f32) -> f32 {
        for _ in 0..LIMIT_STEPS {
            let middle = (rising + falling) / 2.0;
            match self.slope(middle) > 0.0 {
                true => rising = middle,
                false => falling = middle,
            }
        }
        rising
    }

    /// The r of a distorted radius: Newton's method within an interval that shrinks.
    fn undistorted_radius(&self, distorted: f32) -> f32 {
        let (mut low, mut high) = (0.0, self.limit);
        let mut r = distorted.min(high);
        for _ in 0..RADIUS_STEPS {
            let excess = self.radius(r) - distorted;
            match excess > 0.0 {
                true => high = r,
                false => low = r,
            }
            let next = r - excess / self.slope(r);
            // Not for a NaN.
            let next = match next > low && next < high {
                true => next,
                false => (low + high) / 2.0,
            };
            let change = (next - r).abs();
            r = next;
            if change <= CONVERGED * r {
                break;
            }
        }
        r
    }

    /// What the tangential terms add at a point.
    fn sideways(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [p1, p2] = self.tangential;
        let s = x * x + y * y;
        [
            2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }

    /// Where the lens shows a point of the pinhole camera's picture.
    pub(super) fn distort(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let tangent = libm::hypotf(x, y);
        if tangent.is_nan() || tangent <= f32::MIN_POSITIVE {
            return [0.0; 2];
        }
        let (sine_x, sine_y) = match tangent.is_finite() {
            true => (x / tangent, y / tangent),
            false => (1.0, 0.0),
        };
        if self.is_fisheye {
            let r = self.radius(libm::atanf(tangent).min(self.limit));
            return [r * sine_x, r * sine_y];
        }
        let r = tangent.min(self.limit);
        let [dx, dy] = self.sideways([r * sine_x, r * sine_y]);
        let distorted = self.radius(r);
        [distorted * sine_x + dx, distorted * sine_y + dy]
    }

    /// Where a pinhole camera shows a point of the lens's picture.
    pub(super) fn undistort(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let radial = |[x, y]: [f32; 2]| {
            let distorted = libm::hypotf(x, y);
            if !(distorted > f32::MIN_POSITIVE && distorted.is_finite()) {
                return [0.0; 2];
            }
            let r = self.undistorted_radius(distorted);
            let r = if self.is_fisheye { libm::tanf(r) } else { r };
            [r * (x / distorted), r * (y / distorted)]
        };
        let mut point = radial([x, y]);
        if self.tangential != [0.0; 2] {
            for _ in 0..TANGENTIAL_STEPS {
                let [dx, dy] = self.sideways(point);
                point = radial([x - dx, y - dy]);
            }
        }
        point
    }
}

#[cfg(test)]
#[path = "../../tests/common/lenses.rs"]
mod lenses;

#[cfg(test)]
mod tests {
    use super::lenses::{FISHEYE, WIDE};
    use super::*;

    /// A lens with a narrow field of view.
    const NARROW: Distortion = Distortion::BrownConrady {
        k1: 0.3,
        k2: -20.0,
        p1: -0.002,
        p2: 0.001,
        k3: 400.0,
    };

    /// Points within a radius, from a linear congruential generator.
    fn points(radius: f32) -> impl Iterator<Item = [f32; 2]> {
        let mut state = 1u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        (0..2000)
            .map(move |_| [random() * radius, random() * radius])
            .filter(move |[x, y]| libm::hypotf(*x, *y) <= radius)
    }

    #[test]
    fn the_formulae_are_those_of_opencv() {
        let wide = WIDE.lens().unwrap();
        // Written out at (0.5, −0.25): s = 0.3125.
        let s = 0.3125f32;
        let factor = 1.0 - 0.12 * s + 0.012 * s * s - 0.0004 * s * s * s;
        let x = 0.5 * factor + 2.0 * 0.001 * (0.5 * -0.25) - 0.0007 * (s + 2.0 * 0.25);
        let y = -0.25 * factor + 0.001 * (s + 2.0 * 0.0625) - 2.0 * 0.0007 * (0.5 * -0.25);
        let [u, v] = wide.distort([0.5, -0.25]);
        assert!((u - x).abs() < 1e-6 && (v - y).abs() < 1e-6);
        // At 45° on the x axis.
        let t = core::f32::consts::FRAC_PI_4;
        let (t2, t4) = (t * t, t * t * t * t);
        let r = t * (1.0 - 0.02 * t2 + 0.004 * t4 - 0.003 * t4 * t2 + 0.0005 * t4 * t4);
        let [u, v] = FISHEYE.lens().unwrap().distort([1.0, 0.0]);
        assert!((u - r).abs() < 1e-6 && v == 0.0);
    }

    #[test]
    fn both_directions_are_inverse() {
        for (distortion, radius) in [(WIDE, 2.2), (FISHEYE, 4.0), (NARROW, 0.15)] {
            assert!(distortion.is_valid());
            let lens = distortion.lens().unwrap();
            for [x, y] in points(radius) {
                let [u, v] = lens.undistort(lens.distort([x, y]));
                let most = 2e-6 * (1.0 + x * x + y * y) * radius;
                assert!(
                    (u - x).abs() < most && (v - y).abs() < most,
                    "{distortion:?} {x} {y}: {u} {v}"
                );
            }
        }
    }

    #[test]
    fn beyond_the_last_good_radius_all_is_finite() {
        let turns = Distortion::BrownConrady {
            k1: -0.3,
            k2: 0.0,
            p1: 0.1,
            p2: -0.1,
            k3: 0.0,
        };
        assert!(turns.is_valid());
        let limit = turns.lens().unwrap().limit;
        assert!((limit - libm::sqrtf(1.0 / 0.9)).abs() < 1e-4, "{limit}");
        for lens in [turns, WIDE, FISHEYE, NARROW].map(|d| d.lens().unwrap()) {
            for far in [
                1e-30,
                0.5,
                3.0,
                100.0,
                1e10,
                f32::MAX,
                f32::INFINITY,
                f32::NAN,
            ] {
                for point in [[far, 0.0], [far, -far], [0.0, far]] {
                    let both = [lens.distort(point), lens.undistort(point)];
                    assert!(both.iter().flatten().all(|v| v.is_finite()), "{point:?}");
                }
            }
        }
    }

    #[test]
    fn coefficients_out_of_range_are_refused() {
        let brown = |k1, p1| Distortion::BrownConrady {
            k1,
            k2: 0.0,
            p1,
            p2: 0.0,
            k3: 0.0,
        };
        let fisheye = |k4| Distortion::KannalaBrandt {
            k1: 0.0,
            k2: 0.0,
            k3: 0.0,
            k4,
        };
        for bad in [f32::NAN, f32::INFINITY, 1e5, -1e5, -1e4] {
            assert!(!brown(bad, 0.0).is_valid(), "{bad}");
        }
        assert!(brown(1e4, 0.0).is_valid());
        assert!(!brown(0.0, 0.11).is_valid() && !brown(0.0, f32::NAN).is_valid());
        assert!(!fisheye(11.0).is_valid() && !fisheye(f32::NAN).is_valid());
        assert!(fisheye(-10.0).is_valid() && Distortion::None.is_valid());
    }
}
