//! Where the driver sits: a face that is elsewhere is another person's.
//!
//! The place is a point between the eyes, in the camera frame, as the caller gives it, or the mean
//! of what is seen: the face that is seen for the most time within the first minute has it. It then
//! follows the driver slowly and is held, however long somebody else is seen.

use super::config::{MonitorConfig, Place};
use glam::Vec3;

/// Known time from which on the place is held \[µs\].
const FINAL_US: u32 = 60_000_000;
/// Over how long the place is a mean \[µs\]. Chosen: people move on their seats in minutes.
const MEAN_US: f32 = 60_000_000.0;
/// Known time that a guess stands for \[µs\], as for the natural pose.
const GUESS_US: u32 = 15_000_000;

/// Learns the place.
#[derive(Clone)]
pub(super) struct Seat {
    at_mm: Vec3,
    /// Time for which the driver has been seen there, less that for which others were before it was
    /// final \[µs\].
    known_us: u32,
}

impl Seat {
    pub(super) const NEW: Seat = Seat {
        at_mm: Vec3::ZERO,
        known_us: 0,
    };

    /// A guess, which counts as much as this time in which the driver was there.
    pub(super) fn guessed(at_mm: [f32; 3]) -> Seat {
        Seat {
            at_mm: at_mm.into(),
            known_us: GUESS_US,
        }
    }

    /// The place, if it is known \[mm\].
    pub(super) fn at_mm(&self, config: &MonitorConfig) -> Option<[f32; 3]> {
        match config.place {
            Place::Learnt => (self.known_us > 0).then(|| self.at_mm.to_array()),
            Place::Given => Some(config.place_mm),
            Place::Any => None,
        }
    }

    /// Whether it is held.
    pub(super) fn is_final(&self, config: &MonitorConfig) -> bool {
        match config.place {
            Place::Learnt => self.known_us >= FINAL_US,
            Place::Given => true,
            Place::Any => false,
        }
    }

    /// Whether a face there is another person's \[mm\].
    pub(super) fn is_elsewhere(&self, at_mm: Vec3, config: &MonitorConfig) -> bool {
        let radius = config.place_radius_mm;
        let far = |place: [f32; 3]| at_mm.distance_squared(place.into()) > radius * radius;
        self.at_mm(config).is_some_and(far)
    }

    /// Lets time pass with a face there \[mm\].
    pub(super) fn pass(&mut self, time_us: u32, at_mm: Vec3, config: &MonitorConfig) {
        if config.place != Place::Learnt {
            return;
        }
        if self.is_elsewhere(at_mm, config) {
            if !self.is_final(config) {
                // Who is seen for most of the time outvotes the others, Boyer and Moore 1981.
                self.known_us = self.known_us.saturating_sub(time_us);
            }
            return;
        }
        self.known_us = self.known_us.saturating_add(time_us);
        let share = time_us as f32 / (self.known_us as f32).clamp(1.0, MEAN_US);
        self.at_mm += share.min(1.0) * (at_mm - self.at_mm);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_US: u32 = 100_000;

    #[test]
    fn the_place_is_that_of_who_is_seen_most() {
        let config = MonitorConfig::default();
        let (driver, passenger) = (Vec3::new(0.0, 0.0, 700.0), Vec3::new(600.0, 0.0, 750.0));
        let mut seat = Seat::NEW;
        assert!(!seat.is_elsewhere(passenger, &config), "nobody was seen");
        (0..30).for_each(|_| seat.pass(STEP_US, passenger, &config));
        assert!(seat.is_elsewhere(driver, &config));
        (0..640).for_each(|_| seat.pass(STEP_US, driver, &config));
        assert!(seat.is_final(&config) && !seat.is_elsewhere(driver, &config));
        // However long the other one is seen.
        (0..5_000).for_each(|_| seat.pass(STEP_US, passenger, &config));
        assert!(seat.is_elsewhere(passenger, &config));
        // The driver moves.
        let back = driver + Vec3::new(0.0, 0.0, 200.0);
        (0..1_800).for_each(|_| seat.pass(STEP_US, back, &config));
        assert!(seat.at_mm.distance(back) < 20.0, "{}", seat.at_mm);
    }

    #[test]
    fn a_place_that_is_given_is_kept() {
        let config = MonitorConfig {
            place: Place::Given,
            place_mm: [100.0, 0.0, 800.0],
            ..MonitorConfig::default()
        };
        let mut seat = Seat::NEW;
        (0..900).for_each(|_| seat.pass(STEP_US, Vec3::new(-500.0, 0.0, 800.0), &config));
        assert_eq!(seat.at_mm(&config), Some([100.0, 0.0, 800.0]));
        let any = MonitorConfig {
            place: Place::Any,
            ..config
        };
        assert!(!seat.is_elsewhere(Vec3::new(-500.0, 0.0, 800.0), &any));
    }
}
