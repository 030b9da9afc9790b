//! Whose eyes a monitor counts where a passenger is in view.

use posewise::monitor::MonitorState;
use serde_json::{Value, json};

/// Tips of the noses in a frame \[px\].
#[derive(Clone, Copy)]
pub struct TrueNoses {
    pub driver: [f64; 2],
    pub passenger: [f64; 2],
    /// The driver's face is in the picture.
    pub is_driver_seen: bool,
}

/// Frames with a passenger.
#[derive(Default)]
pub struct PassengerScores {
    /// Frames that show the driver, and those of them in which the driver's eyes are known.
    driver: (usize, usize),
    /// Frames in which eyes are known while the passenger's face is followed.
    passenger: usize,
}

impl PassengerScores {
    /// Adds a frame with the nose of the face that is followed \[px\].
    pub fn see(&mut self, truth: &TrueNoses, state: &MonitorState, nose: [f64; 2]) {
        let far = |to: [f64; 2]| (nose[0] - to[0]).hypot(nose[1] - to[1]);
        let is_known = state.openness.is_some();
        let is_driver = far(truth.driver) < far(truth.passenger);
        self.passenger += usize::from(is_known && !is_driver);
        if truth.is_driver_seen {
            self.driver.0 += 1;
            self.driver.1 += usize::from(is_known && is_driver);
        }
    }

    /// Adds those of another clip.
    pub fn add(&mut self, other: &PassengerScores) {
        self.driver.0 += other.driver.0;
        self.driver.1 += other.driver.1;
        self.passenger += other.passenger;
    }

    /// The numbers.
    pub fn json(&self) -> Value {
        let (seen, known) = self.driver;
        json!({
            "driver_frames": seen,
            "driver_known": (seen > 0).then(|| known as f64 / seen as f64),
            "passenger_counted_frames": self.passenger,
        })
    }
}
