//! Keeps the tracker to the driver: while it follows another person's face, faces are searched for
//! around the driver's place.

use posewise::monitor::{MonitorState, UnknownReason};
use posewise::{Intrinsics, Roi};

/// Another person's face is followed for this long before it is given up \[µs\].
const PATIENCE_US: i64 = 300_000;
/// The driver is searched for around the place for this long \[µs\]: who ducks is back by then.
const SEARCH_US: i64 = 8_000_000;
/// Then any face may be followed for this long \[µs\], so that a place that was learnt from another
/// person is outvoted.
const REST_US: i64 = 30_000_000;

/// What is to be done with the tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Give the face up, and search around the driver's place.
    ToDriver(Roi),
    /// Search everywhere again.
    ToAnyone,
}

#[derive(Clone, Copy)]
enum Phase {
    Following,
    Elsewhere { since_us: i64 },
    Searching { since_us: i64 },
    Resting { since_us: i64 },
}

/// Decides it from the monitor's states.
pub struct Keeper {
    phase: Phase,
    radius_mm: f32,
}

impl Keeper {
    /// For a place of this radius.
    pub fn new(radius_mm: f32) -> Self {
        Keeper {
            phase: Phase::Following,
            radius_mm,
        }
    }

    /// The state after a frame of this size \[px\]. The place is the driver's for good where it is
    /// given or learnt to the end; then the search does not rest.
    pub fn see(
        &mut self,
        state: &MonitorState,
        timestamp_us: i64,
        camera: &Intrinsics,
        size: (i32, i32),
    ) -> Option<Turn> {
        let is_elsewhere = state.eyes.reason() == Some(UnknownReason::Elsewhere);
        let is_seen = state.eyes.reason() != Some(UnknownReason::NoFace) && !is_elsewhere;
        let passed = |since_us: i64, us: i64| timestamp_us - since_us >= us;
        let (phase, turn) = match self.phase {
            Phase::Following if is_elsewhere => {
                let since_us = timestamp_us;
                (Phase::Elsewhere { since_us }, None)
            }
            Phase::Elsewhere { since_us } if is_elsewhere && passed(since_us, PATIENCE_US) => {
                match self.region(state.place_mm?, camera, size) {
                    Some(roi) => {
                        let since_us = timestamp_us;
                        (Phase::Searching { since_us }, Some(Turn::ToDriver(roi)))
                    }
                    None => (self.phase, None),
                }
            }
            Phase::Elsewhere { .. } if !is_elsewhere => (Phase::Following, None),
            Phase::Searching { .. } if is_seen => (Phase::Following, Some(Turn::ToAnyone)),
            Phase::Searching { since_us }
                if !state.place_is_final && passed(since_us, SEARCH_US) =>
            {
                let since_us = timestamp_us;
                (Phase::Resting { since_us }, Some(Turn::ToAnyone))
            }
            Phase::Resting { since_us } if passed(since_us, REST_US) => (Phase::Following, None),
            phase => (phase, None),
        };
        self.phase = phase;
        turn
    }

    /// Where the face of someone at the place is centred; `None` where that is not in the picture.
    fn region(&self, at_mm: [f32; 3], camera: &Intrinsics, size: (i32, i32)) -> Option<Roi> {
        let [x, y, z] = at_mm;
        if z <= 0.0 {
            return None;
        }
        let range = |focal: f32, centre: f32, at: f32, size: i32| {
            let (middle, half) = (centre + focal * at / z, focal * self.radius_mm / z);
            let [low, high] = [middle - half, middle + half].map(|v| v.clamp(0.0, size as f32));
            let [low, high] = [low.floor() as u32, high.ceil() as u32];
            (high > low).then_some((low, high - low))
        };
        let (left, width) = range(camera.fx, camera.cx, x, size.0)?;
        let (top, height) = range(camera.fy, camera.cy, y, size.1)?;
        Some(Roi::new(left, top, width, height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::monitor::{EyeState, Monitor, MonitorConfig};

    /// What a keeper says for ten frames a second of these eyes.
    fn turns(keeper: &mut Keeper, now_us: &mut i64, eyes: EyeState, seconds: i64) -> Vec<Turn> {
        let monitor = Monitor::new(&MonitorConfig::default()).expect("defaults");
        let mut state = monitor.state();
        (state.eyes, state.place_mm) = (eyes, Some([100.0, 0.0, 700.0]));
        let camera = Intrinsics::of_frame(640, 480);
        let mut all = Vec::new();
        for _ in 0..10 * seconds {
            *now_us += 100_000;
            all.extend(keeper.see(&state, *now_us, &camera, (640, 480)));
        }
        all
    }

    #[test]
    fn the_driver_is_searched_for_while_somebody_else_is_followed() {
        let (mut keeper, mut now_us) = (Keeper::new(300.0), 0);
        let mut turns = |eyes, seconds| turns(&mut keeper, &mut now_us, eyes, seconds);
        let elsewhere = EyeState::Unknown(UnknownReason::Elsewhere);
        let nobody = EyeState::Unknown(UnknownReason::NoFace);
        assert!(turns(EyeState::Open, 5).is_empty());
        let [Turn::ToDriver(roi)] = turns(elsewhere, 1)[..] else {
            panic!("one turn to the driver");
        };
        // Around 399 px, which is 100 mm to the right at 700.
        assert_eq!(roi, Roi::new(161, 1, 476, 477));
        assert!(turns(nobody, 5).is_empty());
        assert_eq!(turns(EyeState::Closed, 1), [Turn::ToAnyone]);
    }

    #[test]
    fn a_place_that_nobody_comes_back_to_is_outvoted() {
        let (mut keeper, mut now_us) = (Keeper::new(300.0), 0);
        let mut turns = |eyes, seconds| turns(&mut keeper, &mut now_us, eyes, seconds);
        let elsewhere = EyeState::Unknown(UnknownReason::Elsewhere);
        let nobody = EyeState::Unknown(UnknownReason::NoFace);
        assert_eq!(turns(elsewhere, 1).len(), 1);
        assert_eq!(turns(nobody, 10), [Turn::ToAnyone]);
        assert!(turns(elsewhere, 25).is_empty());
        assert_eq!(turns(elsewhere, 10).len(), 1);
    }
}
