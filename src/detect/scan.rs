//! The scan over sizes, rolls and places, in calls of bounded work.
//!
//! Sizes go down from a quarter more than the frame's shorter side: the largest face is found
//! first, and large sizes are cheap. All sizes are scanned for upright faces first, then for rolled
//! ones: most heads are upright and are found in a fraction of the whole scan. After each size the
//! best complete cluster is reported.
//!
//! Between calls the frame may change: a scan of a live stream sees each part of it at another
//! time, and a moving face has left by the time its cluster is complete. So what was hit during a
//! call is reported at the end of that call; a small local search makes up for the sizes that were
//! not scanned yet.

use super::cluster::{Clusters, Hit, radians};
use super::evaluate::{EMPTY_TABLE, WindowGrid};
use super::window::Q4;
use super::{Detection, DetectorModel, Window, local_search, refine};
use crate::image::{Frame, MAX_SIDE, Roi};

/// Largest size over the frame's shorter side \[1/256\]: a face that fills the frame, or of which
/// a part lies outside.
const LARGEST_Q8: i64 = 320;
/// Smallest face that can be asked for \[px\].
const FACE_MIN_PX: i32 = 16;
/// Budget of the local search around a cluster that is reported before it is complete \[units of
/// work\]: its 735 windows, most of them rejected within a unit.
const LOCAL_SEARCH_UNITS: u32 = 800;

/// What a call of the scan ended with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanOutcome {
    /// The budget is used up; the next call continues the scan.
    BudgetSpent,
    /// A face candidate. If the caller rejects it, the next call continues the scan and reports it
    /// again only where other sizes hit it too. If the caller accepts it, it calls
    /// [`Scan::restart`].
    Candidate(Detection),
    /// The whole frame was scanned and holds no further face; the next call starts a new scan.
    Finished,
}

/// Range of [`Detection::size`] that a scan covers \[frame px\], to within one step of its sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Smallest, at least 16.
    pub min_px: i32,
    /// Largest.
    pub max_px: i32,
}

impl Sizes {
    /// This size and all larger ones.
    pub const fn from(min_px: i32) -> Self {
        Sizes {
            min_px,
            max_px: i32::MAX,
        }
    }
}

/// State of a scan: plain data of fixed size.
#[derive(Clone, Debug)]
pub struct Scan {
    // What the scan was started for; another frame size, region or range of sizes restarts it.
    width: i32,
    height: i32,
    roi: Roi,
    min_px: i32,
    max_px: i32,
    // Size of this level [1/16 px]; 0 before the start.
    size: i32,
    // Number of sizes scanned before this one.
    level: u16,
    // Whether this is the second half of the scan, for heads that are rolled.
    rolled: bool,
    // Index of the roll within this half.
    roll: usize,
    // The next place.
    row: i32,
    column: i32,
    // Units of work that the last call did not use.
    units_left: u32,
    clusters: Clusters,
}

/// Window centres along one axis \[1/16 px\]; each is rounded to the nearest pixel.
#[derive(Clone, Copy)]
struct Axis {
    first: i32,
    step: i32,
    count: i32,
}

impl Axis {
    /// Spread symmetrically over `length` pixels of the frame from `start`, and a step beyond
    /// both, because a face at an edge is hit from both sides; `margin` away from the edges of a
    /// frame of `frame_length`.
    fn new([start, length]: [u32; 2], frame_length: i32, margin: i32, step: i32) -> Self {
        let last = (frame_length - 1) * Q4;
        let step = step.max(Q4 / 2);
        // A region never begins beyond the largest frame.
        let pixel = |at: u64| at.min(MAX_SIDE as u64) as i32 * Q4;
        let (start, end) = (start as u64, start as u64 + length as u64);
        let low = (pixel(start) - step).max(margin);
        let high = (pixel(end) + step).min(last - margin);
        let span = (high - low).max(0) as u32;
        let count = (span / step.max(1) as u32) as i32 + 1;
        Axis {
            first: (low + high - (count - 1) * step) / 2,
            step,
            count,
        }
    }

    fn pixel(&self, index: i32) -> i32 {
        (self.first + index * self.step + Q4 / 2) / Q4
    }
}

impl Default for Scan {
    fn default() -> Self {
        Self::new()
    }
}

impl Scan {
    /// A scan that has not begun; all zero.
    pub const fn new() -> Self {
        Scan {
            width: 0,
            height: 0,
            roi: Roi::new(0, 0, 0, 0),
            min_px: 0,
            max_px: 0,
            size: 0,
            level: 0,
            rolled: false,
            roll: 0,
            row: 0,
            column: 0,
            units_left: 0,
            clusters: Clusters::EMPTY,
        }
    }

    /// Drops all state: the next call starts a new scan.
    pub fn restart(&mut self) {
        *self = Self::new();
    }

    /// Continues the scan of the whole frame for about `budget` units of work.
    ///
    /// A window costs one unit plus one for every 16 trees that it needs (three times as much on a
    /// box-filtered frame). So a call evaluates at most 16·`budget` trees plus those of one window,
    /// and once those of [`refine`] and, for a cluster that is reported before it is complete, of a
    /// local search of 800 units.
    pub fn advance(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        sizes: Sizes,
        budget: u32,
    ) -> ScanOutcome {
        self.advance_in(model, frame, Roi::whole(frame), sizes, budget)
    }

    /// As [`Scan::advance`], for faces that are centred in a region; some that are centred a step
    /// beyond it are reported too.
    pub fn advance_in(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        roi: Roi,
        sizes: Sizes,
        budget: u32,
    ) -> ScanOutcome {
        // Not `clamp`: it may panic.
        let min_px = sizes.min_px.min(MAX_SIDE as i32).max(FACE_MIN_PX);
        let wanted = [frame.width(), frame.height(), min_px, sizes.max_px];
        if self.size == 0 || wanted != self.wanted() || roi != self.roi {
            self.roi = roi;
            self.begin(wanted, false);
        }
        self.clusters.begin_call();
        let mut units_left = budget.max(1) as i64;
        while units_left > 0 {
            let Some(roll) = self.rolls(model).get(self.roll) else {
                if let Some(outcome) = self.end_level(model, frame) {
                    self.units_left = units_left.max(0) as u32;
                    return outcome;
                }
                units_left -= 1;
                continue;
            };
            self.scan_roll(model, frame, *roll as i32, &mut units_left);
        }
        self.units_left = 0;
        match self.clusters.report_fresh(model.confirm) {
            Some(found) => ScanOutcome::Candidate(complete(model, frame, &found)),
            None => ScanOutcome::BudgetSpent,
        }
    }

    /// Units of the last call's budget that it did not use.
    pub fn units_left(&self) -> u32 {
        self.units_left
    }

    /// The rolls of this half of the scan: the model's first one, then the others.
    fn rolls<'m>(&self, model: &DetectorModel<'m>) -> &'m [i16] {
        let (upright, rolled) = model.rolls.split_at_checked(1).unwrap_or_default();
        if self.rolled { rolled } else { upright }
    }

    fn wanted(&self) -> [i32; 4] {
        [self.width, self.height, self.min_px, self.max_px]
    }

    fn begin(&mut self, wanted: [i32; 4], rolled: bool) {
        let [width, height, min_px, max_px] = wanted;
        let largest = ((width.min(height) as i64 * LARGEST_Q8) >> 8) as i32;
        *self = Scan {
            width,
            height,
            roi: self.roi,
            min_px,
            max_px,
            size: largest.min(max_px).max(min_px) * Q4,
            rolled,
            ..Self::new()
        };
    }

    /// The remaining places at one size and roll, as far as the budget goes.
    // Not inlined: its table has left the stack when a candidate is completed.
    #[inline(never)]
    fn scan_roll(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        roll: i32,
        units_left: &mut i64,
    ) {
        let q8 = |v: i32| ((self.size as i64 * v as i64) >> 8) as i32;
        let (step, margin) = (q8(model.step_q8), q8(model.margin_q8));
        let Roi {
            x,
            y,
            width,
            height,
        } = self.roi;
        let across = Axis::new([x, width], self.width, margin, step);
        let down = Axis::new([y, height], self.height, margin, step);
        let window = Window::new(0, 0, q8(model.side_q8), radians(roll));
        let mut table = EMPTY_TABLE;
        let windows = WindowGrid::new(frame, window, &mut table);
        while self.row < down.count {
            let y = down.pixel(self.row);
            while self.column < across.count {
                if *units_left <= 0 {
                    return;
                }
                let x = across.pixel(self.column);
                self.column += 1;
                let (score, units) = windows.evaluate(model, x, y);
                *units_left -= units;
                if let Some(score) = score {
                    self.clusters.add(Hit {
                        x: x * Q4,
                        y: y * Q4,
                        size: self.size,
                        roll,
                        score,
                        level: self.level,
                    });
                }
            }
            self.column = 0;
            self.row += 1;
        }
        self.row = 0;
        self.roll += 1;
    }

    /// After all rolls of a size: an outcome, or `None` and the next size.
    fn end_level(&mut self, model: &DetectorModel<'_>, frame: &Frame<'_>) -> Option<ScanOutcome> {
        let next = ((self.size as i64 * model.ratio_q8 as i64) >> 8) as i32;
        // Half a step below the smallest face: the hits of a face straddle two sizes.
        let floor = (self.min_px * Q4 * 15) / 16;
        let last = next < floor || next >= self.size;
        if let Some(best) = self.clusters.report(model.confirm, self.level, last) {
            return Some(ScanOutcome::Candidate(refine(model, frame, &best)));
        }
        if last && !self.rolled {
            self.begin(self.wanted(), true);
            return None;
        }
        if last {
            self.restart();
            return Some(ScanOutcome::Finished);
        }
        self.roll = 0;
        self.level += 1;
        self.size = next;
        None
    }
}

/// Moves an incomplete cluster, which may be off by a step of the scan, onto the face.
fn complete(model: &DetectorModel<'_>, frame: &Frame<'_>, found: &Detection) -> Detection {
    let rough = refine(model, frame, found);
    local_search(model, frame, &rough, LOCAL_SEARCH_UNITS).unwrap_or(rough)
}
