//! The eyes of a result: nothing is seen of them without the setting, and with it nothing else
//! changes.

use crate::common::{demo, model, tracker};
use posewise::eyes::Eyes;
use posewise::{Config, State, Tracker};

#[test]
fn a_step_with_gaze_has_the_same_bits_and_the_eyes() {
    let clip = demo();
    let model = model();
    let new = |gaze| tracker(&Config::default().with_gaze(gaze));
    let (mut without, mut with) = (new(false), new(true));
    let (mut tracked, mut known) = (0, 0);
    for i in 0..clip.luma.len() {
        let (frame, timestamp_us) = (clip.frame(i), clip.time_us(i));
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
        known += usize::from(eyes.gaze.is_ok());
        let gazes = [eyes.each[0].gaze, eyes.each[1].gaze, eyes.gaze];
        for gaze in gazes.into_iter().flatten() {
            for axes in [gaze.camera, gaze.head] {
                let square: f32 = axes.iter().map(|v| v * v).sum();
                assert!((square - 1.0).abs() < 1e-3, "frame {i}: {gaze:?}");
            }
            assert!(gaze.sigma_deg > 0.0, "frame {i}: {gaze:?}");
        }
        assert!(
            eyes.look.iter().all(|v| (0.0..=1.0).contains(v)),
            "frame {i}"
        );
    }
    println!("the gaze is known in {known} of {tracked} frames");
    assert!(2 * known > tracked, "{known} of {tracked}");
}

#[test]
fn a_natural_gaze_is_near_the_gaze_and_nothing_else_changes() {
    let clip = demo();
    let model = model();
    let config = Config::default().with_gaze(true);
    let mut trackers = [tracker(&config), tracker(&config.with_natural_gaze(true))];
    let mut largest = 0.0f32;
    for i in 0..clip.luma.len() {
        let (frame, timestamp_us) = (clip.frame(i), clip.time_us(i));
        let [plain, natural] = trackers.each_mut().map(|tracker| {
            let result = tracker.step(&model, &frame, timestamp_us);
            *result.expect("in order")
        });
        let unknown = |eyes: &Eyes| eyes.each.map(|eye| (eye.open, eye.gaze.err()));
        assert_eq!(unknown(&plain.eyes), unknown(&natural.eyes), "frame {i}");
        let without = |mut result: posewise::TrackResult| {
            result.eyes = Eyes::EMPTY;
            format!("{result:?}")
        };
        assert_eq!(without(plain), without(natural), "frame {i}");
        let (Ok(plain), Ok(natural)) = (plain.eyes.gaze, natural.eyes.gaze) else {
            continue;
        };
        let pairs = plain.camera.iter().zip(natural.camera);
        let cosine: f32 = pairs.map(|(a, b)| a * b).sum();
        largest = largest.max(cosine.clamp(-1.0, 1.0).acos().to_degrees());
    }
    assert!((0.2..8.5).contains(&largest), "{largest}");
}
