//! One step: frame in, result out; and the state machine around it.
//!
//! Searching runs a slice of the detector's sweeps; a face found there is aligned and judged at
//! once. Tracking runs the cascade once from the shape that the last frames predict. A fit in more
//! doubt than the face may bear makes the tracker Coasting: the last answer is repeated, the detector
//! looks around it and elsewhere, and after `HOLD_US` the search starts anew. It starts at once where the
//! face never was sure, which is then spurned for a while.
//!
//! Keyframes are kept of sure frames while Tracking, at most one a step and none that brings nothing
//! new. With the step that loses the face and with each one after it one window of the frame is
//! compared with them, at the expense of the detector's slice; what is found goes the way of a
//! detection. They outlive a loss and a stranger, for the person may come back: a stranger's
//! keyframes take the places of those that were of use longest ago.

use core::mem::MaybeUninit;

use super::answer::write;
use super::config::{Config, ConfigError};
use super::motion::steadied;
use super::place::{overlaps, place_of, start_in};
use super::search::{Lost, Search, Slice};
use super::smooth::{Smoother, Smoothing};
use super::subject::{ACCEPT, STAY, Subject, TRUST, Whose};
use super::{Loss, Model, State, TrackResult};
use crate::align::{Shape, Workspace};
use crate::detect::{Detection, Sizes, local_search};
use crate::image::{Frame, noise_share};
#[cfg(feature = "keyframes")]
use crate::keyframe::{Keyframes, Observation, Query};
#[cfg(feature = "keyframes")]
use crate::math::HeadAngles;
use crate::shape::{FRAME_WEIGHT, FitOptions, Intrinsics, MAX_IDENTITIES, Observed, fit};
use crate::verifier::Confidence;
#[cfg(not(feature = "verifier"))]
use crate::verifier::geometric_confidence;

/// What the sweep meets becomes the tracked face from this probability on at first sight, from [`ACCEPT`]
/// on at second sight: of what looks like a face by chance hardly anything still does once the cascade has
/// gone on.
const AT_FIRST_SIGHT: f32 = 0.9;
/// Share of noise in a frame's luma from which it is box_filtered, and below which no longer.
const NOISY: f32 = 0.2;
const LESS_NOISY: f32 = 0.15;
/// How long the last answer is held \[µs\].
const HOLD_US: i64 = 500_000;
/// Work of one search around a lost face, in the detector's units.
const NEAR_BUDGET: u32 = 1500;

/// What aligning and judging a candidate costs, in the detector's units (measured with
/// `posewise bench`: align plus fit over detector slice).
const ACQUIRE_UNITS: u32 = 4500;
/// What a second look costs, likewise.
const SECOND_LOOK_UNITS: u32 = 2500;

/// What a look for keyframes costs, likewise.
const RECOLLECT_UNITS: u32 = 2200;

/// One look at a candidate.
struct Look {
    /// Passes of the cascade.
    iterations: usize,
    whose: Whose,
    /// Probability from which it is taken.
    least: f32,
}

impl Look {
    /// At what was looked at before, which needs a pass more.
    fn again(whose: Whose) -> Look {
        Look {
            iterations: 1,
            whose,
            least: ACCEPT,
        }
    }
}

/// What a look for keyframes ended with.
#[cfg_attr(not(feature = "keyframes"), allow(dead_code))]
enum Recollected {
    /// Nobody is there, or nobody that is known; what it cost to see that, in the detector's units.
    Nobody(u32),
    /// A face, which is tracked now.
    Found,
}

/// Why a frame was not taken; the tracker is then as before the call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepError {
    /// The timestamp is not after that of the frame before.
    Time,
}

impl core::fmt::Display for StepError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the timestamp is not after that of the frame before")
    }
}

impl core::error::Error for StepError {}

/// All state of one tracked face. Plain data: a copy of it goes on independently.
#[derive(Clone)]
pub struct Tracker {
    config: Config,
    result: TrackResult,
    smoother: Smoother,
    last_timestamp_us: Option<i64>,
    /// Whether the last frame was box_filtered.
    noisy: bool,
    search: Search,
    /// Counts looks for keyframes since a face was tracked.
    looks: u32,
    /// Meaningful unless Searching.
    subject: Subject,
    work: Workspace,
    #[cfg(feature = "keyframes")]
    keyframes: Keyframes,
}

impl Tracker {
    /// Has seen nothing. All zero bytes, so that building one in place is a memset and needs no
    /// copy on the stack.
    const EMPTY: Tracker = Tracker {
        config: Config {
            intrinsics: None,
            min_face_px: 0,
            scan_budget: 0,
            smoothing: Smoothing {
                cutoff_hz: 0.0,
                beta: 0.0,
            },
        },
        result: TrackResult::EMPTY,
        smoother: Smoother::EMPTY,
        last_timestamp_us: None,
        noisy: false,
        search: Search::EMPTY,
        looks: 0,
        subject: Subject::EMPTY,
        work: Workspace::new(),
        #[cfg(feature = "keyframes")]
        keyframes: Keyframes::EMPTY,
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

    /// One frame in, one answer out; bounded work. Timestamps \[µs\] of any monotonic clock must
    /// increase from step to step.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    pub fn step(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
    ) -> Result<&TrackResult, StepError> {
        self.tick(timestamp_us)?;
        let frame = &self.see(frame);
        match self.result.state {
            State::Tracking => match self.track(model, frame, timestamp_us) {
                None => self.remember(model, frame),
                Some(loss) => self.slip(model, frame, timestamp_us, loss),
            },
            State::Coasting => self.hold(model, frame, timestamp_us),
            State::Searching => self.search(model, frame, timestamp_us),
        }
        self.smoother.follow(&self.result, &self.config.smoothing);
        Ok(&self.result)
    }

    /// Starts from a face that the caller has found, as if the detector had: one step of
    /// [`Tracker::step`] without the search.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    #[cfg(feature = "unstable-internals")]
    pub fn step_at(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        face: &Detection,
    ) -> Result<&TrackResult, StepError> {
        self.tick(timestamp_us)?;
        let frame = &self.see(frame);
        if !self.acquire(model, frame, timestamp_us, face, Whose::Stranger, ACCEPT) {
            self.lose(timestamp_us);
        }
        self.smoother.follow(&self.result, &self.config.smoothing);
        Ok(&self.result)
    }

    /// The frame as it is looked at: box_filtered where there is much noise in it.
    fn see<'f>(&mut self, frame: &Frame<'f>) -> Frame<'f> {
        // What is just noisy enough is not to be seen now one way, now the other.
        let enough = if self.noisy { LESS_NOISY } else { NOISY };
        self.noisy = noise_share(frame) >= enough;
        match self.noisy {
            true => frame.box_filtered(),
            false => *frame,
        }
    }

    /// Moves the clock on; refuses to move it back.
    fn tick(&mut self, timestamp_us: i64) -> Result<(), StepError> {
        if self
            .last_timestamp_us
            .is_some_and(|last| timestamp_us <= last)
        {
            return Err(StepError::Time);
        }
        self.last_timestamp_us = Some(timestamp_us);
        Ok(())
    }

    /// The answer to the last step.
    pub fn result(&self) -> &TrackResult {
        &self.result
    }

    /// The answer to the last step, smoothed over time by a One-Euro filter: landmarks and points,
    /// pose, openness of the eyes and animation weights. The rest is as in
    /// [`Tracker::result`].
    pub fn smoothed(&self) -> &TrackResult {
        self.smoother.result()
    }

    /// The settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Forgets the face and the clock; settings stay.
    pub fn reset(&mut self) {
        self.result = TrackResult::default();
        self.smoother = Smoother::EMPTY;
        self.last_timestamp_us = None;
        self.noisy = false;
        self.search.reset();
        self.looks = 0;
        #[cfg(feature = "keyframes")]
        self.keyframes.clear();
    }

    /// Forgets whose face it is, as when somebody else takes the seat: the identity is learnt anew
    /// from the next trusted frames. The face goes on being tracked.
    pub fn forget_identity(&mut self) {
        self.subject.forget_identity();
        #[cfg(feature = "keyframes")]
        self.keyframes.clear();
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

    /// One slice of a sweep: over all sizes, or over those that are likeliest, which takes a few
    /// frames.
    fn search(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64) {
        self.search.next_turn();
        let likely = self.search.likely_sizes(&self.config, frame, now);
        let looked = self.search.recollects(&self.config, RECOLLECT_UNITS, now);
        let spent = match looked.then(|| self.recollect(model, frame, now, self.search.lost)) {
            Some(Recollected::Found) => return,
            Some(Recollected::Nobody(spent)) => spent,
            None => 0,
        };
        if !self.sweep(model, frame, now, likely, spent) {
            self.lose(now);
        }
    }

    /// Goes on with the sweep over the likely sizes, if any are given, and with that over all of them
    /// where work is left and no face is held, after `spent` units of this step's work were used; true
    /// when a face is found and taken.
    fn sweep(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        likely: Option<Sizes>,
        mut spent: u32,
    ) -> bool {
        let wide = self.result.state == State::Searching;
        let mut found = false;
        if self.search.is_in_doubt() && spent <= RECOLLECT_UNITS {
            found = self.second_look(model, frame, now);
            spent += SECOND_LOOK_UNITS;
        }
        let mut slice = Slice::new(&self.config, likely, wide, spent);
        while !found && let Some(face) = self.search.next(&model.detector, frame, &mut slice) {
            found = self.acquire(model, frame, now, &face, Whose::Stranger, AT_FIRST_SIGHT);
            slice.spend(ACQUIRE_UNITS);
        }
        // A still is not shown again.
        if !found && self.search.is_in_doubt() && slice.affords(SECOND_LOOK_UNITS) {
            found = self.second_look(model, frame, now);
        }
        if found {
            self.search.end();
        }
        found
    }

    /// Looks for the lost face, or another that was tracked before, by keyframes.
    #[cfg(feature = "keyframes")]
    #[inline(never)]
    fn recollect(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        lost: Lost,
    ) -> Recollected {
        if lost.size_px <= 0.0 || self.keyframes.is_empty() {
            return Recollected::Nobody(0);
        }
        let wanted = Query {
            size_px: lost.size_px,
            roll: lost.roll,
            attempt: self.looks,
        };
        self.looks = self.looks.wrapping_add(1);
        let Some(found) = self.keyframes.query(frame, &wanted, self.work.scratch()) else {
            return Recollected::Nobody(RECOLLECT_UNITS);
        };
        let mut shape = found.shape;
        let whose = match found.identity == self.keyframes.identity() {
            true => Whose::Lost,
            false => Whose::Stranger,
        };
        let look = Look::again(whose);
        if self.take(model, frame, now, &mut shape, &look).is_err() {
            return Recollected::Nobody(RECOLLECT_UNITS + SECOND_LOOK_UNITS);
        }
        self.keyframes.mark_used(&found);
        self.search.end();
        Recollected::Found
    }

    /// Builds without keyframes have none.
    #[cfg(not(feature = "keyframes"))]
    fn recollect(&mut self, _: &Model<'_>, _: &Frame<'_>, _: i64, _: Lost) -> Recollected {
        Recollected::Nobody(0)
    }

    /// Nor do they keep any.
    #[cfg(not(feature = "keyframes"))]
    fn remember(&mut self, _: &Model<'_>, _: &Frame<'_>) {}

    /// Keeps what is tracked as a keyframe, if it is sure and brings something new.
    #[cfg(feature = "keyframes")]
    #[inline(never)]
    fn remember(&mut self, model: &Model<'_>, frame: &Frame<'_>) {
        let result = &self.result;
        let angles = HeadAngles {
            yaw_deg: result.yaw_deg,
            pitch_deg: result.pitch_deg,
            roll_deg: result.roll_deg,
        };
        let quality = result.confidence * result.visible_share;
        if result.confidence < TRUST || self.keyframes.entry_for(&angles, quality).is_none() {
            return;
        }
        let seen = Observation {
            shape: &self.subject.shape,
            angles,
            size_px: place_of(model, &self.subject.shape).size,
            quality,
        };
        self.keyframes.add(frame, &seen, self.work.scratch());
    }

    /// Looks for a face that was lost a moment ago where it should be by now, and every other time
    /// anywhere: it may have jumped.
    fn hold(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64) {
        let around = place_of(model, &self.subject.shape);
        let jumped = Lost::at(&around, now);
        let spent = match self.recollect(model, frame, now, jumped) {
            Recollected::Found => return,
            Recollected::Nobody(spent) => spent,
        };
        self.search.next_turn();
        let found = if self.search.is_one_in(2) {
            local_search(
                &model.detector,
                frame,
                &around,
                NEAR_BUDGET.saturating_sub(spent).max(1),
            )
            .is_some_and(|face| self.acquire(model, frame, now, &face, Whose::Lost, ACCEPT))
        } else {
            self.sweep(model, frame, now, Some(jumped.sizes(&self.config)), spent)
        };
        if !found {
            self.keep_holding(model, now);
        }
    }

    fn keep_holding(&mut self, model: &Model<'_>, now: i64) {
        let age_us = now.saturating_sub(self.subject.fitted_us);
        if age_us > HOLD_US {
            self.search
                .begin(Lost::at(&place_of(model, &self.subject.shape), now));
            self.lose(now);
        } else {
            self.result.state = State::Coasting;
            self.result.timestamp_us = now;
            self.result.age_us = age_us;
        }
    }

    fn lose(&mut self, now: i64) {
        self.result = TrackResult {
            timestamp_us: now,
            loss: self.result.loss,
            ..TrackResult::EMPTY
        };
    }

    /// Aligns to a detection; true when it is a face, which it is from a probability of `least` on.
    #[inline(never)]
    fn acquire(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        face: &Detection,
        whose: Whose,
        least: f32,
    ) -> bool {
        let start = model.align.views().initial_shape(face.yaw);
        let Some(mut shape) = start.and_then(|start| start_in(&start, face)) else {
            return false;
        };
        let look = Look {
            iterations: model.align.iterations(),
            whose,
            least,
        };
        let taken = self.take(model, frame, now, &mut shape, &look);
        if let Err(face) = taken
            && face < least
        {
            self.search.refuse(face, self.work.global_shape());
        }
        taken.is_ok()
    }

    /// A second look, mostly on the next frame, at what might have become a face: from a poor start
    /// the cascade takes a pass more.
    #[inline(never)]
    fn second_look(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64) -> bool {
        let mut shape = self.search.take_doubtful();
        let look = Look::again(Whose::Stranger);
        self.take(model, frame, now, &mut shape, &look).is_ok()
    }

    /// Aligns, judges, and answers with what is a face.
    ///
    /// # Errors
    /// With nothing changed but the shape: the probability that it is a face, 0 when the shape lost
    /// its extent or lies where a face turned out to be none.
    fn take(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        shape: &mut Shape,
        look: &Look,
    ) -> Result<(), f32> {
        if !model
            .align
            .run(frame, look.iterations, shape, &mut self.work)
        {
            return Err(0.0);
        }
        let mut confidence = evaluated(model, &self.work);
        if confidence.face < TRUST && self.search.spurns(&place_of(model, shape), now) {
            return Err(0.0);
        }
        let taken = confidence.face >= look.least
            && self.answer(model, frame, now, shape, look.whose, &mut confidence);
        taken.then_some(()).ok_or(confidence.face)
    }

    /// Goes on with the face of the frame before; or says why it cannot, with nothing changed.
    #[inline(never)]
    fn track(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64) -> Option<Loss> {
        let subject = &self.subject;
        let elapsed_us = now.saturating_sub(subject.fitted_us);
        let predicted = subject.motion.predict(&subject.shape, elapsed_us);
        let mut shape = steadied(&subject.guess, &predicted);
        let guess = shape;
        let ran = model.align.run(frame, 1, &mut shape, &mut self.work);
        let mut confidence = evaluated(model, &self.work);
        let person = &mut self.subject.person;
        let trusted = confidence.face >= TRUST;
        let recognised = person.update(self.work.features(), trusted, &mut confidence);
        if !ran || confidence.face < self.subject.keep(recognised, now) {
            Some(Loss::LowConfidence)
        } else if !overlaps(&shape, frame) {
            Some(Loss::LeftFrame)
        } else if !self.answer(model, frame, now, &shape, Whose::Tracked, &mut confidence) {
            Some(Loss::NoPose)
        } else {
            self.subject.recognise(recognised, now);
            self.subject.guess = guess;
            self.looks = 0;
            None
        }
    }

    /// The face is not where it should be: it may have jumped, and on this very frame only keyframes
    /// can tell where to.
    fn slip(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64, loss: Loss) {
        let jumped = Lost::at(&place_of(model, &self.subject.shape), now);
        let found = match loss {
            Loss::LeftFrame => Recollected::Nobody(0),
            _ => self.recollect(model, frame, now, jumped),
        };
        if matches!(found, Recollected::Found) {
            return;
        }
        self.result.loss = loss;
        if self.subject.is_trusted() {
            self.keep_holding(model, now);
            return;
        }
        // What was never sure is not waited for: while it is held, nobody of another size is seen.
        if loss == Loss::LowConfidence {
            self.search.spurn(place_of(model, &self.subject.shape), now);
        }
        self.lose(now);
    }

    /// Fits the 3D face to a shape on this frame, moves the subject there and writes the result;
    /// false, with nothing changed, when no pose explains the landmarks.
    #[inline(never)]
    fn answer(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        shape: &Shape,
        whose: Whose,
        confidence: &mut Confidence,
    ) -> bool {
        let camera = match self.config.intrinsics {
            Some(camera) => camera,
            None => Intrinsics::of_frame(frame.width(), frame.height()),
        };
        // A landmark that is probably wrong, or a guess because it is hidden, still says a little.
        let mut weights = confidence.landmarks;
        for (weight, seen) in weights.iter_mut().zip(&confidence.visibility) {
            *weight = 0.05 + *weight * (0.2 + 0.8 * seen);
        }
        let observed = Observed {
            points: shape,
            weights: &weights,
        };
        let subject = &mut self.subject;
        // Of a covered face the fine stages see a hand in place of an eye, and move the eye anywhere:
        // the next frame must not start from there.
        let carried = match confidence.face >= STAY {
            true => shape,
            false => self.work.global_shape(),
        };
        let start = (whose == Whose::Tracked).then_some(&subject.face);
        let identity = match whose {
            Whose::Stranger => [0.0; MAX_IDENTITIES],
            Whose::Lost | Whose::Tracked => subject.face.identity,
        };
        let options = FitOptions::default();
        let fitted = fit(&model.face, &camera, &observed, start, &identity, &options);
        let Some(fitted) = &fitted else {
            return false;
        };
        // Without classifiers all was taken until here.
        #[cfg(not(feature = "verifier"))]
        geometric_confidence(confidence, fitted, &camera);
        let least = match whose {
            Whose::Tracked => subject.keep(0, now),
            _ => ACCEPT,
        };
        if cfg!(not(feature = "verifier")) && confidence.face < least {
            return false;
        }
        if whose == Whose::Stranger {
            subject.become_stranger();
            #[cfg(feature = "keyframes")]
            self.keyframes.new_identity();
        }
        subject.move_to(now, carried, fitted, confidence.face, whose);
        if subject.learns(confidence.face) {
            subject
                .identity
                .add(&model.face, &camera, &observed, fitted, FRAME_WEIGHT);
            subject.face.identity = subject.identity.estimate();
        }
        let seen_by = (&model.face, &camera);
        let blur_px = subject.motion.blur_px();
        write(
            &mut self.result,
            now,
            seen_by,
            shape,
            confidence,
            fitted,
            blur_px,
        );
        true
    }
}

/// Judges the cascade's last run.
fn evaluated(model: &Model<'_>, work: &Workspace) -> Confidence {
    model.verifier.evaluate(work.features(), work.view())
}
