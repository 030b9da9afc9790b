//! Writes section `FACE`: what of the head the tracker needs, quantised.

use crate::head::{Head, outward};
use anyhow::{Result, ensure};
use nalgebra::{DMatrix, SymmetricEigen};
use posewise::shape::{
    FACE_TAG, FITTED_NAMES, FaceModel, Identity, JAW, LANDMARKS, MAX_EXTRA, MAX_IDENTITIES,
};
use posewise_format::{Blob, SectionWriter};

mod visibility;

/// Identity modes kept: what is left out moves a landmark by a fraction of the label noise.
const IDENTITIES: usize = 28;

/// Weight of a contour candidate beside a landmark's 1 when modes are chosen.
const CANDIDATE_WEIGHT: f64 = 0.3;

/// Displacements of every point, in its order.
pub type Mode = Vec<[f32; 3]>;

/// A head cut down to landmarks and contour candidates.
struct Points {
    /// Vertex of each point: landmarks, then the extra candidates in jaw order.
    vertices: Vec<u32>,
    /// Extra candidates of each jaw landmark.
    extra: [u8; JAW],
}

impl Points {
    fn of(head: &Head) -> Points {
        let mut vertices = head.landmarks.to_vec();
        let extra = std::array::from_fn(|i| {
            let path = head.jaw[i].get(1..).unwrap_or(&[]);
            let path = &path[..path.len().min(MAX_EXTRA)];
            vertices.extend(path);
            path.len() as u8
        });
        Points { vertices, extra }
    }

    /// The landmark of each point.
    fn landmarks(&self) -> impl Iterator<Item = usize> {
        let extra = (0..JAW).flat_map(|i| std::iter::repeat_n(i, self.extra[i].into()));
        (0..LANDMARKS).chain(extra)
    }

    fn pick(&self, values: &[[f32; 3]]) -> Mode {
        self.vertices.iter().map(|v| values[*v as usize]).collect()
    }
}

/// The 3D face of a model.
pub fn open<'m>(model: &Blob<'m>) -> Result<FaceModel<'m>> {
    Ok(FaceModel::open(model.section(&FACE_TAG)?)?)
}

/// The section for a head. Points are displaced from the head's by `offsets_mm` (68, head frame:
/// where the photographs' labels sit against the head's vertices) when given.
pub fn face_section(head: &Head, offsets_mm: Option<&[[f32; 3]]>) -> Result<SectionWriter> {
    let points = Points::of(head);
    let mut mean = points.pick(&head.mean);
    for (p, landmark) in mean.iter_mut().zip(points.landmarks()) {
        let offset = offsets_mm.map_or([0.0; 3], |all| all[landmark]);
        (0..3).for_each(|k| p[k] += offset[k]);
    }
    let modes: Vec<Mode> = head.identity.iter().map(|m| points.pick(m)).collect();
    let identity: Vec<Mode> = identity_directions(head)
        .iter()
        .map(|d| combined(&modes, d))
        .collect();
    let animation: Vec<Mode> = head
        .animation
        .iter()
        .map(|index| match index {
            Some(index) => points.pick(&head.expressions[*index].delta),
            None => vec![[0.0; 3]; mean.len()],
        })
        .collect();
    let landmarks: [[f32; 3]; LANDMARKS] = std::array::from_fn(|i| mean[i]);
    ensure!(
        mean.as_flattened().iter().all(|v| v.is_finite()),
        "the mean is not finite"
    );

    let mut section = SectionWriter::new(FACE_TAG);
    section
        .scalar(mean.len() as u32)
        .scalar(identity.len() as u32)
        .array(&points.extra)
        .array(mean.as_flattened());
    write_modes(&mut section, &identity, mean.len());
    write_modes(&mut section, &animation, mean.len());
    section
        .array(outward(&landmarks).as_flattened())
        .array(&noise_mm())
        .array(&FITTED_NAMES.map(animation_sigma))
        .array(&visibility::table(head));
    Ok(section)
}

/// Scales, then the displacements in scales, point by point.
fn write_modes(section: &mut SectionWriter, modes: &[Mode], points: usize) {
    let (scales, quantised) = quantised(modes);
    let by_point = (0..points).flat_map(|point| quantised.iter().flat_map(move |m| m[point]));
    let by_point: Vec<i8> = by_point.collect();
    section.array(&scales).array(&by_point);
}

/// The scale of each mode, and its displacements in scales.
pub fn quantised(modes: &[Mode]) -> (Vec<f32>, Vec<Vec<[i8; 3]>>) {
    let of = |mode: &Mode| {
        let largest = mode
            .as_flattened()
            .iter()
            .fold(0.0f32, |a, v| a.max(v.abs()));
        let scale = largest / 127.0;
        let step = scale.max(f32::MIN_POSITIVE);
        let deltas = mode.iter().map(|d| d.map(|v| (v / step).round() as i8));
        (scale, deltas.collect())
    };
    modes.iter().map(of).unzip()
}

/// Directions in the space of the modes along which the points vary most, strongest first. The
/// modes are per standard deviation and independent, so rotations of them are too.
fn principal(modes: &[Mode], count: usize) -> Vec<Vec<f32>> {
    let n = modes.len();
    let weight = |point: usize| {
        if point < LANDMARKS {
            1.0
        } else {
            CANDIDATE_WEIGHT
        }
    };
    let dot = |a: &Mode, b: &Mode| -> f64 {
        let points = a.iter().zip(b).enumerate();
        points
            .map(|(i, (a, b))| weight(i) * (0..3).map(|k| (a[k] * b[k]) as f64).sum::<f64>())
            .sum()
    };
    let gram = DMatrix::from_fn(n, n, |i, j| dot(&modes[i], &modes[j]));
    let eigen = SymmetricEigen::new(gram);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let directions = order
        .iter()
        .take(count)
        .map(|k| eigen.eigenvectors.column(*k));
    directions
        .map(|d| d.iter().map(|v| *v as f32).collect())
        .collect()
}

/// The mode along a direction.
pub fn combined(modes: &[Mode], direction: &[f32]) -> Mode {
    let mut sum = vec![[0.0; 3]; modes.first().map_or(0, Vec::len)];
    for (mode, d) in modes.iter().zip(direction) {
        for (s, v) in sum.iter_mut().zip(mode) {
            (0..3).for_each(|k| s[k] += d * v[k]);
        }
    }
    sum
}

/// The section's identity modes as combinations of the head's, strongest first.
pub fn identity_directions(head: &Head) -> Vec<Vec<f32>> {
    let points = Points::of(head);
    let modes: Vec<Mode> = head.identity.iter().map(|m| points.pick(m)).collect();
    principal(&modes, IDENTITIES.min(MAX_IDENTITIES))
}

/// The head's own identity weights of weights in the section's modes.
pub fn head_identity(directions: &[Vec<f32>], weights: &Identity) -> Vec<f32> {
    let mut out = vec![0.0; directions.first().map_or(0, Vec::len)];
    for (direction, w) in directions.iter().zip(weights) {
        out.iter_mut().zip(direction).for_each(|(o, d)| *o += w * d);
    }
    out
}

/// Vertex of each point of the section: landmarks, then contour candidates.
pub fn point_vertices(head: &Head) -> Vec<u32> {
    Points::of(head).vertices
}

/// Standard deviation of a good alignment's landmarks, as a length on the face \[mm\]: about
/// 2.5 % of the 64 mm between the eyes, more along brows and jaw where the eye finds no corner.
fn noise_mm() -> [f32; LANDMARKS] {
    std::array::from_fn(|i| match i {
        0..17 => 4.0,
        17..27 => 2.5,
        _ => 1.8,
    })
}

/// Standard deviation of an animation weight over faces in daily life.
fn animation_sigma(name: &str) -> f32 {
    match name {
        "eyeBlinkLeft" | "eyeBlinkRight" => 0.4,
        "jawOpen" => 0.25,
        "mouthSmileLeft" | "mouthSmileRight" => 0.35,
        "jawLeft" | "jawRight" => 0.1,
        _ => 0.25,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_modes_keep_the_energy() {
        // Two independent displacements of 68 points along x and y, and their half.
        let mode = |x, y| vec![[x, y, 0.0f32]; LANDMARKS];
        let modes = [mode(1.0, 0.0), mode(0.0, 2.0), mode(0.5, 0.0)];
        let kept: Vec<Mode> = principal(&modes, 2)
            .iter()
            .map(|d| combined(&modes, d))
            .collect();
        let energy = |m: &Mode| m.as_flattened().iter().map(|v| v * v).sum::<f32>();
        assert!((energy(&kept[0]) - 4.0 * 68.0).abs() < 0.1);
        assert!((energy(&kept[1]) - 1.25 * 68.0).abs() < 0.1);
    }
}
