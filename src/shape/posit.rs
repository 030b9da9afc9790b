//! POSIT: pose from points without an initial pose (DeMenthon and Davis, IJCV 1995).

use super::camera::orthonormal;
use super::{Intrinsics, Pose};
use glam::{Mat3, Vec3};
use nalgebra::{Cholesky, Matrix4, Vector4};

/// Most iterations of the perspective correction; a face at arm's length converges in a few.
const ITERATIONS: usize = 12;
/// Squared change of the perspective correction at which it has converged.
const CONVERGED: f32 = 1e-14;
/// Length that model coordinates are divided by, so that the 4×4 system is well scaled \[mm\].
const UNIT_MM: f32 = 50.0;
/// Least pivot of the 4×4 system relative to its trace: below it the points are (almost) in a
/// plane.
const LEAST_PIVOT: f32 = 1e-4;

/// The pose of points `(head [mm], image [px], weight)`; needs four that are not in one plane.
///
/// In the homogeneous form of SoftPOSIT (David et al., IJCV 2004): with u = (x − cx)/fx and
/// ε = r3·P/Tz, solve u(1 + ε) = s(r1·P + Tx) in least squares for s·(r1, Tx), likewise for y,
/// then update ε.
///
/// `None` when the points are degenerate or the pose is behind the camera.
pub fn posit(
    camera: &Intrinsics,
    points: impl Iterator<Item = (Vec3, [f32; 2], f32)> + Clone,
) -> Option<Pose> {
    let factor = normal_equations(points.clone().map(|(p, _, weight)| (p, weight)))?;
    // r3/Tz of the perspective correction: none at first (scaled orthography).
    let mut correction = Vec3::ZERO;
    let mut pose = None;
    for _ in 0..ITERATIONS {
        let (mut qx, mut qy) = (Vector4::zeros(), Vector4::zeros());
        for (p, [x, y], weight) in points.clone() {
            let scale = weight * (1.0 + correction.dot(p));
            let row = homogeneous(p);
            qx += row * (scale * (x - camera.cx) / camera.fx);
            qy += row * (scale * (y - camera.cy) / camera.fy);
        }
        factor.solve_mut(&mut qx);
        factor.solve_mut(&mut qy);
        let found = pose_of(qx.into(), qy.into())?;
        let next = found.rotation.transpose().z_axis / found.translation_mm.z;
        let converged = (next - correction).length_squared() < CONVERGED;
        correction = next;
        pose = Some(found);
        if converged {
            break;
        }
    }
    pose
}

/// The factor of Σ weight·p·pᵀ over homogeneous points; `None` when they are (almost) in a plane.
fn normal_equations(
    points: impl Iterator<Item = (Vec3, f32)>,
) -> Option<Cholesky<f32, nalgebra::U4>> {
    let mut normal = Matrix4::zeros();
    for (p, weight) in points {
        let row = homogeneous(p);
        normal.ger(weight, &row, &row, 1.0);
    }
    let factor = Cholesky::new(normal)?;
    let pivots = factor.l_dirty().diagonal();
    let weakest = pivots.iter().fold(f32::INFINITY, |m, d| m.min(d * d));
    (weakest > LEAST_PIVOT * normal.trace()).then_some(factor)
}

/// Homogeneous coordinates of a point, in units of [`UNIT_MM`].
fn homogeneous(p: Vec3) -> Vector4<f32> {
    Vector4::new(p.x / UNIT_MM, p.y / UNIT_MM, p.z / UNIT_MM, 1.0)
}

/// Rotation and translation from the two scaled rows s·(r1, Tx) and s·(r2, Ty).
fn pose_of(qx: [f32; 4], qy: [f32; 4]) -> Option<Pose> {
    let (r1, r2) = (
        Vec3::new(qx[0], qx[1], qx[2]) / UNIT_MM,
        Vec3::new(qy[0], qy[1], qy[2]) / UNIT_MM,
    );
    let (n1, n2) = (r1.length(), r2.length());
    let scale = libm::sqrtf(n1 * n2);
    if !(scale.is_finite() && n1 > 1e-9 && n2 > 1e-9) {
        return None;
    }
    let (r1, r2) = (r1 / n1, r2 / n2);
    // The rows are not exactly orthogonal: rotate both by half of the missing angle.
    let (sum, difference) = (r1 + r2, r1 - r2);
    let unit = |v: Vec3| v / v.length().max(1e-9);
    let (sum, difference) = (unit(sum), unit(difference));
    let (r1, r2) = (sum + difference, sum - difference);
    let rotation = orthonormal(Mat3::from_cols(r1, r2, r1.cross(r2))).transpose();
    let pose = Pose {
        rotation,
        translation_mm: Vec3::new(qx[3] / scale, qy[3] / scale, 1.0 / scale),
    };
    pose.is_valid().then_some(pose)
}

/// The second pose with almost the same image under weak perspective: for a flat object, the one
/// whose normal is mirrored at the line of sight (Oberkampf, DeMenthon and Davis, CVIU 1996).
pub(super) fn mirrored(pose: &Pose) -> Pose {
    let sight = {
        let t = pose.translation_mm;
        t / t.length().max(1e-6)
    };
    // A rotation by 180° about the line of sight mirrors the normal; one about the normal restores
    // the axes of the face.
    let half_turn = |axis: Vec3| {
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| axis * (2.0 * axis.dot(e)) - e);
        Mat3::from_cols(columns[0], columns[1], columns[2])
    };
    Pose {
        rotation: orthonormal(half_turn(sight) * pose.rotation * half_turn(Vec3::Z)),
        ..*pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::HeadAngles;
    use crate::shape::Project;

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
    fn degenerate_points_are_rejected() {
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
    fn mirroring_negates_yaw_and_pitch() {
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
