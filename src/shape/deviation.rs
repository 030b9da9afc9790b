//! Standard deviations of a pose.
//!
//! What the fit's covariance has is the noise of the landmarks as if each erred alone. But their
//! errors are alike, the 3D face is not this person's, and the size of the head is unknown. How
//! large the errors are that come of it was measured, by how the face is turned and how much of it
//! is seen: [`SYSTEMATIC`]. Without intrinsics the focal length is unknown too: [`LENS`].

use super::Pose;
use crate::math::towards;
use glam::Vec3;

/// The natural logarithm of a standard deviation is the sum of these, times what they are of.
struct Terms {
    /// Alone: a large face that looks into the lens.
    base: f32,
    /// Of the size of the facing yaw \[90°\], and of its square.
    turn: [f32; 2],
    /// Of the share of the landmarks that is hidden, `1 − visible_share`.
    hidden: f32,
    /// Of the logarithm of how much smaller a face is than 1 px/mm.
    small: f32,
    /// Of the negative logarithm of the confidence, [`MOST_DOUBT`] at most.
    doubt: f32,
}

const fn terms(base: f32, turn: [f32; 2], [hidden, small, doubt]: [f32; 3]) -> Terms {
    Terms {
        base,
        turn,
        hidden,
        small,
        doubt,
    }
}

/// Deviations of the rotation about axes to the right, down and along the line of sight \[deg\], of
/// the position to the right and down, across that line \[mm\], and of the distance as a share of
/// it. The rotation about the line is a rotation in the picture: it errs least, however a face is
/// turned.
///
/// `posewise-lab eval deviations --fit` prints them (docs/accuracy.md): built-in model, the sweeps
/// of seed 61 and seven rendered clips, whole, small and blurred. The people of seed 62 and of the
/// other five clips chose nothing.
const SYSTEMATIC: [Terms; 6] = [
    terms(1.43, [0.00, 0.00], [0.57, 0.11, 0.67]),
    terms(1.33, [0.06, 0.00], [1.53, 0.08, 1.75]),
    terms(0.36, [0.59, 0.00], [1.12, 0.13, 1.03]),
    terms(0.40, [0.17, 0.00], [2.04, 0.01, 2.05]),
    terms(0.69, [0.04, 0.00], [1.41, 0.03, 0.93]),
    terms(-2.41, [0.00, 0.00], [0.26, 0.27, 0.44]),
];

/// Largest negative logarithm of a confidence: below 0.5 errors grow no more.
const MOST_DOUBT: f32 = 0.7;
/// Largest logarithm of 1 px/mm over the size of a face: a face of 12 px.
const MOST_SMALL: f32 = 2.5;

/// Standard deviation of the natural logarithm of the focal length where no intrinsics are given.
///
/// Chosen: cameras that see 15° to 75° across are within 1.5 and 0.3 of the assumed 60°, and most
/// have 35° to 85°, a telephone at arm's length and a lens that looks across a room.
const LENS: f32 = 0.5;
/// The same of the distance, as a share of it: the root of the mean square of e^l − 1 for a normal
/// l of deviation [`LENS`].
const LENS_RANGE: f32 = 0.62;

/// What a pose was fitted to.
pub(crate) struct Seen {
    /// Mean visibility of the landmarks, 0..1.
    pub(crate) visible_share: f32,
    /// That the landmarks are right, 0..1.
    pub(crate) confidence: f32,
    /// Focal length \[px\].
    pub(crate) focal_px: f32,
    /// Whether that was assumed.
    pub(crate) is_assumed: bool,
}

/// Variances of a pose.
pub(crate) struct Variances {
    /// Of the rotation about the camera's axes \[rad²\].
    pub(crate) rotation: [f32; 3],
    /// Of the position \[mm²\].
    pub(crate) translation: [f32; 3],
    /// Of yaw, pitch and roll relative to the line of sight \[rad²\].
    pub(crate) facing: [f32; 3],
}

impl Variances {
    /// Those of a pose with this covariance of the fit.
    pub(crate) fn of(pose: &Pose, covariance: &[[f32; 6]; 6], seen: &Seen) -> Variances {
        let [over, aside, round, right, down, range] = systematic(pose, seen);
        let t = pose.translation_mm;
        let sight = towards(t);
        let mut covariance = *covariance;
        for (axis, turn) in [
            (sight.x_axis, over),
            (sight.y_axis, aside),
            (sight.z_axis, round),
        ] {
            add_turn(&mut covariance, axis * turn.to_radians());
        }
        let facing = pose.facing_variances(&covariance);
        if seen.is_assumed {
            // A longer lens has the face nearer to its axis.
            let across = Vec3::new(-t.y, t.x, 0.0) * (t.z / t.length_squared().max(1.0));
            add_turn(&mut covariance, across * LENS);
        }
        let [rotation, mut translation] = diagonal(&covariance);
        let lens = if seen.is_assumed { LENS_RANGE } else { 0.0 };
        // The distance moves a face along its line of sight; the lens does not move it aside.
        let more = [
            right * right + t.x * t.x * range * range,
            down * down + t.y * t.y * range * range,
            t.z * t.z * (range * range + lens * lens),
        ];
        translation.iter_mut().zip(more).for_each(|(v, m)| *v += m);
        Variances {
            rotation,
            translation,
            facing,
        }
    }
}

/// Adds the error of a rotation about one axis, whose length is the deviation \[rad\].
fn add_turn(covariance: &mut [[f32; 6]; 6], axis: Vec3) {
    let axis = axis.to_array();
    for (row, a) in covariance.iter_mut().zip(axis) {
        for (v, b) in row.iter_mut().zip(axis) {
            *v += a * b;
        }
    }
}

/// Variances of rotation and translation.
fn diagonal(covariance: &[[f32; 6]; 6]) -> [[f32; 3]; 2] {
    let [a, b, c, d, e, f] = covariance;
    [[a[0], b[1], c[2]], [d[3], e[4], f[5]]]
}

/// The deviations of [`SYSTEMATIC`].
fn systematic(pose: &Pose, seen: &Seen) -> [f32; 6] {
    let turn = pose.facing_angles().yaw_deg.abs() / 90.0;
    let hidden = 1.0 - seen.visible_share;
    let px_per_mm = seen.focal_px / pose.translation_mm.z.max(1.0);
    let small = libm::logf(1.0 / px_per_mm.max(1e-6)).clamp(0.0, MOST_SMALL);
    let doubt = -libm::logf(seen.confidence.clamp(1e-6, 1.0));
    let doubt = doubt.min(MOST_DOUBT);
    SYSTEMATIC.map(|terms| {
        let [first, second] = terms.turn;
        let turned = (first + second * turn) * turn;
        let seen = terms.hidden * hidden + terms.small * small + terms.doubt * doubt;
        libm::expf(terms.base + turned + seen)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::HeadAngles;

    fn sigmas(yaw_deg: f32, at: [f32; 3], change: impl Fn(&mut Seen)) -> [[f32; 3]; 3] {
        let angles = HeadAngles {
            yaw_deg,
            ..HeadAngles::default()
        };
        let pose = Pose::of_angles(angles, Vec3::from(at));
        let mut seen = Seen {
            visible_share: 1.0,
            confidence: 1.0,
            focal_px: 600.0,
            is_assumed: false,
        };
        change(&mut seen);
        let v = Variances::of(&pose, &[[0.0; 6]; 6], &seen);
        [
            v.rotation.map(|v| v.sqrt().to_degrees()),
            v.translation.map(f32::sqrt),
            v.facing.map(|v| v.sqrt().to_degrees()),
        ]
    }

    #[test]
    fn in_the_middle_axis_and_facing_deviations_are_the_same() {
        let [[x, y, z], _, [yaw, pitch, roll]] = sigmas(0.0, [0.0, 0.0, 600.0], |_| {});
        for (axis, facing) in [(x, pitch), (y, yaw), (z, roll)] {
            assert!((axis - facing).abs() < 1e-3 * facing, "{axis} {facing}");
        }
        // In profile a pitch turns about the camera's z axis.
        let [[_, _, z], _, [_, pitch, _]] = sigmas(90.0, [0.0, 0.0, 600.0], |_| {});
        assert!((z - pitch).abs() < 1e-3 * pitch, "{z} {pitch}");
    }

    #[test]
    fn an_unknown_lens_is_in_axis_angles_and_distance_but_not_in_facing() {
        let at = [200.0, 0.0, 600.0];
        let [told, place, facing] = sigmas(0.0, at, |_| {});
        let [assumed, far, same] = sigmas(0.0, at, |seen| seen.is_assumed = true);
        assert_eq!(facing, same);
        // A third aside: 0.5 · sin·cos of 18.4° are 8.6°, about the vertical axis.
        let more = (assumed[1].powi(2) - told[1].powi(2)).sqrt();
        assert!((more - 8.6).abs() < 0.1, "{more}");
        assert!((assumed[0] - told[0]).abs() < 1e-3 && (assumed[2] - told[2]).abs() < 1e-3);
        assert_eq!(place[..2], far[..2]);
        assert!(far[2] > 0.62 * 600.0 && place[2] < 0.1 * 600.0);
    }

    #[test]
    fn what_is_hidden_doubtful_or_turned_is_less_certain() {
        let yaw = |yaw_deg, change: fn(&mut Seen)| sigmas(yaw_deg, [0.0, 0.0, 600.0], change)[2][0];
        let front = yaw(0.0, |_| {});
        assert!(front > 3.0 && front < 4.0, "{front}");
        assert!(yaw(80.0, |_| {}) > front);
        assert!(yaw(0.0, |seen| seen.visible_share = 0.4) > 1.9 * front);
        assert!(yaw(0.0, |seen| seen.confidence = 0.5) > 2.0 * front);
        assert_eq!(
            yaw(0.0, |seen| seen.confidence = 0.0),
            yaw(0.0, |seen| seen.confidence = 0.1)
        );
    }
}
