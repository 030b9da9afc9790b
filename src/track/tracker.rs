//! The tracker: its API and its state machine.
//!
//! | state | what a step does | next state if no face is accepted |
//! |---|---|---|
//! | Searching | keyframes of a lost target, then the scan | Searching |
//! | Tracking | sees the predicted place; on loss keyframes | Coasting or Searching |
//! | Coasting | by turns a local search, and keyframes with the scan | Coasting or Searching |
//!
//! If a face is accepted, the next state is Tracking. Coasting is for a target that was trusted,
//! until its last fit is `COAST_US` old.
//!
//! [`Tracker::step`] is the walk of a frame. The target is followed: seen at its predicted place,
//! verified. Where that fails, or there is none, candidates are searched for: each is proposed,
//! seen, verified. What passes is refined, and accepted if a 3D face fits: it becomes target,
//! keyframe and result. A step counts its work, and begins nothing for which it has no room. Values
//! go from room to room as arguments and come back as results; state and loss are those of the last
//! result.
//!
//! All thresholds, timeouts and work costs are in `policy.rs`.
//!
//! The interface and the walk stand together, which makes this file longer than others.
//!
//! Stack: functions that are `#[inline(never)]` hold whole shapes or fits. Kept apart, their frames
//! are not on the stack at the same time.

use core::fmt;
use core::mem::MaybeUninit;

use super::align::{Aligned, Candidate, Origin, Start};
use super::eyes::{Eyes, see};
use super::fit::{Fitted, fit_face};
use super::follow::{Target, see_target, verify_target};
#[cfg(feature = "mesh")]
use super::mesh::{self, MeshError, MeshShape, MeshSpace};
use super::output::{Event, EventKind, EventLog, Smoother, write};
use super::policy::{COAST_US, FOUND_UNITS, NO_LONGER_NOISY, NOISE_PERIOD, NOISY, REFINE_UNITS};
use super::search::{Detected, Excluded, FaceHint, FoundFace};
use super::search::{Proposals, Search, Suppressed, Wanted, list};
use super::step::{SharedFrame, Step};
use super::verify::{Verdict, verify};
use super::weights;
use super::{Config, ConfigError, Loss, Model, Smoothing, State, StepError, TrackResult};
use crate::align::{Networks, Workspace};
use crate::detect::Scan;
use crate::image::{Frame, Roi};
use crate::record::RecordError;
#[cfg(feature = "mesh")]
use crate::shape::MeshVertex;
use crate::shape::{FaceState, Guess, IDENTITY_RECORD_BYTES, Intrinsics, Likeness};

/// All state of one tracked face. Plain data: a copy of it is an independent tracker.
#[derive(Clone)]
pub struct Tracker {
    config: Config,
    result: TrackResult,
    smoother: Smoother,
    last_timestamp_us: Option<i64>,
    /// Whether the last frame was box-filtered.
    is_noisy: bool,
    /// Steps so far; from the largest number on it counts anew.
    steps: u8,
    /// Steps since all networks saw the target.
    rested: u8,
    search: Search,
    suppressed: Suppressed,
    excluded: Excluded,
    /// Meaningful unless Searching.
    target: Target,
    work: Workspace,
    events: EventLog,
    /// Work of the last step \[units\].
    units: u32,
}

/// What became of the target on a frame.
struct Followed {
    is_found: bool,
    /// Why it is lost, if it is.
    loss: Option<Loss>,
    /// What that has cost \[units\].
    units: u32,
}

impl Followed {
    /// There is nothing to follow.
    const NOT: Followed = Followed {
        is_found: false,
        loss: None,
        units: 0,
    };
}

/// Settings and result; the rest is more than anybody reads.
impl fmt::Debug for Tracker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tracker")
            .field("config", &self.config)
            .field("result", &self.result)
            .finish_non_exhaustive()
    }
}

impl Tracker {
    /// All zero bytes, so that building one in place is a memset and needs no copy on the stack. So
    /// the camera is there: `None` is not zero in the compiler's layout. [`Tracker::begin`] makes a
    /// tracker of it that has seen nothing.
    const ZERO: Tracker = Tracker {
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
            network_period: 0,
        },
        result: TrackResult::ZERO,
        smoother: Smoother::ZERO,
        last_timestamp_us: None,
        is_noisy: false,
        steps: 0,
        rested: 0,
        search: Search::EMPTY,
        suppressed: Suppressed::NONE,
        excluded: Excluded::NONE,
        target: Target::EMPTY,
        work: Workspace::new(),
        events: EventLog::EMPTY,
        units: 0,
    };

    /// A tracker that has seen nothing.
    ///
    /// # Errors
    /// [`ConfigError`] names the setting that is out of range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        let mut tracker = Self::ZERO;
        tracker.begin(config);
        Ok(tracker)
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
        let tracker = slot.write(Self::ZERO);
        tracker.begin(config);
        Ok(tracker)
    }

    /// What is not zero of a tracker that has seen nothing.
    fn begin(&mut self, config: &Config) {
        self.config = *config;
        self.result.eyes = Eyes::EMPTY;
        self.smoother.follow(&self.result, &config.smoothing);
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
        self.step_with(model, frame, timestamp_us, &Wanted::Any)
    }

    /// As [`Tracker::step`], for a caller who expects a face somewhere: while searching, it is
    /// attempted there first, then at what the detector finds near it, then the search goes on; one
    /// step in four only searches. A face that is tracked, or was a moment ago, stays the target:
    /// call [`Tracker::reset`] first to change it.
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
        self.step_with(model, frame, timestamp_us, &Wanted::Near(hint))
    }

    /// As [`Tracker::step`], of a tracker in a group whose turn it is not: see
    /// [`crate::align::Networks::Few`].
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    #[cfg(feature = "unstable-internals")]
    pub fn step_with_few(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
    ) -> Result<&TrackResult, StepError> {
        self.check(frame, timestamp_us)?;
        let shared = &mut SharedFrame::new(frame);
        Ok(self.step_shared(model, shared, timestamp_us, &Wanted::Any, Networks::Few))
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
        face: &crate::detect::Detection,
    ) -> Result<&TrackResult, StepError> {
        self.step_with(model, frame, timestamp_us, &Wanted::At(*face))
    }

    /// As [`Tracker::fit_at`], of the face that is tracked, which has jumped there: what is known
    /// of the person stays.
    ///
    /// # Errors
    /// [`StepError`]; the tracker is then unchanged.
    #[cfg(feature = "unstable-internals")]
    pub fn fit_again_at(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        face: &crate::detect::Detection,
    ) -> Result<&TrackResult, StepError> {
        self.step_with(model, frame, timestamp_us, &Wanted::Again(*face))
    }

    /// What the last fit has given the network of weights.
    #[cfg(feature = "unstable-internals")]
    pub fn weight_inputs(&mut self) -> &crate::align::Inputs {
        self.work.seen().inputs()
    }

    /// Looks for faces and writes them to `found`, the largest first. The tracker's own face stays
    /// as it is, and no timestamp is needed.
    ///
    /// A call does the work of [`Config::scan_budget`] and at most one alignment more, and ends
    /// early when `found` is full. The next call, on the same frame or the next one of a video,
    /// goes on from there, until [`Detected::finished`]; the one after that begins anew. With an
    /// empty `found` a call searches nothing, so it never finishes. A face is reported once or more
    /// in a whole scan, and once at most in a call. Only faces in the region of interest, and none
    /// that is excluded, are reported.
    ///
    /// The scan is that of the search: a step that searches goes on with it, and restarts it when
    /// it finds a face.
    ///
    /// # Errors
    /// [`StepError::Roi`].
    pub fn detect(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        found: &mut [FoundFace],
    ) -> Result<Detected, StepError> {
        self.check_roi(frame)?;
        Ok(self.list(model, &mut SharedFrame::new(frame), None, found))
    }

    /// Work of the last step, in units of which a tracking step has 2,600.
    #[cfg(feature = "unstable-internals")]
    pub fn units(&self) -> u32 {
        self.units
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

    /// Writes the vertices of the dense mesh of the face of the last step, while it coasts those of
    /// its last fit; returns their number, [`MeshTopology::vertices`](crate::mesh::MeshTopology).
    /// `model` is that of the step. The vertices follow the picture: near landmarks that were seen
    /// they lie where these do. Of what is smoothed ([`Tracker::smoothed`]) they take nothing.
    ///
    /// ```
    /// use posewise::mesh::{MAX_VERTICES, MeshSpace, MeshVertex};
    /// # use posewise::{Config, Model, Tracker};
    /// # let model = Model::load(posewise::DEFAULT_MODEL).unwrap();
    /// # let tracker = Box::new(Tracker::new(&Config::default()).unwrap());
    /// let mut vertices = [MeshVertex::default(); MAX_VERTICES];
    /// match tracker.mesh(&model, MeshSpace::Picture, &mut vertices) {
    ///     Ok(count) => println!("{:?}", &vertices[..count]),
    ///     Err(why) => println!("{why}"),
    /// }
    /// ```
    ///
    /// # Errors
    /// [`MeshError`]; nothing is written.
    #[cfg(feature = "mesh")]
    pub fn mesh(
        &self,
        model: &Model<'_>,
        space: MeshSpace,
        out: &mut [MeshVertex],
    ) -> Result<usize, MeshError> {
        let Target { face, camera, .. } = &self.target;
        mesh::write(model, &self.result, face, camera, space, out)
    }

    /// How many vertices [`Tracker::mesh`] would write.
    #[cfg(all(feature = "mesh", feature = "ffi"))]
    pub(crate) fn mesh_vertices(&self, model: &Model<'_>) -> Result<usize, MeshError> {
        mesh::open(model, &self.result).map(|mesh| mesh.topology.vertices)
    }

    /// Writes the vertices of a shape of the person's own head, head frame \[mm\], visibility 1;
    /// returns their number, as [`Tracker::mesh`]. The identity is that of the last fit, so it
    /// outlives the loss of the face; it gets better while the face is tracked, and another face
    /// has its own. Until the first trusted frame of a face, and after
    /// [`Tracker::forget_identity`], it is the mean head. Pose, picture and landmarks play no part.
    ///
    /// A face with weights `w` is `neutral + Σ w[i]·(shape[i] − neutral)`: morph targets of a file.
    ///
    /// ```
    /// use posewise::ANIMATIONS;
    /// use posewise::mesh::{MAX_VERTICES, MeshShape, MeshVertex};
    /// # use posewise::{Config, Model, Tracker};
    /// # let model = Model::load(posewise::DEFAULT_MODEL).unwrap();
    /// # let tracker = Box::new(Tracker::new(&Config::default()).unwrap());
    /// let mut vertices = [MeshVertex::default(); MAX_VERTICES];
    /// let shapes = [MeshShape::Neutral].into_iter();
    /// for shape in shapes.chain((0..ANIMATIONS).map(MeshShape::Animation)) {
    ///     match tracker.mesh_shape(&model, shape, &mut vertices) {
    ///         Ok(count) => println!("{shape:?} {:?}", &vertices[..count]),
    ///         Err(why) => println!("{why}"),
    ///     }
    /// }
    /// ```
    ///
    /// # Errors
    /// [`MeshError`]; nothing is written. [`MeshError::NoFace`] if no face was fitted since the
    /// tracker began or was [reset](Tracker::reset).
    #[cfg(feature = "mesh")]
    pub fn mesh_shape(
        &self,
        model: &Model<'_>,
        shape: MeshShape,
        out: &mut [MeshVertex],
    ) -> Result<usize, MeshError> {
        mesh::write_shape(model, &self.target.face, shape, out)
    }

    /// How many vertices [`Tracker::mesh_shape`] would write.
    #[cfg(all(feature = "mesh", feature = "ffi"))]
    pub(crate) fn mesh_shape_vertices(&self, model: &Model<'_>) -> Result<usize, MeshError> {
        mesh::open_shape(model, &self.target.face).map(|mesh| mesh.topology.vertices)
    }

    /// The events that were not read yet. They outlive [`Tracker::reset`].
    ///
    /// ```
    /// # use posewise::{Config, Tracker};
    /// # let mut tracker = Box::new(Tracker::new(&Config::default()).unwrap());
    /// while let Some(event) = tracker.events().pop() {
    ///     println!("{} us: {}, {:?}", event.timestamp_us, event.kind.name(), event.loss);
    /// }
    /// let missed = tracker.events().take_overwritten();
    /// # assert_eq!(missed, 0);
    /// ```
    pub fn events(&mut self) -> &mut EventLog {
        &mut self.events
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
        self.target.face = FaceState::EMPTY;
        self.target.forget_guess();
        self.smoother = Smoother::EMPTY;
        self.last_timestamp_us = None;
        self.is_noisy = false;
        self.search.reset();
        self.suppressed = Suppressed::NONE;
    }

    /// Forgets the identity, as when somebody else takes the seat: it is estimated anew from the
    /// next trusted frames. The face goes on being tracked.
    pub fn forget_identity(&mut self) {
        self.record(EventKind::Forgotten);
        self.target.forget_identity();
        self.search.keyframes.forget();
    }

    /// What was learnt of the person's head, for [`Tracker::restore_identity`] when the person is
    /// back: a record with version and checksum. `None` before the first trusted frame of a face.
    pub fn save_identity(&self, model: &Model<'_>) -> Option<[u8; IDENTITY_RECORD_BYTES]> {
        let learnt = self.target.learnt()?;
        Some(learnt.to_bytes(&model.face))
    }

    /// Guesses that the tracked face, and every new one until [`Tracker::forget_identity`] or
    /// [`Tracker::reset`], is that of a record: its head is there from the first frame on. What is
    /// seen replaces the guess: of the record of another person less than a tenth is left after 200
    /// trusted frames.
    ///
    /// # Errors
    /// [`RecordError`]; the tracker is then unchanged.
    pub fn restore_identity(
        &mut self,
        model: &Model<'_>,
        record: &[u8],
    ) -> Result<(), RecordError> {
        let guess = Guess::from_bytes(record, &model.face)?;
        self.target.guess(&guess);
        Ok(())
    }

    /// Whether the head that was tracked last has the shape of that of a record, by what was seen
    /// of it: a guess of [`Tracker::restore_identity`] plays no part. It is no identification: two
    /// people may have heads of one shape. docs/driver-monitor.md says how often it is wrong.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn compare_identity(
        &self,
        model: &Model<'_>,
        record: &[u8],
    ) -> Result<Likeness, RecordError> {
        let guess = Guess::from_bytes(record, &model.face)?;
        Ok(self.target.likeness(&guess))
    }

    /// What [`Tracker::compare_identity`] decides by.
    ///
    /// # Errors
    /// [`RecordError`].
    #[cfg(feature = "unstable-internals")]
    pub fn identity_evidence(&self, model: &Model<'_>, record: &[u8]) -> Result<f32, RecordError> {
        let guess = Guess::from_bytes(record, &model.face)?;
        Ok(self.target.evidence(&guess))
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

    /// As [`Tracker::set_excluded`], of boxes of tracked faces.
    pub(super) fn leave(&mut self, boxes: &[[f32; 4]]) {
        self.excluded = Excluded::new(boxes).unwrap_or(Excluded::NONE);
    }

    // --- The walk of a frame ---------------------------------------------------------------------

    fn step_with(
        &mut self,
        model: &Model<'_>,
        frame: &Frame<'_>,
        timestamp_us: i64,
        wanted: &Wanted,
    ) -> Result<&TrackResult, StepError> {
        self.check(frame, timestamp_us)?;
        let shared = &mut SharedFrame::new(frame);
        Ok(self.step_shared(model, shared, timestamp_us, wanted, Networks::All))
    }

    /// Whether a step may begin.
    pub(super) fn check(&self, frame: &Frame<'_>, timestamp_us: i64) -> Result<(), StepError> {
        self.check_roi(frame)?;
        let is_after = |last| timestamp_us > last;
        match self.last_timestamp_us.is_none_or(is_after) {
            true => Ok(()),
            false => Err(StepError::Time),
        }
    }

    /// A step that [`Tracker::check`] allows.
    #[inline(never)]
    pub(super) fn step_shared(
        &mut self,
        model: &Model<'_>,
        shared: &mut SharedFrame<'_>,
        timestamp_us: i64,
        wanted: &Wanted,
        networks: Networks,
    ) -> &TrackResult {
        self.last_timestamp_us = Some(timestamp_us);
        let frame = &self.filtered(shared);
        let networks = self.in_turn(networks);
        let step = &Step::new(model, frame, timestamp_us, &self.config).with(networks);
        let followed = match (self.result.state, wanted) {
            (State::Tracking, Wanted::Any | Wanted::Near(_)) => self.follow(step),
            _ => Followed::NOT,
        };
        self.units = followed.units;
        if !followed.is_found {
            // A target that left the frame is in no other place. Another one may have jumped.
            let may_be_elsewhere = followed.loss != Some(Loss::LeftFrame);
            if !(may_be_elsewhere && self.search(step, wanted)) {
                self.find_nothing(step, wanted, followed.loss);
            }
        }
        self.smoother.follow(&self.result, &self.config.smoothing);
        &self.result
    }

    /// Steps since all networks saw the target.
    pub(super) fn rested(&self) -> u8 {
        self.rested
    }

    /// All networks only where it is time for them, by the settings.
    fn in_turn(&mut self, networks: Networks) -> Networks {
        let is_time = u32::from(self.rested) + 1 >= self.config.network_period;
        let networks = match is_time {
            true => networks,
            false => Networks::Few,
        };
        self.rested = match networks {
            Networks::All => 0,
            Networks::First | Networks::Few => self.rested.saturating_add(1),
        };
        networks
    }

    /// A step of a tracker without a face for which others of its group search: its clock goes on.
    pub(super) fn wait(&mut self, timestamp_us: i64) {
        self.last_timestamp_us = Some(timestamp_us);
        self.units = 0;
        self.clear_result(timestamp_us);
        self.smoother.follow(&self.result, &self.config.smoothing);
    }

    /// Lists faces as [`Tracker::detect`], in this scan; without one, in that of the search.
    #[inline(never)]
    pub(super) fn list(
        &mut self,
        model: &Model<'_>,
        shared: &mut SharedFrame<'_>,
        scan: Option<&mut Scan>,
        found: &mut [FoundFace],
    ) -> Detected {
        let is_noisy = shared.noise() >= NOISY;
        let frame = &shared.filtered(is_noisy);
        let step = &Step::new(model, frame, 0, &self.config);
        let scan = scan.unwrap_or_else(|| self.search.scan());
        list(
            step,
            &self.config,
            scan,
            &self.excluded,
            &mut self.work,
            found,
        )
    }

    /// Follows the target to this frame.
    #[inline(never)]
    fn follow(&mut self, step: &Step<'_>) -> Followed {
        let mut aligned = None;
        let mut followed = self.see(step, &mut aligned);
        if let Some(aligned) = &aligned {
            followed.loss = self.accept(step, aligned, Origin::Tracked).err();
            followed.is_found = followed.loss.is_none();
        }
        followed
    }

    /// The target's landmarks on this frame, if it is there. By itself, as [`Tracker::attempt`], so
    /// that a candidate is not on the stack while a face is fitted.
    #[inline(never)]
    fn see(&mut self, step: &Step<'_>, aligned: &mut Option<Aligned>) -> Followed {
        let candidate = &see_target(step, &mut self.target, &self.excluded, &mut self.work);
        let verified = verify_target(step, candidate, &self.target, &self.excluded);
        let mut followed = Followed {
            is_found: false,
            loss: Some(verified.err().unwrap_or(Loss::LowConfidence)),
            units: candidate.units,
        };
        if verified.is_ok() {
            followed.units += REFINE_UNITS;
            candidate.refine(step, &mut self.work, aligned);
        }
        followed
    }

    /// Attempts one place after the other, until a face is accepted; adds to the step's work. False
    /// where none is.
    #[inline(never)]
    fn search(&mut self, step: &Step<'_>, wanted: &Wanted) -> bool {
        let (state, place, units) = (self.result.state, &self.target.place, self.units);
        let mut proposals = Proposals::new(state, wanted, place, &self.config, step.now_us, units);
        loop {
            let (search, work) = (&mut self.search, &mut self.work);
            let next = proposals.next(step, &self.config, search, work);
            self.units = proposals.units();
            let Some(start) = next else {
                return false;
            };
            let mut aligned = None;
            self.attempt(step, &start, &mut proposals, &mut aligned);
            self.units = proposals.units();
            let Some(aligned) = &aligned else {
                continue;
            };
            if self.accept(step, aligned, start.origin).is_ok() {
                proposals.accepted(&mut self.search);
                return true;
            }
        }
    }

    /// The landmarks of what is there, if it may be a face.
    #[inline(never)]
    fn attempt(
        &mut self,
        step: &Step<'_>,
        start: &Start,
        proposals: &mut Proposals,
        aligned: &mut Option<Aligned>,
    ) {
        let candidate = &Candidate::new(step, start, &mut self.work);
        proposals.spend(candidate.units);
        match verify(step, start, candidate, &self.excluded, &self.suppressed) {
            Verdict::Reject => {}
            Verdict::Retry => self.search.offer(start, candidate),
            Verdict::LookAgain => self.search.look_again_at(&start.seen),
            // The next step goes on with it.
            Verdict::Fit if candidate.iterations_left > 0 && !proposals.has_room(FOUND_UNITS) => {
                self.search.offer(start, candidate);
            }
            Verdict::Fit => {
                proposals.spend(FOUND_UNITS);
                candidate.refine(step, &mut self.work, aligned);
            }
        }
    }

    /// Fits an aligned face, takes it as the target and writes the result; else says why not.
    #[inline(never)]
    fn accept(&mut self, step: &Step<'_>, aligned: &Aligned, origin: Origin) -> Result<(), Loss> {
        let prior = &self.target.prior(origin);
        let fit = fit_face(step, aligned, prior);
        let fitted = (fit.as_ref()).and_then(|fit| Fitted::new(step, aligned, fit, prior));
        let fitted = &fitted.ok_or(Loss::NoPose)?;
        let (target, work) = (&mut self.target, &mut self.work);
        target.accept(step, fitted, origin);
        let keyframes = &mut self.search.keyframes;
        keyframes.accept(
            step.frame,
            fitted,
            origin,
            target.place.size,
            work.scratch(),
        );
        let weights = weights::see(step, fitted, &mut target.rest, work);
        let (blur_px, natural) = (target.blur_px(), self.config.natural_gaze);
        let eyes = match self.config.gaze {
            true => see(step, fitted, blur_px, natural, &mut target.eyes, work),
            false => Eyes::EMPTY,
        };
        write(&mut self.result, step, fitted, &weights, &eyes, blur_px);
        match origin {
            Origin::NewFace => self.record(EventKind::Acquired),
            Origin::Reacquired => self.record(EventKind::Reacquired),
            Origin::Tracked => {}
        }
        Ok(())
    }

    /// No face is accepted on this frame.
    #[inline(never)]
    fn find_nothing(&mut self, step: &Step<'_>, wanted: &Wanted, loss: Option<Loss>) {
        match (self.result.state, wanted) {
            (State::Searching, _) | (_, Wanted::At(_) | Wanted::Again(_)) => {
                self.clear_result(step.now_us);
            }
            (State::Tracking, _) => self.lose(step, loss),
            (State::Coasting, _) => self.coast(step),
        }
    }

    /// The target was lost on this frame.
    fn lose(&mut self, step: &Step<'_>, loss: Option<Loss>) {
        self.result.loss = loss;
        if self.target.is_trusted() {
            return self.coast(step);
        }
        // It was probably no face. Coasting would keep the scan from faces of other sizes.
        if loss == Some(Loss::LowConfidence) {
            self.suppressed = Suppressed::at(&self.target.place, step.now_us);
            self.record(EventKind::Suppressed);
        }
        self.record(EventKind::Lost);
        self.clear_result(step.now_us);
    }

    /// Repeats the last fit until it is too old, then starts the search. Nothing is seen of the
    /// eyes.
    fn coast(&mut self, step: &Step<'_>) {
        let age_us = step.now_us.saturating_sub(self.target.fitted_us);
        if age_us <= COAST_US {
            if self.result.state != State::Coasting {
                self.record(EventKind::Coasting);
            }
            self.result.state = State::Coasting;
            self.result.timestamp_us = step.now_us;
            self.result.age_us = age_us;
            self.result.eyes = Eyes::EMPTY;
        } else {
            self.search.expect(&self.target.place, step.now_us);
            self.record(EventKind::Lost);
            self.clear_result(step.now_us);
        }
    }

    // --- Parts of a step -------------------------------------------------------------------------

    fn check_roi(&self, frame: &Frame<'_>) -> Result<(), StepError> {
        match self.config.roi {
            Some(roi) if !roi.is_in(frame) => Err(StepError::Roi),
            _ => Ok(()),
        }
    }

    /// The frame, box-filtered if it is noisy.
    fn filtered<'f>(&mut self, shared: &mut SharedFrame<'f>) -> Frame<'f> {
        let threshold = match self.is_noisy {
            true => NO_LONGER_NOISY,
            false => NOISY,
        };
        let is_due =
            self.result.state != State::Tracking || self.steps.is_multiple_of(NOISE_PERIOD);
        self.steps = self.steps.wrapping_add(1);
        let is_noisy = match is_due {
            true => shared.noise() >= threshold,
            false => self.is_noisy,
        };
        if is_noisy != self.is_noisy {
            self.is_noisy = is_noisy;
            self.record(match is_noisy {
                true => EventKind::FilterOn,
                false => EventKind::FilterOff,
            });
        }
        shared.filtered(is_noisy)
    }

    /// Searching: nothing but the timestamp, and why the last target was lost.
    fn clear_result(&mut self, now_us: i64) {
        self.result = TrackResult {
            timestamp_us: now_us,
            loss: self.result.loss,
            ..TrackResult::EMPTY
        };
    }

    /// Adds an event with what the result says now.
    #[inline(never)]
    fn record(&mut self, kind: EventKind) {
        let timestamp_us = self.last_timestamp_us.unwrap_or(0);
        self.events
            .push(Event::new(kind, timestamp_us, &self.result));
    }
}
