//! With the feature `serde` results, settings and words go to JSON and back.

use crate::common::{demo, model, tracker};
use posewise::eyes::EyeUnknown;
use posewise::monitor::{MonitorConfig, MonitorEventKind, Observation, Preset, UnknownReason};
use posewise::{Config, Event, EventKind, Loss, Smoothing, State, TrackResult};
use serde::Serialize;
use serde::de::DeserializeOwned;

fn there_and_back<T: Serialize + DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("JSON");
    serde_json::from_str(&text).expect(&text)
}

#[test]
fn results_and_events_survive() {
    let (clip, model) = (demo(), model());
    let mut tracker = tracker(&Config::default().with_gaze(true));
    for i in 0..clip.luma.len() {
        let step = tracker.step(&model, &clip.frame(i), clip.time_us(i));
        let result: TrackResult = *step.expect("in order");
        assert_eq!(there_and_back(&result), result, "frame {i}");
        let seen = Observation::from(&result);
        assert_eq!(there_and_back(&seen), seen, "frame {i}");
    }
    let event: Event = tracker.events().pop().expect("a face was found");
    assert_eq!(there_and_back(&event), event);
}

#[test]
fn settings_survive_and_may_be_given_in_part() {
    let config = Config::default().with_smoothing(Smoothing::new(0.0, 3.0));
    assert_eq!(there_and_back(&config), config);
    let part: Config = serde_json::from_str(r#"{"gaze": true}"#).expect("one setting");
    assert_eq!(part, Config::default().with_gaze(true));
    for preset in Preset::ALL {
        let config: MonitorConfig = preset.config();
        assert_eq!(there_and_back(&config), config);
    }
}

#[test]
fn words_are_those_of_tables() {
    fn check<T: Serialize>(all: impl IntoIterator<Item = T>, name: fn(&T) -> &'static str) {
        for value in all {
            let text = serde_json::to_string(&value).expect("JSON");
            assert_eq!(text, format!("\"{}\"", name(&value)));
        }
    }
    check(State::ALL, |state| state.name());
    check(Loss::ALL, |loss| loss.name());
    check(EventKind::ALL, |kind| kind.name());
    check(EyeUnknown::ALL, |unknown| unknown.name());
    check(Preset::ALL, |preset| preset.name());
    check(MonitorEventKind::ALL, |kind| kind.name());
    let reasons = [
        UnknownReason::NoFace,
        UnknownReason::LowConfidence,
        UnknownReason::Turned,
        UnknownReason::Hidden,
    ];
    check(reasons, |reason| reason.name());
}
