//! Errors of 68 landmarks by the units that papers use.

use posewise_metrics::landmarks::{bounds, distance, nme_percent};

/// 68 landmarks \[px\].
pub type Points = [[f64; 2]; 68];

/// First landmark that is not on the jaw.
pub const INNER: usize = 17;

/// Distance of the outer eye corners.
pub fn outer_corners(label: &Points) -> f64 {
    distance(label[36], label[45])
}

/// Distance of the pupils: the mean points of the eyes.
pub fn pupils(label: &Points) -> f64 {
    let centre = |from: usize| {
        let sum = |k: usize| label[from..from + 6].iter().map(|p| p[k]).sum::<f64>();
        [sum(0) / 6.0, sum(1) / 6.0]
    };
    distance(centre(36), centre(42))
}

/// Root of the area of the labels' box.
pub fn box_size(label: &Points) -> f64 {
    let [left, top, right, bottom] = bounds(label);
    ((right - left) * (bottom - top)).sqrt()
}

/// NME \[%\] from landmark `from` on.
pub fn nme(label: &Points, found: &Points, from: usize, unit: f64) -> f64 {
    let pairs = label.iter().copied().zip(found.iter().copied());
    nme_percent(pairs.skip(from), unit.max(f64::MIN_POSITIVE))
}
