//! The last step of the cascade: all landmarks together correct each of them.
//!
//! What a stage reads around a landmark cannot tell it that the others disagree. Here each landmark
//! moves by a linear map of the whole shape, learnt from where the stages before it end on labelled
//! faces: a nose well placed corrects the jaw (correlative regression, thesis 5.1).

use super::Shape;
use crate::math::Similarity;
use crate::model::{Blob, ModelError};
use crate::shape::LANDMARKS;

/// Coordinates of a shape.
const COORDINATES: usize = 2 * LANDMARKS;

/// Section `SREG`, checked.
#[derive(Clone, Copy, Debug)]
pub struct ShapeRegression<'m> {
    /// A row of `x0, y0, …, x67, y67` for each coordinate in the same order.
    weights: &'m [i8],
    /// Of each row.
    scale: &'m [f32],
    /// Canonical units.
    bias: &'m [f32],
}

impl<'m> ShapeRegression<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"SREG";

    /// Reads and checks the section: `weights: i8[136·136], scale, bias: f32[136]`; `None` where the
    /// model lacks it.
    ///
    /// # Errors
    /// When it is too short or a number is not finite.
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

    /// Moves the points of a shape (frame px) by `bias + scale·weights·(shape − mean)`, all in the
    /// canonical frame, which the mean shape places over the other.
    pub fn run(&self, mean: &Shape, shape: &mut Shape) {
        let Some((to_frame, off)) = deviation(mean, shape) else {
            return;
        };
        let rows = self.weights.chunks_exact(COORDINATES);
        let mut rows = rows.zip(self.scale).zip(self.bias);
        let mut next = || {
            rows.next().map_or(0.0, |((row, scale), bias)| {
                let pairs = row.iter().zip(off.as_flattened());
                bias + scale * pairs.map(|(w, v)| f32::from(*w) * v).sum::<f32>()
            })
        };
        for p in shape {
            let [x, y] = to_frame.apply_vector([next(), next()]);
            *p = [p[0] + x, p[1] + y];
        }
    }
}

/// Canonical frame → frame px for a shape, and the shape's distance from the mean in the canonical
/// frame; `None` when it has no extent.
pub fn deviation(mean: &Shape, shape: &Shape) -> Option<(Similarity, Shape)> {
    let to_frame = Similarity::fit(mean, shape)?;
    let back = to_frame.inverse()?;
    let mut off = *shape;
    for (p, m) in off.iter_mut().zip(mean) {
        let [x, y] = back.apply(*p);
        *p = [x - m[0], y - m[1]];
    }
    Some((to_frame, off))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_moves_its_coordinate_in_the_canonical_frame() {
        let mean: Shape = core::array::from_fn(|i| [(i % 9) as f32, (i / 9) as f32]);
        let mut weights = [0i8; COORDINATES * COORDINATES];
        // y of landmark 1 by half of what x of landmark 0 is off.
        weights[3 * COORDINATES] = 64;
        let mut bias = [0.0; COORDINATES];
        bias[0] = 0.25;
        let correction = ShapeRegression {
            weights: &weights,
            scale: &[1.0 / 128.0; COORDINATES],
            bias: &bias,
        };
        // A quarter turn, twice as large.
        let turned = |[x, y]: [f32; 2]| [-2.0 * y + 50.0, 2.0 * x];
        let mut shape = mean.map(turned);
        shape[0][1] += 1.0;
        let (_, off) = deviation(&mean, &shape).unwrap();
        let before = shape;
        correction.run(&mean, &mut shape);
        let moved = |i: usize| [shape[i][0] - before[i][0], shape[i][1] - before[i][1]];
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 0.01;
        assert!(off[0][0] > 0.4, "{off:?}");
        assert!(near(moved(0), [0.0, 0.5]), "{:?}", moved(0));
        assert!(near(moved(1), [-off[0][0], 0.0]), "{:?}", moved(1));
        assert!(near(moved(2), [0.0; 2]));
        let mut point = [[3.0, 3.0]; LANDMARKS];
        correction.run(&mean, &mut point);
        assert!(point.iter().all(|p| p[0].is_finite()));
    }
}
