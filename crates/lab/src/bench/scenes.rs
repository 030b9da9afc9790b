//! The frames of `posewise-lab bench`: everything that makes a step expensive, in a fixed order.
//!
//! | part | of it | visits |
//! |---|---|---|
//! | empty | a shuffled picture | search without keyframes |
//! | clip | its frames in order | acquisition, tracking |
//! | then six times: gone | a cut to another shuffled picture | loss, coasting, search |
//! | moved | the clip, moved | the face is reacquired |
//! | jump | the clip, moved the other way | loss, the face is found while coasting |
//! | damaged | the clip, half of its blocks shuffled | low confidence: rejections, retries |
//!
//! A shuffled picture is a frame cut into blocks in a random order: natural texture without a face.

use image::GrayImage;

use crate::footage::clip::moved;
use crate::random::Random;

/// Side of the shuffled blocks \[px\].
const BLOCK: u32 = 16;
/// How often the face disappears.
const ROUNDS: usize = 6;
/// Steps of a shuffled picture: half a second of coasting and a whole search after it.
const GONE: usize = 45;
/// Steps of each part with a face.
const PART: usize = 20;
const SEED: u64 = 1;

/// The frame of one step.
#[derive(Clone, Copy, Debug)]
enum Scene {
    Frame { at: usize, right: i32, down: i32 },
    Shuffled { at: usize },
    Damaged { at: usize, by: usize },
}

/// The clip, the pictures made from it, and their order.
pub struct Scenes<'c> {
    frames: &'c [GrayImage],
    shuffled: Vec<GrayImage>,
    order: Vec<Scene>,
}

impl<'c> Scenes<'c> {
    /// Of the frames of a clip, at least one.
    pub fn of(frames: &'c [GrayImage]) -> Self {
        let mut random = Random::of(SEED);
        let n = frames.len();
        let some = (0..=ROUNDS).map(|k| &frames[k * n / (ROUNDS + 1)]);
        let shuffled: Vec<GrayImage> = some.map(|frame| shuffle(frame, &mut random)).collect();
        let (width, height) = frames[0].dimensions();
        let mut order = vec![Scene::Shuffled { at: 0 }; GONE];
        let frame = |at: usize, (right, down): (i32, i32)| Scene::Frame {
            at: at % n,
            right,
            down,
        };
        order.extend((0..n).map(|at| frame(at, (0, 0))));
        for round in 1..=ROUNDS {
            let start = random.below(n);
            let by = (
                random.within((width / 4) as i32),
                random.within((height / 8) as i32),
            );
            order.extend([Scene::Shuffled { at: round }; GONE]);
            order.extend((0..PART).map(|i| frame(start + i, by)));
            order.extend((PART..2 * PART).map(|i| frame(start + i, (-by.0, -by.1))));
            order.extend((0..PART).map(|i| Scene::Damaged {
                at: (start + i) % n,
                by: round,
            }));
        }
        Scenes {
            frames,
            shuffled,
            order,
        }
    }

    /// The pictures without a face.
    pub fn shuffled(&self) -> &[GrayImage] {
        &self.shuffled
    }

    /// The pictures of all steps, each made on demand.
    pub fn pictures(&self) -> impl Iterator<Item = GrayImage> {
        self.order.iter().map(|scene| match *scene {
            Scene::Frame { at, right, down } => moved(&self.frames[at], right, down),
            Scene::Shuffled { at } => moved(&self.shuffled[at], 0, 0),
            Scene::Damaged { at, by } => damage(&self.frames[at], &self.shuffled[by]),
        })
    }
}

/// A frame with its blocks in a random order.
fn shuffle(frame: &GrayImage, random: &mut Random) -> GrayImage {
    let (w, h) = frame.dimensions();
    let across = w.div_ceil(BLOCK);
    let mut order: Vec<u32> = (0..across * h.div_ceil(BLOCK)).collect();
    random.shuffle(&mut order);
    GrayImage::from_fn(w, h, |x, y| {
        let from = order[(y / BLOCK * across + x / BLOCK) as usize];
        let (bx, by) = (from % across * BLOCK, from / across * BLOCK);
        // A block at the right or lower edge may be cut.
        *frame.get_pixel((bx + x % BLOCK).min(w - 1), (by + y % BLOCK).min(h - 1))
    })
}

/// Every other block, as on a chess board, of the other picture.
fn damage(frame: &GrayImage, other: &GrayImage) -> GrayImage {
    GrayImage::from_fn(frame.width(), frame.height(), |x, y| {
        let other_one = (x / BLOCK + y / BLOCK) % 2 == 1;
        *if other_one { other } else { frame }.get_pixel(x, y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shuffling_keeps_the_pixels() {
        let image = GrayImage::from_fn(64, 32, |x, y| image::Luma([(x + 2 * y) as u8]));
        let mut new = shuffle(&image, &mut Random::of(3)).into_raw();
        let mut old = image.into_raw();
        assert_ne!(old, new);
        old.sort_unstable();
        new.sort_unstable();
        assert_eq!(old, new);
    }

    #[test]
    fn the_same_pictures_every_time() {
        let frame = |k: u32| GrayImage::from_fn(40, 30, |x, y| image::Luma([(x * y + k) as u8]));
        let frames: Vec<GrayImage> = (0..3).map(frame).collect();
        let (a, b) = (Scenes::of(&frames), Scenes::of(&frames));
        assert!(a.pictures().eq(b.pictures()));
        let steps = GONE + 3 + ROUNDS * (GONE + 3 * PART);
        assert_eq!(a.pictures().count(), steps);
    }
}
