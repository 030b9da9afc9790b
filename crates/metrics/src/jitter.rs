//! How much landmarks jitter: second differences over three frames in a row, which steady motion
//! leaves at 0.

use crate::statistics::median;

/// 68 landmarks of one frame \[px\].
pub type Shape = [[f64; 2]; 68];

/// The second difference of each landmark (frame before, this, next), times `scale`.
pub fn second_difference([a, b, c]: [&Shape; 3], scale: f64) -> Shape {
    std::array::from_fn(|i| [0, 1].map(|k| (a[i][k] - 2.0 * b[i][k] + c[i][k]) * scale))
}

/// The median over landmarks of their r.m.s. length; `None` of no frames.
pub fn landmark_jitter(differences: &[Shape]) -> Option<f64> {
    let rms = |i: usize| {
        let squares = differences
            .iter()
            .map(|d| d[i][0].powi(2) + d[i][1].powi(2));
        (squares.sum::<f64>() / differences.len() as f64).sqrt()
    };
    let values: [f64; 68] = std::array::from_fn(rms);
    median(&values).filter(|v| v.is_finite())
}

/// The part of the displacements that one similarity of the shape explains, by least squares.
pub fn common_motion(shape: &Shape, displacements: &Shape) -> Shape {
    let mean = |of: &Shape| [0, 1].map(|k| of.iter().map(|p| p[k]).sum::<f64>() / 68.0);
    let (centre, shift) = (mean(shape), mean(displacements));
    let at = shape.map(|p| [p[0] - centre[0], p[1] - centre[1]]);
    let extent: f64 = at.iter().map(|p| p[0] * p[0] + p[1] * p[1]).sum();
    let pairs = || at.iter().zip(displacements);
    let grow = pairs().map(|(p, d)| p[0] * d[0] + p[1] * d[1]).sum::<f64>() / extent.max(1e-9);
    let turn = pairs().map(|(p, d)| p[0] * d[1] - p[1] * d[0]).sum::<f64>() / extent.max(1e-9);
    at.map(|[x, y]| {
        [
            shift[0] + grow * x - turn * y,
            shift[1] + grow * y + turn * x,
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Shape {
        std::array::from_fn(|i| {
            let (sin, cos) = (i as f64).sin_cos();
            [100.0 + 30.0 * cos, 80.0 + 20.0 * sin]
        })
    }

    #[test]
    fn steady_motion_does_not_jitter() {
        let at = |dx: f64| ring().map(|[x, y]| [x + dx, y]);
        let steady = second_difference([&at(0.0), &at(2.0), &at(4.0)], 1.0);
        assert!(landmark_jitter(&[steady]).expect("a frame") < 1e-9);
        let shaken = second_difference([&at(0.0), &at(2.0), &at(0.0)], 0.5);
        assert!((landmark_jitter(&[shaken]).expect("a frame") - 2.0).abs() < 1e-9);
        assert_eq!(landmark_jitter(&[]), None);
    }

    #[test]
    fn a_similarity_is_common_motion() {
        let shape = ring();
        let moved = shape.map(|[x, y]| [0.1 * x - 0.02 * y + 3.0, 0.1 * y + 0.02 * x - 1.0]);
        for (common, d) in common_motion(&shape, &moved).iter().zip(moved) {
            assert!((common[0] - d[0]).hypot(common[1] - d[1]) < 1e-9);
        }
    }
}
