//! Head rotations in the angle conventions of the data sets.
//!
//! R is the head-to-camera rotation of docs/conventions.md: x to the image right, y down, z away
//! from the camera; yaw > 0 to the image right, pitch > 0 up, roll > 0 clockwise.

use glam::{Mat3, Vec3};
use posewise::math::{HeadAngles, head_angles, head_rotation};

/// Yaw, pitch, roll \[deg\].
pub type Angles = [f64; 3];

/// Head-to-camera rotation of yaw, pitch and roll as posewise has them.
pub fn rotation([yaw, pitch, roll]: Angles) -> Mat3 {
    head_rotation(HeadAngles {
        yaw_deg: yaw as f32,
        pitch_deg: pitch as f32,
        roll_deg: roll as f32,
    })
}

/// Yaw, pitch and roll as posewise has them.
pub fn angles(rotation: &Mat3) -> Angles {
    let a = head_angles(rotation);
    [a.yaw_deg, a.pitch_deg, a.roll_deg].map(f64::from)
}

/// The rotation since a first one, in the axes of the first head.
pub fn relative(first: &Mat3, now: &Mat3) -> Angles {
    angles(&(first.transpose() * *now))
}

/// Rotation vectors a, b, c \[rad\] of R = Rx(a)·Ry(b)·Rz(c), right-handed about each axis.
fn xyz(r: &Mat3) -> [f32; 3] {
    let z = r.z_axis;
    [
        (-z.y).atan2(z.z),
        z.x.clamp(-1.0, 1.0).asin(),
        (-r.y_axis.x).atan2(r.x_axis.x),
    ]
}

/// R = Rx(a)·Ry(b)·Rz(c) \[rad\].
fn of_xyz([a, b, c]: [f32; 3]) -> Mat3 {
    Mat3::from_rotation_x(a) * Mat3::from_rotation_y(b) * Mat3::from_rotation_z(c)
}

/// From axes with y up and z towards the viewer to ours, and back.
fn flipped(r: &Mat3) -> Mat3 {
    let flip = Mat3::from_diagonal(Vec3::new(1.0, -1.0, -1.0));
    flip * *r * flip
}

/// Boston University: columns 5 to 7 of a row are roll, yaw, pitch \[deg\]; positive are
/// anticlockwise, to the image right, and down. R = Rx(pitch)·Ry(−yaw)·Rz(−roll).
///
/// Source of order and signs: the evaluation scripts of OpenFace, which compare with them.
pub fn of_boston([roll, yaw, pitch]: [f64; 3]) -> Mat3 {
    of_xyz([pitch, -yaw, -roll].map(|a| a.to_radians() as f32))
}

/// AFLW2000-3D, as 300W-LP: `Pose_Para` begins with pitch, yaw, roll \[rad\], left-handed about x
/// right, y up, z towards the viewer, R = Rx·Ry·Rz; positive are up, to the image left, clockwise.
pub fn of_aflw([pitch, yaw, roll]: [f64; 3]) -> Mat3 {
    flipped(&of_xyz([pitch, yaw, roll].map(|a| -a as f32)))
}

/// Yaw, pitch, roll \[deg\] in the convention of [`of_aflw`].
pub fn aflw(r: &Mat3) -> Angles {
    let [pitch, yaw, roll] = xyz(&flipped(r)).map(|a| f64::from(-a).to_degrees());
    [yaw, pitch, roll]
}

/// BIWI: its matrices have our axes. Yaw, pitch, roll \[deg\] by the formulas that papers since
/// Hopenet (Ruiz et al. 2018) evaluate with; positive yaw is to the image left.
pub fn biwi(r: &Mat3) -> Angles {
    let z = r.z_axis;
    let yaw = z.x.atan2(z.y.hypot(z.z));
    let pitch = z.y.atan2(z.z);
    let roll = (-r.y_axis.x).atan2(r.x_axis.x);
    [yaw, pitch, roll].map(|a| f64::from(a).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Angles, b: Angles) {
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-3, "{a:?} {b:?}");
    }

    /// Where the tip of the nose and the crown point to in the image.
    fn directions(r: &Mat3) -> (Vec3, Vec3) {
        (*r * Vec3::NEG_Z, *r * Vec3::NEG_Y)
    }

    #[test]
    fn signs_of_single_rotations() {
        let (nose, _) = directions(&of_boston([0.0, 30.0, 0.0]));
        assert!(
            (nose.x - 0.5).abs() < 1e-6,
            "Boston: yaw to the image right"
        );
        let (nose, _) = directions(&of_boston([0.0, 0.0, 30.0]));
        assert!((nose.y - 0.5).abs() < 1e-6, "Boston: pitch down");
        let (_, crown) = directions(&of_boston([30.0, 0.0, 0.0]));
        assert!((crown.x + 0.5).abs() < 1e-6, "Boston: roll anticlockwise");
        let angle = 30f64.to_radians();
        let (nose, _) = directions(&of_aflw([0.0, angle, 0.0]));
        assert!((nose.x + 0.5).abs() < 1e-6, "AFLW: yaw to the image left");
        let (nose, _) = directions(&of_aflw([angle, 0.0, 0.0]));
        assert!((nose.y + 0.5).abs() < 1e-6, "AFLW: pitch up");
        let (_, crown) = directions(&of_aflw([0.0, 0.0, angle]));
        assert!((crown.x - 0.5).abs() < 1e-6, "AFLW: roll clockwise");
        for (ours, theirs) in [
            ([20.0, 0.0, 0.0], [-20.0, 0.0, 0.0]),
            ([0.0, 20.0, 0.0], [0.0, 20.0, 0.0]),
            ([0.0, 0.0, 20.0], [0.0, 0.0, 20.0]),
        ] {
            near(biwi(&rotation(ours)), theirs);
            near(aflw(&rotation(ours)), theirs);
        }
    }

    #[test]
    fn conversions_are_inverse() {
        for [yaw, pitch, roll] in [[0.0; 3], [50.0, -20.0, 10.0], [-70.0, 30.0, -40.0]] {
            let of = of_aflw([pitch, yaw, roll].map(f64::to_radians));
            near(aflw(&of), [yaw, pitch, roll]);
            let ours = rotation([yaw, pitch, roll]);
            near(angles(&ours), [yaw, pitch, roll]);
            near(relative(&ours, &ours), [0.0; 3]);
        }
    }
}
