//! Lenses for tests, the unit tests of `src/shape/distortion.rs` too. The including module has
//! `Distortion` in scope.

use super::Distortion;

/// A lens with a horizontal field of view of 120°.
pub const WIDE: Distortion = Distortion::BrownConrady {
    k1: -0.12,
    k2: 0.012,
    p1: 0.001,
    p2: -0.0007,
    k3: -0.0004,
};

/// A fisheye with a horizontal field of view of 120°.
pub const FISHEYE: Distortion = Distortion::KannalaBrandt {
    k1: -0.02,
    k2: 0.004,
    k3: -0.003,
    k4: 0.0005,
};
