//! The rotation between two sets of points.

use glam::{Mat3, Vec3};
use nalgebra::Matrix3;

/// Points turned and moved as some others are so that they come nearest to what they belong to.
pub fn moved_onto(from: &[Vec3], to: &[Vec3], points: &[Vec3]) -> Vec<Vec3> {
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / points.len().max(1) as f32;
    let (turn, from_mean, to_mean) = (rotation_onto(from, to), mean(from), mean(to));
    let moved = |p: &Vec3| turn * (*p - from_mean) + to_mean;
    points.iter().map(moved).collect()
}

/// The rotation that brings points nearest to others, both about their means (Kabsch 1976).
pub fn rotation_onto(from: &[Vec3], to: &[Vec3]) -> Mat3 {
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / points.len().max(1) as f32;
    let (from_mean, to_mean) = (mean(from), mean(to));
    let mut sum = Matrix3::<f32>::zeros();
    for (a, b) in from.iter().zip(to) {
        let (a, b) = (*a - from_mean, *b - to_mean);
        sum += nalgebra::Vector3::from(b.to_array())
            * nalgebra::Vector3::from(a.to_array()).transpose();
    }
    let svd = sum.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else {
        return Mat3::IDENTITY;
    };
    let sign = (u * v).determinant().signum();
    let turn = u * Matrix3::from_diagonal(&nalgebra::Vector3::new(1.0, 1.0, sign)) * v;
    Mat3::from_cols_slice(turn.as_slice())
}
