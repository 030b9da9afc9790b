//! The table of keyframes: what is kept of a frame, and which entry is replaced.

use super::descriptor::SteeredPattern;
use super::entry::{Keyframe, q4};
use super::keypoints::keypoints;
use super::outline::Outline;
use super::reduced_image::{ReducedImage, SamplingGrid};
use super::{FACE_PX, Shape};
use crate::image::Frame;
use crate::math::HeadAngles;
use crate::shape::LANDMARKS;

/// Most keyframes.
pub const KEYFRAMES_MAX: usize = 20;

/// Edges between the bins of yaw and of pitch \[deg\].
const YAW_EDGES: [f32; 4] = [-40.0, -14.0, 14.0, 40.0];
const PITCH_EDGES: [f32; 2] = [-14.0, 14.0];

/// A keyframe is replaced by one of the same bin whose quality is better by this.
const QUALITY_GAIN: f32 = 0.15;

/// Side of the reduced image around a face \[px\].
const SIDE: usize = 120;

/// A frame on which the face is known.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The landmarks \[frame px\].
    pub shape: &'a Shape,
    /// Head pose.
    pub angles: HeadAngles,
    /// Size of the face, as in [`Detection::size`](crate::detect::Detection::size) \[frame px\].
    pub size_px: f32,
    /// The face's confidence times its visible share, 0..=1; higher is better.
    pub quality: f32,
}

/// Keyframes: plain data of fixed size, all zero when empty.
#[derive(Clone)]
pub struct Keyframes {
    /// Entries in the order in which they were first taken; an entry stays where it is.
    entries: heapless::Vec<Keyframe, KEYFRAMES_MAX, u8>,
    /// Identity of the tracked face.
    identity: u32,
    /// Counts keyframes that were added or matched.
    clock: u32,
}

/// Number of the bin of a pose.
fn bin_of(angles: &HeadAngles) -> u8 {
    let yaw = YAW_EDGES.iter().filter(|edge| angles.yaw_deg >= **edge);
    let pitch = PITCH_EDGES.iter().filter(|edge| angles.pitch_deg >= **edge);
    (pitch.count() * (YAW_EDGES.len() + 1) + yaw.count()) as u8
}

impl Keyframes {
    /// No keyframe yet.
    pub const EMPTY: Keyframes = Keyframes {
        entries: heapless::Vec::new(),
        identity: 0,
        clock: 0,
    };

    /// Drops all keyframes.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether there is no keyframe.
    pub fn is_empty(&self) -> bool {
        self.entries.iter().all(Keyframe::is_free)
    }

    pub(super) fn entries(&self) -> &[Keyframe] {
        &self.entries
    }

    /// A face is tracked that no keyframe led to: keyframes are added under a new identity.
    pub fn new_identity(&mut self) {
        let last = self.entries.iter().map(|k| k.identity).max().unwrap_or(0);
        self.identity = self.identity.max(last).wrapping_add(1);
    }

    /// Identity of the tracked face: a number that means nothing outside of this table.
    pub fn identity(&self) -> u32 {
        self.identity
    }

    /// The face of a matched keyframe is tracked from here on.
    pub fn mark_used(&mut self, entry: usize) {
        self.clock = self.clock.wrapping_add(1);
        if let Some(keyframe) = self.entries.get_mut(entry) {
            keyframe.used = self.clock;
            self.identity = keyframe.identity;
        }
    }

    /// The entry that a keyframe of this pose and quality would take; `None` when it is not needed.
    ///
    /// An identity has one entry per bin, which only a better keyframe replaces. A new bin takes a
    /// free entry, or the one that was used longest ago.
    pub fn entry_for(&self, angles: &HeadAngles, quality: f32) -> Option<usize> {
        let bin = bin_of(angles);
        let mut entries = self.entries.iter().enumerate();
        let own =
            entries.find(|(_, k)| !k.is_free() && k.identity == self.identity && k.bin == bin);
        match own {
            Some((entry, kept)) => (quality > kept.quality + QUALITY_GAIN).then_some(entry),
            None if !self.entries.is_full() => Some(self.entries.len()),
            None => {
                let entries = self.entries.iter().enumerate();
                let oldest = entries.min_by_key(|(_, k)| (!k.is_free(), k.used));
                oldest.map(|(entry, _)| entry)
            }
        }
    }

    /// Adds a keyframe if [`Keyframes::entry_for`] has an entry for it; `scratch` needs 120² bytes.
    #[inline(never)]
    pub fn add(&mut self, frame: &Frame<'_>, seen: &Observation<'_>, scratch: &mut [u8]) {
        let Some(entry) = self.entry_for(&seen.angles, seen.quality) else {
            return;
        };
        let centre = centroid(seen.shape);
        let Some(grid) = SamplingGrid::around(centre, SIDE, seen.size_px, FACE_PX) else {
            return;
        };
        let image = ReducedImage::of(frame, &grid, scratch);
        let [cx, cy] = grid.to_image(centre);
        let offsets = seen.shape.map(|p| {
            let [x, y] = grid.to_image(p);
            [x - cx, y - cy]
        });
        let roll = seen.angles.roll_deg.to_radians();
        let pattern = SteeredPattern::new(roll);
        let outline = Outline::of(&offsets, roll);
        self.clock = self.clock.wrapping_add(1);
        let (identity, clock) = (self.identity, self.clock);
        let Some(keyframe) = self.entry_mut(entry) else {
            return;
        };
        keyframe.bin = bin_of(&seen.angles);
        keyframe.identity = identity;
        keyframe.used = clock;
        keyframe.quality = seen.quality;
        keyframe.roll = roll;
        keyframe.shape_q4 = offsets.map(|p| p.map(q4));
        keyframe.clear();
        keypoints(&image, |keypoint| {
            let offset = [keypoint.x as f32 - cx, keypoint.y as f32 - cy];
            if !keyframe.points.is_full() && outline.contains(offset) {
                let descriptor = pattern.describe(&image, keypoint.x, keypoint.y);
                keyframe.push(&descriptor, offset, keypoint.is_dark());
            }
        });
    }

    /// An entry; the one after the last is appended.
    fn entry_mut(&mut self, entry: usize) -> Option<&mut Keyframe> {
        if entry == self.entries.len() {
            self.entries.push(Keyframe::FREE).ok()?;
        }
        self.entries.get_mut(entry)
    }
}

fn centroid(shape: &Shape) -> [f32; 2] {
    let n = LANDMARKS as f32;
    let sum = shape
        .iter()
        .fold([0.0, 0.0], |m, p| [m[0] + p[0], m[1] + p[1]]);
    sum.map(|v| v / n)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{SIDE as TEXTURE_SIDE, texture};
    use super::super::{Query, SCRATCH_BYTES};
    use super::*;
    use crate::image::FrameLayout;

    /// A ring of landmarks, 64 px wide, around a point.
    fn ring([x, y]: [f32; 2]) -> Shape {
        core::array::from_fn(|i| {
            let angle = i as f32 * 0.37;
            let radius = if i < 17 { 32.0 } else { 20.0 };
            [
                x + radius * libm::cosf(angle),
                y + radius * libm::sinf(angle),
            ]
        })
    }

    fn angles(yaw_deg: f32, pitch_deg: f32) -> HeadAngles {
        HeadAngles {
            yaw_deg,
            pitch_deg,
            roll_deg: 0.0,
        }
    }

    fn frame(luma: &[u8], width: usize) -> Frame<'_> {
        let height = luma.len() / width;
        Frame::new(&FrameLayout::grey(width as u32, height as u32), luma).unwrap()
    }

    fn add(keyframes: &mut Keyframes, luma: &[u8], yaw_deg: f32, pitch_deg: f32, quality: f32) {
        let seen = Observation {
            shape: &ring([100.0, 100.0]),
            angles: angles(yaw_deg, pitch_deg),
            size_px: 64.0,
            quality,
        };
        keyframes.add(&frame(luma, TEXTURE_SIDE), &seen, &mut [0; SCRATCH_BYTES]);
    }

    const QUERY: Query = Query {
        size_px: 64.0,
        roll: 0.0,
        attempt: 0,
    };

    #[test]
    fn bins_fill_and_are_replaced_by_better_keyframes() {
        let luma = texture(0.0, 1.0, 0);
        let mut keyframes = Keyframes::EMPTY;
        assert!(keyframes.is_empty());
        add(&mut keyframes, &luma, 0.0, 0.0, 0.7);
        let filled = |k: &Keyframes| k.entries.iter().filter(|k| !k.is_free()).count();
        assert_eq!(filled(&keyframes), 1);
        assert!(keyframes.entries[0].points.len() > 8);
        // A keyframe of the same bin is not needed, unless it is much better; then it takes the
        // same entry.
        assert_eq!(keyframes.entry_for(&angles(9.0, -9.0), 0.8), None);
        assert_eq!(keyframes.entry_for(&angles(9.0, -9.0), 0.9), Some(0));
        assert_eq!(keyframes.entry_for(&angles(20.0, 0.0), 0.1), Some(1));
        assert_eq!(keyframes.entry_for(&angles(0.0, 20.0), 0.1), Some(1));
        add(&mut keyframes, &luma, -20.0, 0.0, 0.5);
        // A new identity takes free entries first.
        keyframes.new_identity();
        for bin in 0..15 {
            let yaw = [-60.0, -20.0, 0.0, 20.0, 60.0][bin % 5];
            add(&mut keyframes, &luma, yaw, [-30.0, 0.0, 30.0][bin / 5], 0.5);
        }
        assert_eq!(filled(&keyframes), 17);
        keyframes.mark_used(0);
        let first = keyframes.identity();
        for _ in 0..2 {
            keyframes.new_identity();
            assert_ne!(keyframes.identity(), first);
            add(&mut keyframes, &luma, 0.0, 0.0, 0.5);
            add(&mut keyframes, &luma, 20.0, 0.0, 0.5);
        }
        // The entry that was used lately is kept, the other one was replaced.
        assert_eq!(filled(&keyframes), KEYFRAMES_MAX);
        assert_eq!(keyframes.entries[0].identity, first);
        assert_ne!(keyframes.entries[1].identity, first);
        keyframes.clear();
        assert!(keyframes.is_empty());
    }

    #[test]
    fn a_moved_face_is_found() {
        let mut keyframes = Keyframes::EMPTY;
        add(&mut keyframes, &texture(0.0, 1.0, 0), 0.0, 0.0, 1.0);
        for (roll, scale) in [(0.0, 1.0), (0.2, 1.0), (-0.2, 1.1), (0.0, 0.9)] {
            let luma = texture(roll, scale, 4);
            let frame = frame(&luma, TEXTURE_SIDE);
            let found = keyframes.query(&frame, &QUERY, &mut [0; SCRATCH_BYTES]);
            let found = found.expect("the same texture");
            assert_eq!((found.identity, found.inliers >= 6), (0, true));
            let truth = ring([0.0, 0.0]).map(|[x, y]| {
                let (cos, sin) = (libm::cosf(roll) * scale, libm::sinf(roll) * scale);
                [100.0 + x * cos - y * sin, 100.0 + x * sin + y * cos]
            });
            for (found, truth) in found.shape.iter().zip(&truth) {
                let off = libm::hypotf(found[0] - truth[0], found[1] - truth[1]);
                assert!(off < 4.0, "{off} px at {roll}, {scale}");
            }
        }
    }

    #[test]
    fn nothing_is_found_in_noise_and_flat_images() {
        let mut keyframes = Keyframes::EMPTY;
        add(&mut keyframes, &texture(0.0, 1.0, 0), 0.0, 0.0, 1.0);
        let mut state = 3u32;
        let noise: [u8; TEXTURE_SIDE * TEXTURE_SIDE] = core::array::from_fn(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        let scratch = &mut [0; SCRATCH_BYTES];
        for attempt in 0..8 {
            for (luma, width) in [
                (&noise[..], TEXTURE_SIDE),
                (&[77; 160 * 120], 160),
                (&[200], 1),
                (&[3; 16_384], 16_384),
                (&[3; 16_384], 1),
            ] {
                for size_px in [64.0, 1.0, 0.0, -5.0, 1e9, f32::NAN] {
                    let query = Query {
                        size_px,
                        attempt,
                        roll: size_px,
                    };
                    let found = keyframes.query(&frame(luma, width), &query, scratch);
                    assert_eq!(found, None);
                }
            }
        }
        // Impossible shapes leave no keyframe.
        let mut empty = Keyframes::EMPTY;
        for v in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            let seen = Observation {
                shape: &[[v; 2]; LANDMARKS],
                angles: angles(v, v),
                size_px: v,
                quality: 1.0,
            };
            empty.add(&frame(&noise, TEXTURE_SIDE), &seen, scratch);
            empty.add(&frame(&[0], 1), &seen, &mut []);
        }
        let found = empty.query(&frame(&noise, TEXTURE_SIDE), &QUERY, scratch);
        assert_eq!(found, None);
    }
}
