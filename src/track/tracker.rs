//! The tracker: its API and its state machine.
//!
//! | state | what a step does | next state if no face is accepted |
//! |---|---|---|
//! | Searching | keyframes of a lost target, then the scan | Searching |
//! | Tracking | alignment at the predicted place; on loss keyframes | Coasting or Searching |
//! | Coasting | keyframes, then a local search or the scan | Coasting or Searching |
//!
//! If a face is accepted, the next state is Tracking. Coasting is for a target that was trusted,
//! until its last fit is `COAST_US` old.
//!
//! Every attempt at a face ends with an [`Outcome`]; [`Outcome::Accept`] has written the result.
//! All thresholds, timeouts and work costs are in `policy.rs`.
//!
//! The interface and the state machine stand together, which makes this file longer than others.
//!
//! Stack: functions of this module that are `#[inline(never)]` hold whole shapes or fits. Kept
//! apart, their frames are not on the stack at the same time.

use core::mem::MaybeUninit;

use super::alignment::{Alignment, Needed};
use super::event::{EventKind, EventLog};
use super::excluded::Excluded;
use super::geometry::{centre, detection_of, is_in_frame};
use super::hint::FaceHint;
use super::one_euro::Smoother;
use super::policy::{ACCEPT_CONFIDENCE, COAST_US, LOCAL_SEARCH_PERIOD, NO_LONGER_NOISY, NOISY};
use super::reacquirer::Reacquirer;
use super::rejected::{PendingRetry, Suppressed};
use super::scanner::{LastSeen, ScanPlan, Scanner};
use super::step::{Outcome, Step, WorkBudget, tile_memory};
use super::target::{Origin, Target};
use super::{Config, ConfigError, Loss, Model, Smoothing, State, StepError, TrackResult};
use crate::align::Workspace;
use crate::detect::{Detection, local_search};
use crate::image::{Frame, Roi, noise_share};
use crate::shape::Intrinsics;

/// All state of one tracked face. Plain data: a copy of it is an independent tracker.
#[derive(Clone)]
pub struct Tracker {
    pub(super) config: Config,
    pub(super) result: TrackResult,
    smoother: Smoother,
    pub(super) last_timestamp_us: Option<i64>,
    /// Whether the last frame was box-filtered.
    is_noisy: bool,
    pub(super) scanner: Scanner,
    pub(super) retry: PendingRetry,
    pub(super) suppressed: Suppressed,
    pub(super) reacquirer: Reacquirer,
    pub(super) excluded: Excluded,
    /// Meaningful unless Searching.
    pub(super) target: Target,
    /// The last alignment.
    pub(super) alignment: Alignment,
    pub(super) work: Workspace,
    pub(super) events: EventLog,
}

impl Tracker {
    /// Has seen nothing. All zero bytes, so that building one in place is a memset and needs no
    /// copy on the stack. So the camera is there: `None` is not zero in the compiler's layout. The
    /// settings are replaced at once.
    const EMPTY: Tracker = Tracker {
        config: Config {
            intrinsics: Some(Intrinsics::new(0.0, 0.0, 0.0, 0.0)),
            min_face_px: 0,
            scan_budget: 0,
            smoothing: Smoothing {
                cutoff_hz: 0.0,
                beta: 0.0,
            },
            roi: None,
            gaze: false,
            natural_gaze: false,
        },
        result: TrackResult::EMPTY,
        smoother: Smoother::EMPTY,
        last_timestamp_us: None,
        is_noisy: false,
        scanner: Scanner::EMPTY,
        retry: PendingRetry::NONE,
        suppressed: Suppressed::NONE,
        reacquirer: Reacquirer::EMPTY,
        excluded: Excluded::NONE,
        target: Target::EMPTY,
        alignment: Alignment::EMPTY,
        work: Workspace::new(),
        events: EventLog::EMPTY,
    };

    /// A tracker that has seen nothing.
    ///
    /// # Errors
    /// [`ConfigError`] names the setting that is out of range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Tracker {
            config: *config,
            ..Self::EMPTY
        })
    }

    /// As [`Tracker::new`], in place: for small stacks. On failure the slot is untouched.
    ///
    /// # Errors
    /// As [`Tracker::new`].
    pub fn init_in<'t>(
        slot: &'t mut MaybeUninit<Tracker>,
        config: &Config,
    ) -> Result<&'t mut Tracker, ConfigError> {
        config.check()?;
        let tracker = slot.write(Self::EMPTY);
        tracker.config = *config;
        Ok(tracker)
    }

    /// Takes one frame and returns its result. Work is bounded. Timestamps \[µs\] of any monotonic
    /// clock must increase from step to step.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    pub fn step(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
    ) -> Result<&TrackResult, StepError> {
        self.step_with(model, frame, timestamp_us, None)
    }

    /// As [`Tracker::step`], for a caller who expects a face somewhere: while searching, it is
    /// attempted there first, then at what the detector finds near it, then the search goes on. A
    /// face that is tracked, or was a moment ago, stays the target: call [`Tracker::reset`] first
    /// to change it.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    pub fn step_at(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        hint: &FaceHint,
    ) -> Result<&TrackResult, StepError> {
        let hint = hint.detection().ok_or(StepError::Hint)?;
        self.step_with(model, frame, timestamp_us, Some(&hint))
    }

    fn step_with(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        hint: Option<&Detection>,
    ) -> Result<&TrackResult, StepError> {
        self.check_roi(frame)?;
        self.advance_clock(timestamp_us)?;
        let step = &Step {
            model,
            frame: &self.filtered(frame),
            now_us: timestamp_us,
        };
        self.advance(step, hint);
        self.look(step);
        self.smoother.follow(&self.result, &self.config.smoothing);
        Ok(&self.result)
    }

    /// Attempts a face whose exact box is known, in whatever state the tracker is, and nothing
    /// else.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    #[cfg(feature = "unstable-internals")]
    pub fn fit_at(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        face: &Detection,
    ) -> Result<&TrackResult, StepError> {
        self.advance_clock(timestamp_us)?;
        let step = &Step {
            model,
            frame: &self.filtered(frame),
            now_us: timestamp_us,
        };
        let needed = Needed::to_refine(ACCEPT_CONFIDENCE);
        let outcome = self.attempt_detection(step, face, Origin::NewFace, needed);
        if !outcome.is_accept() {
            self.clear_result(timestamp_us);
        }
        self.look(step);
        self.smoother.follow(&self.result, &self.config.smoothing);
        Ok(&self.result)
    }

    /// The result of the last step.
    pub fn result(&self) -> &TrackResult {
        &self.result
    }

    /// The result of the last step with these fields smoothed over time by a One-Euro filter:
    /// landmarks and points, pose, openness of the eyes and animation weights. The rest is as in
    /// [`Tracker::result`].
    pub fn smoothed(&self) -> &TrackResult {
        self.smoother.result()
    }

    /// The settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Forgets the target, its identity and the clock; settings, excluded boxes and unread events
    /// stay.
    pub fn reset(&mut self) {
        self.record(EventKind::Reset);
        self.result = TrackResult::default();
        self.smoother = Smoother::EMPTY;
        self.last_timestamp_us = None;
        self.is_noisy = false;
        self.scanner.reset();
        self.retry.clear();
        self.suppressed = Suppressed::NONE;
        self.reacquirer.reset();
    }

    /// Forgets the identity, as when somebody else takes the seat: it is estimated anew from the
    /// next trusted frames. The face goes on being tracked.
    pub fn forget_identity(&mut self) {
        self.record(EventKind::Forgotten);
        self.target.forget_identity();
        self.reacquirer.forget();
    }

    /// Changes the camera from the next step on.
    ///
    /// # Errors
    /// [`ConfigError::Intrinsics`].
    pub fn set_intrinsics(&mut self, intrinsics: Option<Intrinsics>) -> Result<(), ConfigError> {
        let config = Config {
            intrinsics,
            ..self.config
        };
        config.check()?;
        self.config = config;
        Ok(())
    }

    /// Changes the region of interest from the next step on; see [`Config::roi`].
    ///
    /// # Errors
    /// [`ConfigError::Roi`].
    pub fn set_roi(&mut self, roi: Option<Roi>) -> Result<(), ConfigError> {
        if roi.is_some_and(|roi| !roi.is_valid()) {
            return Err(ConfigError::Roi);
        }
        self.config.roi = roi;
        Ok(())
    }

    /// From the next step on, this tracker neither finds nor follows the faces with these boxes
    /// (left, top, width, height \[px\]), which replace those given before: other trackers follow
    /// them. Its own face, when it is one of them, is lost with [`Loss::Excluded`].
    ///
    /// # Errors
    /// [`ConfigError::Excluded`]; nothing is changed.
    pub fn set_excluded(&mut self, boxes: &[[f32; 4]]) -> Result<(), ConfigError> {
        self.excluded = Excluded::new(boxes).ok_or(ConfigError::Excluded)?;
        Ok(())
    }

    // --- The state machine -----------------------------------------------------------------------

    /// One step of the state machine.
    fn advance(&mut self, step: &Step<'_>, hint: Option<&Detection>) {
        let state = self.result.state;
        let outcome = match state {
            State::Searching => self.search(step, hint),
            State::Tracking => self.track(step),
            State::Coasting => self.coast(step),
        };
        match (state, outcome) {
            (_, Outcome::Accept) => {}
            (State::Searching, _) => self.clear_result(step.now_us),
            (State::Tracking, Outcome::Reject(loss)) => self.on_loss(step, loss),
            (State::Tracking | State::Coasting, _) => self.coast_or_search(step),
        }
    }

    /// Searching: attempts the caller's hint, compares the keyframes of a lost target, then scans.
    fn search(&mut self, step: &Step<'_>, hint: Option<&Detection>) -> Outcome {
        if hint.is_some_and(|hint| self.attempt_hint(step, hint).is_accept()) {
            self.end_search();
            return Outcome::Accept;
        }
        self.scanner.count_step();
        let plan = self.scanner.plan(&self.config, step);
        let mut budget = WorkBudget::new(self.config.scan_budget);
        if self.scanner.is_keyframe_step(&self.config, step.now_us) {
            let last_seen = self.scanner.last_seen;
            if self.reacquire(step, &last_seen, &mut budget).is_accept() {
                return Outcome::Accept;
            }
        }
        self.scan(step, plan, &mut budget)
    }

    /// Tracking: aligns at the predicted place. A target that is not there may have jumped, and on
    /// this frame only keyframes can find it.
    fn track(&mut self, step: &Step<'_>) -> Outcome {
        let outcome = self.attempt_predicted(step);
        match outcome {
            Outcome::Accept => self.add_keyframe(step),
            Outcome::Reject(Loss::LeftFrame) => {}
            _ => {
                let place = detection_of(step.model, &self.target.shape);
                let last_seen = LastSeen::at(&place, step.now_us);
                let mut budget = WorkBudget::new(self.config.scan_budget);
                if self.reacquire(step, &last_seen, &mut budget).is_accept() {
                    return Outcome::Accept;
                }
            }
        }
        outcome
    }

    /// Coasting: compares keyframes, then searches around the last fit and, by turns, the whole
    /// frame at the target's size.
    fn coast(&mut self, step: &Step<'_>) -> Outcome {
        let place = detection_of(step.model, &self.target.shape);
        let last_seen = LastSeen::at(&place, step.now_us);
        let mut budget = WorkBudget::new(self.config.scan_budget);
        if self.reacquire(step, &last_seen, &mut budget).is_accept() {
            return Outcome::Accept;
        }
        self.scanner.count_step();
        if !self.scanner.is_one_in(LOCAL_SEARCH_PERIOD) {
            let plan = ScanPlan::expected(&last_seen, &self.config);
            return self.scan(step, plan, &mut budget);
        }
        let memory = &mut tile_memory(&mut self.work);
        match local_search(&step.model.detector, step.frame, &place, memory) {
            Some(face) => {
                let needed = Needed::to_refine(ACCEPT_CONFIDENCE);
                self.attempt_detection(step, &face, Origin::Reacquired, needed)
            }
            None => Outcome::NotFound,
        }
    }

    /// The target was lost on this frame and not reacquired.
    fn on_loss(&mut self, step: &Step<'_>, loss: Loss) {
        self.result.loss = loss;
        if self.target.is_trusted() {
            return self.coast_or_search(step);
        }
        // It was probably no face. Coasting would keep the scan from faces of other sizes.
        if loss == Loss::LowConfidence {
            let region = detection_of(step.model, &self.target.shape);
            self.suppressed = Suppressed::at(&region, step.now_us);
            self.record(EventKind::Suppressed);
        }
        self.record(EventKind::Lost);
        self.clear_result(step.now_us);
    }

    /// Repeats the last fit until it is too old, then starts the search.
    fn coast_or_search(&mut self, step: &Step<'_>) {
        let age_us = step.now_us.saturating_sub(self.target.fitted_us);
        if age_us <= COAST_US {
            if self.result.state != State::Coasting {
                self.record(EventKind::Coasting);
            }
            self.result.state = State::Coasting;
            self.result.timestamp_us = step.now_us;
            self.result.age_us = age_us;
        } else {
            let place = detection_of(step.model, &self.target.shape);
            self.scanner.expect(LastSeen::at(&place, step.now_us));
            self.record(EventKind::Lost);
            self.clear_result(step.now_us);
        }
    }

    // --- Parts of a step -------------------------------------------------------------------------

    /// Attempts a face that the caller expects: where it says, then where the detector finds one
    /// near there, because boxes of other detectors differ.
    #[inline(never)]
    fn attempt_hint(&mut self, step: &Step<'_>, hint: &Detection) -> Outcome {
        let needed = Needed::to_refine(ACCEPT_CONFIDENCE);
        let outcome = self.attempt_detection(step, hint, Origin::NewFace, needed);
        if outcome.is_accept() {
            return outcome;
        }
        let memory = &mut tile_memory(&mut self.work);
        match local_search(&step.model.detector, step.frame, hint, memory) {
            Some(face) => self.attempt_detection(step, &face, Origin::NewFace, needed),
            None => Outcome::NotFound,
        }
    }

    /// Attempts the target at its predicted place.
    #[inline(never)]
    fn attempt_predicted(&mut self, step: &Step<'_>) -> Outcome {
        if !self.align_target(step) {
            return Outcome::Reject(Loss::LowConfidence);
        }
        let alignment = &self.alignment;
        if self.excluded.contains(centre(&alignment.shape)) {
            return Outcome::Reject(Loss::Excluded);
        }
        let recognised = alignment.recognised;
        if !self.is_kept(step) {
            return Outcome::Reject(Loss::LowConfidence);
        }
        if !is_in_frame(&alignment.shape, step.frame) {
            return Outcome::Reject(Loss::LeftFrame);
        }
        let outcome = self.accept(step, Origin::Tracked);
        if outcome.is_accept() {
            self.target
                .tracked(&self.alignment.initial_shape, recognised, step.now_us);
            self.reacquirer.tracked();
        }
        outcome
    }

    pub(super) fn check_roi(&self, frame: &Frame<'_>) -> Result<(), StepError> {
        match self.config.roi {
            Some(roi) if !roi.is_in(frame) => Err(StepError::Roi),
            _ => Ok(()),
        }
    }

    /// The frame, box-filtered if it is noisy.
    fn filtered<'f>(&mut self, frame: &Frame<'f>) -> Frame<'f> {
        let threshold = match self.is_noisy {
            true => NO_LONGER_NOISY,
            false => NOISY,
        };
        let is_noisy = noise_share(frame) >= threshold;
        if is_noisy != self.is_noisy {
            self.is_noisy = is_noisy;
            self.record(match is_noisy {
                true => EventKind::FilterOn,
                false => EventKind::FilterOff,
            });
        }
        match is_noisy {
            true => frame.box_filtered(),
            false => *frame,
        }
    }

    fn advance_clock(&mut self, timestamp_us: i64) -> Result<(), StepError> {
        if self
            .last_timestamp_us
            .is_some_and(|last| timestamp_us <= last)
        {
            return Err(StepError::Time);
        }
        self.last_timestamp_us = Some(timestamp_us);
        Ok(())
    }

    /// Searching: nothing but the timestamp, and why the last target was lost.
    fn clear_result(&mut self, now_us: i64) {
        self.result = TrackResult {
            timestamp_us: now_us,
            loss: self.result.loss,
            ..TrackResult::EMPTY
        };
    }
}
