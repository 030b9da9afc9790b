//! A face that is lost and returns elsewhere is re-acquired by keyframes within two steps.
#![cfg(feature = "keyframes")]

use crate::common::{demo, grey, model, tracker};
use posewise::{Config, State, Tracker};

/// A frame of the demo clip, shifted \[px\]; pixels from outside repeat the edge.
fn shifted(luma: &[u8], width: usize, height: usize, (dx, dy): (i32, i32)) -> Vec<u8> {
    let at = |i: usize, shift: i32, n: usize| (i as i32 - shift).clamp(0, n as i32 - 1) as usize;
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    rows.map(|(x, y)| luma[at(y, dy, height) * width + at(x, dx, width)])
        .collect()
}

#[test]
fn a_face_that_returns_elsewhere_is_reacquired() {
    let clip = demo();
    let (width, height) = (clip.width, clip.height);
    let (model, new) = (model(), || tracker(&Config::default()));
    let mut tracker = new();
    let mut now = 0;
    let mut step = |tracker: &mut Tracker, luma: &[u8]| {
        now += clip.frame_us as i64;
        let frame = grey(width, height, luma);
        let result = tracker.step(&model, &frame, now).expect("in order");
        (result.state, result.landmarks[30])
    };
    for luma in &clip.luma[..60] {
        step(&mut tracker, luma);
    }
    let (_, nose) = step(&mut tracker, &clip.luma[60]);
    let empty = vec![90; width * height];
    for shift in [(60, 20), (-50, -25), (0, 30)] {
        for _ in 0..30 {
            let (state, _) = step(&mut tracker, &empty);
            assert_ne!(state, State::Tracking);
        }
        let back = shifted(&clip.luma[60], width, height, shift);
        let mut steps = (1..=2).map(|_| step(&mut tracker, &back));
        let found = steps.find(|(state, _)| *state == State::Tracking);
        let (_, reacquired) = found.expect("tracked within two steps");
        let off =
            (reacquired.x - nose.x - shift.0 as f32).hypot(reacquired.y - nose.y - shift.1 as f32);
        assert!(off < 4.0, "{off} px off after a shift by {shift:?}");
    }
    // Without its keyframes the tracker searches as one that has seen nothing.
    tracker.forget_identity();
    for _ in 0..30 {
        step(&mut tracker, &empty);
    }
    let mut fresh = new();
    step(&mut fresh, &empty);
    tracker.reset();
    step(&mut tracker, &empty);
    let back = shifted(&clip.luma[60], width, height, (60, 20));
    for _ in 0..40 {
        let (a, b) = (step(&mut tracker, &back), step(&mut fresh, &back));
        assert_eq!(a.0, b.0, "same state as a new tracker");
    }
}
