//! Finds a known face in a frame: keypoints are matched with those of every keyframe.

use super::FACE_PX;
use super::descriptor::{BITS, SteeredPattern, hamming_distance, near, split};
use super::entry::{KEYFRAME_POINTS_MAX, Keyframe, KeyframeMatch};
use super::keypoints::{Keypoint, keypoints};
use super::ransac::{Pair, consensus};
use super::reduced_image::{ReducedImage, SamplingGrid};
use super::table::{KEYFRAMES_MAX, Keyframes};
use crate::image::Frame;
use crate::math::Similarity;

/// Most bits of the first 64 in which matching descriptors differ …
const HEAD_DISTANCE_MAX: u32 = 24;
/// … and most of all 256: a third, where unrelated descriptors differ in about half.
const DISTANCE_MAX: u32 = 80;
/// Ratio test (Lowe, 2004): the best distance is below this share of the second best \[1/256\].
const RATIO: u32 = 230;

/// Scales that attempts cycle through, as multiples of the expected one: a descriptor bridges no
/// more than the step between them. Every other one of them takes the head for upright.
const SCALES: [f32; 4] = [1.0, 1.25, 1.0, 0.8];

/// What to search for.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// Expected size of the face, as in [`Detection::size`](crate::detect::Detection::size)
    /// \[frame px\].
    pub size_px: f32,
    /// Expected roll, clockwise in the image \[rad\].
    pub roll: f32,
    /// Number of queries before this one. It selects the window of a frame that is larger than a
    /// reduced image, and after all windows another scale and roll.
    pub attempt: u32,
}

/// For a keypoint of a keyframe: the nearest keypoint of the reduced image, the Hamming distance to
/// it and to the second nearest.
#[derive(Clone, Copy)]
struct NearestPair {
    best: u16,
    second: u16,
    x: u16,
    y: u16,
}

impl NearestPair {
    const NONE: NearestPair = NearestPair {
        best: BITS as u16,
        second: BITS as u16,
        x: 0,
        y: 0,
    };

    fn add(&mut self, distance: u32, keypoint: &Keypoint) {
        let distance = distance as u16;
        if distance < self.best {
            *self = NearestPair {
                best: distance,
                second: self.best,
                x: keypoint.x,
                y: keypoint.y,
            };
        } else {
            self.second = self.second.min(distance);
        }
    }

    /// Whether the nearest keypoint matches: near enough, and by far the nearest.
    fn is_match(&self) -> bool {
        let (best, second) = (self.best as u32, self.second as u32);
        best <= DISTANCE_MAX && best * 256 < second * RATIO
    }
}

/// Parallel to the table and its points: every element is read, so these are arrays and no lists.
type Nearest = [[NearestPair; KEYFRAME_POINTS_MAX]; KEYFRAMES_MAX];

impl Keyframes {
    /// Searches one window of the frame for the keyframes' faces; `scratch` needs
    /// [`SCRATCH_BYTES`]. Work is bounded by the window's pixels, its keypoints times the points of
    /// all keyframes, and the iterations of RANSAC.
    ///
    /// [`SCRATCH_BYTES`]: super::SCRATCH_BYTES
    #[inline(never)]
    pub fn query(
        &self,
        frame: &Frame<'_>,
        query: &Query,
        scratch: &mut [u8],
    ) -> Option<KeyframeMatch> {
        let windows = SamplingGrid::count(frame, query.size_px, FACE_PX).max(1);
        let variant = query.attempt / windows;
        let size_px = query.size_px * SCALES.get(variant as usize % SCALES.len())?;
        let roll = match variant.is_multiple_of(2) {
            true => query.roll,
            false => 0.0,
        };
        let grid = SamplingGrid::window(frame, query.attempt, size_px, FACE_PX)?;
        let image = ReducedImage::of(frame, &grid, scratch);
        let mut nearest = [[NearestPair::NONE; KEYFRAME_POINTS_MAX]; KEYFRAMES_MAX];
        self.find_nearest(&image, roll, &mut nearest);
        let candidates = self.entries().iter().zip(&nearest).enumerate();
        let matches = candidates.filter_map(|(entry, (keyframe, nearest))| {
            let (inliers, similarity) = align(keyframe, nearest, roll - keyframe.roll)?;
            Some((inliers, entry, similarity))
        });
        let (inliers, entry, similarity) = matches.max_by_key(|(inliers, entry, _)| {
            // Of equals the first entry.
            (*inliers, KEYFRAMES_MAX - entry)
        })?;
        let keyframe = self.entries().get(entry)?;
        let shape = keyframe.shape().map(|p| grid.to_frame(similarity.apply(p)));
        Some(KeyframeMatch {
            shape,
            identity: keyframe.identity,
            inliers,
            entry,
        })
    }

    /// For each point of each keyframe the nearest and second nearest keypoint of the image.
    #[inline(never)]
    fn find_nearest(&self, image: &ReducedImage<'_>, roll: f32, nearest: &mut Nearest) {
        let pattern = SteeredPattern::new(roll);
        keypoints(image, |keypoint| {
            let descriptor = pattern.describe(image, keypoint.x, keypoint.y);
            let (head, tail) = split(&descriptor);
            for (keyframe, nearest) in self.entries().iter().zip(nearest.iter_mut()) {
                let mut left = near(&keyframe.heads, head, HEAD_DISTANCE_MAX)
                    & keyframe.points_that_are(keypoint.is_dark());
                while left != 0 {
                    let number = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let (of, point) = (keyframe.heads.get(number), keyframe.points.get(number));
                    if let (Some(of), Some(point)) = (of, point)
                        && let Some(nearest) = nearest.get_mut(number)
                    {
                        let distance = hamming_distance((*of, &point.tail), (head, &tail));
                        nearest.add(distance, &keypoint);
                    }
                }
            }
        });
    }
}

/// The transform from a keyframe to the image on which most of its matches agree, and how many do.
#[inline(never)]
fn align(
    keyframe: &Keyframe,
    nearest: &[NearestPair],
    rotation: f32,
) -> Option<(usize, Similarity)> {
    let mut pairs = heapless::Vec::<Pair, KEYFRAME_POINTS_MAX>::new();
    let points = keyframe.points.iter().zip(nearest);
    for (point, nearest) in points.filter(|(_, nearest)| nearest.is_match()) {
        // A keyframe has no more points than that, so there is space.
        let _ = pairs.push((point.offset(), [nearest.x as f32, nearest.y as f32]));
    }
    consensus(&pairs, rotation)
}
