//! The eyes of a result: nothing is seen of them without the setting, and with it nothing else
//! changes.

mod common;

use posewise::{Config, EyeUnknown, Eyes, Frame, FrameLayout, Model, State, Tracker};

#[test]
fn a_step_with_gaze_has_the_same_bits_and_the_eyes() {
    let Some(clip) = common::demo() else {
        eprintln!("skipped: there is no tests/data/demo.y4m.gz");
        return;
    };
    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let new = |gaze| {
        let config = Config::default().with_gaze(gaze);
        Box::new(Tracker::new(&config).expect("valid"))
    };
    let (mut without, mut with) = (new(false), new(true));
    let layout = FrameLayout::grey(clip.width as u32, clip.height as u32);
    let (mut tracked, mut known) = (0, 0);
    for (i, luma) in clip.luma.iter().enumerate() {
        let frame = Frame::new(&layout, luma).expect("a frame");
        let timestamp_us = (i as f64 * clip.frame_us) as i64;
        let step = |tracker: &mut Tracker| {
            let result = tracker.step(&model, &frame, timestamp_us);
            *result.expect("in order")
        };
        let (plain, mut seen) = (step(&mut without), step(&mut with));
        assert_eq!(plain.eyes, Eyes::EMPTY, "frame {i}");
        let eyes = seen.eyes;
        seen.eyes = Eyes::EMPTY;
        // The text has every bit of every number but the payload of a NaN.
        assert_eq!(format!("{plain:?}"), format!("{seen:?}"), "frame {i}");
        if seen.state != State::Tracking {
            assert_eq!(eyes, Eyes::EMPTY, "frame {i}");
            continue;
        }
        tracked += 1;
        known += usize::from(eyes.gaze.unknown == EyeUnknown::Known);
        for gaze in [eyes.each[0].gaze, eyes.each[1].gaze, eyes.gaze] {
            let is_known = gaze.unknown == EyeUnknown::Known;
            for axes in [gaze.camera, gaze.head] {
                let square: f32 = axes.iter().map(|v| v * v).sum();
                let expected = if is_known { 1.0 } else { 0.0 };
                assert!((square - expected).abs() < 1e-3, "frame {i}: {gaze:?}");
            }
            assert_eq!(gaze.sigma_deg > 0.0, is_known, "frame {i}: {gaze:?}");
        }
        assert!(
            eyes.look.iter().all(|v| (0.0..=1.0).contains(v)),
            "frame {i}"
        );
    }
    println!("the gaze is known in {known} of {tracked} frames");
    assert!(2 * known > tracked, "{known} of {tracked}");
}
