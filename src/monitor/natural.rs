//! The direction in which this person looks at the road, as an offset from the configured one.
//!
//! It is the median of yaw and pitch over the first minute of known pose, within bounds: most of
//! the time drivers look at the road. There is a first estimate after ten seconds.

use super::config::MonitorConfig;
use super::quantile::{add, quantile};

/// Width of a bin \[deg\].
const BIN_DEG: f32 = 2.0;
/// Bins of yaw and pitch: up to 50° and 30° to both sides, the largest bounds of the settings.
const YAW_BINS: usize = 50;
const PITCH_BINS: usize = 30;
/// Known time from which on there is an estimate, and after which it is final \[µs\].
const FIRST_US: u32 = 10_000_000;
const FINAL_US: u32 = 60_000_000;
/// Known time after which a gaze has a direction of its own, once there is that of the head \[µs\].
/// Eyes are known less often than heads, and without it glances of the first seconds after the
/// head's estimate are missed. Chosen.
const GAZE_US: u32 = 5_000_000;
/// Known time that a guess stands for \[µs\]. Chosen: less than half of what follows.
const GUESS_US: u32 = 15_000_000;

/// Learns the offset.
#[derive(Clone)]
pub(super) struct Natural {
    yaw_us: [u32; YAW_BINS],
    pitch_us: [u32; PITCH_BINS],
    known_us: u32,
    offset_deg: [f32; 2],
}

impl Natural {
    pub(super) const NEW: Natural = Natural {
        yaw_us: [0; YAW_BINS],
        pitch_us: [0; PITCH_BINS],
        known_us: 0,
        offset_deg: [0.0; 2],
    };

    /// A guess, which counts as much as this time in which the driver looked there: a wrong one is
    /// outvoted before the estimate is final.
    pub(super) fn guessed(at_deg: [f32; 2], config: &MonitorConfig) -> Natural {
        let mut natural = Natural::NEW;
        natural.pass(GUESS_US, at_deg, config);
        natural
    }

    /// Whether there is an estimate; settings without bounds need none.
    pub(super) fn is_known(&self, config: &MonitorConfig) -> bool {
        self.known_us >= FIRST_US || !is_learnt(config)
    }

    /// The same of a gaze, of which the head's direction is learnt too.
    pub(super) fn is_known_beside(&self, of_head: &Natural, config: &MonitorConfig) -> bool {
        self.is_known(config) || self.known_us >= GAZE_US && of_head.is_known(config)
    }

    pub(super) fn is_final(&self, config: &MonitorConfig) -> bool {
        self.known_us >= FINAL_US || !is_learnt(config)
    }

    /// Yaw and pitch of the estimate, from the configured direction \[deg\].
    pub(super) fn offset_deg(&self) -> [f32; 2] {
        self.offset_deg
    }

    /// Lets time pass with this yaw and pitch from the configured direction \[deg\]; returns
    /// whether that made the estimate final.
    pub(super) fn pass(&mut self, time_us: u32, at_deg: [f32; 2], config: &MonitorConfig) -> bool {
        let [yaw, pitch] = at_deg;
        let bounds = [config.natural_yaw_deg, config.natural_pitch_deg];
        if self.is_final(config) || yaw.abs() > bounds[0] || pitch.abs() > bounds[1] {
            return false;
        }
        let place = |angle: f32, bins: usize| angle / BIN_DEG + bins as f32 / 2.0;
        add(&mut self.yaw_us, place(yaw, YAW_BINS), time_us);
        add(&mut self.pitch_us, place(pitch, PITCH_BINS), time_us);
        self.known_us += time_us;
        self.offset_deg = [
            median(&self.yaw_us).clamp(-bounds[0], bounds[0]),
            median(&self.pitch_us).clamp(-bounds[1], bounds[1]),
        ];
        self.is_final(config)
    }
}

/// The median \[deg\]; bins are around 0.
fn median(bins: &[u32]) -> f32 {
    let centre = bins.len() as f32 / 2.0;
    (quantile(bins, 0.5).unwrap_or(centre) - centre) * BIN_DEG
}

/// Whether the settings let a natural pose be learnt.
pub(super) fn is_learnt(config: &MonitorConfig) -> bool {
    config.natural_yaw_deg > 0.0 && config.natural_pitch_deg > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_road() {
        let config = MonitorConfig::default();
        let mut natural = Natural::NEW;
        let mut finals = 0;
        for i in 0..3_000 {
            // A third of the time elsewhere.
            let at = if i % 3 == 0 {
                [-9.0, -22.0]
            } else {
                [29.0, 7.0]
            };
            finals += u32::from(natural.pass(33_333, at, &config));
            assert_eq!(natural.is_known(&config), i >= 300);
        }
        assert_eq!(finals, 1);
        let [yaw, pitch] = natural.offset_deg();
        assert!(
            (yaw - 29.0).abs() < 1.0 && (pitch - 7.0).abs() < 1.0,
            "{yaw} {pitch}"
        );
    }

    #[test]
    fn a_gaze_is_known_sooner_beside_a_head_that_is() {
        let config = MonitorConfig::default();
        let (mut head, mut gaze) = (Natural::NEW, Natural::NEW);
        gaze.pass(GAZE_US, [4.0, -3.0], &config);
        assert!(!gaze.is_known_beside(&head, &config));
        head.pass(FIRST_US, [5.0, -2.0], &config);
        assert!(gaze.is_known_beside(&head, &config) && !gaze.is_known(&config));
        assert!(!Natural::NEW.is_known_beside(&head, &config));
    }

    #[test]
    fn a_guess_is_an_estimate_and_a_wrong_one_is_outvoted() {
        let config = MonitorConfig::default();
        let mut natural = Natural::guessed([20.0, -6.0], &config);
        assert!(natural.is_known(&config) && !natural.is_final(&config));
        let [yaw, pitch] = natural.offset_deg();
        assert!((yaw - 20.0).abs() < 1.5 && (pitch + 6.0).abs() < 1.5);
        for _ in 0..1_400 {
            natural.pass(33_333, [-10.0, 3.0], &config);
        }
        assert!(natural.is_final(&config));
        assert!((natural.offset_deg()[0] + 10.0).abs() < 1.5);
    }

    #[test]
    fn what_lies_beyond_the_bounds_is_not_learnt() {
        let config = MonitorConfig {
            natural_yaw_deg: 10.0,
            ..MonitorConfig::default()
        };
        let mut natural = Natural::NEW;
        for _ in 0..3_000 {
            assert!(!natural.pass(33_333, [12.0, 0.0], &config));
        }
        assert!(!natural.is_known(&config));
    }
}
