//! Time of a monitor, from timestamps that may stop or jump.

/// A gap counts as at most this \[µs\]: an hour, longer than every window.
const LONGEST_US: u32 = 3_600_000_000;

/// What lies between two observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passed {
    /// This is the first observation.
    Nothing,
    /// This time \[µs\].
    Time(u32),
    /// The clock was set back; how long it was is unknown.
    Back,
}

/// The timestamp of the last observation.
#[derive(Clone, Copy)]
pub(super) struct Clock {
    last_us: Option<i64>,
}

impl Clock {
    pub(super) const NEW: Clock = Clock { last_us: None };

    pub(super) fn last_us(&self) -> i64 {
        self.last_us.unwrap_or_default()
    }

    /// What has passed since the last observation; `None` for its timestamp again.
    pub(super) fn pass(&mut self, now_us: i64) -> Option<Passed> {
        let passed = match self.last_us {
            None => Passed::Nothing,
            Some(last) if now_us == last => return None,
            Some(last) if now_us < last => Passed::Back,
            Some(last) => {
                let passed = now_us.abs_diff(last).min(u64::from(LONGEST_US));
                Passed::Time(passed as u32)
            }
        };
        self.last_us = Some(now_us);
        Some(passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_passes_and_jumps() {
        let mut clock = Clock::NEW;
        assert_eq!(clock.pass(i64::MIN), Some(Passed::Nothing));
        assert_eq!(clock.pass(i64::MAX), Some(Passed::Time(LONGEST_US)));
        assert_eq!(clock.pass(i64::MAX), None);
        assert_eq!(clock.pass(5), Some(Passed::Back));
        assert_eq!(clock.pass(40_005), Some(Passed::Time(40_000)));
    }
}
