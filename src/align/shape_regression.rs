//! The last step of the cascade: a linear regression of each landmark on the whole shape.
//!
//! Features around one landmark carry no information on the error of the others. Here each landmark
//! moves by a linear function of all landmarks, trained on the results of the earlier stages on
//! labelled faces: a well placed nose corrects the jaw (correlative regression, thesis 5.1).

use super::shape::Shape;
use crate::math::{Similarity, dot};
use crate::shape::LANDMARKS;
use posewise_format::{Blob, ModelError};

/// Number of coordinates of a shape.
const COORDINATES: usize = 2 * LANDMARKS;

/// A checked view of section `SREG`.
#[derive(Clone, Copy, Debug)]
pub struct ShapeRegression<'m> {
    /// 136 rows, one per output coordinate, of 136 weights, one per input coordinate; both in the
    /// order `x0, y0, …, x67, y67`.
    weights: &'m [i8],
    /// Value of weight 1 of each row.
    scale: &'m [f32],
    /// Constant displacement of each coordinate \[canonical units\].
    bias: &'m [f32],
}

impl<'m> ShapeRegression<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"SREG";

    /// Reads and checks the section: `weights: i8[136·136], scale: f32[136], bias: f32[136]`.
    /// `None` where the model lacks it.
    ///
    /// # Errors
    /// When the section is too short or a number is out of range.
    pub fn open(blob: &Blob<'m>) -> Result<Option<Self>, ModelError> {
        let mut s = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(None),
            other => other?,
        };
        Ok(Some(ShapeRegression {
            weights: s.i8s(COORDINATES * COORDINATES)?,
            scale: s.f32s(COORDINATES)?,
            bias: s.f32s(COORDINATES)?,
        }))
    }

    /// Moves the landmarks of `shape` (frame px) by `bias + scale·weights·(shape − mean)`, computed
    /// in the canonical frame. Does nothing when the shape has no extent.
    pub fn run(&self, mean: &Shape, shape: &mut Shape) {
        let Some((to_frame, deviation)) = deviation(mean, shape) else {
            return;
        };
        let rows = self.weights.chunks_exact(COORDINATES);
        let mut rows = rows.zip(self.scale).zip(self.bias);
        let mut next = || {
            rows.next().map_or(0.0, |((row, scale), bias)| {
                let mut weights = [0.0; COORDINATES];
                weights
                    .iter_mut()
                    .zip(row)
                    .for_each(|(w, v)| *w = f32::from(*v));
                bias + scale * dot(&weights, deviation.as_flattened())
            })
        };
        for p in shape {
            let [x, y] = to_frame.apply_vector([next(), next()]);
            *p = [p[0] + x, p[1] + y];
        }
    }
}

/// The similarity transform canonical frame → frame px that fits the mean shape to `shape` (frame
/// px), and `shape − mean` in the canonical frame. `None` when the shape has no extent.
pub fn deviation(mean: &Shape, shape: &Shape) -> Option<(Similarity, Shape)> {
    let to_frame = Similarity::fit(mean, shape)?;
    let to_canonical = to_frame.inverse()?;
    let mut deviation = *shape;
    for (p, m) in deviation.iter_mut().zip(mean) {
        let [x, y] = to_canonical.apply(*p);
        *p = [x - m[0], y - m[1]];
    }
    Some((to_frame, deviation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_moves_its_coordinate_in_the_canonical_frame() {
        let mean: Shape = core::array::from_fn(|i| [(i % 9) as f32, (i / 9) as f32]);
        let mut weights = [0i8; COORDINATES * COORDINATES];
        // Landmark 1 moves in y by half of the deviation of landmark 0 in x.
        weights[3 * COORDINATES] = 64;
        let mut bias = [0.0; COORDINATES];
        bias[0] = 0.25;
        let regression = ShapeRegression {
            weights: &weights,
            scale: &[1.0 / 128.0; COORDINATES],
            bias: &bias,
        };
        // Rotated by 90°, at twice the size.
        let turned = |[x, y]: [f32; 2]| [-2.0 * y + 50.0, 2.0 * x];
        let mut shape = mean.map(turned);
        shape[0][1] += 1.0;
        let (_, deviation) = deviation(&mean, &shape).unwrap();
        let before = shape;
        regression.run(&mean, &mut shape);
        let moved = |i: usize| [shape[i][0] - before[i][0], shape[i][1] - before[i][1]];
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 0.01;
        assert!(deviation[0][0] > 0.4, "{deviation:?}");
        assert!(near(moved(0), [0.0, 0.5]), "{:?}", moved(0));
        assert!(near(moved(1), [-deviation[0][0], 0.0]), "{:?}", moved(1));
        assert!(near(moved(2), [0.0; 2]));
        let mut point = [[3.0, 3.0]; LANDMARKS];
        regression.run(&mean, &mut point);
        assert!(point.iter().all(|p| p[0].is_finite()));
    }
}
