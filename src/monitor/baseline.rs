//! Openness of this person's open eyes, learnt while alert, then frozen.
//!
//! P80 is relative to the person's own wide-open eye. The tracker's openness is relative to the
//! fitted face already; what is left differs between people and between their eyes.

use super::quantile::{add, quantile};

/// Bins of the openness, 0..1.
const BINS: usize = 20;
/// Learnt from so much known time \[µs\]. Chosen: half a PERCLOS window.
const LEARN_US: u32 = 30_000_000;
/// Openness below this one is not that of an open eye.
const LEAST_OPEN: f32 = 0.5;
/// Share of that time in which eyes may be closed; with more, the person is not alert and learning
/// begins anew. Wierwille 1994: drowsy above 15 %.
const MOST_CLOSED: f32 = 0.15;
/// The open eye is this quantile of the open samples. Chosen above the median: lids droop, but
/// seldom rise.
const QUANTILE: f32 = 0.75;
/// Bounds of the open eye, so that nobody's half-shut eyes become open ones.
const BOUNDS: [f32; 2] = [0.6, 1.0];

/// Learns from both eyes.
#[derive(Clone)]
pub(super) struct Baseline {
    open_us: [[u32; BINS]; 2],
    known_us: u32,
    closed_us: u32,
    is_final: bool,
    open_eye: [f32; 2],
}

impl Baseline {
    pub(super) const NEW: Baseline = Baseline {
        open_us: [[0; BINS]; 2],
        known_us: 0,
        closed_us: 0,
        is_final: false,
        open_eye: [1.0; 2],
    };

    /// Nothing is learnt, and this is guessed of the open left and right eye.
    pub(super) fn guessed(open_eye: [f32; 2]) -> Baseline {
        let [least, most] = BOUNDS;
        Baseline {
            open_eye: open_eye.map(|open| open.clamp(least, most)),
            ..Baseline::NEW
        }
    }

    /// Openness of the open left and right eye; what was guessed, or 1, until it is final.
    pub(super) fn open_eye(&self) -> [f32; 2] {
        self.open_eye
    }

    pub(super) fn is_final(&self) -> bool {
        self.is_final
    }

    /// Lets time pass with these eyes, as the tracker reports them, of which at least one is known;
    /// `is_long` is a closure that is no blink. Returns whether that made it final.
    pub(super) fn pass(&mut self, time_us: u32, eyes: [Option<f32>; 2], is_long: bool) -> bool {
        if self.is_final {
            return false;
        }
        if is_long {
            self.begin_anew();
            return false;
        }
        self.known_us += time_us;
        let mut is_open = false;
        for (bins, open) in self.open_us.iter_mut().zip(eyes) {
            let Some(open) = open.filter(|open| *open >= LEAST_OPEN) else {
                continue;
            };
            is_open = true;
            add(bins, open * BINS as f32, time_us);
        }
        if !is_open {
            self.closed_us += time_us;
        }
        if self.known_us >= LEARN_US {
            self.finish();
        }
        self.is_final
    }

    /// What was learnt, or guessed, counts until something is.
    fn begin_anew(&mut self) {
        *self = Baseline::guessed(self.open_eye);
    }

    fn finish(&mut self) {
        if self.closed_us as f32 > MOST_CLOSED * self.known_us as f32 {
            self.begin_anew();
            return;
        }
        let [left, right] = self.open_us.each_ref().map(open_of);
        // An eye that was never seen is as the other one.
        let other = left.or(right).unwrap_or(1.0);
        self.open_eye = [left.unwrap_or(other), right.unwrap_or(other)];
        self.is_final = true;
    }
}

/// The quantile of the open samples; `None` where there are none.
fn open_of(bins: &[u32; BINS]) -> Option<f32> {
    let [least, most] = BOUNDS;
    let place = quantile(bins, QUANTILE)?;
    Some((place / BINS as f32).clamp(least, most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_eyes_are_learnt_once() {
        let mut baseline = Baseline::NEW;
        let mut learnt = 0;
        for i in 0..2_000 {
            // One frame of ten is a blink; the right eye is seen half of the time.
            let open = if i % 10 == 0 { 0.1 } else { 0.81 };
            let right = (i % 2 == 0).then_some(if i % 10 == 0 { 0.1 } else { 0.72 });
            learnt += u32::from(baseline.pass(33_333, [Some(open), right], false));
        }
        assert_eq!((learnt, baseline.is_final()), (1, true));
        let [left, right] = baseline.open_eye();
        assert!((left - 0.83).abs() < 0.03 && (right - 0.73).abs() < 0.03);
    }

    #[test]
    fn a_guess_counts_until_something_is_learnt() {
        let mut baseline = Baseline::guessed([0.7, 0.2]);
        assert_eq!(baseline.open_eye(), [0.7, 0.6]);
        baseline.pass(33_333, [Some(0.9); 2], true);
        assert_eq!(baseline.open_eye(), [0.7, 0.6]);
        for _ in 0..1_000 {
            baseline.pass(33_333, [Some(0.9); 2], false);
        }
        assert!(baseline.is_final() && baseline.open_eye()[0] > 0.85);
    }

    #[test]
    fn sleepy_eyes_are_not_learnt() {
        let mut baseline = Baseline::NEW;
        for i in 0..2_000 {
            let open = if i % 4 == 0 { 0.1 } else { 0.8 };
            assert!(!baseline.pass(33_333, [Some(open); 2], false));
        }
        for i in 0..2_000 {
            assert!(!baseline.pass(33_333, [Some(0.8); 2], i % 600 == 0));
        }
        assert_eq!(baseline.open_eye(), [1.0; 2]);
    }
}
