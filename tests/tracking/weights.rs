//! Animation weights that are seen: there are none in a model without section `WGHT`, and all else
//! is the same then.

use crate::common::{demo, model, tracker};
use posewise::{ANIMATION_NAMES, Config, Model, State};
use posewise_format::{AlignedBytes, without};

#[test]
fn without_the_section_what_is_seen_is_0_and_the_rest_is_the_same() {
    let clip = demo();
    let with = model();
    let smaller = without(posewise::DEFAULT_MODEL, &[*b"WGHT"]).expect("a valid model");
    let smaller = AlignedBytes::new(&smaller);
    let less = Model::load(&smaller).expect("a valid model");
    let mut trackers = [tracker(&Config::default()), tracker(&Config::default())];
    let first = ANIMATION_NAMES.iter().position(|name| *name == "cheekPuff");
    let first = first.expect("the first that is seen");
    let (mut largest, mut tracked) = ([0.0f32; ANIMATION_NAMES.len()], 0);
    for i in 0..clip.luma.len() {
        let (frame, timestamp_us) = (clip.frame(i), clip.time_us(i));
        let [full, part] = &mut trackers;
        let mut full = *(full.step(&with, &frame, timestamp_us)).expect("in order");
        let part = *(part.step(&less, &frame, timestamp_us)).expect("in order");
        tracked += usize::from(full.state == State::Tracking);
        for (largest, weight) in largest.iter_mut().zip(full.animation) {
            assert!((0.0..=1.0).contains(&weight), "frame {i}");
            *largest = largest.max(weight);
        }
        full.animation[first..].fill(0.0);
        // The text has every bit of every number but the payload of a NaN.
        assert_eq!(format!("{full:?}"), format!("{part:?}"), "frame {i}");
    }
    println!("largest of {tracked} frames: {:?}", &largest[first..]);
    assert!(largest[first..].iter().any(|weight| *weight > 0.05));
}
