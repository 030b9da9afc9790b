//! Which face a tracker takes, that it stays with it, and how it loses and finds one: the demo
//! clip's face pasted into larger pictures, once or twice.

mod common;

use common::{Clip, demo};
use posewise::{
    Config, ConfigError, FaceHint, Frame, FrameLayout, Loss, Model, Roi, State, StepError,
    TrackResult, Tracker,
};

const WIDTH: usize = 640;
const HEIGHT: usize = 360;
const FRAME_US: i64 = 40_000;
/// Middle and width of the clip's face in its first frames, about \[px\].
const FACE: ([f32; 2], f32) = ([160.0, 130.0], 90.0);

/// A face of the clip: how many times its size, where its middle goes.
#[derive(Clone, Copy)]
struct Pasted {
    scale: f32,
    at: [f32; 2],
}

/// A picture with such faces; later ones lie over earlier ones.
fn picture(clip: &Clip, frame: usize, faces: &[Pasted]) -> Vec<u8> {
    // Forwards and backwards, so that the face never jumps.
    let from = &clip.luma[(frame % 38).min(38 - frame % 38)];
    let ground = |i: usize| 90 + (((i % WIDTH) * 7 + (i / WIDTH) * 13) % 31) as u8;
    let mut luma: Vec<u8> = (0..WIDTH * HEIGHT).map(ground).collect();
    for face in faces {
        // Head and shoulders, not the clip's whole background.
        let half = 0.75 * FACE.1 * face.scale;
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let [dx, dy] = [x as f32 - face.at[0], y as f32 - face.at[1]];
                if dx.abs() > half || dy.abs() > half {
                    continue;
                }
                let u = (FACE.0[0] + dx / face.scale).round() as usize;
                let v = (FACE.0[1] + dy / face.scale).round() as usize;
                if u < clip.width && v < clip.height {
                    luma[y * WIDTH + x] = from[v * clip.width + u];
                }
            }
        }
    }
    luma
}

/// A picture as a camera shows it in a room so dim: every level is this share of what it was, and
/// the sensor's noise, up to half of this to either side, stays.
fn dimmed(luma: &mut [u8], share: f32, noise: f32, frame: usize) {
    for (i, level) in luma.iter_mut().enumerate() {
        let mixed = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ (frame as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let random = (mixed.wrapping_mul(0x94d0_49bb_1331_11eb) >> 40) as f32 / (1 << 24) as f32;
        *level = (share * *level as f32 + noise * (random - 0.5)).clamp(0.0, 255.0) as u8;
    }
}

struct Watch<'m> {
    clip: Clip,
    /// 1 by day.
    light: f32,
    /// Range of the sensor's noise [grey levels]; as long as it is light there is none.
    noise: f32,
    model: &'m Model<'m>,
    tracker: Box<Tracker>,
    frame: usize,
}

impl Watch<'_> {
    fn see(&mut self, faces: &[Pasted]) -> TrackResult {
        let mut luma = picture(&self.clip, self.frame, faces);
        if self.light < 1.0 {
            dimmed(&mut luma, self.light, self.noise, self.frame);
        }
        let layout = FrameLayout::grey(WIDTH as u32, HEIGHT as u32);
        let frame = Frame::new(&layout, &luma).expect("a frame");
        let time = self.frame as i64 * FRAME_US;
        self.frame += 1;
        *self
            .tracker
            .step(self.model, &frame, time)
            .expect("time goes on")
    }

    /// One step for a caller who expects this face, whose box is off by a share of its size.
    fn see_at(&mut self, faces: &[Pasted], expected: Pasted, off: f32) -> TrackResult {
        let luma = picture(&self.clip, self.frame, faces);
        let layout = FrameLayout::grey(WIDTH as u32, HEIGHT as u32);
        let frame = Frame::new(&layout, &luma).expect("a frame");
        let time = self.frame as i64 * FRAME_US;
        self.frame += 1;
        let side = FACE.1 * expected.scale;
        let [x, y] = expected.at.map(|v| v + (off - 0.5) * side);
        let hint = FaceHint::new([x, y, side, side]);
        *self
            .tracker
            .step_at(self.model, &frame, time, &hint)
            .expect("time goes on")
    }

    /// Shows the same until a face is tracked; how many frames that took.
    fn until_tracked(&mut self, faces: &[Pasted], most: usize) -> (usize, TrackResult) {
        for n in 1..=most {
            let result = self.see(faces);
            if result.state == State::Tracking {
                return (n, result);
            }
        }
        panic!("not tracked in {most} frames");
    }
}

/// Runs a test on the clip, if it is there.
fn watch(config: Config, test: impl FnOnce(&mut Watch<'_>)) {
    let Some(clip) = demo() else {
        eprintln!("skipped: there is no tests/data/demo.y4m.gz");
        return;
    };
    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    test(&mut Watch {
        clip,
        light: 1.0,
        noise: 6.0,
        model: &model,
        tracker: Box::new(Tracker::new(&config).expect("good settings")),
        frame: 0,
    });
}

fn middle(result: &TrackResult) -> [f32; 2] {
    let [x, y, w, h] = result.face_box;
    [x + w / 2.0, y + h / 2.0]
}

fn is_at(result: &TrackResult, face: Pasted) -> bool {
    let [x, y] = middle(result);
    (x - face.at[0]).hypot(y - face.at[1]) < 0.3 * FACE.1 * face.scale
}

const SMALL: Pasted = Pasted {
    scale: 0.9,
    at: [130.0, 180.0],
};
const LARGE: Pasted = Pasted {
    scale: 1.7,
    at: [430.0, 180.0],
};

/// The whole frame is searched at once.
fn patient() -> Config {
    let mut config = Config::default();
    config.scan_budget = 1_000_000;
    config
}

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
        let luma = picture(&watch.clip, 0, &[LARGE]);
        let layout = FrameLayout::grey(WIDTH as u32, HEIGHT as u32);
        let frame = Frame::new(&layout, &luma).expect("a frame");
        let hint = FaceHint::new([0.0, 0.0, f32::NAN, 50.0]);
        let step = watch.tracker.step_at(watch.model, &frame, 0, &hint);
        assert_eq!(step.err(), Some(StepError::Hint));
        // The timestamp was not used up.
        assert!(watch.tracker.step(watch.model, &frame, 0).is_ok());
    });
}

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
                let found = result.state == State::Tracking;
                assert!(!found, "{n}: {:?}", result.face_box);
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
        let luma = picture(&watch.clip, 0, &[LARGE]);
        let layout = FrameLayout::grey(WIDTH as u32, HEIGHT as u32);
        let frame = Frame::new(&layout, &luma).expect("a frame");
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
            assert_eq!(result.loss, Loss::LowConfidence);
        }
        let back = Pasted {
            at: [220.0, 170.0],
            ..LARGE
        };
        let (frames, result) = watch.until_tracked(&[back], 10);
        assert!(is_at(&result, back), "{:?}", result.face_box);
        println!("found after {frames} frames");
        assert_eq!(result.loss, Loss::None);
    });
}

#[test]
fn a_large_face_that_appears_is_found_soon_wherever_the_sweep_is() {
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
    // Smaller than what every other slice goes to, and never twice where it was.
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
        assert!(reasons.iter().all(|r| *r != Loss::None), "{reasons:?}");
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
        let known = |result: &TrackResult| result.eye_open.map(|open| open >= 0.0);
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
fn smoothed_answers_follow_the_raw_ones() {
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
