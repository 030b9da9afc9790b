//! From a picture of now to a keyframe's face in it.

use super::descriptor::{BITS, Steered, apart};
use super::picture::{Grid, Picture};
use super::points::keypoints;
use super::table::{KEYFRAME_POINTS_MAX, KEYFRAMES_MAX, Keyframe, Keyframes};
use super::{FACE_PX, Shape};
use crate::image::Frame;
use crate::math::Similarity;

/// Most bits of the first 64 that may differ, and of all 256.
const FIRST_FAR: u32 = 24;
const FAR: u32 = 80;
/// The best must be nearer than this share of the second best \[1/256\].
const RATIO: u32 = 230;
/// Rounds for one keyframe.
const ROUNDS: usize = 64;
/// A match agrees with a similarity that brings it this near \[px of the reduced picture\].
const NEAR: f32 = 3.0;
/// Fewest matches that must agree.
const AGREED: usize = 5;
/// Sizes and rolls that a descriptor bridges, beside those expected.
const SIZES: core::ops::RangeInclusive<f32> = 0.6..=1.6;
const ROLL: f32 = 0.6;

/// Sizes looked for in turn, as multiples of the expected one. Every other time the head is taken
/// for upright.
const OTHERS: [f32; 4] = [1.0, 1.25, 1.0, 0.8];

/// What to look for.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The face's size, as the detector has it \[frame px\].
    pub size_px: f32,
    /// Its roll \[rad\].
    pub roll: f32,
    /// Counts the looks at it: through the windows of a frame that does not fit into one picture,
    /// then through other sizes and rolls than those.
    pub attempt: u32,
}

/// A face that was seen before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyframeMatch {
    /// Where its landmarks should be \[frame px\].
    pub shape: Shape,
    /// Whose face it is, as [`Keyframes::identity`] counts.
    pub identity: u32,
    /// Matches that agree.
    pub inliers: usize,
    entry: usize,
}

/// A keypoint of a keyframe and the keypoints of now that are most alike.
#[derive(Clone, Copy)]
struct Match {
    best: u16,
    second: u16,
    x: u16,
    y: u16,
}

impl Match {
    const NONE: Match = Match {
        best: BITS as u16,
        second: BITS as u16,
        x: 0,
        y: 0,
    };

    fn is_clear(&self) -> bool {
        let (best, second) = (self.best as u32, self.second as u32);
        best <= FAR && best * 256 < second * RATIO
    }
}

/// A pair of places: on the keyframe, in the picture.
type Pair = ([f32; 2], [f32; 2]);

impl Keyframes {
    /// Looks for a face that was seen before, in a window of the frame. Work is bounded by the
    /// window's pixels, its keypoints times those of the table, and the rounds.
    #[inline(never)]
    pub fn query(
        &self,
        frame: &Frame<'_>,
        wanted: &Query,
        memory: &mut [u8],
    ) -> Option<KeyframeMatch> {
        let guess = wanted.attempt / Grid::count(frame, wanted.size_px, FACE_PX).max(1);
        let size_px = wanted.size_px * OTHERS.get(guess as usize % OTHERS.len())?;
        let roll = match guess.is_multiple_of(2) {
            true => wanted.roll,
            false => 0.0,
        };
        let grid = Grid::window(frame, wanted.attempt, size_px, FACE_PX)?;
        let picture = Picture::of(frame, &grid, memory);
        let mut matches = [[Match::NONE; KEYFRAME_POINTS_MAX]; KEYFRAMES_MAX];
        self.compare(&picture, roll, &mut matches);
        let candidates = self.table.iter().zip(&matches).enumerate();
        let found = candidates.filter_map(|(entry, (keyframe, matches))| {
            let turn = roll - keyframe.roll;
            let (agreed, similarity) = agree(keyframe, matches, turn)?;
            Some((agreed, entry, similarity))
        });
        let (agreed, entry, similarity) = found.max_by_key(|(agreed, entry, _)| {
            // The first of equals.
            (*agreed, KEYFRAMES_MAX - entry)
        })?;
        let keyframe = self.table.get(entry)?;
        let shape = keyframe.shape().map(|p| grid.to_frame(similarity.apply(p)));
        Some(KeyframeMatch {
            shape,
            identity: keyframe.identity,
            inliers: agreed,
            entry,
        })
    }

    /// What was found is a face: it is tracked from here on.
    pub fn mark_used(&mut self, found: &KeyframeMatch) {
        self.mark_entry_used(found.entry);
    }

    /// For each keypoint of the table the best and the second best of the picture.
    #[inline(never)]
    fn compare(
        &self,
        picture: &Picture<'_>,
        roll: f32,
        matches: &mut [[Match; KEYFRAME_POINTS_MAX]; KEYFRAMES_MAX],
    ) {
        let steered = Steered::new(roll, picture);
        keypoints(picture, |found| {
            let descriptor = steered.describe(picture, found.x, found.y);
            for (keyframe, matches) in self.table.iter().zip(matches.iter_mut()) {
                for (point, kept) in keyframe.points().iter().zip(matches) {
                    if point.dark != found.dark() {
                        continue;
                    }
                    let Some(distance) = apart(&point.descriptor, &descriptor, FIRST_FAR) else {
                        continue;
                    };
                    let distance = distance as u16;
                    if distance < kept.best {
                        *kept = Match {
                            best: distance,
                            second: kept.best,
                            x: found.x,
                            y: found.y,
                        };
                    } else {
                        kept.second = kept.second.min(distance);
                    }
                }
            }
        });
    }
}

/// The similarity on which most matches of a keyframe agree, and how many do.
#[inline(never)]
fn agree(keyframe: &Keyframe, matches: &[Match], turn: f32) -> Option<(usize, Similarity)> {
    let mut pairs = [([0.0; 2], [0.0; 2]); KEYFRAME_POINTS_MAX];
    let clear = keyframe.points().iter().zip(matches);
    let clear = clear.filter(|(_, m)| m.is_clear());
    let mut count = 0;
    for (pair, (point, m)) in pairs.iter_mut().zip(clear) {
        *pair = (point.place(), [m.x as f32, m.y as f32]);
        count += 1;
    }
    let pairs = pairs.get(..count).unwrap_or(&[]);
    consensus(pairs, turn)
}

/// RANSAC: similarities from two pairs each, a fixed number of rounds from a fixed seed; then a
/// least-squares fit to the pairs that agree with the best.
pub(super) fn consensus(pairs: &[Pair], turn: f32) -> Option<(usize, Similarity)> {
    if pairs.len() < AGREED {
        return None;
    }
    let mut state = 0x9E37_79B9u32;
    let mut one = || {
        // xorshift32
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        let at = ((state >> 16) as usize * pairs.len()) >> 16;
        pairs.get(at).copied().unwrap_or_default()
    };
    let (mut most, mut best) = (0, Similarity::IDENTITY);
    for _ in 0..ROUNDS {
        let (a, b) = (one(), one());
        let Some(similarity) = Similarity::fit(&[a.0, b.0], &[a.1, b.1]) else {
            continue;
        };
        if !likely(&similarity, turn) {
            continue;
        }
        let agreed = pairs.iter().filter(|p| agrees(&similarity, p)).count();
        if agreed > most {
            (most, best) = (agreed, similarity);
        }
    }
    if most < AGREED {
        return None;
    }
    let (mut from, mut to) = (
        [[0.0; 2]; KEYFRAME_POINTS_MAX],
        [[0.0; 2]; KEYFRAME_POINTS_MAX],
    );
    let agreeing = pairs.iter().filter(|p| agrees(&best, p));
    let mut count = 0;
    for ((from, to), pair) in from.iter_mut().zip(&mut to).zip(agreeing) {
        (*from, *to) = *pair;
        count += 1;
    }
    let refined = Similarity::fit(from.get(..count)?, to.get(..count)?)?;
    likely(&refined, turn).then_some((most, refined))
}

fn likely(similarity: &Similarity, turn: f32) -> bool {
    let Similarity { a, b, .. } = *similarity;
    // Turned back by what is expected.
    let (cos, sin) = (libm::cosf(turn), libm::sinf(turn));
    let (a, b) = (a * cos + b * sin, b * cos - a * sin);
    SIZES.contains(&similarity.scale()) && a > 0.0 && b.abs() < ROLL * a
}

fn agrees(similarity: &Similarity, (from, to): &Pair) -> bool {
    let [x, y] = similarity.apply(*from);
    let (dx, dy) = (x - to[0], y - to[1]);
    dx * dx + dy * dy < NEAR * NEAR
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
            let (agreed, found) = consensus(&pairs, 0.0).expect("ten of 28 agree");
            assert!((10..=12).contains(&agreed), "{agreed}");
            let off = found.apply([10.0, -10.0]);
            let [x, y] = truth.apply([10.0, -10.0]);
            assert!((off[0] - x).abs() < 3.0 && (off[1] - y).abs() < 3.0);
            // Upright faces are expected, or such as are turned by a third of a turn.
            assert!(consensus(&pairs, 2.0).is_none());
        }
    }

    #[test]
    fn chance_agrees_on_nothing() {
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
