//! The sum of a time over the last 30 s.
//!
//! As in `perclos`, but in bins of a quarter of a second, and with the bin that fills: the window
//! is 29.75 to 30 s long, and the sum is that of now.

use super::config::CUMULATIVE_WINDOW_US;

/// Length of a bin \[µs\].
pub(super) const BIN_US: u32 = 250_000;
const BINS: usize = (CUMULATIVE_WINDOW_US / BIN_US) as usize;

/// The bins and their sum.
#[derive(Clone)]
pub(super) struct Recent {
    bins: [u32; BINS],
    current: usize,
    into_us: u32,
    sum: u32,
}

impl Recent {
    pub(super) const EMPTY: Recent = Recent {
        bins: [0; BINS],
        current: 0,
        into_us: 0,
        sum: 0,
    };

    /// Lets time pass, the last `counted_us` of which count.
    pub(super) fn pass(&mut self, time_us: u32, counted_us: u32) {
        self.skip(time_us.saturating_sub(counted_us), false);
        self.skip(counted_us.min(time_us), true);
    }

    /// Sum of what counted \[µs\].
    pub(super) fn sum_us(&self) -> u32 {
        self.sum
    }

    /// Nothing of the past counts any more.
    pub(super) fn clear(&mut self) {
        self.bins = [0; BINS];
        self.sum = 0;
    }

    #[inline(never)]
    fn skip(&mut self, time_us: u32, counts: bool) {
        let mut left = time_us;
        let mut finished = 0;
        while left > 0 && finished <= BINS {
            let part = left.min(BIN_US - self.into_us);
            if counts && let Some(bin) = self.bins.get_mut(self.current) {
                *bin += part;
                self.sum += part;
            }
            left -= part;
            self.into_us += part;
            if self.into_us >= BIN_US {
                self.finish_bin();
                finished += 1;
            }
        }
        self.into_us = (self.into_us + left) % BIN_US;
    }

    fn finish_bin(&mut self) {
        self.current = (self.current + 1) % BINS;
        if let Some(oldest) = self.bins.get_mut(self.current) {
            self.sum -= *oldest;
            *oldest = 0;
        }
        self.into_us = 0;
    }
}
