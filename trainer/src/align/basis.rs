//! The space of shapes: mean, similarity, and principal modes.

use crate::faces::Face;
use faer::Mat;
use posewise::align::{Shape, mirror};
use posewise::math::Similarity;
use posewise::shape::LANDMARKS;

/// Coordinates of a shape.
pub const COORDINATES: usize = 2 * LANDMARKS;

/// Inter-ocular distance of the mean shape: the canonical unit is then about a pixel of a crop in
/// which a face's box is 64 px wide.
const INTER_OCULAR: f32 = 36.0;

/// Mean shape and orthonormal basis in the canonical frame.
pub struct Basis {
    /// Mean shape, centred, upright.
    pub mean: Shape,
    /// Rows of [`COORDINATES`]: the similarity's four, then modes by falling variance.
    pub rows: Vec<Vec<f32>>,
    /// Standard deviation of the training shapes along each row (0 for the similarity's).
    pub deviation: Vec<f32>,
}

/// Coordinates as one vector.
pub fn flat(shape: &Shape) -> Vec<f32> {
    shape.iter().flatten().copied().collect()
}

impl Basis {
    /// Generalised Procrustes mean and `modes` principal modes of the faces' shapes.
    pub fn fit(faces: &[Face], modes: usize) -> Basis {
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
            // Its own mirror image, because left-turned faces are seen in a mirror.
            let other = mirror(&mean);
            mean = std::array::from_fn(|i| {
                let (p, q) = (mean[i], other[i]);
                [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0]
            });
            normalise(&mut mean);
        }
        let mut rows = similarity_rows(&mean);
        let mut covariance = Mat::<f64>::zeros(COORDINATES, COORDINATES);
        let mut total = 0.0;
        for face in faces {
            let mut d = flat(&align(&face.landmarks, &mean));
            d.iter_mut().zip(flat(&mean)).for_each(|(d, m)| *d -= m);
            for row in &rows {
                let dot: f32 = row.iter().zip(&d).map(|(a, b)| a * b).sum();
                d.iter_mut().zip(row).for_each(|(d, r)| *d -= dot * r);
            }
            total += face.weight as f64;
            for i in 0..COORDINATES {
                for j in 0..COORDINATES {
                    covariance[(i, j)] += (d[i] * d[j] * face.weight) as f64;
                }
            }
        }
        let eigen = covariance
            .self_adjoint_eigen(faer::Side::Lower)
            .expect("finite covariance");
        let mut deviation = vec![0.0; rows.len()];
        // Eigenvalues come in rising order.
        for k in (0..COORDINATES).rev().take(modes) {
            rows.push((0..COORDINATES).map(|i| eigen.U()[(i, k)] as f32).collect());
            deviation.push((eigen.S()[k].max(0.0) / total).sqrt() as f32);
        }
        Basis {
            mean,
            rows,
            deviation,
        }
    }

    /// The part of a canonical displacement that the basis spans.
    pub fn project(&self, displacement: &[f32]) -> Vec<f32> {
        let dot = |row: &Vec<f32>| row.iter().zip(displacement).map(|(a, b)| a * b).sum();
        self.rows.iter().map(dot).collect()
    }
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

/// Scale, rotation, shift along x and y: orthonormal because the mean is centred.
fn similarity_rows(mean: &Shape) -> Vec<Vec<f32>> {
    let norm = flat(mean).iter().map(|v| v * v).sum::<f32>().sqrt();
    let one = 1.0 / (LANDMARKS as f32).sqrt();
    let make = |f: &dyn Fn([f32; 2]) -> [f32; 2]| flat(&mean.map(f));
    vec![
        make(&|[x, y]| [x / norm, y / norm]),
        make(&|[x, y]| [-y / norm, x / norm]),
        make(&|_| [one, 0.0]),
        make(&|_| [0.0, one]),
    ]
}
