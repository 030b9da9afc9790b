//! Where a step looks for a face: the places that it attempts one after the other, within its work.

mod faces;
mod keyframes;
mod rejected;
mod scan;

pub use faces::{Detected, FaceHint, FoundFace, list};
pub use rejected::{Excluded, Seen, Suppressed};

use super::align::{Candidate, Needed, Origin, Start};
use super::config::Config;
use super::output::State;
use super::policy::{
    ACCEPT_CONFIDENCE, DISCARD_CONFIDENCE, FIRST_ATTEMPT_CONFIDENCE, FIRST_UNITS, FOUND_UNITS,
    ITERATION_UNITS, KEYFRAME_UNITS, LOCAL_ITERATIONS, LOCAL_SEARCH_PERIOD, LOCAL_UNITS,
    LOOK_AGAIN_PERIOD, RETRY_CONFIDENCE, TURNED_ITERATIONS, TURNED_UNITS,
};
use super::step::{Step, WorkBudget};
use crate::align::{Networks, Workspace};
use crate::detect::{Detection, Scan, TILE_UNITS, is_upright};
use keyframes::Keyframes;
use rejected::PendingRetry;
use scan::{LastSeen, ScanPlan, Scanner, nearest};

/// What the search keeps from frame to frame.
#[derive(Clone)]
pub struct Search {
    scanner: Scanner,
    retry: PendingRetry,
    /// The best detection whose attempt went astray; none if there is none.
    astray: Seen,
    pub keyframes: Keyframes,
}

impl Search {
    pub const EMPTY: Search = Search {
        scanner: Scanner::EMPTY,
        retry: PendingRetry::NONE,
        astray: Seen::NONE,
        keyframes: Keyframes::EMPTY,
    };

    /// As before the first step.
    pub fn reset(&mut self) {
        self.end();
        self.scanner.reset();
        self.keyframes.reset();
    }

    /// The target is gone from this place, and expected back.
    pub fn expect(&mut self, place: &Detection, now_us: i64) {
        self.scanner.expect(LastSeen::at(place, now_us));
    }

    /// The scan of all sizes.
    pub fn scan(&mut self) -> &mut Scan {
        &mut self.scanner.all
    }

    /// Keeps a rejected candidate for a retry, if none is kept that is better.
    pub fn offer(&mut self, start: &Start, rejected: &Candidate) {
        self.retry.offer(&PendingRetry {
            confidence: rejected.confidence.face,
            shape: rejected.shape,
            is_unfinished: rejected.iterations_left > 0,
            seen: start.seen,
        });
    }

    /// Keeps a detection whose attempt went astray, if none is kept that is better.
    pub fn look_again_at(&mut self, seen: &Seen) {
        if seen.face.score > self.astray.face.score {
            self.astray = *seen;
        }
    }

    /// A face was found: ends scan and retries.
    fn end(&mut self) {
        self.scanner.restart();
        self.retry.clear();
        self.astray = Seen::NONE;
    }

    /// The rest of a first attempt, which may be retried once more, or the second and last attempt
    /// at a rejected detection.
    fn retried(&mut self) -> Option<Start> {
        let retry = self.retry.take()?;
        let mut start = Start::near(retry.shape, Origin::NewFace);
        start.seen = retry.seen;
        start.may_retry = retry.is_unfinished;
        // Of many places, some look somewhat like a face.
        if retry.is_unfinished || self.scanner.has_many_tiles() {
            start.needed = Needed::to_refine(FIRST_ATTEMPT_CONFIDENCE);
        }
        // Most of these are no faces: all networks see it if it is better then.
        if retry.confidence < RETRY_CONFIDENCE {
            start.networks = Networks::First;
        }
        Some(start)
    }
}

/// What the caller knows of the face that it wants.
#[derive(Clone, Copy)]
pub enum Wanted {
    /// Nothing.
    Any,
    /// It is expected here, roughly. What other detectors report differs from this one's boxes.
    Near(Detection),
    /// It is exactly here, and nowhere else.
    #[cfg_attr(
        not(feature = "unstable-internals"),
        expect(dead_code, reason = "only programs that measure know that")
    )]
    At(Detection),
    /// The face that was tracked is exactly here, and nowhere else.
    #[cfg_attr(
        not(feature = "unstable-internals"),
        expect(dead_code, reason = "only programs that measure know that")
    )]
    Again(Detection),
}

/// Work of a search with keyframes and of the attempt at what it finds \[units\].
const KEYFRAME_ATTEMPT_UNITS: u32 = KEYFRAME_UNITS + RETRY_FIRST_UNITS;
/// Work of a retry with all networks, and with the first one only \[units\].
const RETRY_UNITS: u32 = ITERATION_UNITS + FOUND_UNITS;
const RETRY_FIRST_UNITS: u32 = FIRST_UNITS + FOUND_UNITS;

/// What is proposed next.
#[derive(Clone, Copy)]
enum Stage {
    /// The caller's place, and nothing else.
    Exactly(Detection, Origin),
    /// The caller's place …
    Expected(Detection),
    /// … and what the detector finds near it.
    NearExpected(Detection),
    /// Nothing yet: a step that searches begins.
    Begin,
    /// Nothing yet: this step has lost the target, last seen here.
    Lost(LastSeen),
    /// A keyframe in one window of the frame, after the target was last seen here.
    Keyframe(LastSeen),
    /// Nothing yet: steps that coast search around the target's place, and for keyframes and in the
    /// frame, by turns.
    Turn(LastSeen),
    /// What the detector finds near the target's last place.
    NearTarget(Detection),
    /// The pending retry, or what the detector sees where an attempt went astray …
    Retry,
    /// … with work for one tile at least …
    BeginScan,
    /// … each detection of the scan …
    Scan,
    /// … and retries, on the same frame where work is left: a still picture is not shown again.
    Retries,
    End,
}

/// The places of one step.
pub struct Proposals {
    state: State,
    stage: Stage,
    plan: ScanPlan,
    budget: WorkBudget,
    /// The keyframe of the last proposal.
    entry: Option<usize>,
}

impl Proposals {
    /// Those of a step in this state, whose target was last fitted at `place`, and was followed
    /// with so much work.
    pub fn new(
        state: State,
        wanted: &Wanted,
        place: &Detection,
        config: &Config,
        now_us: i64,
        spent: u32,
    ) -> Proposals {
        let last_seen = LastSeen::at(place, now_us);
        let stage = match (wanted, state) {
            (Wanted::At(face), _) => Stage::Exactly(*face, Origin::NewFace),
            (Wanted::Again(face), _) => Stage::Exactly(*face, Origin::Reacquired),
            (Wanted::Near(face), State::Searching) => Stage::Expected(*face),
            (_, State::Searching) => Stage::Begin,
            (_, State::Tracking) => Stage::Lost(last_seen),
            (_, State::Coasting) => Stage::Turn(last_seen),
        };
        Proposals {
            state,
            stage,
            plan: ScanPlan::expected(&last_seen, config),
            budget: WorkBudget::new(config.scan_budget, spent),
            entry: None,
        }
    }

    /// Counts work that an attempt took \[units\].
    pub fn spend(&mut self, units: u32) {
        self.budget.spend(units);
    }

    /// Whether so much more is within what a step may take \[units\].
    pub fn has_room(&self, units: u32) -> bool {
        self.budget.has_room(units)
    }

    /// All work of the step so far \[units\].
    pub fn units(&self) -> u32 {
        self.budget.total()
    }

    /// The next place; `None` when there is none or the step's work is done.
    #[inline(never)]
    pub fn next(
        &mut self,
        step: &Step<'_>,
        config: &Config,
        search: &mut Search,
        work: &mut Workspace,
    ) -> Option<Start> {
        self.entry = None;
        loop {
            let (start, next) = match self.stage {
                Stage::Exactly(face, origin) => (first(step, &face, origin), Stage::End),
                Stage::Expected(_) if search.scanner.leaves_hint() => (None, Stage::Begin),
                Stage::Expected(face) => {
                    let start = first(step, &face, Origin::NewFace);
                    (start, Stage::NearExpected(face))
                }
                Stage::NearExpected(face) => {
                    self.budget.spend(local_units(&face));
                    let found = nearest(step, &face, work);
                    let start = found.and_then(|face| first(step, &face, Origin::NewFace));
                    (start, Stage::Begin)
                }
                Stage::NearTarget(face) => {
                    let start = self.near(step, &face, Origin::Reacquired, work);
                    (start, Stage::End)
                }
                Stage::Begin => (None, self.begin(step, config, search)),
                Stage::Keyframe(last) => self.keyframe(step, &last, search, work),
                Stage::Lost(last) => (None, self.lost(&last, search)),
                Stage::Turn(last) => (None, turn(&last, search)),
                // If a keyframe match was rejected, the step has had its retry.
                Stage::Retry if self.budget.spent() > KEYFRAME_UNITS => (None, Stage::BeginScan),
                Stage::Retry => {
                    let retry = self.retry(search);
                    let is_due = retry.is_none() && search.scanner.is_one_in(LOOK_AGAIN_PERIOD);
                    let start = match is_due {
                        true => self.astray(step, search, work),
                        false => retry,
                    };
                    (start, Stage::BeginScan)
                }
                Stage::BeginScan => {
                    self.budget.leave(TILE_UNITS);
                    (None, Stage::Scan)
                }
                Stage::Scan => self.detection(step, search, work),
                Stage::Retries if self.budget.left() >= RETRY_UNITS => {
                    let start = search.retried();
                    let start = start.or_else(|| self.astray(step, search, work));
                    let is_last = start.is_none();
                    (start, if is_last { Stage::End } else { Stage::Retries })
                }
                Stage::Retries => (None, Stage::End),
                Stage::End => return None,
            };
            self.stage = next;
            if start.is_some() {
                return start;
            }
        }
    }

    /// What the detector finds near a place, with the first network only.
    fn near(
        &mut self,
        step: &Step<'_>,
        place: &Detection,
        origin: Origin,
        work: &mut Workspace,
    ) -> Option<Start> {
        self.budget.spend(local_units(place));
        let most = match is_upright(place) {
            true => LOCAL_ITERATIONS,
            false => TURNED_ITERATIONS,
        };
        let face = nearest(step, place, work)?;
        let start = first(step, &face, origin)?;
        Some(Start {
            iterations: most.min(start.iterations),
            networks: Networks::First,
            ..start
        })
    }

    /// The pending retry, with the networks for which there is room; it waits where there is none.
    fn retry(&mut self, search: &mut Search) -> Option<Start> {
        if !self.budget.has_room(RETRY_FIRST_UNITS) {
            return None;
        }
        let start = search.retried()?;
        match self.budget.has_room(RETRY_UNITS) {
            true => Some(start),
            false => Some(start.with(Networks::First)),
        }
    }

    /// What the detector sees where an attempt went astray; it waits where there is no room.
    fn astray(
        &mut self,
        step: &Step<'_>,
        search: &mut Search,
        work: &mut Workspace,
    ) -> Option<Start> {
        let Seen { face, looks } = search.astray;
        let attempt = LOCAL_ITERATIONS as u32 * FIRST_UNITS + FOUND_UNITS;
        if looks == 0 || !self.budget.has_room(local_units(&face) + attempt) {
            return None;
        }
        search.astray = Seen::NONE;
        let mut start = self.near(step, &face, Origin::NewFace, work)?;
        if search.scanner.has_many_tiles() {
            start.needed = Needed::to_refine(FIRST_ATTEMPT_CONFIDENCE);
        }
        start.seen.looks = looks - 1;
        Some(start)
    }

    /// The last proposal was accepted as the target.
    pub fn accepted(&self, search: &mut Search) {
        match (self.entry, self.stage) {
            (Some(entry), _) => {
                search.keyframes.confirm(entry);
                search.end();
            }
            // One place was searched and no frame: the scan goes on if the target is lost again.
            (None, Stage::End) => {}
            (None, _) => search.end(),
        }
    }

    /// A step that has lost its target looks for it by keyframes, or leaves that to the next one,
    /// which has no target to follow.
    fn lost(&mut self, last: &LastSeen, search: &mut Search) -> Stage {
        match self.budget.has_room(KEYFRAME_ATTEMPT_UNITS) {
            true => Stage::Keyframe(*last),
            false => {
                search.scanner.end_turn(LOCAL_SEARCH_PERIOD);
                Stage::End
            }
        }
    }

    /// Plans a step that searches. What the caller's place took comes on top of its work.
    fn begin(&mut self, step: &Step<'_>, config: &Config, search: &mut Search) -> Stage {
        let scanner = &mut search.scanner;
        scanner.count_step();
        self.plan = scanner.plan(config, step);
        self.budget = WorkBudget::new(config.scan_budget, self.budget.total());
        match scanner.is_keyframe_step(config, step.now_us) {
            true => Stage::Keyframe(scanner.last_seen),
            false => Stage::Retry,
        }
    }

    /// The target, or another face that was tracked before, in one window of the frame.
    fn keyframe(
        &mut self,
        step: &Step<'_>,
        last: &LastSeen,
        search: &mut Search,
        work: &mut Workspace,
    ) -> (Option<Start>, Stage) {
        let next = match self.state {
            State::Searching | State::Coasting => Stage::Retry,
            State::Tracking => Stage::End,
        };
        if !search.keyframes.can_find(&last.place) {
            return (None, next);
        }
        self.budget.spend(KEYFRAME_UNITS);
        let found = (search.keyframes).find(step.frame, &last.place, work.scratch());
        self.entry = found.as_ref().map(|found| found.entry);
        (
            found.map(|found| Start::near(found.shape, found.origin).with(Networks::First)),
            next,
        )
    }

    /// The next detection of the scan.
    fn detection(
        &mut self,
        step: &Step<'_>,
        search: &mut Search,
        work: &mut Workspace,
    ) -> (Option<Start>, Stage) {
        let Some(face) = (search.scanner).next(step, &mut self.plan, &mut self.budget, work) else {
            return (None, Stage::Retries);
        };
        let before = step.model.align.iterations().saturating_sub(1) as u32 * FIRST_UNITS;
        let (all, first) = (before + RETRY_UNITS, before + RETRY_FIRST_UNITS);
        let budget = &self.budget;
        let (to_iterate, networks) = match budget.left() >= all {
            true => (DISCARD_CONFIDENCE, Networks::All),
            false if budget.has_room(all) => (RETRY_CONFIDENCE, Networks::All),
            // The frame after it is seen with all.
            false if budget.has_room(first) => (RETRY_CONFIDENCE, Networks::First),
            // The next step goes on with it.
            false => (f32::INFINITY, Networks::All),
        };
        let needed = Needed {
            to_iterate,
            to_refine: FIRST_ATTEMPT_CONFIDENCE,
        };
        let start = Start::at(step, &face, Origin::NewFace, needed);
        (start.map(|start| start.with(networks)), Stage::Scan)
    }
}

/// Work of a search around a place \[units\].
fn local_units(place: &Detection) -> u32 {
    match is_upright(place) {
        true => LOCAL_UNITS,
        false => TURNED_UNITS,
    }
}

/// The first attempt at a face that is expected.
fn first(step: &Step<'_>, face: &Detection, origin: Origin) -> Option<Start> {
    Start::at(step, face, origin, Needed::to_refine(ACCEPT_CONFIDENCE))
}

/// Where a step that coasts searches: around the target's last place or, by turns, by keyframes and
/// then in the whole frame at its size.
fn turn(last: &LastSeen, search: &mut Search) -> Stage {
    search.scanner.count_step();
    match search.scanner.is_one_in(LOCAL_SEARCH_PERIOD) {
        true => Stage::NearTarget(last.place),
        false => Stage::Keyframe(*last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_detector_looks_again_at_the_best_detection() {
        let seen = |score: f32| Seen {
            face: Detection {
                score,
                ..Detection::NONE
            },
            looks: 1,
        };
        let mut search = Search::EMPTY;
        for score in [1.0, 3.0, 2.0] {
            search.look_again_at(&seen(score));
        }
        assert_eq!(search.astray, seen(3.0));
        search.end();
        assert_eq!(search.astray, Seen::NONE);
    }
}
