//! No step does much more than another, whatever happens to the face: the work of all parts of a
//! step, counted by the tracker in units of which a step that tracks has 2,600.

use crate::common::random::Random;
use crate::common::watch::{HEIGHT, LARGE, Pasted, SMALL, WIDTH, picture};
use crate::common::{check_page, demo, grey, model, tracker};
use posewise::{Config, State};

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

/// A face comes, goes, jumps, is covered and damaged.
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

#[test]
fn the_work_of_a_step_is_bounded_in_every_state() {
    let (clip, model) = (demo(), model());
    let mut tracker = tracker(&Config::default());
    let mut random = Random(7);
    let mut most = [0; 4];
    for (frame, (faces, damaged)) in scenes().into_iter().enumerate() {
        let mut luma = picture(clip, frame, &faces);
        damage(&mut luma, damaged, &mut random);
        let before = tracker.result().state;
        let time_us = frame as i64 * 33_333;
        let step = tracker.step(&model, &grey(WIDTH, HEIGHT, &luma), time_us);
        let after = step.expect("in order").state;
        let kind = match (before, after) {
            (State::Tracking, State::Tracking) => 0,
            (_, State::Tracking) => 1,
            (State::Searching, _) => 2,
            _ => 3,
        };
        most[kind] = most[kind].max(tracker.units());
    }
    println!("tracking, acquiring, searching, coasting: {most:?} units at most");
    let rows = [
        "tracked on the frame before",
        "found, or found again",
        "searching",
        "lost, or coasting",
    ];
    for (row, units) in rows.into_iter().zip(most) {
        check_page("docs/performance.md", row, units as usize, 0.0);
    }
}
