//! The mean shape, which fixes the canonical frame.

use crate::faces::Face;
use posewise::align::{Shape, mirror};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;

/// Inter-ocular distance of the mean shape: the canonical unit is then about a pixel of a crop in
/// which a face's box is 64 px wide.
const INTER_OCULAR: f32 = 36.0;

/// Generalised Procrustes mean of the faces' shapes, centred, upright, its own mirror image.
pub fn mean_shape(faces: &[Face]) -> Shape {
    let mut mean = faces[0].landmarks;
    normalise(&mut mean);
    for _ in 0..5 {
        let mut sum = [[0.0f64; 2]; LANDMARKS];
        let mut total = 0.0;
        for face in faces {
            let aligned = align(&face.landmarks, &mean);
            total += face.weight as f64;
            for (s, p) in sum.iter_mut().zip(&aligned) {
                s[0] += p[0] as f64 * face.weight as f64;
                s[1] += p[1] as f64 * face.weight as f64;
            }
        }
        mean = sum.map(|[x, y]| [(x / total) as f32, (y / total) as f32]);
        let other = mirror(&mean);
        mean = std::array::from_fn(|i| {
            let (p, q) = (mean[i], other[i]);
            [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0]
        });
        normalise(&mut mean);
    }
    mean
}

/// `shape` brought to `to` by a similarity.
pub fn align(shape: &Shape, to: &Shape) -> Shape {
    let similarity = Similarity::fit(shape, to).expect("a face has extent");
    shape.map(|p| similarity.apply(p))
}

/// Centred, outer eye corners level and [`INTER_OCULAR`] apart.
fn normalise(shape: &mut Shape) {
    let (right, left) = (shape[36], shape[45]);
    let target = [[-INTER_OCULAR / 2.0, 0.0], [INTER_OCULAR / 2.0, 0.0]];
    let similarity = Similarity::fit(&[right, left], &target).expect("eyes are apart");
    let mut turned = shape.map(|p| similarity.apply(p));
    let n = LANDMARKS as f32;
    let centre = turned
        .iter()
        .fold([0.0, 0.0], |c, p| [c[0] + p[0] / n, c[1] + p[1] / n]);
    turned
        .iter_mut()
        .for_each(|p| *p = [p[0] - centre[0], p[1] - centre[1]]);
    *shape = turned;
}
