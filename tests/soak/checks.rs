//! What must hold on each step.

use super::session::Slot;
use super::video::Picture;
use crate::ffi::{monitor_types::*, types::*};
use crate::targets::outputs::Outputs;

/// How long a face that is lost is repeated at most \[µs\], as in `track/policy.rs`.
const COAST_US: i64 = 500_000;

/// Whether a region of interest lies in a picture.
pub(super) fn is_in([x, y, width, height]: [u32; 4], [all_x, all_y]: [u32; 2]) -> bool {
    x + width <= all_x && y + height <= all_y
}

pub(super) fn expected_status(slot: &Slot, picture: &Picture) -> posewise_status {
    let in_order = (slot.last_us).is_none_or(|last| picture.frame.timestamp_us > last);
    match (is_in(slot.roi, picture.upright()), in_order) {
        (false, _) => POSEWISE_E_ROI,
        (true, false) => POSEWISE_E_TIME,
        (true, true) => POSEWISE_OK,
    }
}

/// The change of state is an allowed one. A face that coasts repeats the last fit.
pub(super) fn check_change(slot: &Slot, r: &posewise_result, outputs: &Outputs) {
    let from = slot.state;
    match r.state {
        POSEWISE_COASTING => {
            assert!(from != POSEWISE_SEARCHING, "coasting without a face: {r:?}");
            assert_eq!(r.age_us, r.timestamp_us.saturating_sub(slot.fitted_us));
            assert!((1..=COAST_US).contains(&r.age_us), "{r:?}");
            assert!(outputs.landmarks() == slot.landmarks, "no repetition");
            assert!(r.loss != POSEWISE_LOSS_NONE, "{r:?}");
        }
        POSEWISE_SEARCHING => {
            let is_lost = from != POSEWISE_SEARCHING;
            assert!(!is_lost || r.loss != POSEWISE_LOSS_NONE, "{r:?}");
        }
        _ => assert_eq!(r.loss, POSEWISE_LOSS_NONE),
    }
}

/// Each change of state is an event, and nothing else is.
pub(super) fn check_events(from: u32, r: &posewise_result, events: &[posewise_event]) {
    let has = |kind| events.iter().any(|event| event.kind == kind);
    assert!(
        events
            .iter()
            .all(|event| event.timestamp_us == r.timestamp_us)
    );
    let coasts = (from, r.state) == (POSEWISE_TRACKING, POSEWISE_COASTING);
    assert_eq!(has(POSEWISE_EVENT_COASTING), coasts, "{events:?}");
    let is_lost = from != POSEWISE_SEARCHING && r.state == POSEWISE_SEARCHING;
    assert_eq!(has(POSEWISE_EVENT_LOST), is_lost, "{events:?}");
    let found = [POSEWISE_EVENT_ACQUIRED, POSEWISE_EVENT_REACQUIRED].map(has);
    match (from, r.state) {
        (POSEWISE_TRACKING, POSEWISE_TRACKING) => {}
        (_, POSEWISE_TRACKING) => assert!(found[0] ^ found[1], "{events:?}"),
        _ => assert_eq!(found, [false; 2], "{events:?}"),
    }
}

/// A tracked face is centred in or near the frame, and not much larger.
pub(super) fn check_place(r: &posewise_result, picture: &Picture) {
    let [x, y, width, height] = r.face_box;
    let size = width.max(height);
    let [all_x, all_y] = picture.upright().map(|side| side as f32);
    let near = |at: f32, end: f32| (-0.5 * size..=end + 0.5 * size).contains(&at);
    assert!(width > 0.0 && height > 0.0, "{r:?}");
    assert!(
        near(x + width / 2.0, all_x) && near(y + height / 2.0, all_y),
        "{r:?}"
    );
    assert!(size <= 8.0 * all_x.max(all_y), "{r:?}");
}

/// Shows the step to the tracker's monitor. Eyes are known of a tracked face only, and each closure
/// that is no blink ends before the next one begins.
pub(super) fn check_watched(
    slot: &mut Slot,
    r: &posewise_result,
) -> (posewise_monitor_state, Vec<posewise_monitor_event>) {
    let status = slot.watcher.watch(slot.tracker.ptr(), r.timestamp_us);
    // A tracker that was reset takes any time; a monitor takes any but the last one again.
    assert!(matches!(status, POSEWISE_OK | POSEWISE_E_TIME), "{status}");
    let state = slot.watcher.state();
    let is_known = state.eyes != POSEWISE_MONITOR_EYES_UNKNOWN;
    assert!(!is_known || r.state == POSEWISE_TRACKING, "{r:?} {state:?}");
    assert_eq!(state.timestamp_us, r.timestamp_us);
    let events = slot.watcher.events();
    assert!(
        events
            .iter()
            .all(|event| event.timestamp_us == r.timestamp_us),
        "{events:?}"
    );
    (state, events)
}
