//! 2D similarity transforms: rotation, uniform scale and translation.

/// (x, y) ↦ (a·x − b·y + tx, b·x + a·y + ty); a = s·cos θ, b = s·sin θ, θ > 0 clockwise on screen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the formula above defines them
pub struct Similarity {
    pub a: f32,
    pub b: f32,
    pub tx: f32,
    pub ty: f32,
}

impl Similarity {
    /// The identity.
    pub const IDENTITY: Similarity = Similarity {
        a: 1.0,
        b: 0.0,
        tx: 0.0,
        ty: 0.0,
    };

    /// The image of a point.
    #[inline]
    pub fn apply(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [
            self.a * x - self.b * y + self.tx,
            self.b * x + self.a * y + self.ty,
        ]
    }

    /// The image of a vector: rotated and scaled, not translated.
    #[inline]
    pub fn apply_vector(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [self.a * x - self.b * y, self.b * x + self.a * y]
    }

    /// The uniform scale.
    pub fn scale(&self) -> f32 {
        libm::sqrtf(self.a * self.a + self.b * self.b)
    }

    /// The rotation \[rad\], clockwise on screen, −π..π.
    pub fn angle(&self) -> f32 {
        libm::atan2f(self.b, self.a)
    }

    /// The composition: first `self`, then `next`.
    pub fn then(&self, next: &Similarity) -> Similarity {
        let [tx, ty] = next.apply([self.tx, self.ty]);
        let [a, b] = next.apply_vector([self.a, self.b]);
        Similarity { a, b, tx, ty }
    }

    /// The inverse; `None` when the scale is zero or not finite.
    pub fn inverse(&self) -> Option<Similarity> {
        let det = self.a * self.a + self.b * self.b;
        if !(det.is_finite() && det > 1e-12) {
            return None;
        }
        let (a, b) = (self.a / det, -self.b / det);
        let linear = Similarity {
            a,
            b,
            tx: 0.0,
            ty: 0.0,
        };
        let [tx, ty] = linear.apply_vector([-self.tx, -self.ty]);
        Some(Similarity { a, b, tx, ty })
    }

    /// The least-squares similarity transform from `from` to `to`, paired in order (Umeyama, PAMI
    /// 1991, in two dimensions). `None` when the points of `from` coincide or are not finite.
    pub fn fit(from: &[[f32; 2]], to: &[[f32; 2]]) -> Option<Similarity> {
        let n = from.len().min(to.len());
        if n == 0 {
            return None;
        }
        let mean = |points: &[[f32; 2]]| {
            let (x, y) = points
                .iter()
                .take(n)
                .fold((0.0, 0.0), |(x, y), p| (x + p[0], y + p[1]));
            [x / n as f32, y / n as f32]
        };
        let (from_mean, to_mean) = (mean(from), mean(to));
        let (mut dot, mut cross, mut norm) = (0.0f32, 0.0f32, 0.0f32);
        for (p, q) in from.iter().zip(to) {
            let (px, py) = (p[0] - from_mean[0], p[1] - from_mean[1]);
            let (qx, qy) = (q[0] - to_mean[0], q[1] - to_mean[1]);
            dot += px * qx + py * qy;
            cross += px * qy - py * qx;
            norm += px * px + py * py;
        }
        if !(norm.is_finite() && norm > 1e-12) {
            return None;
        }
        let linear = Similarity {
            a: dot / norm,
            b: cross / norm,
            tx: 0.0,
            ty: 0.0,
        };
        let [x, y] = linear.apply_vector(from_mean);
        Some(Similarity {
            tx: to_mean[0] - x,
            ty: to_mean[1] - y,
            ..linear
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_then_inverse_round_trips() {
        let truth = Similarity {
            a: 1.2,
            b: -0.7,
            tx: 30.0,
            ty: -4.0,
        };
        let from = [[0.0, 0.0], [10.0, 0.0], [3.0, 8.0]];
        let to = from.map(|p| truth.apply(p));
        let fit = Similarity::fit(&from, &to).unwrap();
        let back = fit.then(&fit.inverse().unwrap());
        for (p, q) in from.iter().zip(&to) {
            let r = fit.apply(*p);
            assert!((r[0] - q[0]).abs() < 1e-4 && (r[1] - q[1]).abs() < 1e-4);
            let p2 = back.apply(*p);
            assert!((p2[0] - p[0]).abs() < 1e-4 && (p2[1] - p[1]).abs() < 1e-4);
        }
        assert!(Similarity::fit(&[[1.0, 1.0]; 3], &to).is_none());
        assert!(
            Similarity {
                a: 0.0,
                b: 0.0,
                tx: 1.0,
                ty: 1.0
            }
            .inverse()
            .is_none()
        );
    }
}
