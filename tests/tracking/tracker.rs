//! Which face a tracker takes, that it stays with it, and how it loses and finds one: the demo
//! clip's face pasted into larger pictures, once or twice.

use crate::common::grey;
use crate::common::watch::{
    FACE, FRAME_US, HEIGHT, LARGE, Pasted, SMALL, WIDTH, is_at, patient, picture, watch,
};
use posewise::{Config, FaceHint, Loss, State, StepError, TrackResult};

#[test]
fn the_largest_face_is_picked() {
    watch(patient(), |watch| {
        let (_, result) = watch.until_tracked(&[SMALL, LARGE], 3);
        assert!(is_at(&result, LARGE), "{:?}", result.face_box);
    });
}

/// A camera's budget finds a small face much later.
#[test]
fn an_expected_face_is_tracked_at_once() {
    for off in [0.0, 0.1, -0.2] {
        watch(Config::default(), |watch| {
            let result = watch.see_at(&[SMALL, LARGE], SMALL, off);
            assert_eq!(result.state, State::Tracking, "{off}");
            assert!(is_at(&result, SMALL), "{off}: {:?}", result.face_box);
        });
    }
}

#[test]
fn where_no_face_is_expected_the_search_goes_on() {
    watch(Config::default(), |watch| {
        let result = (0..60)
            .map(|_| watch.see_at(&[LARGE], SMALL, 0.0))
            .find(|result| result.state == State::Tracking);
        assert!(is_at(&result.expect("found"), LARGE));
    });
}

#[test]
fn a_tracked_face_stays_where_another_is_expected() {
    watch(patient(), |watch| {
        watch.until_tracked(&[LARGE], 3);
        for _ in 0..5 {
            let result = watch.see_at(&[SMALL, LARGE], SMALL, 0.0);
            assert!(is_at(&result, LARGE), "{:?}", result.face_box);
        }
    });
}

#[test]
fn a_hint_out_of_range_changes_nothing() {
    watch(Config::default(), |watch| {
        let luma = picture(watch.clip, 0, &[LARGE]);
        let frame = grey(WIDTH, HEIGHT, &luma);
        let hint = FaceHint::new([0.0, 0.0, f32::NAN, 50.0]);
        let step = watch.tracker.step_at(watch.model, &frame, 0, &hint);
        assert_eq!(step.err(), Some(StepError::Hint));
        // The timestamp was not used up.
        assert!(watch.tracker.step(watch.model, &frame, 0).is_ok());
    });
}

#[test]
fn a_larger_newcomer_does_not_steal_it() {
    watch(patient(), |watch| {
        watch.until_tracked(&[SMALL], 3);
        for _ in 0..10 {
            watch.see(&[SMALL]);
        }
        for _ in 0..30 {
            let result = watch.see(&[SMALL, LARGE]);
            assert_eq!(result.state, State::Tracking);
            assert!(is_at(&result, SMALL), "{:?}", result.face_box);
        }
    });
}

#[test]
fn a_second_face_that_passes_does_not_attract_it() {
    watch(patient(), |watch| {
        let own = Pasted {
            scale: 1.2,
            at: [320.0, 180.0],
        };
        watch.until_tracked(&[own], 3);
        for n in 0..60 {
            let other = Pasted {
                scale: 1.0,
                at: [40.0 + 3.0 * n as f32, 180.0],
            };
            // From far away to side by side; the tracked face is in front.
            let result = watch.see(&[other, own]);
            assert_eq!(result.state, State::Tracking, "{n}");
            assert!(is_at(&result, own), "{n}: {:?}", result.face_box);
        }
    });
}

#[test]
fn a_face_that_comes_back_elsewhere_is_found_at_the_camera_s_budget() {
    watch(Config::default(), |watch| {
        watch.until_tracked(&[LARGE], 60);
        for _ in 0..20 {
            watch.see(&[LARGE]);
        }
        for n in 0..25 {
            let result = watch.see(&[]);
            assert_ne!(result.state, State::Tracking);
            let held = (n + 1) * FRAME_US <= 500_000;
            assert_eq!(result.state == State::Coasting, held, "{n}");
            assert_eq!(result.loss, Some(Loss::LowConfidence));
        }
        let back = Pasted {
            at: [220.0, 170.0],
            ..LARGE
        };
        let (frames, result) = watch.until_tracked(&[back], 10);
        assert!(is_at(&result, back), "{:?}", result.face_box);
        println!("found after {frames} frames");
        assert_eq!(result.loss, None);
    });
}

#[test]
fn a_large_face_that_appears_is_found_soon_wherever_the_scan_is() {
    for empty in [1, 13, 25, 37] {
        watch(Config::default(), |watch| {
            for _ in 0..empty {
                assert_eq!(watch.see(&[]).state, State::Searching);
            }
            let (frames, result) = watch.until_tracked(&[LARGE], 15);
            assert!(is_at(&result, LARGE), "{:?}", result.face_box);
            println!("found after {frames} frames, {empty} into the scan");
        });
    }
}

#[test]
fn a_small_face_that_moves_is_found() {
    // Smaller than the faces that half of the scan's work goes to, and never twice at one place.
    let (from, to) = ([60.0, 100.0], [560.0, 240.0]);
    watch(Config::default(), |watch| {
        let tracked = (0..60).any(|n| {
            let share = n as f32 / 60.0;
            let at = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
            watch.see(&[Pasted { at, ..SMALL }]).state == State::Tracking
        });
        assert!(tracked);
    });
}

#[test]
fn a_face_in_a_dim_room_is_found() {
    watch(patient(), |watch| {
        watch.light = 0.12;
        let (_, result) = watch.until_tracked(&[SMALL], 3);
        assert!(is_at(&result, SMALL));
    });
}

#[test]
fn a_face_full_of_noise_is_found_and_kept() {
    watch(patient(), |watch| {
        (watch.light, watch.noise) = (0.9, 130.0);
        let (_, result) = watch.until_tracked(&[SMALL], 3);
        assert!(is_at(&result, SMALL));
        for _ in 0..20 {
            let result = watch.see(&[SMALL]);
            assert_eq!(result.state, State::Tracking);
            assert!(is_at(&result, SMALL));
        }
    });
}

#[test]
fn the_reason_of_a_loss_is_told() {
    watch(patient(), |watch| {
        watch.until_tracked(&[LARGE], 3);
        // Out of the picture, a tenth of its width per frame.
        let mut reasons = Vec::new();
        for n in 0..40 {
            let gone = Pasted {
                at: [LARGE.at[0] + 15.0 * n as f32, LARGE.at[1]],
                ..LARGE
            };
            let result = watch.see(&[gone]);
            if result.state != State::Tracking {
                reasons.push(result.loss);
            }
        }
        assert!(reasons.iter().all(Option::is_some), "{reasons:?}");
        assert!(!reasons.is_empty());
    });
}

#[test]
fn eyes_that_move_too_fast_to_tell_are_unknown() {
    watch(patient(), |watch| {
        let at = |x: f32| Pasted {
            scale: 1.7,
            at: [x, 180.0],
        };
        watch.until_tracked(&[at(200.0)], 3);
        let known = |result: &TrackResult| result.eye_open.map(|open| open.is_some());
        assert_eq!(known(&watch.see(&[at(200.0)])), [true; 2]);
        // An eye is some 26 px wide: it moves by 0.8 of that in 1/30 s.
        for n in 1..=4 {
            let result = watch.see(&[at(200.0 + 25.0 * n as f32)]);
            assert_eq!(result.state, State::Tracking, "{n}");
            assert_eq!(known(&result), [false; 2], "{n}: {:?}", result.eye_open);
        }
        assert_eq!(known(&watch.see(&[at(300.0)])), [true; 2]);
    });
}

#[test]
fn smoothed_results_follow_the_raw_ones() {
    watch(patient(), |watch| {
        let (_, raw) = watch.until_tracked(&[LARGE], 3);
        assert_eq!(
            *watch.tracker.smoothed(),
            raw,
            "the first result is not smoothed"
        );
        for _ in 0..20 {
            let raw = watch.see(&[LARGE]);
            let smooth = watch.tracker.smoothed();
            assert_eq!(
                (smooth.state, smooth.timestamp_us),
                (raw.state, raw.timestamp_us)
            );
            assert!((smooth.yaw_deg - raw.yaw_deg).abs() < 5.0);
            let pairs = smooth.landmarks.iter().zip(&raw.landmarks);
            let off = pairs.map(|(a, b)| (a.x - b.x).hypot(a.y - b.y));
            assert!(off.fold(0.0, f32::max) < 0.05 * FACE.1 * LARGE.scale);
        }
        watch.tracker.reset();
        assert_eq!(*watch.tracker.smoothed(), TrackResult::EMPTY);
    });
}
