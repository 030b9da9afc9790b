//! One step: frame in, result out; and the state machine around it.
//!
//! Searching runs a slice of the detector's sweep; a face found there is aligned and judged at
//! once. Small faces take most of a sweep, so every other slice goes to one over large faces alone. A
//! face that was lost not long ago is mostly looked for at its own size, wherever it is.
//! Tracking runs the cascade once from the shape that the last frames predict. A fit whose
//! probability falls below `KEEP` (`STAY` where it was never sure, `KEEP_RECOGNISED` where what is seen
//! of it looks like itself) makes the tracker Holding: the last answer is repeated, the detector looks
//! around it and elsewhere, and after `HOLD_US` the search starts anew.
//!
//! Keyframes are kept of sure frames while Tracking, at most one a step and none that brings nothing
//! new. With the step that loses the face and with each one after it one window of the frame is
//! compared with them, at the expense of the detector's slice; what is found goes the way of a
//! detection. They outlive a loss and a stranger, for the person may come back: a stranger's
//! keyframes take the places of those that were of use longest ago.

use super::config::{Config, ConfigError};
use super::motion::{Motion, steadied};
use core::mem::MaybeUninit;

use super::answer::write;
use super::place::{overlaps, place_of, start_in};
use super::smooth::{Smoother, Smoothing};
use super::{Loss, Model, State, TrackResult};
use crate::align::{Shape, Workspace};
use crate::detect::{Detection, Scan, Sizes, Swept, search_near};
#[cfg(not(feature = "experts"))]
use crate::experts::by_fit;
use crate::experts::{Person, Verdict};
use crate::image::Frame;
#[cfg(feature = "keyframes")]
use crate::keyframe::{Keyframes, Seen, Wanted};
#[cfg(feature = "keyframes")]
use crate::math::HeadAngles;
use crate::shape::{
    FIRST, FRAME_WEIGHT, FaceState, FitOptions, IdentityEstimator, Intrinsics, LANDMARKS,
    MAX_IDENTITIES, Observed, fit,
};

/// A detection becomes a tracked face from this probability on.
const ACCEPT: f32 = 0.8;
/// A face that was never sure is given up below this probability: without a step between the two,
/// one at the edge would come and go. Below it the fine stages' answer leads nowhere.
const STAY: f32 = 0.5;
/// A candidate gets a second look from this probability on.
const DOUBT: f32 = 0.1;
/// A face that was sure once is given up below this probability: a fit that was right a frame ago
/// deserves more trust than one out of the blue.
const KEEP: f32 = 0.02;
/// … and below this one while so many of its landmarks look like themselves: something covers the
/// others.
const KEEP_RECOGNISED: f32 = 0.003;
const RECOGNISED: u32 = 8;
/// How long a face may be in doubt without being recognised \[µs\], longer than a blink: what is left
/// where somebody was may resemble a face a little for as long as it is looked at.
const DOUBTED_US: i64 = 250_000;
/// How long the last answer is held \[µs\].
const HOLD_US: i64 = 500_000;
/// How long a lost face is expected back at about the same size \[µs\].
const RECALL_US: i64 = 10_000_000;
/// Of so many slices of the search for it one goes to faces of all sizes.
const RECALL_TURNS: u32 = 4;
/// Of so many slices of any other search one goes to large faces.
const LARGE_TURNS: u32 = 2;
/// Large faces are at least this share of the frame's shorter side: who sits before a camera.
const LARGE: f32 = 0.25;
/// Only frames at least this sure teach who it is.
const TRUST: f32 = 0.9;
/// So many trusted frames teach it one by one.
const IDENTITY_FRAMES: u32 = 30;
/// Of the trusted frames after those, one in so many refines the identity.
const REFINED_EVERY: u32 = 4;
/// Work of one search around a lost face, in the detector's units.
const NEAR_BUDGET: u32 = 1500;

/// What aligning and judging a candidate costs, in the detector's units (measured with
/// `posewise bench`: align plus fit over detector slice).
const ACQUIRE_UNITS: u32 = 4500;
/// What a second look costs, likewise.
const SECOND_LOOK_UNITS: u32 = 2500;

/// What a look for keyframes costs, likewise.
const RECOLLECT_UNITS: u32 = 2200;

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

/// What is known of the tracked face. Edited in place: it takes much of a small stack.
#[derive(Clone)]
struct Subject {
    /// Where the next frame starts from.
    shape: Shape,
    /// Where the last frame's crop was placed.
    guess: Shape,
    motion: Motion,
    /// The 3D face of the last fit.
    face: FaceState,
    identity: IdentityEstimator,
    /// How the person's landmarks look.
    person: Person,
    /// Whether it was sure at least once since it was found: only then may it become as doubtful as
    /// a covered face is.
    trusted: bool,
    /// Frames that were sure since it was found.
    trusted_frames: u32,
    /// When it was last fitted \[µs\].
    fitted_us: i64,
    /// When it was last a face more likely than not, or recognised \[µs\].
    known_us: i64,
}

impl Subject {
    const EMPTY: Subject = Subject {
        shape: [[0.0; 2]; LANDMARKS],
        guess: [[0.0; 2]; LANDMARKS],
        motion: Motion::STILL,
        face: FaceState::EMPTY,
        // Renewed for every stranger; zero until then, as all of `Tracker::EMPTY`.
        identity: IdentityEstimator::with_memory(0.0),
        person: Person::NOBODY,
        trusted: false,
        trusted_frames: 0,
        fitted_us: 0,
        known_us: 0,
    };

    /// Probability below which the face counts as lost, when so many landmarks look like themselves.
    fn keep(&self, recognised: u32, now: i64) -> f32 {
        // Without `experts` and `adaptation` nobody is recognised, and a covered face would be given up too.
        let doubted = cfg!(all(feature = "experts", feature = "adaptation"))
            && now.saturating_sub(self.known_us) > DOUBTED_US;
        match self.trusted {
            true if recognised >= RECOGNISED => KEEP_RECOGNISED,
            true if !doubted => KEEP,
            _ => STAY,
        }
    }
}

/// A face that was there not long ago.
#[derive(Clone, Copy)]
struct Lost {
    /// As the detector has it; 0 for nobody.
    size_px: f32,
    /// In-plane rotation \[rad\].
    #[cfg_attr(not(feature = "keyframes"), allow(dead_code))]
    roll: f32,
    when_us: i64,
}

impl Lost {
    const NOBODY: Lost = Lost {
        size_px: 0.0,
        roll: 0.0,
        when_us: 0,
    };

    fn at(place: &Detection, when_us: i64) -> Lost {
        Lost {
            size_px: place.size,
            roll: place.roll,
            when_us,
        }
    }
}

/// Whose face a shape is, and what to fit the 3D face from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Whose {
    /// Nobody's that is known.
    Stranger,
    /// The subject's, lost for a while: the identity holds, the pose does not.
    Lost,
    /// The subject's, tracked from the frame before.
    Tracked,
}

/// All state of one tracked face. Plain data: a copy of it goes on independently.
#[derive(Clone)]
pub struct Tracker {
    config: Config,
    result: TrackResult,
    smoother: Smoother,
    last_timestamp_us: Option<i64>,
    scan: Scan,
    /// The sweep over the sizes that are likeliest.
    likely: Scan,
    lost: Lost,
    /// The likeliest of the last frame's candidates that were refused; 0 if there was none.
    doubt: f32,
    doubtful: Shape,
    /// Counts steps without a face.
    turn: u32,
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
        scan: Scan::new(),
        likely: Scan::new(),
        lost: Lost::NOBODY,
        doubt: 0.0,
        doubtful: [[0.0; 2]; LANDMARKS],
        turn: 0,
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
        match self.result.state {
            State::Tracking => match self.track(model, frame, timestamp_us) {
                None => self.remember(model, frame),
                Some(loss) => self.slip(model, frame, timestamp_us, loss),
            },
            State::Holding => self.hold(model, frame, timestamp_us),
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
    pub fn step_at(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        face: &Detection,
    ) -> Result<&TrackResult, StepError> {
        self.tick(timestamp_us)?;
        if !self.acquire(model, frame, timestamp_us, face, Whose::Stranger) {
            self.lose(timestamp_us);
        }
        self.smoother.follow(&self.result, &self.config.smoothing);
        Ok(&self.result)
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
        self.scan.restart();
        self.likely.restart();
        self.lost = Lost::NOBODY;
        self.doubt = 0.0;
        self.turn = 0;
        self.looks = 0;
        #[cfg(feature = "keyframes")]
        self.keyframes.forget();
    }

    /// Forgets whose face it is, as when somebody else takes the seat: the identity is learnt anew
    /// from the next trusted frames. The face goes on being tracked.
    pub fn forget_person(&mut self) {
        self.subject.identity = IdentityEstimator::new();
        self.subject.person = Person::NOBODY;
        self.subject.face.identity = [0.0; MAX_IDENTITIES];
        #[cfg(feature = "keyframes")]
        self.keyframes.forget();
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
        let age_us = now.saturating_sub(self.lost.when_us);
        self.turn = self.turn.wrapping_add(1);
        let recent = self.lost.size_px > 0.0 && age_us < RECALL_US;
        let likely = match recent {
            true => (!self.turn.is_multiple_of(RECALL_TURNS)).then(|| self.sizes_of(&self.lost)),
            // Not the first one: where it sees the whole frame, there is no need for it.
            false => (self.turn.is_multiple_of(LARGE_TURNS)).then(|| self.large_sizes(frame)),
        };
        // Rarely where the budget is so small that a look would be most of it.
        let rare = RECOLLECT_UNITS.div_ceil(self.config.scan_budget.max(1));
        let rare = rare.max(if recent { 1 } else { RECALL_TURNS });
        let looked = self.turn.is_multiple_of(rare);
        let spent = match looked.then(|| self.recollect(model, frame, now, self.lost)) {
            Some(Recollected::Found) => return,
            Some(Recollected::Nobody(spent)) => spent,
            None => 0,
        };
        if !self.sweep(model, frame, now, likely, spent) {
            self.lose(now);
        }
    }

    fn all_sizes(&self) -> Sizes {
        Sizes::from(self.config.min_face_px as i32)
    }

    /// About as large as a face was when it was lost.
    fn sizes_of(&self, lost: &Lost) -> Sizes {
        Sizes {
            min_px: ((lost.size_px * 0.8) as i32).max(self.all_sizes().min_px),
            max_px: (lost.size_px * 1.25) as i32,
        }
    }

    fn large_sizes(&self, frame: &Frame<'_>) -> Sizes {
        let large = LARGE * frame.width().min(frame.height()) as f32;
        Sizes::from((large as i32).max(self.all_sizes().min_px))
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
        spent: u32,
    ) -> bool {
        let all = self.all_sizes();
        // While a face is held nobody of another size takes its place.
        let searching = self.result.state == State::Searching;
        let mut likely = likely.filter(|sizes| *sizes != all);
        let mut budget = self.config.scan_budget.saturating_sub(spent).max(1);
        let mut found = false;
        if self.doubt >= DOUBT && spent <= RECOLLECT_UNITS {
            found = self.second_look(model, frame, now);
            budget = budget.saturating_sub(SECOND_LOOK_UNITS).max(1);
        }
        while budget > 0 && !found {
            let (scan, sizes) = match likely {
                Some(sizes) => (&mut self.likely, sizes),
                None => (&mut self.scan, all),
            };
            let swept = scan.advance(&model.detector, frame, sizes, budget);
            budget = scan.left();
            match swept {
                Swept::Found(face) => {
                    budget = budget.saturating_sub(ACQUIRE_UNITS);
                    found = self.acquire(model, frame, now, &face, Whose::Stranger);
                }
                Swept::Nothing if likely.is_some() && searching => likely = None,
                Swept::Nothing | Swept::Unfinished => break,
            }
        }
        if found {
            self.found();
        }
        found
    }

    /// Nobody is looked for any more.
    fn found(&mut self) {
        self.scan.restart();
        self.likely.restart();
        self.lost = Lost::NOBODY;
        self.doubt = 0.0;
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
        let wanted = Wanted {
            size_px: lost.size_px,
            roll: lost.roll,
            turn: self.looks,
        };
        self.looks = self.looks.wrapping_add(1);
        let Some(found) = self.keyframes.find(frame, &wanted, self.work.scratch()) else {
            return Recollected::Nobody(RECOLLECT_UNITS);
        };
        let mut shape = found.shape;
        let whose = match found.person == self.keyframes.person() {
            true => Whose::Lost,
            false => Whose::Stranger,
        };
        let taken = self.take(model, frame, now, 1, &mut shape, whose);
        if taken.is_err() {
            return Recollected::Nobody(RECOLLECT_UNITS + SECOND_LOOK_UNITS);
        }
        self.keyframes.take(&found);
        self.found();
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
        let quality = result.score * result.seen_share;
        if result.score < TRUST || self.keyframes.place(&angles, quality).is_none() {
            return;
        }
        let seen = Seen {
            shape: &self.subject.shape,
            angles,
            size_px: place_of(model, &self.subject.shape).size,
            quality,
        };
        self.keyframes.learn(frame, &seen, self.work.scratch());
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
        self.turn = self.turn.wrapping_add(1);
        let found = if self.turn.is_multiple_of(2) {
            search_near(
                &model.detector,
                frame,
                &around,
                NEAR_BUDGET.saturating_sub(spent).max(1),
            )
            .is_some_and(|face| self.acquire(model, frame, now, &face, Whose::Lost))
        } else {
            self.sweep(model, frame, now, Some(self.sizes_of(&jumped)), spent)
        };
        if !found {
            self.keep_holding(model, now);
        }
    }

    fn keep_holding(&mut self, model: &Model<'_>, now: i64) {
        let age_us = now.saturating_sub(self.subject.fitted_us);
        if age_us > HOLD_US {
            self.scan.restart();
            self.lost = Lost::at(&place_of(model, &self.subject.shape), now);
            self.lose(now);
        } else {
            self.result.state = State::Holding;
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

    /// Aligns to a detection; true when it is a face.
    #[inline(never)]
    fn acquire(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        face: &Detection,
        whose: Whose,
    ) -> bool {
        let start = model.align.views().start(face.turn);
        let Some(mut shape) = start.and_then(|start| start_in(&start, face)) else {
            return false;
        };
        let passes = model.align.passes();
        let taken = self.take(model, frame, now, passes, &mut shape, whose);
        if let Err(face) = taken
            && face < ACCEPT
            && face > self.doubt
        {
            (self.doubt, self.doubtful) = (face, *self.work.coarse());
        }
        taken.is_ok()
    }

    /// A second look, on the next frame, at what might have become a face: from a poor start the
    /// cascade takes a pass more.
    #[inline(never)]
    fn second_look(&mut self, model: &Model<'_>, frame: &Frame<'_>, now: i64) -> bool {
        let mut shape = self.doubtful;
        self.doubt = 0.0;
        self.take(model, frame, now, 1, &mut shape, Whose::Stranger)
            .is_ok()
    }

    /// Aligns, judges, and answers with what is a face.
    ///
    /// # Errors
    /// With nothing changed but the shape: the probability that it is a face, 0 when the shape lost
    /// its extent.
    fn take(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        now: i64,
        passes: usize,
        shape: &mut Shape,
        whose: Whose,
    ) -> Result<(), f32> {
        if !model.align.run(frame, passes, shape, &mut self.work) {
            return Err(0.0);
        }
        let mut verdict = judged(model, &self.work);
        let taken =
            verdict.face >= ACCEPT && self.answer(model, frame, now, shape, whose, &mut verdict);
        taken.then_some(()).ok_or(verdict.face)
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
        let mut verdict = judged(model, &self.work);
        let person = &mut self.subject.person;
        let trusted = verdict.face >= TRUST;
        let recognised = person.follow(self.work.features(), trusted, &mut verdict);
        if !ran || verdict.face < self.subject.keep(recognised, now) {
            Some(Loss::Doubt)
        } else if !overlaps(&shape, frame) {
            Some(Loss::Left)
        } else if !self.answer(model, frame, now, &shape, Whose::Tracked, &mut verdict) {
            Some(Loss::Pose)
        } else {
            if recognised >= RECOGNISED {
                self.subject.known_us = now;
            }
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
            Loss::Left => Recollected::Nobody(0),
            _ => self.recollect(model, frame, now, jumped),
        };
        if !matches!(found, Recollected::Found) {
            self.result.loss = loss;
            self.keep_holding(model, now);
        }
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
        verdict: &mut Verdict,
    ) -> bool {
        let camera = match self.config.intrinsics {
            Some(camera) => camera,
            None => Intrinsics::of_frame(frame.width(), frame.height()),
        };
        // A landmark that is probably wrong, or a guess because it is hidden, still says a little.
        let mut weights = verdict.landmarks;
        for (weight, seen) in weights.iter_mut().zip(&verdict.seen) {
            *weight = 0.05 + *weight * (0.2 + 0.8 * seen);
        }
        weights.iter_mut().take(FIRST).for_each(|w| *w = 0.0);
        let observed = Observed {
            points: shape,
            weights: &weights,
        };
        let subject = &mut self.subject;
        // Of a covered face the fine stages see a hand in place of an eye, and move the eye anywhere:
        // the next frame must not start from there.
        let carried = match verdict.face >= STAY {
            true => shape,
            false => self.work.coarse(),
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
        #[cfg(not(feature = "experts"))]
        by_fit(verdict, fitted, &camera);
        let least = match whose {
            Whose::Tracked => subject.keep(0, now),
            _ => ACCEPT,
        };
        if cfg!(not(feature = "experts")) && verdict.face < least {
            return false;
        }
        if whose == Whose::Stranger {
            subject.identity = IdentityEstimator::new();
            subject.person = Person::NOBODY;
            subject.trusted_frames = 0;
            #[cfg(feature = "keyframes")]
            self.keyframes.stranger();
        }
        subject.motion = match whose {
            Whose::Tracked => {
                let elapsed_us = now.saturating_sub(subject.fitted_us);
                Motion::between(&subject.shape, carried, elapsed_us)
            }
            Whose::Stranger | Whose::Lost => Motion::STILL,
        };
        if whose != Whose::Tracked {
            // From here on the crop moves as little as it can.
            subject.guess = *carried;
        }
        subject.shape = *carried;
        subject.fitted_us = now;
        if verdict.face >= STAY {
            subject.known_us = now;
        }
        subject.face = fitted.state;
        subject.trusted = verdict.face >= TRUST || subject.trusted && whose != Whose::Stranger;
        subject.trusted_frames = subject
            .trusted_frames
            .wrapping_add(u32::from(verdict.face >= TRUST));
        let learns = subject.identity.frames() < IDENTITY_FRAMES
            || subject.trusted_frames.is_multiple_of(REFINED_EVERY);
        if verdict.face >= TRUST && learns {
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
            verdict,
            fitted,
            blur_px,
        );
        true
    }
}

/// Judges the cascade's last run.
fn judged(model: &Model<'_>, work: &Workspace) -> Verdict {
    model.verifier.judge(work.features(), work.view())
}

#[cfg(all(test, feature = "experts", feature = "adaptation"))]
mod tests {
    use super::*;

    #[test]
    fn a_doubted_face_is_kept_for_a_while_and_longer_where_it_is_recognised() {
        let stranger = Subject {
            known_us: 1_000_000,
            ..Subject::EMPTY
        };
        let subject = Subject {
            trusted: true,
            ..stranger.clone()
        };
        let (soon, late) = (1_000_000 + DOUBTED_US, 1_000_001 + DOUBTED_US);
        assert_eq!(stranger.keep(0, soon), STAY);
        assert_eq!(subject.keep(0, soon), KEEP);
        assert_eq!(subject.keep(0, late), STAY);
        assert_eq!(subject.keep(RECOGNISED - 1, late), STAY);
        assert_eq!(subject.keep(RECOGNISED, late), KEEP_RECOGNISED);
    }
}
