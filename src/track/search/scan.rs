//! The detector's scans, which go on over many steps, and which sizes of faces come first.
//!
//! Small faces take most of a scan's work. So every other step starts with large faces; and while a
//! lost face is expected back, most steps start with its size, anywhere in the frame.

use crate::align::Workspace;
use crate::detect::{
    Detection, Scan, ScanBudget, ScanOutcome, Sizes, TILE_UNITS, TileMemory, local_search,
};
use crate::image::Frame;
use crate::track::config::Config;
use crate::track::policy::{
    CANDIDATE_UNITS, EXPECT_PERIOD, EXPECT_US, EXPECTED_SIZES, HINT_PERIOD, KEYFRAME_UNITS,
    LARGE_FACE, LARGE_FACE_PERIOD, UNCLEAR_PERIOD,
};
use crate::track::step::{Step, WorkBudget};

/// The detector's memory: that of the alignment, between two of its runs.
fn tile_memory(work: &mut Workspace) -> TileMemory<'_> {
    let (crop, maps) = work.network_memory();
    TileMemory { crop, maps }
}

/// The face that the detector finds near a place.
pub fn nearest(step: &Step<'_>, place: &Detection, work: &mut Workspace) -> Option<Detection> {
    local_search(
        &step.model.detector,
        step.frame,
        place,
        &mut tile_memory(work),
    )
}

/// Where the target was last seen, and when.
#[derive(Clone, Copy)]
pub struct LastSeen {
    /// Of size 0 if there was no target.
    pub place: Detection,
    when_us: i64,
}

impl LastSeen {
    const NEVER: LastSeen = LastSeen {
        place: Detection::NONE,
        when_us: 0,
    };

    pub fn at(place: &Detection, now_us: i64) -> LastSeen {
        LastSeen {
            place: *place,
            when_us: now_us,
        }
    }

    /// Whether the target is expected back at about this size.
    fn is_recent(&self, now_us: i64) -> bool {
        self.place.size > 0.0 && now_us.saturating_sub(self.when_us) < EXPECT_US
    }

    /// Sizes at which it is expected.
    fn sizes(&self, config: &Config) -> Sizes {
        let [smallest, largest] = EXPECTED_SIZES;
        Sizes {
            min_px: ((self.place.size * smallest) as i32).max(all_sizes(config).min_px),
            max_px: (self.place.size * largest) as i32,
        }
    }
}

fn all_sizes(config: &Config) -> Sizes {
    Sizes::from(config.min_face_px as i32)
}

/// Which sizes one step scans.
pub struct ScanPlan {
    /// Scanned first, by a scan of their own.
    first: Option<Sizes>,
    all: Sizes,
    /// Whether all sizes follow in the same step once the first ones are done.
    then_all: bool,
}

impl ScanPlan {
    /// These sizes first, then all.
    fn all_after(first: Option<Sizes>, config: &Config) -> ScanPlan {
        let all = all_sizes(config);
        ScanPlan {
            first: first.filter(|sizes| *sizes != all),
            all,
            then_all: true,
        }
    }

    /// While coasting: no face of another size takes the target's place.
    pub fn expected(last_seen: &LastSeen, config: &Config) -> ScanPlan {
        ScanPlan {
            then_all: false,
            ..Self::all_after(Some(last_seen.sizes(config)), config)
        }
    }
}

/// The scans of the frame, which go on over many steps.
#[derive(Clone)]
pub struct Scanner {
    pub all: Scan,
    first: Scan,
    pub last_seen: LastSeen,
    /// Counts steps without a face.
    steps: u32,
}

impl Scanner {
    pub const EMPTY: Scanner = Scanner {
        all: Scan::new(),
        first: Scan::new(),
        last_seen: LastSeen::NEVER,
        steps: 0,
    };

    /// A face was found: the next scan starts anew, and no face is expected back.
    pub fn restart(&mut self) {
        self.all.restart();
        self.first.restart();
        self.last_seen = LastSeen::NEVER;
    }

    /// As before the first step.
    pub fn reset(&mut self) {
        self.restart();
        self.steps = 0;
    }

    /// The target is gone and expected back.
    pub fn expect(&mut self, last_seen: LastSeen) {
        self.all.restart();
        self.last_seen = last_seen;
    }

    /// Whether the frame has many tiles: some places then look somewhat like a face.
    pub fn has_many_tiles(&self) -> bool {
        self.all.has_many_tiles() || self.first.has_many_tiles()
    }

    /// Counts a step without a face.
    pub fn count_step(&mut self) {
        self.steps = self.steps.wrapping_add(1);
    }

    /// Whether this is one of those steps in `period`.
    pub fn is_one_in(&self, period: u32) -> bool {
        self.steps.is_multiple_of(period)
    }

    /// Whether this step does not look where the caller expects a face. The first one does.
    pub fn leaves_hint(&self) -> bool {
        self.steps % HINT_PERIOD == 1
    }

    /// The next step is the first of `period`, after the one that [`Scanner::is_one_in`] means.
    pub fn end_turn(&mut self, period: u32) {
        self.steps -= self.steps % period.max(1);
    }

    /// The plan of this step while searching.
    pub fn plan(&self, config: &Config, step: &Step<'_>) -> ScanPlan {
        let first = match self.last_seen.is_recent(step.now_us) {
            true => (!self.is_one_in(EXPECT_PERIOD)).then(|| self.last_seen.sizes(config)),
            // Not in the first step: where it scans the whole frame, all sizes are enough.
            false => {
                let large = || large_sizes(config, step.frame);
                self.is_one_in(LARGE_FACE_PERIOD).then(large)
            }
        };
        ScanPlan::all_after(first, config)
    }

    /// Whether this step compares keyframes while searching.
    pub fn is_keyframe_step(&self, config: &Config, now_us: i64) -> bool {
        // Rarely where that would be most of a small budget.
        let affordable = KEYFRAME_UNITS.div_ceil(config.scan_budget.max(1));
        let wanted = match self.last_seen.is_recent(now_us) {
            true => 1,
            false => EXPECT_PERIOD,
        };
        self.is_one_in(affordable.max(wanted))
    }

    /// The next detection of the plan; `None` when the budget is spent or the scan is
    /// finished. Where less than [`CANDIDATE_UNITS`] are left, a detection waits for a later step;
    /// tiles are evaluated meanwhile.
    pub fn next(
        &mut self,
        step: &Step<'_>,
        plan: &mut ScanPlan,
        budget: &mut WorkBudget,
        work: &mut Workspace,
    ) -> Option<Detection> {
        let (roi, steps) = (step.scanned(), self.steps);
        let memory = &mut tile_memory(work);
        while budget.left() >= TILE_UNITS {
            let (scan, sizes) = match plan.first {
                Some(sizes) => (&mut self.first, sizes),
                None => (&mut self.all, plan.all),
            };
            let given = ScanBudget {
                units: budget.left(),
                candidate: CANDIDATE_UNITS.min(budget.limit()),
                clear: !steps.is_multiple_of(UNCLEAR_PERIOD),
                looks: true,
            };
            let detector = &step.model.detector;
            let outcome = scan.advance_in(detector, step.frame, roi, sizes, given, memory);
            budget.spend(given.units.saturating_sub(scan.units_left()));
            match outcome {
                ScanOutcome::Candidate(face) => return Some(face),
                ScanOutcome::Finished if plan.first.is_some() && plan.then_all => {
                    plan.first = None;
                }
                // It had ended with the step before.
                ScanOutcome::Finished if budget.spent() == 0 => {}
                ScanOutcome::Finished | ScanOutcome::BudgetSpent => return None,
            }
        }
        None
    }
}

/// The next outcome of a scan of all sizes.
pub fn next_of_all(
    scan: &mut Scan,
    config: &Config,
    step: &Step<'_>,
    budget: &mut WorkBudget,
    work: &mut Workspace,
) -> ScanOutcome {
    let (roi, sizes) = (step.scanned(), all_sizes(config));
    let memory = &mut tile_memory(work);
    let (detector, given) = (&step.model.detector, budget.left());
    let tiles = ScanBudget::of_tiles(given);
    let outcome = scan.advance_in(detector, step.frame, roi, sizes, tiles, memory);
    budget.spend(given.saturating_sub(scan.units_left()));
    outcome
}

fn large_sizes(config: &Config, frame: &Frame<'_>) -> Sizes {
    let large = LARGE_FACE * frame.width().min(frame.height()) as f32;
    Sizes::from((large as i32).max(all_sizes(config).min_px))
}
