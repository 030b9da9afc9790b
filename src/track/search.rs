//! Where a face is looked for: sweeps over all sizes and over the likeliest, and what deserves a
//! second look.
//!
//! Small faces take most of a sweep, so every other slice goes to one over large faces alone. A face
//! that was lost not long ago is mostly looked for at its own size, wherever it is.

use super::Config;
use crate::align::Shape;
use crate::detect::{Detection, DetectorModel, Scan, ScanOutcome, Sizes};
use crate::image::Frame;
use crate::shape::LANDMARKS;

/// A candidate gets a second look from this probability on.
const DOUBT: f32 = 0.1;
/// How long a lost face is expected back at about the same size \[µs\].
const RECALL_US: i64 = 10_000_000;
/// How long what was no face after all has to be sure to be taken for one again \[µs\].
const SPURNED_US: i64 = 10_000_000;
/// Of so many slices of the search for it one goes to faces of all sizes.
const RECALL_TURNS: u32 = 4;
/// Of so many slices of any other search one goes to large faces.
const LARGE_TURNS: u32 = 2;
/// Large faces are at least this share of the frame's shorter side: who sits before a camera.
const LARGE: f32 = 0.25;

/// Place of nothing.
const NOWHERE: Detection = Detection {
    x: 0.0,
    y: 0.0,
    size: 0.0,
    roll: 0.0,
    yaw: 0.0,
    score: 0.0,
};

/// A face that was there not long ago.
#[derive(Clone, Copy)]
pub(super) struct Lost {
    /// As the detector has it; 0 for nobody.
    pub(super) size_px: f32,
    /// In-plane rotation \[rad\].
    #[cfg_attr(not(feature = "keyframes"), allow(dead_code))]
    pub(super) roll: f32,
    when_us: i64,
}

impl Lost {
    const NOBODY: Lost = Lost {
        size_px: 0.0,
        roll: 0.0,
        when_us: 0,
    };

    pub(super) fn at(place: &Detection, when_us: i64) -> Lost {
        Lost {
            size_px: place.size,
            roll: place.roll,
            when_us,
        }
    }

    fn is_recent(&self, now: i64) -> bool {
        self.size_px > 0.0 && now.saturating_sub(self.when_us) < RECALL_US
    }

    /// About as large as it was.
    pub(super) fn sizes(&self, config: &Config) -> Sizes {
        Sizes {
            min_px: ((self.size_px * 0.8) as i32).max(all_sizes(config).min_px),
            max_px: (self.size_px * 1.25) as i32,
        }
    }
}

fn all_sizes(config: &Config) -> Sizes {
    Sizes::from(config.min_face_px as i32)
}

/// What one step may do of the sweeps.
pub(super) struct Slice {
    /// Sizes that come first.
    likely: Option<Sizes>,
    all: Sizes,
    /// Whether the others come once these are done; while a face is held nobody of another size takes
    /// its place.
    wide: bool,
    /// Work that is left, in the detector's units.
    budget: u32,
}

impl Slice {
    /// After `spent` units of a step's work were used.
    pub(super) fn new(config: &Config, likely: Option<Sizes>, wide: bool, spent: u32) -> Slice {
        let all = all_sizes(config);
        Slice {
            likely: likely.filter(|sizes| *sizes != all),
            all,
            wide,
            budget: config.scan_budget.saturating_sub(spent).max(1),
        }
    }

    /// Whether so much work is left.
    pub(super) fn affords(&self, units: u32) -> bool {
        self.budget >= units
    }

    /// Takes the cost of a candidate that was judged.
    pub(super) fn spend(&mut self, units: u32) {
        self.budget = self.budget.saturating_sub(units);
    }
}

/// State of the search across steps.
#[derive(Clone)]
pub(super) struct Search {
    scan: Scan,
    /// The sweep over the sizes that are likeliest.
    likely: Scan,
    pub(super) lost: Lost,
    /// The likeliest of the last frame's candidates that were refused; 0 if there was none.
    doubt: f32,
    doubtful: Shape,
    /// What was taken for a face, never was sure and was given up; of size 0 if there was nothing.
    spurned: Detection,
    spurned_us: i64,
    /// Counts steps without a face.
    turn: u32,
}

impl Search {
    pub(super) const EMPTY: Search = Search {
        scan: Scan::new(),
        likely: Scan::new(),
        lost: Lost::NOBODY,
        doubt: 0.0,
        doubtful: [[0.0; 2]; LANDMARKS],
        spurned: NOWHERE,
        spurned_us: 0,
        turn: 0,
    };

    /// Nobody is looked for any more.
    pub(super) fn end(&mut self) {
        self.scan.restart();
        self.likely.restart();
        self.lost = Lost::NOBODY;
        self.doubt = 0.0;
    }

    /// As before the first step.
    pub(super) fn reset(&mut self) {
        self.end();
        self.spurned = NOWHERE;
        self.turn = 0;
    }

    /// Somebody who was there is looked for.
    pub(super) fn begin(&mut self, lost: Lost) {
        self.scan.restart();
        self.lost = lost;
    }

    /// One more step without a face.
    pub(super) fn next_turn(&mut self) {
        self.turn = self.turn.wrapping_add(1);
    }

    /// Whether this is one in so many of those steps.
    pub(super) fn is_one_in(&self, turns: u32) -> bool {
        self.turn.is_multiple_of(turns)
    }

    /// The sizes to begin with while nobody is held.
    pub(super) fn likely_sizes(
        &self,
        config: &Config,
        frame: &Frame<'_>,
        now: i64,
    ) -> Option<Sizes> {
        match self.lost.is_recent(now) {
            true => (!self.is_one_in(RECALL_TURNS)).then(|| self.lost.sizes(config)),
            // Not the first one: where it sees the whole frame, there is no need for it.
            false => self.is_one_in(LARGE_TURNS).then(|| {
                let large = LARGE * frame.width().min(frame.height()) as f32;
                Sizes::from((large as i32).max(all_sizes(config).min_px))
            }),
        }
    }

    /// Whether to compare keyframes on this turn, which costs so many of the detector's units.
    pub(super) fn recollects(&self, config: &Config, units: u32, now: i64) -> bool {
        // Rarely where the budget is so small that a look would be most of it.
        let rare = units.div_ceil(config.scan_budget.max(1));
        let recent = self.lost.is_recent(now);
        self.is_one_in(rare.max(if recent { 1 } else { RECALL_TURNS }))
    }

    /// The next candidate of the sweep over the likely sizes, if there are any, then of that over all of
    /// them; none when the slice is spent or the sweep at its end.
    pub(super) fn next(
        &mut self,
        detector: &DetectorModel<'_>,
        frame: &Frame<'_>,
        slice: &mut Slice,
    ) -> Option<Detection> {
        while slice.budget > 0 {
            let (scan, sizes) = match slice.likely {
                Some(sizes) => (&mut self.likely, sizes),
                None => (&mut self.scan, slice.all),
            };
            let swept = scan.advance(detector, frame, sizes, slice.budget);
            slice.budget = scan.units_left();
            match swept {
                ScanOutcome::Candidate(face) => return Some(face),
                ScanOutcome::Finished if slice.likely.is_some() && slice.wide => {
                    slice.likely = None
                }
                ScanOutcome::Finished | ScanOutcome::BudgetSpent => return None,
            }
        }
        None
    }

    /// What was there was no face after all.
    pub(super) fn spurn(&mut self, place: Detection, now: i64) {
        (self.spurned, self.spurned_us) = (place, now);
    }

    /// Whether what is there was no face a while ago.
    pub(super) fn spurns(&self, place: &Detection, now: i64) -> bool {
        let old = &self.spurned;
        let apart = libm::hypotf(place.x - old.x, place.y - old.y);
        now.saturating_sub(self.spurned_us) < SPURNED_US
            && apart < 0.5 * old.size
            && (0.67..1.5).contains(&(place.size / old.size))
    }

    /// A candidate was refused with this probability, and ended there.
    pub(super) fn refuse(&mut self, face: f32, shape: &Shape) {
        if face > self.doubt {
            (self.doubt, self.doubtful) = (face, *shape);
        }
    }

    /// Whether what was refused on the last frame might have become a face.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.doubt >= DOUBT
    }

    /// Where that was; it is forgotten with this.
    pub(super) fn take_doubtful(&mut self) -> Shape {
        self.doubt = 0.0;
        self.doubtful
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_no_face_is_spurned_where_it_was_and_for_a_while() {
        let thing = Detection {
            x: 100.0,
            y: 80.0,
            size: 60.0,
            ..NOWHERE
        };
        let mut search = Search::EMPTY;
        assert!(!search.spurns(&thing, 0));
        search.spurn(thing, 1_000_000);
        let at = |x: f32, size: f32| Detection { x, size, ..thing };
        let late = 1_000_000 + SPURNED_US;
        assert!(search.spurns(&at(120.0, 70.0), late - 1));
        assert!(!search.spurns(&thing, late));
        assert!(!search.spurns(&at(140.0, 60.0), late - 1));
        assert!(!search.spurns(&at(100.0, 120.0), late - 1));
        search.reset();
        assert!(!search.spurns(&thing, late - 1));
    }
}
