//! Errors of landmarks: distances over a unit, which is the distance of the outer eye corners or a
//! size that does not shorten with yaw.

use crate::statistics::mean;
use num_traits::Float;

/// The first of the 68 landmarks that is not on the jaw.
pub const INNER: usize = 17;

/// Distance of two points.
pub fn distance<T: Float>(a: [T; 2], b: [T; 2]) -> T {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of each pair of points over `unit`.
pub fn normalized_errors<T: Float, const N: usize>(
    label: &[[T; 2]; N],
    found: &[[T; 2]; N],
    unit: T,
) -> [T; N] {
    std::array::from_fn(|i| distance(label[i], found[i]) / unit)
}

/// Normalised mean error of pairs of points \[% of `unit`\]; 0 of none.
pub fn nme_percent<T: Float>(pairs: impl Iterator<Item = ([T; 2], [T; 2])>, unit: T) -> T {
    let (sum, count) = pairs
        .map(|(a, b)| distance(a, b))
        .fold((T::zero(), 0usize), |(sum, n), d| (sum + d, n + 1));
    let number = |v: usize| T::from(v).expect("a float holds every count");
    number(100) * sum / number(count.max(1)) / unit
}

/// Box of points: left, top, right, bottom.
pub fn bounds<T: Float>(points: &[[T; 2]]) -> [T; 4] {
    let (low, high) = (T::max_value(), T::min_value());
    points
        .iter()
        .fold([low, low, high, high], |[l, t, r, b], [x, y]| {
            [l.min(*x), t.min(*y), r.max(*x), b.max(*y)]
        })
}

/// Root of the area of the box around points.
pub fn box_size<T: Float>(points: &[[T; 2]]) -> T {
    let [left, top, right, bottom] = bounds(points);
    ((right - left) * (bottom - top)).sqrt()
}

/// Mean distance of the inner landmarks that are seen, over the [`box_size`] of all labels; `None`
/// when no inner landmark is seen.
pub fn seen_error(
    label: &[[f64; 2]; 68],
    seen: &[bool; 68],
    found: &[[f64; 2]; 68],
) -> Option<f64> {
    let inner = (INNER..68).filter(|i| seen[*i]);
    let distances: Vec<f64> = inner.map(|i| distance(label[i], found[i])).collect();
    mean(&distances).map(|d| d / box_size(label).max(1e-9))
}

/// Distance of the outer eye corners.
pub fn outer_corners<T: Float>(points: &[[T; 2]; 68]) -> T {
    distance(points[36], points[45])
}

/// Distance of the eyes' centres, which stand for the pupils.
pub fn eye_centres<T: Float>(points: &[[T; 2]; 68]) -> T {
    let six = T::from(6).expect("a float holds it");
    let sum = |eye: &[[T; 2]], k: usize| eye.iter().fold(T::zero(), |sum, p| sum + p[k]);
    let centre = |eye: &[[T; 2]]| [0, 1].map(|k| sum(eye, k) / six);
    distance(centre(&points[36..42]), centre(&points[42..48]))
}

/// Intersection over union of two boxes as of [`bounds`].
pub fn iou<T: Float>(a: &[T; 4], b: &[T; 4]) -> T {
    let zero = T::zero();
    let overlap = |i: usize| (a[i + 2].min(b[i + 2]) - a[i].max(b[i])).max(zero);
    let area = |c: &[T; 4]| (c[2] - c[0]).max(zero) * (c[3] - c[1]).max(zero);
    let both = overlap(0) * overlap(1);
    let least = T::from(1e-9).expect("a float holds it");
    both / (area(a) + area(b) - both).max(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_by_hand() {
        let (label, found) = ([[0.0, 0.0], [10.0, 0.0]], [[3.0, 4.0], [10.0, 1.0]]);
        assert_eq!(normalized_errors(&label, &found, 10.0), [0.5, 0.1]);
        let pairs = || label.into_iter().zip(found);
        assert_eq!(nme_percent(pairs(), 10.0), 30.0);
        assert_eq!(nme_percent(pairs().take(0), 10.0), 0.0);
    }

    #[test]
    fn only_seen_inner_landmarks_count() {
        let label = std::array::from_fn(|i| [i as f64, i as f64]);
        let found = label.map(|[x, y]: [f64; 2]| [x + if x < 30.0 { 6.7 } else { 60.0 }, y]);
        let seen = std::array::from_fn(|i| i < 30);
        let error = seen_error(&label, &seen, &found).expect("some are seen");
        assert!((error - 0.1).abs() < 1e-12, "{error}");
        assert_eq!(seen_error(&label, &[false; 68], &found), None);
    }

    #[test]
    fn eyes_by_hand() {
        let points = std::array::from_fn(|i| [i as f64, 0.0]);
        assert_eq!(outer_corners(&points), 9.0);
        assert_eq!(eye_centres(&points), 6.0);
    }

    #[test]
    fn boxes_by_hand() {
        let a = bounds(&[[0.0, 2.0], [4.0, 0.0], [1.0, 1.0]]);
        assert_eq!(a, [0.0, 0.0, 4.0, 2.0]);
        assert_eq!(box_size(&[[0.0, 2.0], [8.0, 0.0]]), 4.0);
        assert_eq!(iou(&a, &a), 1.0);
        assert_eq!(iou(&a, &[2.0, 0.0, 4.0, 2.0]), 0.5);
        assert_eq!(iou(&a, &[5.0, 0.0, 6.0, 2.0]), 0.0);
    }
}
