//! RANSAC: the similarity transform on which most matches of a keyframe agree (Fischler and Bolles,
//! "Random sample consensus", 1981).

use super::entry::KEYFRAME_POINTS_MAX;
use crate::math::Similarity;

/// Iterations for one keyframe. With 40 % inliers a pair of inliers is drawn in 64 iterations with
/// a probability of 1 − (1 − 0.16)⁶⁴, all but certainly.
const ITERATIONS: usize = 64;
/// A match is an inlier of a transform that maps it this near \[px of the reduced image\].
const INLIER_PX: f32 = 3.0;
/// Fewest inliers.
pub(super) const INLIERS_MIN: usize = 5;
/// Range of scales that a descriptor tolerates, relative to the expected one.
const SCALES: core::ops::RangeInclusive<f32> = 0.6..=1.6;
/// Largest tangent of the rotation that a descriptor tolerates, relative to the expected one: 31°.
const ROTATION_TAN: f32 = 0.6;

/// A matched point: on the keyframe, relative to its centre, and in the reduced image \[px of the
/// reduced image\].
pub(super) type Pair = ([f32; 2], [f32; 2]);

/// The number of inliers and the transform from the keyframe to the reduced image; `None` with
/// fewer than [`INLIERS_MIN`]. `rotation` is the expected one, clockwise \[rad\].
///
/// Each iteration fits a similarity to two pairs drawn from a fixed seed. The best is fitted again,
/// by least squares, to all its inliers.
pub(super) fn consensus(pairs: &[Pair], rotation: f32) -> Option<(usize, Similarity)> {
    if pairs.len() < INLIERS_MIN {
        return None;
    }
    let mut state = 0x9E37_79B9u32;
    let mut draw = || {
        // xorshift32
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        let at = ((state >> 16) as usize * pairs.len()) >> 16;
        pairs.get(at).copied().unwrap_or_default()
    };
    let (mut most, mut best) = (0, Similarity::IDENTITY);
    for _ in 0..ITERATIONS {
        let (a, b) = (draw(), draw());
        let Some(similarity) = Similarity::fit(&[a.0, b.0], &[a.1, b.1]) else {
            continue;
        };
        if !is_plausible(&similarity, rotation) {
            continue;
        }
        let inliers = pairs.iter().filter(|p| is_inlier(&similarity, p)).count();
        if inliers > most {
            (most, best) = (inliers, similarity);
        }
    }
    if most < INLIERS_MIN {
        return None;
    }
    let mut from = heapless::Vec::<[f32; 2], KEYFRAME_POINTS_MAX>::new();
    let mut to = heapless::Vec::<[f32; 2], KEYFRAME_POINTS_MAX>::new();
    for pair in pairs.iter().filter(|p| is_inlier(&best, p)) {
        // A keyframe has no more points than that, so there is space.
        let _ = (from.push(pair.0), to.push(pair.1));
    }
    let refined = Similarity::fit(&from, &to)?;
    is_plausible(&refined, rotation).then_some((most, refined))
}

/// Whether scale and rotation are such as descriptors tolerate.
fn is_plausible(similarity: &Similarity, rotation: f32) -> bool {
    let Similarity { a, b, .. } = *similarity;
    // Without the expected rotation.
    let (cos, sin) = (libm::cosf(rotation), libm::sinf(rotation));
    let (a, b) = (a * cos + b * sin, b * cos - a * sin);
    SCALES.contains(&similarity.scale()) && a > 0.0 && b.abs() < ROTATION_TAN * a
}

fn is_inlier(similarity: &Similarity, (from, to): &Pair) -> bool {
    let [x, y] = similarity.apply(*from);
    let (dx, dy) = (x - to[0], y - to[1]);
    dx * dx + dy * dy < INLIER_PX * INLIER_PX
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below(state: &mut u32, n: f32) -> f32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as f32 / (1 << 24) as f32 * n
    }

    fn random(state: &mut u32) -> Pair {
        let mut one = |n| below(state, n);
        (
            [one(60.0) - 30.0, one(60.0) - 30.0],
            [one(320.0), one(240.0)],
        )
    }

    #[test]
    fn a_planted_similarity_is_found_among_outliers() {
        let truth = Similarity {
            a: 1.1,
            b: 0.2,
            tx: 200.0,
            ty: 90.0,
        };
        for seed in 0..20 {
            let mut state = seed;
            let pairs: [Pair; 28] = core::array::from_fn(|i| {
                let (from, to) = random(&mut state);
                let [x, y] = truth.apply(from);
                if i % 3 == 0 {
                    (from, [x + 1.0, y - 1.0])
                } else {
                    (from, to)
                }
            });
            let (inliers, found) = consensus(&pairs, 0.0).expect("ten of 28 are inliers");
            assert!((10..=12).contains(&inliers), "{inliers}");
            let mapped = found.apply([10.0, -10.0]);
            let [x, y] = truth.apply([10.0, -10.0]);
            assert!((mapped[0] - x).abs() < 3.0 && (mapped[1] - y).abs() < 3.0);
            // A rotation far from the expected one is rejected.
            assert!(consensus(&pairs, 2.0).is_none());
        }
    }

    #[test]
    fn random_pairs_have_no_consensus() {
        let mut state = 1;
        for _ in 0..200 {
            let pairs: [Pair; KEYFRAME_POINTS_MAX] = core::array::from_fn(|_| random(&mut state));
            assert_eq!(consensus(&pairs, 0.0), None);
        }
        assert_eq!(consensus(&[], 0.0), None);
        assert_eq!(consensus(&[([1.0; 2], [5.0; 2]); 9], 0.0), None);
        assert_eq!(consensus(&[([1.0; 2], [f32::NAN; 2]); 9], 0.0), None);
    }
}
