//! The scan over sizes and places, tile by tile, in calls of bounded work.
//!
//! A level is the frame at one reduction; each next level is twice as fine, and its tiles find the
//! faces that are too small for the one before. The coarsest level is first: the largest faces are
//! found first, and coarse levels have few tiles. The tiles of a level are evaluated in the order
//! of what the level before saw there ([`Order`]). A clear candidate is reported right after its
//! tile.
//!
//! Where a frame has many tiles, a candidate is seen in a tile of its own before it is reported: it
//! costs less than an attempt, and most candidates of clutter end there. A face that the edge of a
//! tile cut, or that was small in it, gets its place and its size there.
//!
//! A face is missed by where tiles lie and by how large it is in them. So each scan reduces the
//! frame by another factor than the one before ([`FINEST_Q4`]).
//!
//! Between calls the frame may change: a scan of a live stream sees each part of it at another
//! time.

use super::candidates::Candidates;
use super::hints::{Order, PASSES, Scores};
use super::model::TILE;
use super::tile::{TileMemory, evaluate, upright_tile};
use super::{Detection, DetectorModel, local_search};
use crate::image::{Frame, MAX_SIDE, Roi, reduce};

/// Work of a tile \[units\]: its instructions over those of a tracking step, of which 2,600 units
/// are one.
pub const TILE_UNITS: u32 = 700;

/// Most tiles of other passes that are stepped over at once.
const TILES_PASSED: u32 = 1024;
/// Work that this counts as \[units\].
const PASSED_UNITS: u32 = 32;

/// Score of a clear candidate \[logit above the detector's threshold\]: a probability of 0.5.
const CLEAR_SCORE: f32 = 1.4;
/// Score from which on a candidate is seen in a tile of its own, where there are many tiles, and
/// which it has to have there for an attempt …
const LOOK_SCORE: f32 = 1.4;
/// … or to be clear, before the last tile.
///
/// Source: faces of 60 px of `faces300w/train` in photographs of 3840×2160 px: 92 of 103 looks at a
/// face and 154 of 1,298 at clutter show more. With 1.4, 1.8 and 2.2, of 200 faces 32, 31 and 44
/// are tracked after more than 40 steps or never (*Candidates in tiles of their own*).
const CLEAR_LOOK: f32 = 1.8;
/// Largest face that has such a tile, as a multiple of the smallest that is searched for: the tile
/// is as coarse as those of the second level above the finest, and reads no more of the frame.
const LOOK_SIZES: i32 = 8;
/// Tiles of the first scan's finest level from which on there are many. Chosen: those of 1920×1080.
const MANY_TILES: u32 = 40;

/// Which faces a scan has at the smallest size of a tile \[1/16 of the smallest face\], one scan
/// after the other: steps of a sixteenth, the most different first.
///
/// Source: pictures shown eight times, with one, two, four and eight of these: profiles of
/// `profiles/train` found 93.2, 95.0, 96.0 and 97.1 %, faces of `faces68/train` blurred by 3 px
/// 89.6 (one), 91.1 (four) and 91.3 %; faceless frames tracked 0 of 1,500 (*Scans that differ*).
const FINEST_Q4: [i32; 8] = [16, 18, 14, 17, 15, 19, 13, 20];
/// The first of these where there are many tiles: the last, which has the fewest.
///
/// Source: faces of 60 px of `faces300w/train` in 3840×2160 px: half after 20 steps for 22.
const FIRST_OF_MANY: u8 = 7;

/// Largest size over the frame's shorter side \[1/256\]: a face that fills the frame, or of which
/// a part lies outside.
const LARGEST_Q8: i64 = 320;
/// Smallest face that can be asked for \[px\].
const FACE_MIN_PX: i32 = 16;
/// Most levels: a coarser one would show the largest frame in a pixel.
const LEVELS_MAX: u8 = 14;
/// Sizes beyond those asked for that are reported still: half a level either way.
const SIZE_MARGIN: f32 = 1.25;
/// How far beyond the region a face may be centred \[of its size\]: as far as the network errs.
const ROI_MARGIN: f32 = 0.1;

/// What a call of the scan ended with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanOutcome {
    /// The budget is used up; the next call continues the scan.
    BudgetSpent,
    /// A face candidate. If the caller rejects it, the next call continues the scan and reports it
    /// again only where another tile shows it far better. If the caller accepts it, it calls
    /// [`Scan::restart`].
    Candidate(Detection),
    /// The whole frame was scanned and holds no further face; the next call starts a new scan.
    Finished,
}

/// Range of [`Detection::size`] that a scan covers \[frame px\], to within a quarter.
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

    /// Whether a face of this size is reported \[frame px\].
    pub(super) fn holds(&self, size: f32) -> bool {
        let (min_px, max_px) = (self.min_px as f32, self.max_px as f32);
        size * SIZE_MARGIN >= min_px && size <= max_px * SIZE_MARGIN
    }
}

/// Work that a call of the scan may do \[units\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanBudget {
    /// For tiles, of [`TILE_UNITS`] each, and candidates.
    pub units: u32,
    /// What the caller does with a candidate. One is reported while so much is left; the others
    /// wait for a later call.
    pub candidate: u32,
    /// Whether only clear candidates are reported while there are tiles left to evaluate.
    pub clear: bool,
    /// Whether candidates are seen in tiles of their own where there are many tiles.
    pub looks: bool,
}

impl ScanBudget {
    /// All for tiles; candidates are reported whatever is left.
    pub const fn of_tiles(units: u32) -> Self {
        ScanBudget {
            units,
            candidate: 0,
            clear: false,
            looks: false,
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
    sizes: Sizes,
    // Whether it has begun.
    begun: bool,
    // Whether the first scan's finest level has many tiles.
    many: bool,
    // Levels that are finer than this one, and the number of the next tile of this one.
    level: u8,
    tile: u32,
    // The pass over the level's tiles, which pass each belongs to, and what the level has seen.
    pass: u8,
    order: Order,
    scores: Scores,
    // Which scan this is since the last restart.
    number: u8,
    // Units of work that the last call did not use.
    units_left: u32,
    candidates: Candidates,
}

/// What a scan does next.
enum Next {
    /// Evaluates a tile: its corner \[frame px\] and scale \[1/256 frame px per tile px\].
    Tile { corner: [i32; 2], scale_q8: i32 },
    /// Goes on, after many tiles that belong to other passes.
    Passed,
    /// Begins another pass.
    Pass,
    /// Nothing: it is finished.
    End,
}

/// Tiles along one axis.
#[derive(Clone, Copy)]
struct Axis {
    /// Left or upper edge of the first tile \[frame px\].
    first: i64,
    /// From the first tile's edge to that of the last one \[frame px\].
    span: i64,
    count: u32,
}

impl Axis {
    /// Tiles of `side` px that cover `length` px of the frame from `start` and overlap by `overlap`
    /// px at least. A length that is shorter than a tile is in its middle.
    fn new(start: i64, length: i64, side: i64, overlap: i64) -> Axis {
        let spare = length - side;
        if spare <= 0 {
            return Axis {
                first: start + spare / 2,
                span: 0,
                count: 1,
            };
        }
        let step = (side - overlap).max(1);
        Axis {
            first: start,
            span: spare,
            count: ((spare + step - 1) / step) as u32 + 1,
        }
    }

    /// Edge of a tile \[frame px\].
    fn at(&self, index: u32) -> i32 {
        let last = i64::from(self.count.saturating_sub(1)).max(1);
        (self.first + self.span * i64::from(index) / last) as i32
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
            sizes: Sizes {
                min_px: 0,
                max_px: 0,
            },
            begun: false,
            many: false,
            level: 0,
            tile: 0,
            pass: 0,
            order: Order::NONE,
            scores: Scores::NONE,
            number: 0,
            units_left: 0,
            candidates: Candidates::EMPTY,
        }
    }

    /// Drops all state: the next call starts a new scan.
    pub fn restart(&mut self) {
        *self = Self::new();
    }

    /// Continues the scan of the whole frame: evaluates as many tiles as the budget has, one at
    /// least, and ends early at a candidate. One that was found before is reported without work.
    #[cfg(feature = "unstable-internals")]
    pub fn advance(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        sizes: Sizes,
        budget: ScanBudget,
        memory: &mut TileMemory<'_>,
    ) -> ScanOutcome {
        self.advance_in(model, frame, Roi::whole(frame), sizes, budget, memory)
    }

    /// As [`Scan::advance`], for faces that are centred in a region; some that are centred a tenth
    /// of their size beyond it are reported too.
    pub fn advance_in(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        roi: Roi,
        sizes: Sizes,
        budget: ScanBudget,
        memory: &mut TileMemory<'_>,
    ) -> ScanOutcome {
        self.begin(model, frame, roi, sizes);
        self.units_left = budget.units;
        let looks = budget.looks && self.many;
        let mut is_first = true;
        loop {
            let clear = match (looks, budget.clear) {
                (true, true) => CLEAR_LOOK,
                (true, false) => LOOK_SCORE,
                (false, true) => CLEAR_SCORE,
                (false, false) => f32::NEG_INFINITY,
            };
            if let Some(face) = self.report(clear, looks, budget) {
                return ScanOutcome::Candidate(face);
            }
            if !is_first && self.units_left < TILE_UNITS {
                return ScanOutcome::BudgetSpent;
            }
            if looks && self.look(model, frame, LOOK_SCORE, memory) {
                is_first = false;
                continue;
            }
            match self.next(model) {
                Next::Tile { corner, scale_q8 } => {
                    self.evaluate(model, frame, corner, scale_q8, memory);
                    self.units_left = self.units_left.saturating_sub(TILE_UNITS);
                    is_first = false;
                }
                Next::Passed => self.units_left = self.units_left.saturating_sub(PASSED_UNITS),
                Next::Pass => {}
                // What is left is seen too, as far as there is work for it.
                Next::End if looks && self.look(model, frame, f32::NEG_INFINITY, memory) => {
                    is_first = false;
                }
                Next::End => return self.end(looks, budget),
            }
        }
    }

    /// The best candidate of at least this score, where the budget has what an attempt takes.
    fn report(&mut self, score: f32, looks: bool, budget: ScanBudget) -> Option<Detection> {
        match (self.units_left >= budget.candidate, looks) {
            (false, _) => None,
            (true, true) => self.candidates.report_seen(score, self.most_seen()),
            (true, false) => self.candidates.report_from(score),
        }
    }

    /// The largest face that is seen in a tile of its own \[frame px\].
    fn most_seen(&self) -> f32 {
        (LOOK_SIZES * self.sizes.min_px) as f32
    }

    /// Sees the best candidate of at least this score in a tile of its own, if there is one.
    fn look(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        score: f32,
        memory: &mut TileMemory<'_>,
    ) -> bool {
        let most = self.most_seen();
        let Some(face) = self.candidates.unseen(score, most) else {
            return false;
        };
        let upright = Detection { roll: 0.0, ..face };
        let seen = local_search(model, frame, &upright, memory);
        let seen = seen.filter(|face| self.sizes.holds(face.size) && is_centred(&self.roi, face));
        self.candidates.see(seen, most);
        self.units_left = self.units_left.saturating_sub(TILE_UNITS);
        true
    }

    /// After the last tile: a candidate that waits, or the end.
    fn end(&mut self, looks: bool, budget: ScanBudget) -> ScanOutcome {
        if let Some(face) = self.report(f32::NEG_INFINITY, looks, budget) {
            return ScanOutcome::Candidate(face);
        }
        match self.candidates.has_pending() {
            true => ScanOutcome::BudgetSpent,
            false => self.finished(),
        }
    }

    /// The next call begins another scan.
    fn finished(&mut self) -> ScanOutcome {
        *self = Scan {
            number: self.number.wrapping_add(1),
            units_left: self.units_left,
            ..Self::new()
        };
        ScanOutcome::Finished
    }

    /// Whether there are many tiles in the scan that goes on.
    pub fn has_many_tiles(&self) -> bool {
        self.many
    }

    /// Units of the last call's budget that it did not use.
    pub fn units_left(&self) -> u32 {
        self.units_left
    }

    /// Begins a scan, unless the one that goes on is of the same kind.
    fn begin(&mut self, model: &DetectorModel<'_>, frame: &Frame<'_>, roi: Roi, sizes: Sizes) {
        let (width, height) = (frame.width(), frame.height());
        let largest = ((i64::from(width.min(height)) * LARGEST_Q8) >> 8) as i32;
        let min_px = sizes.min_px.min(MAX_SIDE as i32).max(FACE_MIN_PX);
        let sizes = Sizes {
            min_px,
            max_px: sizes.max_px.min(largest).max(min_px),
        };
        let is_same =
            (self.width, self.height, self.roi, self.sizes) == (width, height, roi, sizes);
        if self.begun && is_same {
            return;
        }
        let number = self.number;
        *self = Scan {
            width,
            height,
            roi,
            sizes,
            begun: true,
            ..Self::new()
        };
        self.many = self.tiles(model) >= MANY_TILES;
        self.number = match number {
            0 if self.many => FIRST_OF_MANY,
            _ => number,
        };
        let [_, most] = model.sizes_q8;
        let covers = |level: &u8| {
            let largest = i64::from(self.scale_q8(model, *level)) * i64::from(most);
            largest >= i64::from(sizes.max_px) << 16
        };
        self.level = (0..LEVELS_MAX).find(covers).unwrap_or(LEVELS_MAX);
    }

    /// The next tile of the scan, in the order of passes.
    fn next(&mut self, model: &DetectorModel<'_>) -> Next {
        if self.pass >= PASSES {
            return Next::End;
        }
        let scale_q8 = self.scale_q8(model, self.level);
        let [across, down] = self.axes(model, scale_q8);
        let end = (across.count * down.count).min(self.tile.saturating_add(TILES_PASSED));
        while self.tile < end {
            let tile = self.tile;
            self.tile += 1;
            let corner = [
                across.at(tile % across.count.max(1)),
                down.at(tile / across.count.max(1)),
            ];
            if self.pass_of(model, corner, scale_q8) == self.pass {
                return Next::Tile { corner, scale_q8 };
            }
        }
        if end < across.count * down.count {
            return Next::Passed;
        }
        self.tile = 0;
        self.pass += 1;
        if self.pass == PASSES && self.level > 0 {
            self.level -= 1;
            self.pass = 0;
            self.order = Order::new(&self.scores);
            self.scores = Scores::NONE;
        }
        Next::Pass
    }

    /// The pass of a tile, by its middle, which no other tile shows.
    fn pass_of(&self, model: &DetectorModel<'_>, corner: [i32; 2], scale_q8: i32) -> u8 {
        let px = |tile_px: i32| (tile_px * scale_q8) as f32 / 256.0;
        let (from, to) = (px(model.overlap), px(TILE as i32 - model.overlap));
        let [x, y] = corner.map(|v| v as f32);
        let (width, height) = (self.width as f32, self.height as f32);
        let place = |by: f32| [(x + by) / width, (y + by) / height];
        self.order.pass(place(from), place(to))
    }

    /// Tiles of this level.
    fn tiles(&self, model: &DetectorModel<'_>) -> u32 {
        let [across, down] = self.axes(model, self.scale_q8(model, self.level));
        across.count.saturating_mul(down.count)
    }

    /// Tiles across and down that show all faces of a level that are centred in the region.
    fn axes(&self, model: &DetectorModel<'_>, scale_q8: i32) -> [Axis; 2] {
        let px = |tile_px_q8: i64| (tile_px_q8 * i64::from(scale_q8)) >> 16;
        let [_, largest] = model.sizes_q8;
        let reach = px(i64::from(largest));
        let axis = |start: u32, length: u32, frame: i32| {
            let (start, length) = (i64::from(start), i64::from(length));
            let low = (start - reach).max(0).min(i64::from(frame));
            let high = (start + length + reach).min(i64::from(frame)).max(low);
            let (side, overlap) = (px((TILE as i64) << 8), px(i64::from(model.overlap) << 8));
            Axis::new(low, high - low, side, overlap)
        };
        [
            axis(self.roi.x, self.roi.width, self.width),
            axis(self.roi.y, self.roi.height, self.height),
        ]
    }

    /// Frame px per tile px of a level \[1/256\]: the finest shows the smallest face at about the
    /// smallest size of a tile.
    fn scale_q8(&self, model: &DetectorModel<'_>, level: u8) -> i32 {
        let [smallest, _] = model.sizes_q8;
        let of_scan = FINEST_Q4.get(usize::from(self.number) % FINEST_Q4.len());
        let min_px_q4 = i64::from(self.sizes.min_px) * i64::from(of_scan.copied().unwrap_or(16));
        let finest = (min_px_q4 << 12) / i64::from(smallest.max(1));
        (finest << level).min(i64::from(MAX_SIDE) << 8).max(1) as i32
    }

    fn evaluate(
        &mut self,
        model: &DetectorModel<'_>,
        frame: &Frame<'_>,
        corner: [i32; 2],
        scale_q8: i32,
        memory: &mut TileMemory<'_>,
    ) {
        reduce(frame, corner, scale_q8, TILE, memory.crop);
        let to_frame = upright_tile(corner, scale_q8 as f32 / 256.0);
        let (roi, sizes) = (self.roi, self.sizes);
        let wanted = |face: &Detection| sizes.holds(face.size) && is_centred(&roi, face);
        let (width, height) = (self.width as f32, self.height as f32);
        let scores = &mut self.scores;
        let visit = |[x, y]: [f32; 2], score: u8| scores.add([x / width, y / height], score);
        evaluate(
            model,
            &to_frame,
            wanted,
            visit,
            memory,
            &mut self.candidates,
        );
    }
}

/// Whether a face is centred in a region, or nearly.
fn is_centred(roi: &Roi, face: &Detection) -> bool {
    let margin = ROI_MARGIN * face.size;
    let within = |v: f32, start: u32, length: u32| {
        let start = start as f32;
        v >= start - margin && v <= start + length as f32 + margin
    };
    within(face.x, roi.x, roi.width) && within(face.y, roi.y, roi.height)
}
