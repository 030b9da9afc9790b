//! Pictures with several faces: the region of interest, excluded faces, and the list of faces.

use crate::common::grey;
use crate::common::watch::{
    FACE, HEIGHT, LARGE, Pasted, SMALL, WIDTH, Watch, is_at, patient, picture, watch,
};
use posewise::{Config, ConfigError, FoundFace, Loss, MAX_EXCLUDED, Roi};
use posewise::{State, StepError};

/// The half of the picture with the small face.
const LEFT: Roi = Roi::new(0, 0, 260, HEIGHT as u32);

#[test]
fn only_faces_centred_in_the_region_are_found() {
    // The largest comes first without a region, as another test shows.
    watch(patient().with_roi(LEFT), |watch| {
        let (frames, result) = watch.until_tracked(&[SMALL, LARGE], 3);
        assert!(is_at(&result, SMALL), "{frames}: {:?}", result.face_box);
    });
    watch(patient().with_roi(LEFT), |watch| {
        for n in 0..10 {
            assert_eq!(watch.see(&[LARGE]).state, State::Searching, "{n}");
            let result = watch.see_at(&[LARGE], LARGE, 0.0);
            assert_eq!(result.state, State::Searching, "{n}: by a hint");
        }
        // From the next step on.
        watch.tracker.set_roi(None).expect("the whole frame");
        watch.until_tracked(&[LARGE], 3);
    });
}

#[test]
fn a_lost_face_is_not_found_again_outside_of_the_region() {
    for outside in [[360.0, 180.0], [520.0, 180.0]] {
        watch(patient(), |watch| {
            let at = |x: f32| Pasted {
                at: [x, 180.0],
                ..LARGE
            };
            watch.until_tracked(&[at(200.0)], 3);
            for _ in 0..20 {
                watch.see(&[at(200.0)]);
            }
            watch.tracker.set_roi(Some(LEFT)).expect("in the frame");
            // It jumps there: local search, scan and keyframes would find it.
            for n in 0..30 {
                let moved = Pasted {
                    at: outside,
                    ..LARGE
                };
                let result = watch.see(&[moved]);
                let found = result.state == State::Tracking && is_at(&result, moved);
                assert!(!found, "{n}: {:?}", result.face_box);
                // The old place may be kept for a moment, as if something covered the face.
                assert!(n < 5 || result.state != State::Tracking, "{n}");
            }
            let (_, result) = watch.until_tracked(&[at(200.0)], 3);
            assert!(is_at(&result, at(200.0)));
        });
    }
}

#[test]
fn a_tracked_face_may_leave_the_region() {
    watch(patient().with_roi(LEFT), |watch| {
        let at = |x: f32| Pasted {
            scale: 1.2,
            at: [x, 180.0],
        };
        watch.until_tracked(&[at(200.0)], 3);
        for n in 0..40 {
            let result = watch.see(&[at(200.0 + 4.0 * n as f32)]);
            assert_eq!(result.state, State::Tracking, "{n}");
        }
    });
}

#[test]
fn a_region_must_lie_in_the_frame() {
    watch(Config::default(), |watch| {
        let luma = picture(watch.clip, 0, &[LARGE]);
        let frame = grey(WIDTH, HEIGHT, &luma);
        let whole = Roi::new(0, 0, WIDTH as u32, HEIGHT as u32);
        let beyond = Roi::new(1, 0, WIDTH as u32, HEIGHT as u32);
        watch.tracker.set_roi(Some(beyond)).expect("some frame");
        let step = watch.tracker.step(watch.model, &frame, 0);
        assert_eq!(step.err(), Some(StepError::Roi));
        let empty = Roi::new(5, 5, 0, 5);
        assert_eq!(
            watch.tracker.set_roi(Some(empty)).err(),
            Some(ConfigError::Roi)
        );
        assert_eq!(watch.tracker.config().roi, Some(beyond));
        watch.tracker.set_roi(Some(whole)).expect("the whole frame");
        // The timestamp was not used up.
        assert!(watch.tracker.step(watch.model, &frame, 0).is_ok());
    });
}

/// Box of a pasted face.
fn face_box(face: Pasted) -> [f32; 4] {
    let side = FACE.1 * face.scale;
    let [x, y] = face.at.map(|v| v - side / 2.0);
    [x, y, side, side]
}

#[test]
fn an_excluded_face_is_not_found() {
    watch(patient(), |watch| {
        watch.tracker.set_excluded(&[face_box(LARGE)]).expect("one");
        let (_, result) = watch.until_tracked(&[SMALL, LARGE], 3);
        assert!(is_at(&result, SMALL), "{:?}", result.face_box);
    });
    watch(patient(), |watch| {
        watch.tracker.set_excluded(&[face_box(LARGE)]).expect("one");
        for _ in 0..8 {
            assert_eq!(watch.see_at(&[LARGE], LARGE, 0.0).state, State::Searching);
        }
        watch.tracker.set_excluded(&[]).expect("none");
        watch.until_tracked(&[LARGE], 3);
    });
}

/// A tracker that has slid onto the face of another one gives it back.
#[test]
fn a_tracked_face_that_is_excluded_is_lost_and_another_found() {
    watch(patient(), |watch| {
        watch.until_tracked(&[LARGE], 3);
        for _ in 0..10 {
            watch.see(&[LARGE]);
        }
        watch.tracker.set_excluded(&[face_box(LARGE)]).expect("one");
        let result = watch.see(&[LARGE]);
        assert_eq!(
            (result.state, result.loss),
            (State::Coasting, Some(Loss::Excluded))
        );
        for n in 0..5 {
            assert_ne!(watch.see(&[LARGE]).state, State::Tracking, "{n}");
        }
        let other = Pasted {
            at: [160.0, 180.0],
            ..LARGE
        };
        let (_, result) = watch.until_tracked(&[LARGE, other], 5);
        assert!(is_at(&result, other), "{:?}", result.face_box);
    });
}

#[test]
fn excluded_boxes_are_checked() {
    watch(Config::default(), |watch| {
        let good = [0.0, 0.0, 50.0, 50.0];
        let many = [good; MAX_EXCLUDED + 1];
        for bad in [&many[..], &[[0.0, 0.0, f32::NAN, 50.0]]] {
            let set = watch.tracker.set_excluded(bad);
            assert_eq!(set.err(), Some(ConfigError::Excluded));
        }
        assert!(watch.tracker.set_excluded(&many[1..]).is_ok());
    });
}

/// Calls on one picture until the scan is finished: all faces, and the number of calls.
fn detect_all(watch: &mut Watch<'_>, faces: &[Pasted], room: usize) -> (Vec<FoundFace>, usize) {
    let luma = picture(watch.clip, 0, faces);
    let frame = grey(WIDTH, HEIGHT, &luma);
    let mut all = Vec::new();
    for calls in 1..2000 {
        let mut found = vec![FoundFace::default(); room];
        let detect = watch.tracker.detect(watch.model, &frame, &mut found);
        let detected = detect.expect("a region in the frame");
        all.extend_from_slice(&found[..detected.count]);
        if detected.finished {
            return (all, calls);
        }
    }
    panic!("a scan ends");
}

fn has(found: &[FoundFace], face: Pasted) -> bool {
    found.iter().any(|f| {
        let [x, y, w, h] = f.face_box;
        let [u, v] = face.at;
        (x + w / 2.0 - u).hypot(y + h / 2.0 - v) < 0.3 * FACE.1 * face.scale
    })
}

#[test]
fn all_faces_of_a_frame_are_listed_with_any_budget() {
    for (config, most_calls) in [(patient(), 3), (Config::default(), 700)] {
        watch(config, |watch| {
            let (found, calls) = detect_all(watch, &[SMALL, LARGE], 8);
            assert!(calls <= most_calls, "{calls}");
            assert!(has(&found, SMALL) && has(&found, LARGE), "{found:?}");
            for face in &found {
                let right = has(&[*face], SMALL) || has(&[*face], LARGE);
                assert!(right && face.confidence >= 0.8, "{face:?}");
            }
            assert!(
                has(&found[..1], LARGE),
                "the largest comes first: {found:?}"
            );
            // The next call begins anew.
            assert!(has(&detect_all(watch, &[SMALL, LARGE], 8).0, LARGE));
        });
    }
}

#[test]
fn a_full_list_ends_a_call_and_the_next_one_goes_on() {
    watch(patient(), |watch| {
        let (found, calls) = detect_all(watch, &[SMALL, LARGE], 1);
        assert!(calls >= 3, "{calls}");
        assert!(
            has(&found[..1], LARGE) && has(&found[1..], SMALL),
            "{found:?}"
        );
    });
}

#[test]
fn neither_excluded_faces_nor_those_outside_of_the_region_are_listed() {
    watch(patient(), |watch| {
        watch.tracker.set_excluded(&[face_box(LARGE)]).expect("one");
        let (found, _) = detect_all(watch, &[SMALL, LARGE], 8);
        assert!(has(&found, SMALL) && !has(&found, LARGE), "{found:?}");
        watch.tracker.set_excluded(&[]).expect("none");
        watch.tracker.set_roi(Some(LEFT)).expect("in the frame");
        let (found, _) = detect_all(watch, &[SMALL, LARGE], 8);
        assert!(has(&found, SMALL) && !has(&found, LARGE), "{found:?}");
    });
}

#[test]
fn listing_faces_leaves_the_tracked_one_alone() {
    let track = |detects: bool| {
        let mut all = Vec::new();
        watch(patient(), |watch| {
            watch.until_tracked(&[LARGE], 3);
            for _ in 0..6 {
                if detects {
                    detect_all(watch, &[SMALL, LARGE], 8);
                }
                all.push(watch.see(&[SMALL, LARGE]));
            }
        });
        all
    };
    assert_eq!(track(true), track(false));
}
