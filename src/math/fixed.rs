//! Scalar functions.

/// Integer square root, rounded down.
pub fn isqrt(value: u32) -> u32 {
    value.isqrt()
}

/// Logistic function, 0..1. The argument is clamped to ±30, where `f32` has reached 0 and 1.
pub fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + libm::expf(-x.clamp(-30.0, 30.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values() {
        assert_eq!(
            (isqrt(0), isqrt(15), isqrt(16), isqrt(u32::MAX)),
            (0, 3, 4, 65_535)
        );
        assert_eq!(sigmoid(0.0), 0.5);
        assert!(sigmoid(1e9) <= 1.0 && sigmoid(-1e9) >= 0.0);
    }
}
