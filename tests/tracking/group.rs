//! Groups: several trackers on the same pictures.

use crate::common::watch::{
    FRAME_US, HEIGHT, LARGE, Pasted, SMALL, WIDTH, is_at, patient, picture,
};
use crate::common::{demo, grey, model, tracker};
use posewise::{Config, Group, MAX_GROUP, Roi, State, StepError, TrackResult, Tracker};

const COUNT: usize = 3;

struct Shown {
    group: Group,
    trackers: Vec<Box<Tracker>>,
    frame: usize,
}

impl Shown {
    fn new(config: &Config) -> Shown {
        Shown {
            group: Group::new(),
            trackers: (0..COUNT).map(|_| tracker(config)).collect(),
            frame: 0,
        }
    }

    /// One step on the next frame with these faces.
    fn see(&mut self, faces: &[Pasted]) -> Vec<TrackResult> {
        let luma = picture(demo(), self.frame, faces);
        let frame = grey(WIDTH, HEIGHT, &luma);
        let now_us = self.frame as i64 * FRAME_US;
        self.frame += 1;
        (self.group)
            .step(&model(), &mut self.trackers, &frame, now_us)
            .expect("time goes on");
        self.trackers.iter().map(|t| *t.result()).collect()
    }
}

/// The tracker that follows this face.
fn who(results: &[TrackResult], face: Pasted) -> Option<usize> {
    let follows = |r: &TrackResult| r.state == State::Tracking && is_at(r, face);
    results.iter().position(follows)
}

#[test]
fn each_face_has_a_tracker_and_keeps_it() {
    let mut shown = Shown::new(&patient());
    let mut results = Vec::new();
    for _ in 0..3 {
        results = shown.see(&[SMALL, LARGE]);
    }
    let (small, large) = (who(&results, SMALL), who(&results, LARGE));
    assert!(small.is_some() && large.is_some() && small != large);
    for n in 0..60 {
        let results = shown.see(&[SMALL, LARGE]);
        assert_eq!(who(&results, SMALL), small, "{n}");
        assert_eq!(who(&results, LARGE), large, "{n}");
        let tracking = results.iter().filter(|r| r.state == State::Tracking);
        assert_eq!(tracking.count(), 2, "{n}");
        assert!((0..COUNT).all(|k| shown.group.is_own(k)), "{n}");
    }
}

#[test]
fn who_comes_back_soon_has_the_same_tracker() {
    let mut shown = Shown::new(&patient());
    let mut results = Vec::new();
    for _ in 0..20 {
        results = shown.see(&[SMALL, LARGE]);
    }
    let (small, large) = (who(&results, SMALL), who(&results, LARGE));
    for n in 0..30 {
        let results = shown.see(&[LARGE]);
        assert_eq!(who(&results, LARGE), large, "{n}");
    }
    for _ in 0..10 {
        results = shown.see(&[SMALL, LARGE]);
    }
    assert_eq!((who(&results, SMALL), who(&results, LARGE)), (small, large));
}

#[test]
fn what_one_tracker_refuses_none_takes() {
    let mut shown = Shown::new(&patient());
    shown.see(&[LARGE]);
    let luma = picture(demo(), 0, &[LARGE]);
    let frame = grey(WIDTH, HEIGHT, &luma);
    let before: Vec<TrackResult> = shown.trackers.iter().map(|t| *t.result()).collect();
    let model = model();
    let mut step = |trackers: &mut [Box<Tracker>], now_us| {
        shown.group.step(&model, trackers, &frame, now_us).err()
    };
    assert_eq!(step(&mut shown.trackers, 0), Some(StepError::Time));
    let beyond = Roi::new(1, 0, WIDTH as u32, HEIGHT as u32);
    shown.trackers[COUNT - 1]
        .set_roi(Some(beyond))
        .expect("some frame");
    assert_eq!(step(&mut shown.trackers, FRAME_US), Some(StepError::Roi));
    let mut many: Vec<_> = (0..=MAX_GROUP).map(|_| tracker(&patient())).collect();
    assert_eq!(step(&mut many, FRAME_US), Some(StepError::Group));
    let after: Vec<TrackResult> = shown.trackers.iter().map(|t| *t.result()).collect();
    assert_eq!(before, after);
    shown.trackers[COUNT - 1]
        .set_roi(None)
        .expect("the whole frame");
    assert_eq!(step(&mut shown.trackers, FRAME_US), None);
}

/// Whose turn it is not holds what was changed before, and is about where it would be.
#[test]
fn networks_in_turns_see_nearly_the_same() {
    let track = |period: u32| {
        let (model, mut tracker) = (model(), tracker(&patient().with_network_period(period)));
        let clip = demo();
        let step = |(n, luma): (usize, &Vec<u8>)| {
            let frame = grey(clip.width, clip.height, luma);
            *tracker
                .step(&model, &frame, clip.time_us(n))
                .expect("in order")
        };
        clip.luma.iter().enumerate().map(step).collect::<Vec<_>>()
    };
    let (always, in_turns) = (track(1), track(4));
    let mut changed = 0;
    for (n, (a, b)) in always.iter().zip(&in_turns).enumerate() {
        assert_eq!(a.state, b.state, "{n}");
        let width = a.face_box[2];
        for (p, q) in a.landmarks.iter().zip(&b.landmarks) {
            assert!((p.x - q.x).hypot(p.y - q.y) <= 0.05 * width, "{n}");
        }
        changed += usize::from(a != b);
    }
    assert!(changed > always.len() / 2, "{changed} of {}", always.len());
}
