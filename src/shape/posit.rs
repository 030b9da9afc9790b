//! POSIT: pose from points without a start (DeMenthon and Davis, IJCV 1995).

use super::camera::orthonormal;
use super::{Intrinsics, Pose};
use crate::math::solve_spd;
use glam::{Mat3, Vec3};

/// Rounds of the perspective correction; it settles in a few for a face at arm's length.
const ROUNDS: usize = 12;

/// Length that model coordinates are divided by, so that the 4×4 system is well scaled \[mm\].
const UNIT_MM: f32 = 50.0;

/// Pose of points `(head [mm], image [px], weight)`; needs four that are not in one plane.
///
/// In the homogeneous form of SoftPOSIT (David et al. 2004): with u = (x − cx)/fx and
/// ε = r3·P/Tz, solve u(1 + ε) = s(r1·P + Tx) in least squares for s·(r1, Tx), likewise for y,
/// then renew ε.
///
/// `None` when the points are degenerate or the pose ends behind the camera.
pub fn posit(
    camera: &Intrinsics,
    points: impl Iterator<Item = (Vec3, [f32; 2], f32)> + Clone,
) -> Option<Pose> {
    let mut normal = [[0.0f32; 4]; 4];
    for (p, _, weight) in points.clone() {
        let row = homogeneous(p);
        for (sums, a) in normal.iter_mut().zip(row) {
            sums.iter_mut()
                .zip(row)
                .for_each(|(s, b)| *s += weight * a * b);
        }
    }
    // A plane leaves (almost) nothing in the direction of its normal; refuse instead of guessing.
    let trace: f32 = normal
        .iter()
        .enumerate()
        .map(|(i, r)| r.get(i).unwrap_or(&0.0))
        .sum();
    let mut factor = normal;
    let solvable = solve_spd(&mut factor, &mut [0.0; 4]);
    let weakest = factor.iter().enumerate().filter_map(|(i, row)| row.get(i));
    let weakest = weakest.fold(f32::INFINITY, |m, d| m.min(d * d));
    if !(solvable && weakest > 1e-4 * trace) {
        return None;
    }
    // Rows r3/Tz of the perspective correction: none at first (scaled orthography).
    let mut depth = Vec3::ZERO;
    let mut pose = None;
    for _ in 0..ROUNDS {
        let (mut qx, mut qy) = ([0.0f32; 4], [0.0f32; 4]);
        for (p, [x, y], weight) in points.clone() {
            let scale = weight * (1.0 + depth.dot(p));
            let u = scale * (x - camera.cx) / camera.fx;
            let v = scale * (y - camera.cy) / camera.fy;
            for ((qx, qy), a) in qx.iter_mut().zip(&mut qy).zip(homogeneous(p)) {
                *qx += u * a;
                *qy += v * a;
            }
        }
        if !(solve_spd(&mut normal.clone(), &mut qx) && solve_spd(&mut normal.clone(), &mut qy)) {
            return None;
        }
        let found = pose_of(qx, qy)?;
        let rotation = found.rotation.transpose();
        let next = rotation.z_axis / found.translation_mm.z;
        let settled = (next - depth).length_squared() < 1e-14;
        depth = next;
        pose = Some(found);
        if settled {
            break;
        }
    }
    pose
}

fn homogeneous(p: Vec3) -> [f32; 4] {
    [p.x / UNIT_MM, p.y / UNIT_MM, p.z / UNIT_MM, 1.0]
}

/// Rotation and translation from the two scaled rows.
fn pose_of(qx: [f32; 4], qy: [f32; 4]) -> Option<Pose> {
    let (r1, r2) = (
        Vec3::new(qx[0], qx[1], qx[2]) / UNIT_MM,
        Vec3::new(qy[0], qy[1], qy[2]) / UNIT_MM,
    );
    let (n1, n2) = (
        libm::sqrtf(r1.length_squared()),
        libm::sqrtf(r2.length_squared()),
    );
    let scale = libm::sqrtf(n1 * n2);
    if !(scale.is_finite() && n1 > 1e-9 && n2 > 1e-9) {
        return None;
    }
    let (r1, r2) = (r1 / n1, r2 / n2);
    // The rows are not quite at right angles: turn both by half of what is missing.
    let (sum, difference) = (r1 + r2, r1 - r2);
    let half = |v: Vec3| v / libm::sqrtf(v.length_squared()).max(1e-9);
    let (sum, difference) = (half(sum), half(difference));
    let (r1, r2) = (sum + difference, sum - difference);
    let rotation = orthonormal(Mat3::from_cols(r1, r2, r1.cross(r2))).transpose();
    let pose = Pose {
        rotation,
        translation_mm: Vec3::new(qx[3] / scale, qy[3] / scale, 1.0 / scale),
    };
    pose.is_valid().then_some(pose)
}

/// The other pose that looks almost the same under weak perspective: for a flat object, the one
/// whose normal is mirrored at the line of sight (Oberkampf, DeMenthon and Davis 1996).
pub(super) fn mirrored(pose: &Pose) -> Pose {
    let sight = {
        let t = pose.translation_mm;
        t / libm::sqrtf(t.length_squared()).max(1e-6)
    };
    // Half a turn about the line of sight mirrors the face's normal; half a turn about the normal
    // puts the face's axes back. Together they are a plain turn of the head.
    let turn_about = |axis: Vec3| {
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| axis * (2.0 * axis.dot(e)) - e);
        Mat3::from_cols(columns[0], columns[1], columns[2])
    };
    Pose {
        rotation: orthonormal(turn_about(sight) * pose.rotation * turn_about(Vec3::Z)),
        ..*pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::HeadAngles;

    const POINTS: [[f32; 3]; 6] = [
        [-45.0, 0.0, 10.0],
        [45.0, 0.0, 10.0],
        [0.0, 35.0, -45.0],
        [-25.0, 70.0, -10.0],
        [25.0, 70.0, -10.0],
        [0.0, 110.0, -15.0],
    ];

    fn poses() -> impl Iterator<Item = Pose> {
        [
            (0., 0., 0.),
            (30., -20., 10.),
            (-85., 15., -30.),
            (90., 0., 0.),
        ]
        .into_iter()
        .map(|(yaw_deg, pitch_deg, roll_deg)| {
            let angles = HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            };
            Pose::of_angles(angles, Vec3::new(60.0, -40.0, 450.0))
        })
    }

    #[test]
    fn exact_points_give_the_exact_pose() {
        let camera = Intrinsics::of_frame(640, 480);
        for truth in poses() {
            let points = POINTS
                .map(Vec3::from_array)
                .map(|p| (p, camera.project(truth.apply(p)), 1.0));
            let found = posit(&camera, points.into_iter()).unwrap();
            let off = found.rotation * truth.rotation.transpose();
            assert!(
                (off.x_axis.x + off.y_axis.y + off.z_axis.z - 3.0).abs() < 1e-3,
                "{found:?}"
            );
            assert!((found.translation_mm - truth.translation_mm).length() < 1.0);
        }
    }

    #[test]
    fn degenerate_points_are_refused() {
        let camera = Intrinsics::of_frame(640, 480);
        let flat = POINTS.map(|[x, y, _]| (Vec3::new(x, y, 0.0), [x, y], 1.0));
        assert!(posit(&camera, flat.into_iter()).is_none());
        assert!(posit(&camera, core::iter::empty()).is_none());
        let nan = POINTS.map(|p| (Vec3::from_array(p), [f32::NAN; 2], 1.0));
        assert!(posit(&camera, nan.into_iter()).is_none());
        let same = POINTS.map(|p| (Vec3::from_array(p), [5.0; 2], 1.0));
        assert!(posit(&camera, same.into_iter()).is_none());
    }

    #[test]
    fn mirroring_swaps_the_turn() {
        let angles = HeadAngles {
            yaw_deg: 20.0,
            pitch_deg: 10.0,
            roll_deg: 0.0,
        };
        let pose = Pose::of_angles(angles, Vec3::new(0.0, 0.0, 500.0));
        let other = mirrored(&pose).angles();
        assert!((other.yaw_deg + 20.0).abs() < 1.0 && (other.pitch_deg + 10.0).abs() < 1.0);
        assert!(other.roll_deg.abs() < 6.0);
    }
}
