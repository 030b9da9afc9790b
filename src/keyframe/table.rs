//! The table of keyframes: what is kept of a frame, and which entry makes room.

use super::descriptor::{Descriptor, Steered};
use super::picture::{Grid, Picture};
use super::points::keypoints;
use super::{FACE_PX, Shape};
use crate::image::Frame;
use crate::math::HeadAngles;
use crate::shape::LANDMARKS;

/// Most keyframes.
pub const KEYFRAMES_MAX: usize = 20;
/// Most keypoints of a keyframe.
pub const KEYFRAME_POINTS_MAX: usize = 32;

/// Yaws and pitches that part the bins \[deg\].
const YAWS: [f32; 4] = [-40.0, -14.0, 14.0, 40.0];
const PITCHES: [f32; 2] = [-14.0, 14.0];

/// A keyframe of a bin is replaced by one that is better by so much.
const BETTER: f32 = 0.15;

/// Side of the picture around a face \[px\].
const SIDE: usize = 120;
/// How far above the brows there still is face, in its sizes.
const FOREHEAD: f32 = 0.2;

/// Units of a place on a keyframe \[1/px\].
const Q4: f32 = 16.0;

/// A keypoint of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub descriptor: Descriptor,
    /// Relative to the middle of the face \[1/16 px of the reduced picture\].
    place: [i16; 2],
    pub dark: bool,
}

impl Point {
    const NONE: Point = Point {
        descriptor: [0; 8],
        place: [0; 2],
        dark: false,
    };

    /// Relative to the middle of the face \[px of the reduced picture\].
    pub fn place(&self) -> [f32; 2] {
        self.place.map(|v| v as f32 / Q4)
    }
}

/// A face as it was once.
#[derive(Clone, Copy)]
pub(super) struct Keyframe {
    /// Points in use; 0 in a free entry.
    count: u8,
    bin: u8,
    /// Whose face it is.
    pub identity: u32,
    /// When it was last of use; higher is later.
    used: u32,
    quality: f32,
    /// \[rad\]
    pub roll: f32,
    /// The landmarks, as a point's place.
    shape: [[i16; 2]; LANDMARKS],
    points: [Point; KEYFRAME_POINTS_MAX],
}

impl Keyframe {
    const FREE: Keyframe = Keyframe {
        count: 0,
        bin: 0,
        identity: 0,
        used: 0,
        quality: 0.0,
        roll: 0.0,
        shape: [[0; 2]; LANDMARKS],
        points: [Point::NONE; KEYFRAME_POINTS_MAX],
    };

    pub fn points(&self) -> &[Point] {
        self.points.get(..self.count as usize).unwrap_or(&[])
    }

    /// The landmarks, relative to the middle of the face \[px of the reduced picture\].
    pub fn shape(&self) -> Shape {
        self.shape.map(|p| p.map(|v| v as f32 / Q4))
    }
}

/// A face to remember.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// Its landmarks \[frame px\].
    pub shape: &'a Shape,
    /// How its head is turned.
    pub angles: HeadAngles,
    /// Its size, as the detector has it \[frame px\].
    pub size_px: f32,
    /// How sure it is and how much of it is seen; higher is better.
    pub quality: f32,
}

/// Keyframes: plain data of fixed size, all zero when empty.
#[derive(Clone)]
pub struct Keyframes {
    pub(super) table: [Keyframe; KEYFRAMES_MAX],
    /// Whose face is tracked: another number for every stranger.
    identity: u32,
    /// Counts what was of use.
    clock: u32,
}

/// Number of the bin of a pose.
fn bin_of(angles: &HeadAngles) -> u8 {
    let yaw = YAWS.iter().filter(|edge| angles.yaw_deg >= **edge).count();
    let pitch = PITCHES.iter().filter(|edge| angles.pitch_deg >= **edge);
    (pitch.count() * (YAWS.len() + 1) + yaw) as u8
}

impl Keyframes {
    /// None yet.
    pub const EMPTY: Keyframes = Keyframes {
        table: [Keyframe::FREE; KEYFRAMES_MAX],
        identity: 0,
        clock: 0,
    };

    /// Forgets all faces.
    pub fn clear(&mut self) {
        self.table.iter_mut().for_each(|k| k.count = 0);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.table.iter().all(|k| k.count == 0)
    }

    /// A face is tracked that no keyframe led to: what is seen from here on is kept as somebody
    /// else's.
    pub fn new_identity(&mut self) {
        let last = self.table.iter().map(|k| k.identity).max().unwrap_or(0);
        self.identity = self.identity.max(last).wrapping_add(1);
    }

    /// Whose face is tracked.
    pub fn identity(&self) -> u32 {
        self.identity
    }

    /// The face of an entry is tracked again.
    pub(super) fn mark_entry_used(&mut self, entry: usize) {
        self.clock = self.clock.wrapping_add(1);
        if let Some(keyframe) = self.table.get_mut(entry) {
            keyframe.used = self.clock;
            self.identity = keyframe.identity;
        }
    }

    /// Where a face seen like this would go; `None` when it brings nothing new. A bin of a person
    /// has one entry. Else a free entry is taken, or the one that was of use longest ago.
    pub fn entry_for(&self, angles: &HeadAngles, quality: f32) -> Option<usize> {
        let bin = bin_of(angles);
        let mut entries = self.table.iter().enumerate();
        let own = entries.find(|(_, k)| k.count > 0 && k.identity == self.identity && k.bin == bin);
        match own {
            Some((entry, kept)) => (quality > kept.quality + BETTER).then_some(entry),
            None => {
                let entries = self.table.iter().enumerate();
                let oldest = entries.min_by_key(|(_, k)| (k.count > 0, k.used));
                oldest.map(|(entry, _)| entry)
            }
        }
    }

    /// Remembers a face, if it brings something new; `memory` needs 120² bytes.
    #[inline(never)]
    pub fn add(&mut self, frame: &Frame<'_>, seen: &Observation<'_>, memory: &mut [u8]) {
        let Some(entry) = self.entry_for(&seen.angles, seen.quality) else {
            return;
        };
        let centre = middle(seen.shape);
        let Some(grid) = Grid::around(centre, SIDE, seen.size_px, FACE_PX) else {
            return;
        };
        let picture = Picture::of(frame, &grid, memory);
        let [cx, cy] = grid.of_frame(centre);
        let local = seen.shape.map(|p| {
            let [x, y] = grid.of_frame(p);
            [x - cx, y - cy]
        });
        let roll = seen.angles.roll_deg.to_radians();
        let steered = Steered::new(roll, &picture);
        let outline = Outline::of(&local, roll);
        self.clock = self.clock.wrapping_add(1);
        let (identity, clock) = (self.identity, self.clock);
        let Some(keyframe) = self.table.get_mut(entry) else {
            return;
        };
        keyframe.count = 0;
        keyframe.bin = bin_of(&seen.angles);
        keyframe.identity = identity;
        keyframe.used = clock;
        keyframe.quality = seen.quality;
        keyframe.roll = roll;
        keyframe.shape = local.map(|p| p.map(q4));
        keypoints(&picture, |found| {
            let place = [found.x as f32 - cx, found.y as f32 - cy];
            let free = keyframe.points.get_mut(keyframe.count as usize);
            if let Some(free) = free.filter(|_| outline.holds(place)) {
                *free = Point {
                    descriptor: steered.describe(&picture, found.x, found.y),
                    place: place.map(q4),
                    dark: found.dark(),
                };
                keyframe.count += 1;
            }
        });
    }
}

fn q4(v: f32) -> i16 {
    libm::roundf((v * Q4).clamp(-32_000.0, 32_000.0)) as i16
}

fn middle(shape: &Shape) -> [f32; 2] {
    let n = LANDMARKS as f32;
    let sum = shape
        .iter()
        .fold([0.0, 0.0], |m, p| [m[0] + p[0], m[1] + p[1]]);
    sum.map(|v| v / n)
}

/// A convex outline around the landmarks and the forehead: how far it reaches in each direction.
struct Outline {
    reach: [([f32; 2], f32); 16],
}

impl Outline {
    fn of(shape: &Shape, roll: f32) -> Outline {
        let up = [libm::sinf(roll), -libm::cosf(roll)];
        let mut reach = [([0.0; 2], 0.0); 16];
        for (i, (direction, far)) in reach.iter_mut().enumerate() {
            let angle = i as f32 * (core::f32::consts::TAU / 16.0);
            let d = [libm::cosf(angle), libm::sinf(angle)];
            let along = shape.iter().map(|p| p[0] * d[0] + p[1] * d[1]);
            let upward = (up[0] * d[0] + up[1] * d[1]).max(0.0);
            *direction = d;
            *far = along.fold(0.0, f32::max) + upward * FOREHEAD * FACE_PX;
        }
        Outline { reach }
    }

    fn holds(&self, [x, y]: [f32; 2]) -> bool {
        let mut reach = self.reach.iter();
        reach.all(|(d, far)| x * d[0] + y * d[1] <= *far)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{SIDE as SQUARE, texture};
    use super::super::{Query, SCRATCH_BYTES};
    use super::*;
    use crate::image::FrameLayout;

    /// A ring of landmarks, 64 px wide, around a place.
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

    fn learn(keyframes: &mut Keyframes, luma: &[u8], yaw_deg: f32, pitch_deg: f32, quality: f32) {
        let seen = Observation {
            shape: &ring([100.0, 100.0]),
            angles: angles(yaw_deg, pitch_deg),
            size_px: 64.0,
            quality,
        };
        keyframes.add(&frame(luma, SQUARE), &seen, &mut [0; SCRATCH_BYTES]);
    }

    const WANTED: Query = Query {
        size_px: 64.0,
        roll: 0.0,
        attempt: 0,
    };

    #[test]
    fn bins_fill_and_are_replaced_by_better_ones() {
        let luma = texture(0.0, 1.0, 0);
        let mut keyframes = Keyframes::EMPTY;
        assert!(keyframes.is_empty());
        learn(&mut keyframes, &luma, 0.0, 0.0, 0.7);
        let filled = |k: &Keyframes| k.table.iter().filter(|k| k.count > 0).count();
        assert_eq!(filled(&keyframes), 1);
        assert!(keyframes.table[0].points().len() > 8);
        // The same bin brings nothing, unless much better; then the entry stays the same.
        assert_eq!(keyframes.entry_for(&angles(9.0, -9.0), 0.8), None);
        assert_eq!(keyframes.entry_for(&angles(9.0, -9.0), 0.9), Some(0));
        assert_eq!(keyframes.entry_for(&angles(20.0, 0.0), 0.1), Some(1));
        assert_eq!(keyframes.entry_for(&angles(0.0, 20.0), 0.1), Some(1));
        learn(&mut keyframes, &luma, -20.0, 0.0, 0.5);
        // Somebody else's face does not replace it before there is no room.
        keyframes.new_identity();
        for bin in 0..15 {
            let yaw = [-60.0, -20.0, 0.0, 20.0, 60.0][bin % 5];
            learn(&mut keyframes, &luma, yaw, [-30.0, 0.0, 30.0][bin / 5], 0.5);
        }
        assert_eq!(filled(&keyframes), 17);
        keyframes.mark_entry_used(0);
        let first = keyframes.identity();
        for _ in 0..2 {
            keyframes.new_identity();
            assert_ne!(keyframes.identity(), first);
            learn(&mut keyframes, &luma, 0.0, 0.0, 0.5);
            learn(&mut keyframes, &luma, 20.0, 0.0, 0.5);
        }
        // The one that was of use lately is kept, the one that was not has made room.
        assert_eq!(filled(&keyframes), KEYFRAMES_MAX);
        assert_eq!(keyframes.table[0].identity, first);
        assert_ne!(keyframes.table[1].identity, first);
        keyframes.clear();
        assert!(keyframes.is_empty());
    }

    #[test]
    fn a_face_is_found_where_it_went() {
        let mut keyframes = Keyframes::EMPTY;
        learn(&mut keyframes, &texture(0.0, 1.0, 0), 0.0, 0.0, 1.0);
        for (roll, scale) in [(0.0, 1.0), (0.2, 1.0), (-0.2, 1.1), (0.0, 0.9)] {
            let luma = texture(roll, scale, 4);
            let frame = frame(&luma, SQUARE);
            let found = keyframes.query(&frame, &WANTED, &mut [0; SCRATCH_BYTES]);
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
    fn where_there_is_nothing_nothing_is_found() {
        let mut keyframes = Keyframes::EMPTY;
        learn(&mut keyframes, &texture(0.0, 1.0, 0), 0.0, 0.0, 1.0);
        let mut state = 3u32;
        let noise: [u8; SQUARE * SQUARE] = core::array::from_fn(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        let memory = &mut [0; SCRATCH_BYTES];
        for attempt in 0..8 {
            for (luma, width) in [
                (&noise[..], SQUARE),
                (&[77; 160 * 120], 160),
                (&[200], 1),
                (&[3; 16_384], 16_384),
                (&[3; 16_384], 1),
            ] {
                for size_px in [64.0, 1.0, 0.0, -5.0, 1e9, f32::NAN] {
                    let wanted = Query {
                        size_px,
                        attempt,
                        roll: size_px,
                    };
                    let found = keyframes.query(&frame(luma, width), &wanted, memory);
                    assert_eq!(found, None);
                }
            }
        }
        // Faces that cannot be: nothing to find them by is kept.
        let mut empty = Keyframes::EMPTY;
        for v in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            let seen = Observation {
                shape: &[[v; 2]; LANDMARKS],
                angles: angles(v, v),
                size_px: v,
                quality: 1.0,
            };
            empty.add(&frame(&noise, SQUARE), &seen, memory);
            empty.add(&frame(&[0], 1), &seen, &mut []);
        }
        let found = empty.query(&frame(&noise, SQUARE), &WANTED, memory);
        assert_eq!(found, None);
    }
}
