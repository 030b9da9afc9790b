//! The sweep over sizes, rolls and places, in slices.
//!
//! Sizes go from the frame's shorter side down, so the largest face is met first, and large sizes,
//! which are cheap, are done soon. All sizes are searched for upright faces first, then for turned
//! ones: most heads are upright, and are found in a fraction of the sweep. After each size the
//! largest confirmed cluster that is complete is told. Between slices the frame may change: a sweep
//! over a live stream sees each part of it at another time, and a face that moves is elsewhere when
//! its cluster is complete. So what was met in a slice is told at its end, and a small search around
//! it makes up for the sizes that were not looked at yet.

use super::cluster::{Clusters, Hit, turns};
use super::evaluate::{EMPTY, Windows};
use super::window::Q4;
use super::{Detection, DetectorModel, Window, local_search, refine};
use crate::image::Frame;

/// Smallest face that can be asked for \[px\].
const FACE_MIN_PX: i32 = 16;
/// Work of a search around what is told before it is complete.
const SETTLE_UNITS: u32 = 800;

/// What a slice of the sweep ended with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanOutcome {
    /// The budget is used up; the sweep goes on with the next call.
    BudgetSpent,
    /// A face. Should it prove not to be one, the next call goes on with the sweep, and tells it again
    /// only where other sizes show it too; else call [`Scan::restart`].
    Candidate(Detection),
    /// The whole frame was seen and holds no face; the next call starts a new sweep.
    Finished,
}

/// Which faces a sweep looks for, by [`Detection::size`] \[px\]: within a step of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Narrowest, at least 16.
    pub min_px: i32,
    /// Widest.
    pub max_px: i32,
}

impl Sizes {
    /// All from this one on.
    pub const fn from(min_px: i32) -> Self {
        Sizes {
            min_px,
            max_px: i32::MAX,
        }
    }
}

/// State of a sweep: plain data of fixed size.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scan {
    // What the sweep was started for; another frame size or other faces start it anew.
    width: i32,
    height: i32,
    min_px: i32,
    max_px: i32,
    // Size of this pass [1/16 px]; 0 before the start.
    size: i32,
    pass: u16,
    // Whether this is the second half of the sweep, for heads that are turned in the image.
    turned: bool,
    roll: usize,
    row: i32,
    column: i32,
    // Units that the last slice did not use.
    left: u32,
    clusters: Clusters,
}

/// Places of window centres along one axis \[1/16 px\]; each is taken to the nearest pixel.
#[derive(Clone, Copy)]
struct Axis {
    first: i32,
    step: i32,
    count: i32,
}

impl Axis {
    /// Centred on `length` pixels, keeping `margin` from both edges.
    fn new(length: i32, margin: i32, step: i32) -> Self {
        let last = (length - 1) * Q4;
        let room = (last - 2 * margin).max(0) as u32;
        let step = step.max(Q4 / 2);
        let count = (room / step.max(1) as u32) as i32 + 1;
        Axis {
            first: (last - (count - 1) * step) / 2,
            step,
            count,
        }
    }

    fn pixel(&self, index: i32) -> i32 {
        (self.first + index * self.step + Q4 / 2) / Q4
    }
}

impl Scan {
    /// A sweep that has not begun.
    pub const fn new() -> Self {
        Scan {
            width: 0,
            height: 0,
            min_px: 0,
            max_px: 0,
            size: 0,
            pass: 0,
            turned: false,
            roll: 0,
            row: 0,
            column: 0,
            left: 0,
            clusters: Clusters::EMPTY,
        }
    }

    /// Forgets everything: the next slice starts a new sweep.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Goes on with the sweep for at most about `budget` units of work.
    ///
    /// A window costs one unit and one more for every 16 trees that it needs, so a call asks at
    /// most 16·`budget` trees plus those of one window, and once those of [`refine`] and of a search
    /// around what is told at a slice's end, 800 units.
    pub fn advance(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        sizes: Sizes,
        budget: u32,
    ) -> ScanOutcome {
        let min_px = sizes.min_px.max(FACE_MIN_PX);
        let wanted = [frame.width(), frame.height(), min_px, sizes.max_px];
        if self.size == 0 || wanted != self.wanted() {
            self.begin(wanted, false);
        }
        self.clusters.begin_slice();
        let mut left = budget.max(1) as i64;
        while left > 0 {
            let Some(roll) = self.rolls(model).get(self.roll) else {
                if let Some(end) = self.end_pass(model, frame) {
                    self.left = left.max(0) as u32;
                    return end;
                }
                left -= 1;
                continue;
            };
            self.rows(model, frame, *roll as i32, &mut left);
        }
        self.left = 0;
        match self.clusters.report_fresh(model.confirm) {
            Some(told) => ScanOutcome::Candidate(settle(model, frame, &told)),
            None => ScanOutcome::BudgetSpent,
        }
    }

    /// Units of the last slice's budget that it did not use.
    pub fn left(&self) -> u32 {
        self.left
    }

    /// The rolls of this half of the sweep: the model's first one, then the others.
    fn rolls<'m>(&self, model: &DetectorModel<'m>) -> &'m [i16] {
        let (upright, turned) = model.rolls.split_at_checked(1).unwrap_or_default();
        if self.turned { turned } else { upright }
    }

    fn wanted(&self) -> [i32; 4] {
        [self.width, self.height, self.min_px, self.max_px]
    }

    fn begin(&mut self, wanted: [i32; 4], turned: bool) {
        let [width, height, min_px, max_px] = wanted;
        *self = Scan {
            width,
            height,
            min_px,
            max_px,
            size: width.min(height).min(max_px).max(min_px) * Q4,
            turned,
            ..Self::default()
        };
    }

    /// The rest of the places at one size and roll, as far as the work goes.
    // By itself, so that its table has left the stack when a candidate is settled.
    #[inline(never)]
    fn rows(&mut self, model: &DetectorModel<'_>, frame: &Frame<'_>, roll: i32, left: &mut i64) {
        let q8 = |v: i32| ((self.size as i64 * v as i64) >> 8) as i32;
        let (step, margin) = (q8(model.step_q8), q8(model.margin_q8));
        let across = Axis::new(self.width, margin, step);
        let down = Axis::new(self.height, margin, step);
        let window = Window::new(0, 0, q8(model.side_q8), turns(roll));
        let mut table = EMPTY;
        let windows = Windows::new(frame, window, &mut table);
        while self.row < down.count {
            let y = down.pixel(self.row);
            while self.column < across.count {
                if *left <= 0 {
                    return;
                }
                let x = across.pixel(self.column);
                self.column += 1;
                let (score, units) = windows.evaluate(model, x, y);
                *left -= units;
                if let Some(score) = score {
                    self.clusters.add(Hit {
                        x: x * Q4,
                        y: y * Q4,
                        size: self.size,
                        roll,
                        score,
                        pass: self.pass,
                    });
                }
            }
            self.column = 0;
            self.row += 1;
        }
        self.row = 0;
        self.roll += 1;
    }

    /// After all rolls of a size: an end of the sweep, or the next size.
    fn end_pass(&mut self, model: &DetectorModel<'_>, frame: &Frame<'_>) -> Option<ScanOutcome> {
        let next = ((self.size as i64 * model.ratio_q8 as i64) >> 8) as i32;
        // Half a step below the smallest face, for its hits straddle two sizes.
        let floor = (self.min_px * Q4 * 15) / 16;
        let last = next < floor || next >= self.size;
        if let Some(best) = self.clusters.report(model.confirm, self.pass, last) {
            return Some(ScanOutcome::Candidate(refine(model, frame, &best)));
        }
        if last && !self.turned {
            self.begin(self.wanted(), true);
            return None;
        }
        if last {
            self.restart();
            return Some(ScanOutcome::Finished);
        }
        self.roll = 0;
        self.pass += 1;
        self.size = next;
        None
    }
}

/// An incomplete cluster, moved onto the face: it may be off by a step of the grid.
fn settle(model: &DetectorModel<'_>, frame: &Frame<'_>, told: &Detection) -> Detection {
    let rough = refine(model, frame, told);
    local_search(model, frame, &rough, SETTLE_UNITS).unwrap_or(rough)
}
