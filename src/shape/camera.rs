//! The camera and the rigid pose of a head.

use core::ops::RangeInclusive;

use super::distortion::Distortion;
#[cfg(any(test, feature = "monitor", feature = "unstable-internals"))]
use crate::math::head_rotation;
use crate::math::{HeadAngles, head_angles};
use glam::{Mat3, Vec3};

/// A camera \[px\], with its lens.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Intrinsics {
    /// Focal length along x, 1 to a million.
    pub fx: f32,
    /// Focal length along y, 1 to a million, and 0.1 to 10 times the one along x.
    pub fy: f32,
    /// Principal point, x; within 100,000 of 0.
    pub cx: f32,
    /// Principal point, y; within 100,000 of 0.
    pub cy: f32,
    /// What the lens does to the picture.
    pub distortion: Distortion,
}

/// Range of the focal lengths \[px\], chosen beyond every camera: 166° across a frame of 16 px, and
/// 0.9° across the widest one, 16,384 px. Within it no step of the fit overflows.
pub(crate) const FOCAL_PX: RangeInclusive<f32> = 1.0..=1e6;
/// Range of fy/fx, the ratio of width to height of a pixel; anamorphic lenses have 0.5 to 2.
pub(crate) const PIXEL_ASPECT: RangeInclusive<f32> = 0.1..=10.0;
/// Largest distance of the principal point from the origin, along an axis \[px\]: six times the
/// widest frame, for frames that are cut out of larger ones.
pub(crate) const PRINCIPAL_PX: f32 = 1e5;

/// Least depth for a projection \[mm\]: nearer points are projected from here.
pub(crate) const NEAREST_MM: f32 = 20.0;

/// Greatest distance of a head \[mm\]: at 100 m a head is smaller than a pixel.
pub(crate) const FARTHEST_MM: f32 = 100_000.0;

impl Intrinsics {
    /// A pinhole camera of these focal lengths and principal point \[px\].
    pub const fn new(fx: f32, fy: f32, cx: f32, cy: f32) -> Self {
        Intrinsics {
            fx,
            fy,
            cx,
            cy,
            distortion: Distortion::None,
        }
    }

    /// With this lens.
    pub const fn with_distortion(self, distortion: Distortion) -> Self {
        Intrinsics { distortion, ..self }
    }

    /// The default camera of a frame of this size \[px\]: a horizontal field of view of 60°, the
    /// principal point at the image centre.
    pub fn of_frame(width: i32, height: i32) -> Self {
        // 1 / (2·tan 30°)
        let f = width as f32 * 0.866_025_4;
        Self::new(f, f, (width - 1) as f32 / 2.0, (height - 1) as f32 / 2.0)
    }

    /// Whether focal lengths and principal point are in their ranges. For the lens see
    /// [`Distortion::is_valid`].
    pub fn is_valid(&self) -> bool {
        let Intrinsics { fx, fy, cx, cy, .. } = *self;
        // No comparison holds for a NaN.
        FOCAL_PX.contains(&fx)
            && FOCAL_PX.contains(&fy)
            && PIXEL_ASPECT.contains(&(fy / fx))
            && cx.abs() <= PRINCIPAL_PX
            && cy.abs() <= PRINCIPAL_PX
    }

    /// Where the lens shows a point of the camera frame \[mm\] in the picture \[px\]. A point less
    /// than 20 mm in front of the camera, or behind it, is taken as one that is 20 mm away.
    pub fn image_of(&self, point_mm: [f32; 3]) -> [f32; 2] {
        let at = self.project(point_mm.into());
        match self.distortion.lens() {
            Some(lens) => self.pixel(lens.distort(self.at_unit_depth(at))),
            None => at,
        }
    }

    /// Where a pinhole camera would show points of the picture \[px\]. Unchanged to the last bit
    /// where there is no distortion.
    pub fn undistorted<const N: usize>(&self, points_px: &[[f32; 2]; N]) -> [[f32; 2]; N] {
        match self.distortion.lens() {
            Some(lens) => points_px.map(|p| self.pixel(lens.undistort(self.at_unit_depth(p)))),
            None => *points_px,
        }
    }

    /// The point of a pixel on the plane at unit depth.
    fn at_unit_depth(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [(x - self.cx) / self.fx, (y - self.cy) / self.fy]
    }

    /// The pixel of a point on the plane at unit depth.
    fn pixel(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [x * self.fx + self.cx, y * self.fy + self.cy]
    }

    /// Jacobian of [`Intrinsics::project`], by rows \[px/mm\].
    #[inline]
    pub(super) fn project_gradient(&self, point_mm: Vec3) -> [Vec3; 2] {
        let z = point_mm.z.max(NEAREST_MM);
        [
            Vec3::new(self.fx / z, 0.0, -self.fx * point_mm.x / (z * z)),
            Vec3::new(0.0, self.fy / z, -self.fy * point_mm.y / (z * z)),
        ]
    }
}

/// What the 3D fit computes with. A trait, so that the stable interface has no type of another
/// crate.
pub trait Project {
    /// Image position \[px\] of a point in the camera frame \[mm\], without the lens.
    fn project(&self, point_mm: Vec3) -> [f32; 2];
}

impl Project for Intrinsics {
    #[inline]
    fn project(&self, point_mm: Vec3) -> [f32; 2] {
        let z = point_mm.z.max(NEAREST_MM);
        [
            self.fx * point_mm.x / z + self.cx,
            self.fy * point_mm.y / z + self.cy,
        ]
    }
}

/// Pose of a head: camera = rotation · head + translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Head-to-camera rotation, orthonormal.
    pub rotation: Mat3,
    /// Origin of the head frame in the camera frame \[mm\].
    pub translation_mm: Vec3,
}

impl Default for Pose {
    /// Half a metre in front of the camera, looking into it.
    fn default() -> Self {
        Pose {
            rotation: Mat3::IDENTITY,
            translation_mm: Vec3::new(0.0, 0.0, 500.0),
        }
    }
}

impl Pose {
    /// The pose of these angles and this position.
    #[cfg(any(test, feature = "monitor", feature = "unstable-internals"))]
    pub fn of_angles(angles: HeadAngles, translation_mm: Vec3) -> Self {
        Pose {
            rotation: head_rotation(angles),
            translation_mm,
        }
    }

    /// A point of the head in the camera frame \[mm\].
    #[inline]
    pub fn apply(&self, head_mm: Vec3) -> Vec3 {
        self.rotation * head_mm + self.translation_mm
    }

    /// Yaw, pitch and roll relative to the camera's axes.
    pub fn angles(&self) -> HeadAngles {
        head_angles(&self.rotation)
    }

    /// The rotation as a unit quaternion x, y, z, w with w ≥ 0.
    pub fn quaternion(&self) -> [f32; 4] {
        // Shepperd 1978. Not glam's: the last bits of its SIMD quaternions differ between machines.
        let [x, y, z] = self.rotation.to_cols_array_2d();
        let ([m00, m10, m20], [m01, m11, m21], [m02, m12, m22]) = (x, y, z);
        let trace = m00 + m11 + m22;
        let q = if trace > m00.max(m11).max(m22) {
            [m21 - m12, m02 - m20, m10 - m01, 1.0 + trace]
        } else if m00 > m11.max(m22) {
            [1.0 + m00 - m11 - m22, m10 + m01, m20 + m02, m21 - m12]
        } else if m11 > m22 {
            [m10 + m01, 1.0 - m00 + m11 - m22, m21 + m12, m02 - m20]
        } else {
            [m20 + m02, m21 + m12, 1.0 - m00 - m11 + m22, m10 - m01]
        };
        let norm = libm::sqrtf(q.iter().map(|c| c * c).sum());
        let scale = if q[3] < 0.0 { -norm } else { norm };
        if norm > 0.0 {
            q.map(|c| c / scale)
        } else {
            [0.0, 0.0, 0.0, 1.0]
        }
    }

    /// The pose after a rotation about the head's origin (rotation vector, camera axes \[rad\]) and
    /// a translation \[mm\]; the rotation stays orthonormal.
    pub(super) fn moved(&self, rotation_rad: Vec3, translation_mm: Vec3) -> Pose {
        Pose {
            rotation: orthonormal(exponential(rotation_rad) * self.rotation),
            translation_mm: self.translation_mm + translation_mm,
        }
    }

    /// Whether all numbers are finite and the head is in front of the camera, below
    /// [`FARTHEST_MM`].
    pub(super) fn is_valid(&self) -> bool {
        self.rotation.to_cols_array().iter().all(|v| v.is_finite())
            && self.translation_mm.to_array().iter().all(|v| v.is_finite())
            && self.translation_mm.z > NEAREST_MM
            && self.translation_mm.z < FARTHEST_MM
    }
}

/// Rodrigues' formula: rotation vector \[rad\] → rotation matrix. Not glam's: its sine and cosine
/// are the platform's where another crate of the program enables glam's `std`.
fn exponential(vector: Vec3) -> Mat3 {
    let angle_squared = vector.length_squared();
    let angle = libm::sqrtf(angle_squared);
    // Below 1e-3 rad the quotients lose digits: Taylor series.
    let (a, b) = if angle > 1e-3 {
        (
            libm::sinf(angle) / angle,
            (1.0 - libm::cosf(angle)) / angle_squared,
        )
    } else {
        (1.0 - angle_squared / 6.0, 0.5 - angle_squared / 24.0)
    };
    let Vec3 { x, y, z } = vector;
    let cross = Mat3::from_cols(
        Vec3::new(0.0, z, -y),
        Vec3::new(-z, 0.0, x),
        Vec3::new(y, -x, 0.0),
    );
    Mat3::IDENTITY + cross * a + cross * cross * b
}

/// Orthonormalises the columns by Gram–Schmidt.
pub(super) fn orthonormal(m: Mat3) -> Mat3 {
    let x = m.x_axis.normalize();
    let y = (m.y_axis - x * x.dot(m.y_axis)).normalize();
    Mat3::from_cols(x, y, x.cross(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_signs() {
        let camera = Intrinsics::of_frame(641, 481);
        assert_eq!(camera.project(Vec3::new(0.0, 0.0, 500.0)), [320.0, 240.0]);
        let [x, y] = camera.project(Vec3::new(10.0, 20.0, 500.0));
        assert!(x > 320.0 && y > 240.0, "x right, y down");
        // 30° from the axis is the edge of a 60° field of view.
        let edge = camera.project(Vec3::new(libm::tanf(30f32.to_radians()), 0.0, 1.0) * 100.0);
        assert!((edge[0] - 640.5).abs() < 0.1, "{edge:?}");
        assert!(camera.project(Vec3::ZERO).iter().all(|v| v.is_finite()));
    }

    #[test]
    fn gradient_matches_differences() {
        let camera = Intrinsics::of_frame(640, 480);
        let at = Vec3::new(40.0, -25.0, 430.0);
        let rows = camera.project_gradient(at);
        for (k, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            let (a, b) = (camera.project(at + axis), camera.project(at - axis));
            for (row, d) in rows.iter().zip([a[0] - b[0], a[1] - b[1]]) {
                assert!((row[k] - d / 2.0).abs() < 2e-3);
            }
        }
    }

    #[test]
    fn quaternions_rotate_as_matrices() {
        for (yaw_deg, pitch_deg, roll_deg) in [
            (0., 0., 0.),
            (80., 10., -20.),
            (-170., 30., 100.),
            (10., -80., 179.),
        ] {
            let angles = HeadAngles {
                yaw_deg,
                pitch_deg,
                roll_deg,
            };
            let pose = Pose::of_angles(angles, Vec3::Z);
            let [x, y, z, w] = pose.quaternion();
            let u = Vec3::new(x, y, z);
            let v = Vec3::new(1.0, 2.0, -3.0);
            // Hamilton: v + 2w(u × v) + 2u × (u × v)
            let turned = v + 2.0 * w * u.cross(v) + 2.0 * u.cross(u.cross(v));
            assert!((turned - pose.rotation * v).length() < 1e-4 && w >= 0.0);
        }
    }
}
