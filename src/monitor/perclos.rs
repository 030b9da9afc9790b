//! Sums over the last 60 and 180 whole seconds.
//!
//! Time since the first observation is divided into bins of a second. A window is the last 60 (or
//! 180) bins that are complete, so that it is exactly that long, and its sums are exact: integers
//! in µs, from which the bin that leaves is subtracted. What is measured in a bin takes part in the
//! window when the bin is complete.

use super::state::Perclos;

/// Length of a bin \[µs\].
pub(super) const BIN_US: u32 = 1_000_000;
/// Bins of the windows.
const SHORT: usize = 60;
const LONG: usize = 180;
/// Those of the long window, and the one that fills.
const BINS: usize = LONG + 1;

/// Closures from which on P70 and P80 count, as an openness.
const OPEN_70: f32 = 0.3;
const OPEN_80: f32 = 0.2;
/// Steps of the square of the closure: with a bin's µs they stay below 2³².
pub(super) const SQUARE: f32 = 1024.0;

/// What is summed.
const KNOWN: usize = 0;
const P70: usize = 1;
const P80: usize = 2;
const EM: usize = 3;
const CLOSURES: usize = 4;
const CLOSED_US: usize = 5;
const SUMS: usize = 6;

/// The bins and the sums of both windows.
#[derive(Clone)]
pub(super) struct Windows {
    bins: [[u32; SUMS]; BINS],
    /// The bin that fills, and how much of it has passed \[µs\].
    current: usize,
    into_us: u32,
    short: [u64; SUMS],
    long: [u64; SUMS],
}

impl Windows {
    pub(super) const EMPTY: Windows = Windows {
        bins: [[0; SUMS]; BINS],
        current: 0,
        into_us: 0,
        short: [0; SUMS],
        long: [0; SUMS],
    };

    /// Lets time pass, with this openness or an unknown one.
    pub(super) fn pass(&mut self, time_us: u32, openness: Option<f32>) {
        let mut left = time_us;
        let mut finished = 0;
        while left > 0 && finished <= BINS {
            let part = left.min(BIN_US - self.into_us);
            if let Some(openness) = openness {
                self.add(part, openness);
            }
            left -= part;
            self.into_us += part;
            if self.into_us >= BIN_US {
                self.finish_bin();
                finished += 1;
            }
        }
        // All bins are empty by now: only the phase is left to be set.
        self.into_us = (self.into_us + left) % BIN_US;
    }

    /// A closure ended that took so long.
    pub(super) fn add_closure(&mut self, closed_us: u32) {
        if let Some([.., closures, sum]) = self.bins.get_mut(self.current) {
            *closures = closures.saturating_add(1);
            *sum = sum.saturating_add(closed_us);
        }
    }

    /// Both windows: 60 and 180 s.
    pub(super) fn measures(&self) -> [Perclos; 2] {
        [
            measures(&self.short, SHORT as u32),
            measures(&self.long, LONG as u32),
        ]
    }

    #[inline(never)]
    fn add(&mut self, time_us: u32, openness: f32) {
        let closure = 1.0 - openness.clamp(0.0, 1.0);
        let square = (closure * closure * SQUARE) as u32;
        let Some([known, p70, p80, em, ..]) = self.bins.get_mut(self.current) else {
            return;
        };
        // No bin holds more than its length.
        *known += time_us;
        *em += time_us * square;
        if openness <= OPEN_70 {
            *p70 += time_us;
        }
        if openness <= OPEN_80 {
            *p80 += time_us;
        }
    }

    #[inline(never)]
    fn finish_bin(&mut self) {
        let bin = |bins: &[[u32; SUMS]; BINS], i: usize| bins.get(i % BINS).copied();
        let complete = bin(&self.bins, self.current).unwrap_or_default();
        let leaves_short = bin(&self.bins, self.current + BINS - SHORT).unwrap_or_default();
        // The oldest bin of the long window is the next one to fill.
        self.current = (self.current + 1) % BINS;
        let leaves_long = bin(&self.bins, self.current).unwrap_or_default();
        replace(&mut self.short, &complete, &leaves_short);
        replace(&mut self.long, &complete, &leaves_long);
        if let Some(next) = self.bins.get_mut(self.current) {
            *next = [0; SUMS];
        }
        self.into_us = 0;
    }
}

fn replace(sums: &mut [u64; SUMS], new: &[u32; SUMS], old: &[u32; SUMS]) {
    for (sum, (new, old)) in sums.iter_mut().zip(new.iter().zip(old)) {
        *sum = sum
            .wrapping_add(u64::from(*new))
            .wrapping_sub(u64::from(*old));
    }
}

#[inline(never)]
fn measures(sums: &[u64; SUMS], seconds: u32) -> Perclos {
    let sum = |which: usize| sums.get(which).copied().unwrap_or_default();
    let known = sum(KNOWN) as f32;
    let share = |which| {
        if known > 0.0 {
            sum(which) as f32 / known
        } else {
            0.0
        }
    };
    Perclos {
        p70: share(P70),
        p80: share(P80),
        em: share(EM) / SQUARE,
        known: known / (seconds as f32 * BIN_US as f32),
        closures: sum(CLOSURES) as u32,
        mean_closure_us: (sum(CLOSED_US).checked_div(sum(CLOSURES))).map(|mean| mean as u32),
    }
}
