//! Every threshold, timeout and work cost of tracking.
//!
//! Each constant states its meaning, its unit in brackets (none: a probability or a ratio), and
//! under *Source* what its value was measured on. *Source: chosen* means that no other value was
//! measured. Titles in italics are records of `docs/dev/records.md`; commands and today's figures
//! are in `docs/accuracy.md`.
//!
//! Not here: settings with their defaults and ranges (`config.rs`), how keyframes are matched
//! (`src/keyframe`), how noise is measured (`src/image/noise.rs`), and what the 3D fit and the
//! identity estimate weigh (`src/shape`).

// --- Acceptance of a face ------------------------------------------------------------------------

/// A detection becomes the target from this confidence on in its first attempt.
///
/// Source: clip `07_leave`, in which a saddle cloth once had 0.804 and was tracked for a second
/// while `ACCEPT_CONFIDENCE` was enough (*Profiles in the detector*).
pub(super) const FIRST_ATTEMPT_CONFIDENCE: f32 = 0.9;

/// A candidate becomes the target from this confidence on in a retry, in a local search while
/// coasting, by keyframes, and where the caller expects a face. In a frame with many tiles a retry
/// of a new face needs `FIRST_ATTEMPT_CONFIDENCE`: there are more places that may look like one.
///
/// Source: 60 pictures without people, 1,500 frames: 134 are tracked with 0.5, 25 with 0.8, none
/// with 0.8 and a verifier that knows the detector's false positives (*Negatives of the verifier*).
/// In 300 frames of 3840×2160 with a face of 60 px something else is tracked in 5 with 0.8, in 2
/// with 0.9 (*Candidates in tiles of their own*).
pub(super) const ACCEPT_CONFIDENCE: f32 = 0.8;

/// A rejected detection is retried from this confidence on, with one more iteration. A detection
/// with less after its first iteration is discarded or waits for the next step to go on, if this
/// step has not the work for it.
///
/// Source: 1,422 candidates in pictures without people: 164 have more than `DISCARD_CONFIDENCE`
/// after one iteration, 7 have more than this. Of the faces that are found in `faces300w/dev` by a
/// first attempt 95 % have more than this, of those of `faces68/dev` 93 %.
pub(super) const RETRY_CONFIDENCE: f32 = 0.1;

/// A candidate with less confidence after an iteration is rejected without another one.
///
/// Source: 1,404 candidates in pictures without people: 88 % are rejected after one iteration.
/// Found faces of `faces300w/dev` and of dim pictures of `faces68/dev` are the same with 0, 0.001,
/// 0.003 and 0.01.
pub(super) const DISCARD_CONFIDENCE: f32 = 0.01;

/// Below this confidence an attempt has gone astray, and the detector looks again where it found a
/// face; with more, another iteration goes on from where the attempt ended.
///
/// Source: 86 faces of `faces68/train-teacher.csv` that a first attempt of the built-in model does
/// not find: below, 24 are found by two more iterations and 32 from where the detector sees them
/// then; above, 24 and 23.
pub(super) const LOOK_AGAIN_CONFIDENCE: f32 = 0.5;

/// How often the detector looks again at a face.
///
/// Source: as above; 32 are found by the first look, 7 more by the second.
pub(super) const LOOKS: u8 = 2;

/// Least score of a detection for that \[logit above the detector's threshold\].
///
/// Source: as above; nine of ten of these faces have more.
pub(super) const LOOK_AGAIN_SCORE: f32 = 1.0;

/// Of the steps that search one in this number looks again, so that false candidates do not take
/// much of a scan.
///
/// Source: chosen.
pub(super) const LOOK_AGAIN_PERIOD: u32 = 8;

/// From this confidence on a frame is trusted: the identity, the appearance and the keyframes are
/// updated from it, and a face that reached it once may coast.
///
/// Source: chosen.
pub(super) const TRUST_CONFIDENCE: f32 = 0.9;

// --- Keeping or losing the target ----------------------------------------------------------------

/// A target that was never trusted is lost below this confidence. Lower than `ACCEPT_CONFIDENCE`,
/// so that a face at the edge does not come and go. Below it the next frame starts from the shape
/// of the global stage, because the refiners of a covered face move its eyes anywhere.
///
/// Source: chosen when the refiner of the lids was added.
pub(super) const UNTRUSTED_KEEP_CONFIDENCE: f32 = 0.5;

/// A target that was trusted is lost below this confidence.
///
/// Source: chosen; the half-covered faces of clip `06_occluder` have 0.02 at least.
pub(super) const TRUSTED_KEEP_CONFIDENCE: f32 = 0.02;

/// A target that was trusted and is recognised is lost below this confidence.
///
/// Source: clip `06_occluder`: of its half-covered frames 100 % are tracked, 59 % without
/// recognition (*Keeping an occluded face*). Two units of the logit below
/// `TRUSTED_KEEP_CONFIDENCE`.
pub(super) const RECOGNISED_KEEP_CONFIDENCE: f32 = 0.003;

/// A target is recognised when at least this number of landmarks is visible and matches its
/// appearance.
///
/// Source: clip `06_occluder` and `eval faceless --after`: with 6 two more faceless frames are
/// tracked after a loss, with 8 no covered frame is lost (*Keeping an occluded face*).
pub(super) const RECOGNISED_LANDMARKS: u32 = 8;

/// How long a target may have low confidence without being recognised \[µs\]: longer than a blink.
/// For a trusted target low means below `UNTRUSTED_KEEP_CONFIDENCE`, for others below
/// `ACCEPT_CONFIDENCE`.
///
/// Source: `eval faceless --after webcam-b`: 9 of 1,500 frames tracked, 15 with twice as long; no
/// frame of any clip is lost by it (*Giving up faces of low confidence*).
pub(super) const LOW_CONFIDENCE_US: i64 = 250_000;

/// The same for a trusted target whose head was last turned from the camera by more than the angle
/// of `TURNED_COSINE`: a profile shows less to be sure of, and who looks over the shoulder turns
/// back \[µs\].
///
/// Source: heads of the sweeps from 60° of yaw on (*Profiles of low confidence*). The second itself
/// and the 60° are chosen.
pub(super) const TURNED_LOW_CONFIDENCE_US: i64 = 1_000_000;
pub(super) const TURNED_COSINE: f32 = 0.5;

/// There is an anchor until the head turns away: looks at the camera to within less than the angle
/// of this cosine, with a confidence of at least `UNTRUSTED_KEEP_CONFIDENCE`. A head that turns
/// farther shows ever less of its face without being covered.
///
/// Source: validation clips of turning heads, yaw of 60° to 95°: mean error 5.1°, 7.7° if the
/// anchor stays.
pub(super) const ANCHOR_MIN_FACING: f32 = 0.707;

/// A target is in place, whatever its confidence, when the share of its landmarks that are visible
/// and the share of what surrounds its face that is unchanged have at least this sum.
///
/// Source: validation clips of covered faces, three sets of heads: of the frames with something
/// before the face 94, 100 and 90 % are tracked with 0.5, 98, 100 and 95 % with 0.4, 98, 100 and
/// 99 % with 0.38 (*Another picture, seen farther around*).
pub(super) const IN_PLACE_SHARES: f32 = 0.38;

/// Width of the square whose edge is compared to see whether a target is in place, in widths of the
/// face: hair, neck and what is next to them.
///
/// Source: chosen.
pub(super) const SURROUNDINGS: f32 = 2.0;

/// A trusted target of low confidence is lost at once when a smaller share of what surrounds its
/// face is as in the frame before, in place or moved along: the picture is another one.
///
/// Source: 3,000 frames in which a picture without people takes the place of a face: none is
/// tracked, 129 without this; no covered frame of the validation clips is lost by it. The same
/// holds with 0.5; with 0.55 and `CUT_SURROUNDINGS` of 2 covered frames are lost (*Another picture,
/// seen farther around*).
pub(super) const CUT_SHARE: f32 = 0.45;

/// Width of the square whose edge is compared for that, in widths of the face: farther than an arm
/// before the face reaches in most directions.
///
/// Source: as `CUT_SHARE`: with 2 either 25 frames of one picture are tracked or 50 frames of a
/// covered face are lost.
pub(super) const CUT_SURROUNDINGS: f32 = 5.0;

/// Largest change of luma with which a cell around the face is as it was \[grey levels\].
///
/// Source: chosen.
pub(super) const UNCHANGED_LUMA: usize = 9;

/// Largest change of luma that all cells may have in common \[grey levels\]. Of a larger one
/// nothing is taken off, because any two even surfaces differ by some change in common.
///
/// Source: chosen.
pub(super) const COMMON_LUMA: usize = 16;

/// How long a target in place is kept after its confidence was last high \[µs\].
///
/// Source: chosen.
pub(super) const COVERED_US: i64 = 5_000_000;

/// How long the last fit of a lost target is repeated \[µs\]. Then the target counts as gone.
///
/// Source: chosen.
pub(super) const COAST_US: i64 = 500_000;

// --- Suppression of rejected regions -------------------------------------------------------------

/// How long a region is suppressed whose face was lost without ever being trusted \[µs\]. A
/// candidate there needs `TRUST_CONFIDENCE`.
///
/// Source: clip `07_leave` shown in sixteen ways, together with `LOW_CONFIDENCE_US`: 53 of 1,344
/// faceless frames tracked, 131 without both. The ten seconds themselves are chosen.
pub(super) const SUPPRESS_US: i64 = 10_000_000;

/// A candidate lies in the suppressed region when its centre is nearer than this share of the
/// region's size …
///
/// Source: chosen.
pub(super) const SUPPRESS_DISTANCE: f32 = 0.5;

/// … and its size is within these multiples of the region's.
///
/// Source: chosen.
pub(super) const SUPPRESS_SIZES: core::ops::Range<f32> = 0.67..1.5;

// --- Several faces -------------------------------------------------------------------------------

/// Two faces are the same when the centre of one is nearer to that of the other's box than this
/// share of the box's longer side: an excluded face, or two that are listed.
///
/// Source: chosen; boxes of one face differ by a quarter at most, and a face half behind another
/// has its centre at half of the side.
pub(super) const SAME_FACE: f32 = 0.4;

/// How long after a loss a tracker of a group searches by itself, before another one looks for a
/// new face \[µs\].
///
/// Source: chosen; somebody who passes behind another is back sooner.
pub(super) const RETURN_US: i64 = 2_000_000;

/// Time constant of a claim to a face \[µs\].
///
/// Source: chosen; a face that is being covered has a smaller claim for this long.
pub(super) const CLAIM_US: f32 = 500_000.0;

/// A face whose tracker has this claim is expected back after a loss.
///
/// Source: chosen; a false positive is lost before, which takes 0.2 s.
pub(super) const ESTABLISHED_CLAIM: f32 = 0.3;

// --- Search --------------------------------------------------------------------------------------

/// How long a lost face is expected back at about its last size \[µs\].
///
/// Source: chosen.
pub(super) const EXPECT_US: i64 = 10_000_000;

/// Sizes at which a lost face is expected, as multiples of its last size.
///
/// Source: chosen; a detection's size is within a step of the scan.
pub(super) const EXPECTED_SIZES: [f32; 2] = [0.8, 1.25];

/// Of the steps while a face is expected back, one in this number scans all sizes and not the
/// expected ones. While none is expected, one in this number compares keyframes.
///
/// Source: chosen.
pub(super) const EXPECT_PERIOD: u32 = 4;

/// Of the steps while the caller expects a face somewhere, one in this number does not look there,
/// so that a wrong place leaves room for what the scan finds.
///
/// Source: chosen.
pub(super) const HINT_PERIOD: u32 = 4;

/// Of the steps while no face is expected, one in this number scans for large faces first, which
/// takes two to four tiles at any frame size. A whole scan takes as many steps only in frames above
/// 1280×720.
///
/// Source: chosen.
pub(super) const LARGE_FACE_PERIOD: u32 = 8;

/// Of the steps with tiles left to evaluate, one in this number attempts candidates that are not
/// clear too; otherwise these wait for the end of the scan.
///
/// Source: faces of 60 px in photographs of 3840×2160 px; false candidates took most of each step.
pub(super) const UNCLEAR_PERIOD: u32 = 8;

/// Smallest large face, as a share of the frame's shorter side: a person who sits before a camera.
///
/// Source: chosen.
pub(super) const LARGE_FACE: f32 = 0.25;

/// Of the steps that coast, one in this number searches around the last fit, the others scan the
/// frame.
///
/// Source: chosen.
pub(super) const LOCAL_SEARCH_PERIOD: u32 = 2;

/// Largest angle by which a head of low confidence turns from one frame to the next \[rad\].
///
/// Source: chosen, 60°.
pub(super) const MOST_TURN: f32 = 1.05;

/// Largest speed with which it does so where it was turned beyond the angle of `ANCHOR_MIN_FACING`
/// \[rad/s\], and the least angle that counts as such a turn \[rad\]. A head turned to profile is
/// recognised by what is left of it, and its fit then flips to the front or to the other side.
///
/// Source: chosen: 900° a second, 30°. With 60° from frame to frame, fits of three of 38 heads of
/// two sweeps flip and stay so (*Profiles of low confidence*).
pub(super) const MOST_TURN_SPEED: f32 = 15.7;
pub(super) const LEAST_TURN: f32 = 0.52;

// --- Work costs ----------------------------------------------------------------------------------

/// Work of an iteration of the global stage and its verification \[units: a tracking step has
/// 2,600\].
///
/// Source: `posewise-lab bench` on x86-64 with AVX2, as all of these.
pub(super) const ITERATION_UNITS: u32 = 1550;

/// Work of an iteration with the first network only \[units\].
pub(super) const FIRST_UNITS: u32 = 850;

/// A candidate of the scan is looked at where so much is left of a step's work; else it waits for
/// the next step, and tiles are evaluated meanwhile \[units\].
///
/// Source: chosen, two iterations and more. With the work of one, a searching step in clutter takes
/// 1.7 times the instructions.
pub(super) const CANDIDATE_UNITS: u32 = 1900;

/// Work of the refiners and the 3D fit of the target \[units\].
pub(super) const REFINE_UNITS: u32 = 1050;

/// The same of a face that is found: its fit starts from two poses \[units\].
pub(super) const FOUND_UNITS: u32 = 1450;

/// Work of a local search \[units\]: a tile.
pub(super) const LOCAL_UNITS: u32 = 750;

/// The same for a head that is rolled far: each pixel of the tile is the mean of many \[units\].
pub(super) const TURNED_UNITS: u32 = 1600;

/// Work of comparing one window of a frame with all keyframes \[units\].
pub(super) const KEYFRAME_UNITS: u32 = 1600;

/// Work beyond which a step begins nothing more, but for a tile of the scan: the next one does
/// \[units\].
///
/// Source: chosen, one and a half tracking steps; the longest step takes what `posewise-lab bench`
/// says.
pub(super) const STEP_UNITS: u32 = 3900;

/// Iterations at what a local search finds, and where the head is rolled far: the target's face is
/// known, and tracking goes on from there.
///
/// Source: chosen, for [`STEP_UNITS`].
pub(super) const LOCAL_ITERATIONS: usize = 2;
pub(super) const TURNED_ITERATIONS: usize = 1;

// --- Noise ---------------------------------------------------------------------------------------

/// Share of noise in a frame's luma from which on the frame is box-filtered.
///
/// Source: 511 photographs with added noise of 8, 15 and 25 grey levels have 0.16, 0.30 and 0.47 in
/// the median, without it 0.036 at most (*A box filter for frames with much noise*).
pub(super) const NOISY: f32 = 0.2;

/// Of the steps that track a face one in this number measures the noise.
///
/// Source: chosen: noise lasts, and 432 samples are 1 % of a step.
pub(super) const NOISE_PERIOD: u8 = 4;

/// Share of noise below which a frame is no longer box-filtered after one that was.
///
/// Source: chosen: hysteresis, so that frames at the edge are not filtered by turns.
pub(super) const NO_LONGER_NOISY: f32 = 0.15;

// --- Motion --------------------------------------------------------------------------------------

/// Longest time between two fits from which a velocity is taken, and over which it predicts \[µs\].
///
/// Source: chosen.
pub(super) const MAX_PREDICTION_US: i64 = 200_000;

/// Farthest prediction \[widths of the face\].
///
/// Source: chosen.
pub(super) const MAX_PREDICTION: f32 = 0.3;

/// Smaller motion between two fits is noise and counts as none \[widths of the face\].
///
/// Source: chosen.
pub(super) const MIN_MOTION: f32 = 0.02;

/// Motion in a thirtieth of a second from which on all networks see a face on each frame \[widths
/// of the face\]: what a network has changed holds for a face that moves little.
///
/// Source: chosen with `eval turns --of 4`: error on clip `05_fast` 6.13 % without a bound, 5.46 %
/// with it, 5.45 % with all networks on each frame.
pub(super) const FAST_MOTION: f32 = 0.05;

/// Distance of prediction and last crop from which on the crop follows at once \[widths of the
/// face\]. A crop that followed every small distance would feed the noise of the last fit back.
///
/// Source: chosen with `eval jitter` on the webcam clips; no figures are kept.
pub(super) const CROP_FOLLOWS_AT: f32 = 0.08;

/// Least share of the distance by which the crop follows.
///
/// Source: as `CROP_FOLLOWS_AT`.
pub(super) const CROP_FOLLOWS_LEAST: f32 = 0.1;

// --- 3D fit and identity -------------------------------------------------------------------------

/// Weight of a landmark in the 3D fit: `FIT_WEIGHT_MIN` plus its confidence times a factor that
/// goes from `FIT_WEIGHT_HIDDEN` (hidden) to 1 (visible). Landmarks that are wrong or hidden keep a
/// little weight, because the fit is robust and few landmarks may be left.
///
/// Source: chosen.
pub(super) const FIT_WEIGHT_MIN: f32 = 0.05;

/// Factor on the confidence of a landmark that is certainly hidden; see `FIT_WEIGHT_MIN`.
///
/// Source: chosen.
pub(super) const FIT_WEIGHT_HIDDEN: f32 = 0.2;

/// Weight of the rotation's prior in the 3D fit when no landmark is visible; it falls to 0 with the
/// visible share. It is large because in the fit each landmark counts as independent of the others,
/// though the errors of hidden ones are alike.
///
/// Source: chosen.
pub(super) const ROTATION_PRIOR_WEIGHT: f32 = 500.0;

/// One in how many trusted frames updates the identity after this number of updates. The first ones
/// do, so that a face soon has its shape; then fewer, because an update takes a part of a step, and
/// neighbouring frames have nearly the same errors.
///
/// Source: chosen.
pub(super) const fn identity_period(updates: u32) -> u32 {
    match updates {
        0..4 => 1,
        4..IDENTITY_FRAMES => 4,
        _ => 8,
    }
}

/// Updates after which an identity is settled.
///
/// Source: from then on the estimator forgets (`MEMORY` of src/shape/identity.rs over
/// `FRAME_WEIGHT`).
pub(super) const IDENTITY_FRAMES: u32 = 12;

/// Evidence from which on a head has the shape of that of a record: how much more likely what is
/// seen is for that head than for anybody's, as a natural logarithm.
///
/// Source: `posewise-lab eval identities` on 20 rendered people in three clips each (`render-u3pt
/// --seed 61`): one of a hundred pairs of other people has 5.6 or more.
pub(super) const SAME_EVIDENCE: f32 = 5.6;

/// Evidence down to which it is another one.
///
/// Source: as above; one of a hundred pairs of the same person has -0.96 or less.
pub(super) const OTHER_EVIDENCE: f32 = -1.0;

// --- Appearance of the target's landmarks --------------------------------------------------------

/// A frame moves means and variances of the features by one part in this number.
///
/// Source: `posewise-lab adaptive`, rendered clips: area under the ROC of visible and hidden 0.943
/// with 1/50, 0.941 with 1/20, 0.940 with 1/10, 0.935 without (*Adaptive appearance*).
pub(super) const APPEARANCE_RATE: i32 = 64;

/// Added to the variance of each feature, so that distances are finite \[squared feature units\].
///
/// Source: chosen.
pub(super) const APPEARANCE_VARIANCE: f32 = 16.0;

/// A landmark's appearance is used after this number of updates.
///
/// Source: chosen.
pub(super) const APPEARANCE_MIN_FRAMES: u16 = 10;

/// Only landmarks with at least this visibility update their appearance.
///
/// Source: chosen.
pub(super) const APPEARANCE_MIN_VISIBILITY: f32 = 0.7;

/// Largest change of a visibility by the appearance \[logit\]. The change itself is the distance,
/// with weight 1.
///
/// Source: chosen; the weight is from the table at `APPEARANCE_RATE`.
pub(super) const APPEARANCE_MAX_CHANGE: f32 = 4.0;

/// A visible landmark matches its appearance below this distance \[mean squared deviations, less
/// 1\].
///
/// Source: chosen together with `RECOGNISED_LANDMARKS`.
pub(super) const APPEARANCE_MATCH: f32 = 0.5;

/// A landmark that matches is visible from this visibility on.
///
/// Source: chosen: more likely visible than hidden.
pub(super) const APPEARANCE_MATCH_VISIBILITY: f32 = 0.5;

// --- Eye openness --------------------------------------------------------------------------------

/// `eye_open` is unknown where fewer landmarks of the eye, of six, face the camera.
///
/// Source: chosen.
pub(super) const EYE_MIN_FACING: usize = 4;

/// `eye_open` is unknown where the visibilities of the eye's six landmarks sum up to less.
///
/// Source: chosen: half of them.
pub(super) const EYE_MIN_VISIBILITY: f32 = 3.0;

/// `eye_open` is unknown where the eye moves farther while a frame is exposed \[widths of the
/// eye\]: it is a streak, in which open and shut look alike.
///
/// Source: rendered clips: the correlation of `eye_open` with the truth goes from 0.944 to 0.955
/// (*Motion blur and unknown eyes*).
pub(super) const EYE_MAX_BLUR: f32 = 0.6;

/// Eyes are unknown where the nose's direction has a smaller cosine with the line to the camera.
///
/// Source: chosen: 65°.
pub(super) const EYE_MIN_FACING_COSINE: f32 = 0.42;

/// Lids and gaze are unknown where a millimetre of the eye is smaller \[px\].
///
/// Source: chosen: the iris is four pixels wide, and the face 45.
pub(super) const EYE_MIN_PX_PER_MM: f32 = 0.3;

/// Eyes behind glasses that are dark with this probability are unknown.
///
/// Source: chosen.
pub(super) const EYE_DARK: f32 = 0.5;

/// Eyes that are visible with a smaller probability are unknown.
///
/// Source: chosen.
pub(super) const EYE_VISIBLE: f32 = 0.5;

/// Eyes whose landmarks are hidden are visible after all where a person wears glasses, with this
/// probability of glasses and of a visible eye: visibilities take lids behind glasses for hidden.
///
/// Source: rendered clips (*Spectacles as they are*).
pub(super) const EYE_VISIBLE_AFTER_ALL: f32 = 0.8;

/// Mean probability of glasses from which a person wears them; what hides an eye then is taken for
/// a reflection.
///
/// Source: chosen.
pub(super) const EYE_GLASSES: f32 = 0.5;

/// Seconds over which the mean goes, and most of a step.
///
/// Source: chosen.
pub(super) const GLASSES_S: f32 = 1.3;
pub(super) const GLASSES_STEP_S: f32 = 0.2;

/// Lids and gaze are unknown where a larger share of the eye's crop is overexposed.
///
/// Source: chosen.
pub(super) const EYE_MAX_GLARE: f32 = 0.3;

/// A gaze is unknown where the probability of an open eye is less.
///
/// Source: chosen.
pub(super) const GAZE_MIN_OPEN: f32 = 0.5;

/// A gaze is unknown where its standard deviation is larger \[deg\].
///
/// Source: chosen.
pub(super) const GAZE_MAX_SIGMA_DEG: f32 = 12.0;

/// Share of a gaze's standard deviation that both eyes have in common.
///
/// Source: chosen.
pub(super) const GAZE_SHARED: f32 = 0.5;

/// Angle of a gaze in the head frame at which its weight is 1 \[rad\].
///
/// Source: the morphable head, whose `eyeLook` shapes turn lids as for half a radian.
pub(super) const EYE_LOOK_RAD: f32 = 0.5;

/// Share of a person's mean gaze in the head frame that is taken off.
///
/// Source: driver clips of seed 11: 0.4 to 0.8 are within 0.2° of it, 1 is 0.2 to 0.4° worse
/// (*Eyes behind lenses, lids half way, a person's mean gaze*).
pub(super) const NATURAL_GAZE_SHARE: f32 = 0.6;

/// Most that is taken off \[rad\].
///
/// Source: chosen: 8°.
pub(super) const NATURAL_GAZE_MAX_RAD: f32 = 0.14;

/// A gaze counts in its mean up to this angle from it \[rad\].
///
/// Source: chosen: 10°, so that a glance counts little.
pub(super) const NATURAL_GAZE_CUT_RAD: f32 = 0.175;

/// For how long a mean gaze of straight ahead is held to have been seen \[s\].
///
/// Source: chosen.
pub(super) const NATURAL_GAZE_PRIOR_S: f32 = 2.0;

/// Over how long the mean is at most \[s\].
///
/// Source: chosen.
pub(super) const NATURAL_GAZE_S: f32 = 120.0;

/// For how long a gaze counts at most \[s\].
///
/// Source: chosen: two frames at ten frames a second.
pub(super) const NATURAL_GAZE_STEP_S: f32 = 0.2;

/// Only a head counts whose nose's direction has at least this cosine with the line to the camera.
///
/// Source: chosen: 40°.
pub(super) const NATURAL_GAZE_FACING_COSINE: f32 = 0.766;

/// Longest exposure of a frame that is assumed for motion blur \[µs\].
///
/// Source: chosen: 1/30 s, a whole frame of most cameras.
pub(super) const EXPOSURE_US: f32 = 33_333.0;

// --- Smoothing -----------------------------------------------------------------------------------

/// Cutoff of the filter of the speeds \[Hz\].
///
/// Source: Casiez et al. 2012, who fix it at 1 Hz.
pub(super) const SPEED_CUTOFF_HZ: f32 = 1.0;

/// The filter starts anew after a longer time without a fit \[µs\].
///
/// Source: chosen.
pub(super) const MAX_SMOOTHING_GAP_US: i64 = 250_000;

/// Unit of the speeds of points in space: width of a face \[mm\].
///
/// Source: chosen: anatomy, rounded.
pub(super) const FACE_WIDTH_MM: f32 = 150.0;

// --- Mesh ----------------------------------------------------------------------------------------

/// Product of a landmark's confidence and visibility from which it draws the mesh all the way.
///
/// Source: chosen: more likely right and seen than not.
#[cfg(feature = "mesh")]
pub(super) const MESH_SURE: f32 = 0.5;

// --- Weights that are seen -----------------------------------------------------------------------

/// What a weight's rest follows of the difference to it, at most.
///
/// Source: chosen.
pub(super) const REST_CUT: f32 = 0.2;

/// How much slower a rest rises than it falls.
///
/// Source: chosen.
pub(super) const REST_RISE: f32 = 0.25;

/// Largest rest.
///
/// Source: chosen.
pub(super) const REST_MAX: f32 = 0.4;

/// For how long nothing seen counts as much as what is seen \[s\].
///
/// Source: chosen.
pub(super) const REST_PRIOR_S: f32 = 0.5;

/// What is seen of a face counts for so long \[s\].
///
/// Source: chosen.
pub(super) const REST_S: f32 = 20.0;

/// Longest time that a frame counts for \[s\].
///
/// Source: chosen.
pub(super) const REST_STEP_S: f32 = 0.2;

/// The rest is learnt of faces that look at the camera at least so much: within 30°.
///
/// Source: chosen.
pub(super) const REST_FACING_COSINE: f32 = 0.866;

/// Mean visibility of the mouth's landmarks up to which nothing is said of its weights, and that
/// from which they are given as they are seen.
///
/// Source: chosen.
pub(super) const WEIGHT_HIDDEN: f32 = 0.3;
pub(super) const WEIGHT_SHOWN: f32 = 0.6;
