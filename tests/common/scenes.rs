//! Scenes in which a tracker does all that it can: a face comes, goes, jumps, is covered, damaged.

use super::random::Random;
use super::watch::{HEIGHT, LARGE, Pasted, SMALL, WIDTH, picture};
use super::{demo, grey, model, tracker};
use posewise::{Config, Frame, Model, State, Tracker};

/// Side of the blocks that are exchanged [px].
const BLOCK: usize = 16;

/// Exchanges some of a picture's blocks: texture that is as natural, and a face that is damaged.
fn damage(luma: &mut [u8], share: f32, random: &mut Random) {
    let (across, down) = (WIDTH / BLOCK, HEIGHT / BLOCK);
    for _ in 0..(share * (across * down) as f32) as usize {
        let mut block = || {
            let [x, y] = [across, down].map(|n| random.below(n) * BLOCK);
            y * WIDTH + x
        };
        let (a, b) = (block(), block());
        for row in 0..BLOCK {
            for column in 0..BLOCK {
                luma.swap(a + row * WIDTH + column, b + row * WIDTH + column);
            }
        }
    }
}

/// Faces and the share of damage of each frame.
fn scenes() -> Vec<(Vec<Pasted>, f32)> {
    let at = |x: f32, y: f32| Pasted {
        at: [x, y],
        ..LARGE
    };
    let mut scenes = Vec::new();
    let mut show = |faces: &[Pasted], damaged: f32, frames: usize| {
        scenes.extend((0..frames).map(|_| (faces.to_vec(), damaged)));
    };
    show(&[], 2.0, 12);
    for _ in 0..4 {
        show(&[LARGE], 0.0, 24);
        show(&[at(200.0, 170.0)], 0.0, 8);
        show(&[LARGE, SMALL], 0.3, 8);
        show(&[LARGE], 0.8, 12);
        show(&[at(470.0, 185.0)], 0.5, 8);
        show(&[], 2.0, 24);
        show(&[SMALL], 0.2, 16);
    }
    scenes
}

/// What steps do, as docs/performance.md has them.
pub const KINDS: [&str; 4] = [
    "tracked on the frame before",
    "found, or found again",
    "searching",
    "lost, or coasting",
];

/// Takes a step of any scene.
pub fn step(
    _: usize,
    tracker: &mut Tracker,
    model: &Model<'_>,
    frame: &Frame<'_>,
    time_us: i64,
) -> bool {
    tracker.step(model, frame, time_us).expect("in order");
    true
}

/// Takes a step on each scene, as long as `take`, which takes it, says to go on; `done` is given
/// its number, its place in [`KINDS`] and its units.
pub fn watch_scenes(
    mut take: impl FnMut(usize, &mut Tracker, &Model<'_>, &Frame<'_>, i64) -> bool,
    mut done: impl FnMut(usize, usize, u32),
) {
    let (clip, model) = (demo(), model());
    let mut tracker = tracker(&Config::default());
    let mut random = Random(7);
    for (number, (faces, damaged)) in scenes().into_iter().enumerate() {
        let mut luma = picture(clip, number, &faces);
        damage(&mut luma, damaged, &mut random);
        let before = tracker.result().state;
        let frame = grey(WIDTH, HEIGHT, &luma);
        if !take(number, &mut tracker, &model, &frame, number as i64 * 33_333) {
            return;
        }
        let kind = match (before, tracker.result().state) {
            (State::Tracking, State::Tracking) => 0,
            (_, State::Tracking) => 1,
            (State::Searching, _) => 2,
            _ => 3,
        };
        done(number, kind, tracker.units());
    }
}
