//! The table of keyframes: what is kept of a frame, and which entry makes room.

use super::descriptor::{Descriptor, Steered};
use super::picture::{Grid, Picture};
use super::points::keypoints;
use super::{FACE_PX, Shape};
use crate::image::Frame;
use crate::math::HeadAngles;
use crate::shape::LANDMARKS;

/// Most keyframes.
pub const KEYFRAMES: usize = 20;
/// Most keypoints of a keyframe.
pub const POINTS: usize = 32;

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
    pub person: u32,
    /// When it was last of use; higher is later.
    used: u32,
    quality: f32,
    /// \[rad\]
    pub roll: f32,
    /// The landmarks, as a point's place.
    shape: [[i16; 2]; LANDMARKS],
    points: [Point; POINTS],
}

impl Keyframe {
    const FREE: Keyframe = Keyframe {
        count: 0,
        bin: 0,
        person: 0,
        used: 0,
        quality: 0.0,
        roll: 0.0,
        shape: [[0; 2]; LANDMARKS],
        points: [Point::NONE; POINTS],
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
pub struct Seen<'a> {
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
    pub(super) table: [Keyframe; KEYFRAMES],
    /// Whose face is tracked: another number for every stranger.
    person: u32,
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
        table: [Keyframe::FREE; KEYFRAMES],
        person: 0,
        clock: 0,
    };

    /// Forgets all faces.
    pub fn forget(&mut self) {
        self.table.iter_mut().for_each(|k| k.count = 0);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.table.iter().all(|k| k.count == 0)
    }

    /// A face is tracked that no keyframe led to: what is seen from here on is kept as somebody
    /// else's.
    pub fn stranger(&mut self) {
        let last = self.table.iter().map(|k| k.person).max().unwrap_or(0);
        self.person = self.person.max(last).wrapping_add(1);
    }

    /// Whose face is tracked.
    pub fn person(&self) -> u32 {
        self.person
    }

    /// The face of an entry is tracked again.
    pub(super) fn again(&mut self, entry: usize) {
        self.clock = self.clock.wrapping_add(1);
        if let Some(keyframe) = self.table.get_mut(entry) {
            keyframe.used = self.clock;
            self.person = keyframe.person;
        }
    }

    /// Where a face seen like this would go; `None` when it brings nothing new. A bin of a person
    /// has one entry. Else a free entry is taken, or the one that was of use longest ago.
    pub fn place(&self, angles: &HeadAngles, quality: f32) -> Option<usize> {
        let bin = bin_of(angles);
        let mut entries = self.table.iter().enumerate();
        let own = entries.find(|(_, k)| k.count > 0 && k.person == self.person && k.bin == bin);
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
    pub fn learn(&mut self, frame: &Frame<'_>, seen: &Seen<'_>, memory: &mut [u8]) {
        let Some(entry) = self.place(&seen.angles, seen.quality) else {
            return;
        };
        let centre = middle(seen.shape);
        let Some(grid) = Grid::around(centre, SIDE, seen.size_px, FACE_PX) else {
            return;
        };
        let picture = Picture::of(frame, &grid, memory);
        let [cx, cy] = grid.from_frame(centre);
        let local = seen.shape.map(|p| {
            let [x, y] = grid.from_frame(p);
            [x - cx, y - cy]
        });
        let roll = seen.angles.roll_deg.to_radians();
        let steered = Steered::new(roll, &picture);
        let outline = Outline::of(&local, roll);
        self.clock = self.clock.wrapping_add(1);
        let (person, clock) = (self.person, self.clock);
        let Some(keyframe) = self.table.get_mut(entry) else {
            return;
        };
        keyframe.count = 0;
        keyframe.bin = bin_of(&seen.angles);
        keyframe.person = person;
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
