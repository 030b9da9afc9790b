//! The log of a tracker says what its results say: each change of state is an event, with its time
//! and reason, and nothing else is.

use crate::common::{Clip, demo, grey, model, tracker};
use posewise::{Config, Event, EventKind, Model, State, Tracker};

/// A tracker and the state after its last step.
struct Watched<'m> {
    model: &'m Model<'m>,
    tracker: Box<Tracker>,
    state: State,
    now_us: i64,
}

impl Watched<'_> {
    /// Takes one frame; returns its events, compared with the change of state.
    fn see(&mut self, luma: &[u8]) -> Vec<Event> {
        self.now_us += 40_000;
        let frame = grey(demo().width, demo().height, luma);
        let step = self.tracker.step(self.model, &frame, self.now_us);
        let result = *step.expect("time goes on");
        let events: Vec<Event> = std::iter::from_fn(|| self.tracker.events().pop()).collect();
        assert!(events.iter().all(|event| event.timestamp_us == self.now_us));
        let has = |kind| events.iter().any(|event| event.kind == kind);
        let changes = (self.state, result.state);
        let (is_found, is_new) = (has(EventKind::Reacquired), has(EventKind::Acquired));
        let coasts = changes == (State::Tracking, State::Coasting);
        assert_eq!(has(EventKind::Coasting), coasts, "{events:?}");
        let is_lost = self.state != State::Searching && result.state == State::Searching;
        assert_eq!(has(EventKind::Lost), is_lost, "{events:?}");
        match changes {
            (State::Tracking, State::Tracking) => {}
            (_, State::Tracking) => assert!(is_found ^ is_new, "{events:?}"),
            _ => assert!(!is_found && !is_new, "{events:?}"),
        }
        for event in &events {
            match event.kind {
                EventKind::Acquired | EventKind::Reacquired => {
                    assert_eq!(event.face_box, result.face_box);
                    assert_eq!(event.confidence, result.confidence);
                    assert_eq!(event.loss, None);
                }
                EventKind::Coasting | EventKind::Lost => {
                    assert_eq!(event.loss, result.loss);
                    assert!(event.loss.is_some() && event.face_box[2] > 0.0);
                }
                _ => {}
            }
        }
        self.state = result.state;
        events
    }
}

/// Runs a test on the clip.
fn watch(test: impl FnOnce(&Clip, &mut Watched<'_>)) {
    let model = model();
    let config = Config::default().with_scan_budget(1_000_000);
    let mut watched = Watched {
        model: &model,
        tracker: tracker(&config),
        state: State::Searching,
        now_us: 0,
    };
    test(demo(), &mut watched);
}

fn kinds(events: &[Event]) -> Vec<EventKind> {
    events.iter().map(|event| event.kind).collect()
}

#[test]
fn a_face_that_goes_and_comes_back() {
    watch(|clip, watched| {
        let none = vec![100; clip.width * clip.height];
        let mut events = Vec::new();
        // Gone for longer than it coasts, then for less.
        for (shown, gone) in [(20, 20), (10, 5), (10, 0)] {
            (0..shown).for_each(|frame| events.extend(watched.see(&clip.luma[frame])));
            (0..gone).for_each(|_| events.extend(watched.see(&none)));
        }
        use EventKind::*;
        let expected = [Acquired, Coasting, Lost, Reacquired, Coasting, Reacquired];
        assert_eq!(kinds(&events), expected, "{events:?}");
        watched.tracker.forget_identity();
        watched.tracker.reset();
        watched.state = State::Searching;
        let log = watched.tracker.events();
        assert_eq!(log.unread(), 2);
        assert_eq!(log.pop().map(|event| event.kind), Some(Forgotten));
        assert_eq!(log.pop().map(|event| event.kind), Some(Reset));
        let again = watched.see(&clip.luma[0]);
        assert_eq!(kinds(&again), [Acquired]);
    });
}

#[test]
fn noise_that_comes_and_goes() {
    watch(|clip, watched| {
        let noisy: Vec<u8> = (clip.luma[3].iter().enumerate())
            .map(|(i, level)| {
                let random = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56;
                (i32::from(*level) + random as i32 - 128).clamp(0, 255) as u8
            })
            .collect();
        let mut events = Vec::new();
        for frame in 0..12 {
            let is_noisy = (4..8).contains(&frame);
            let luma = if is_noisy { &noisy } else { &clip.luma[frame] };
            events.extend(watched.see(luma));
        }
        let at = |kind| events.iter().find(|event| event.kind == kind);
        let times = [EventKind::FilterOn, EventKind::FilterOff]
            .map(|kind| at(kind).map(|event| event.timestamp_us / 40_000));
        assert_eq!(times, [Some(5), Some(9)], "{events:?}");
    });
}
