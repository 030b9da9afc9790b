//! Every number of a result is finite, whatever camera is accepted: random cameras, also at the
//! limits of what is accepted, with real faces and with what a tiny model takes for faces.

mod common;
#[path = "../fuzz/src/targets/mod.rs"]
#[allow(dead_code)] // only some of the targets' parts are used here
mod targets;

// The targets use `crate::ffi`.
use posewise::ffi;

use common::random::Random;
use ffi::types::*;
use posewise::{Config, Intrinsics, State, TrackResult};
use targets::memory::Exact;
use targets::{outputs, tiny};

fn check(result: &TrackResult, camera: &Intrinsics) {
    // The text has all fields, those of later versions too.
    let text = format!("{result:?}");
    let finite = !text.contains("NaN") && !text.contains("inf");
    assert!(finite, "{camera:?}: {text}");
}

/// Tracks 20 frames of the demo clip's face again and again, with a new camera for each, and checks
/// every result. Frames that were tracked, and cameras that were refused.
fn track_demo(
    rounds: i64,
    mut random: Random,
    camera: impl Fn(&mut Random) -> Intrinsics,
) -> (usize, usize) {
    let model = common::model();
    let config = Config::default().with_gaze(true).with_natural_gaze(true);
    let mut tracker = common::tracker(&config);
    let (mut tracked, mut refused) = (0, 0);
    for round in 0..rounds {
        for i in 0..20 {
            let camera = camera(&mut random);
            refused += usize::from(tracker.set_intrinsics(Some(camera)).is_err());
            let frame = common::demo().frame(20 + i);
            let now = (round * 20 + i as i64 + 1) * 33_333;
            let result = tracker.step(&model, &frame, now).expect("in order");
            tracked += usize::from(result.state == State::Tracking);
            check(result, &camera);
            check(tracker.smoothed(), &camera);
        }
    }
    println!("{tracked} tracked, {refused} cameras refused");
    (tracked, refused)
}

#[test]
fn real_faces() {
    let (tracked, refused) = track_demo(60, Random(1), |random| random.camera(6.0));
    assert!(tracked > 900 && refused > 100);
}

#[test]
fn real_faces_through_any_lens() {
    let (tracked, refused) = track_demo(40, Random(3), |random| {
        // Cameras with a field of view from 5° to nearly 180°.
        let focal = 10f32.powf(random.unit() * 2.0 + 1.5);
        Intrinsics::new(focal, focal, 160.0, 120.0).with_distortion(random.lens())
    });
    assert!(tracked > 600 && refused > 50);
}

#[test]
fn anything_taken_for_a_face() {
    const WIDTH: usize = 56;
    const HEIGHT: usize = 48;
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: 24,
        gaze: POSEWISE_GAZE_NATURAL,
        ..Default::default()
    };
    let mut random = Random(2);
    let mut data = Exact::new(WIDTH * HEIGHT, 1, 0);
    let mut tracked = 0;
    for _ in 0..2000 {
        let camera = random.camera(3.0);
        let Intrinsics { fx, fy, cx, cy, .. } = camera;
        let config = posewise_config {
            intrinsics: posewise_intrinsics { fx, fy, cx, cy },
            ..config
        };
        let Ok(mut tracker) = outputs::Tracker::new(tiny::model(), Some(&config), 0xA5) else {
            continue;
        };
        let (kind, noise) = (random.next() % 4, random.next() % 8 + 1);
        for step in 1..=6 {
            for (i, luma) in data.get_mut().iter_mut().enumerate() {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let smooth = [x * 4 + y, (x ^ y) * 3, 90 + (x * x + y * y) % 32, 0][kind as usize];
                *luma = (smooth as u64 + random.next() % noise) as u8;
            }
            let frame = posewise_frame {
                struct_size: size_of::<posewise_frame>() as u32,
                format: POSEWISE_FMT_GREY,
                timestamp_us: 33_333 * step,
                width: WIDTH as u32,
                height: HEIGHT as u32,
                stride: WIDTH as u32,
                rotation_deg: 0,
                flags: 0,
                reserved: 0,
                data_len: WIDTH * HEIGHT,
                data: data.ptr(),
            };
            // SAFETY: a whole frame.
            let outputs = unsafe { tracker.step(&frame) };
            tracked += usize::from(outputs.expect("a valid frame").is_tracking());
        }
    }
    println!("{tracked} tracked");
    assert!(tracked > 100);
}
