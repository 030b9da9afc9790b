//! The result of a step.

use crate::shape::{ANIMATIONS, LANDMARKS};
use crate::track::eyes::Eyes;

/// What the tracker is doing. Complete: a program must handle each of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum State {
    /// No face; of the result only `timestamp_us` and `loss` say something.
    #[default]
    Searching,
    /// Fitted on this frame.
    Tracking,
    /// Not fitted on this frame: the last fit, `age_us` old.
    Coasting,
}

impl State {
    /// Every state, in the order of the C ABI.
    pub const ALL: [State; 3] = [State::Searching, State::Tracking, State::Coasting];

    /// Its name in every table and language, as `searching`.
    pub const fn name(self) -> &'static str {
        match self {
            State::Searching => "searching",
            State::Tracking => "tracking",
            State::Coasting => "coasting",
        }
    }
}

/// Why a face was lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Loss {
    /// The confidence fell too low: no face, or landmarks that are wrong.
    LowConfidence = 1, // `None` of an `Option` is 0 then
    /// The centre of its box left the frame.
    LeftFrame,
    /// No head pose explains the landmarks.
    NoPose,
    /// It is a face that another tracker follows; see [`crate::Tracker::set_excluded`].
    Excluded,
}

impl Loss {
    /// Every reason, in the order of the C ABI, which has `none` before the first.
    pub const ALL: [Loss; 4] = [
        Loss::LowConfidence,
        Loss::LeftFrame,
        Loss::NoPose,
        Loss::Excluded,
    ];

    /// Its name in every table and language, as `low-confidence`.
    pub const fn name(self) -> &'static str {
        match self {
            Loss::LowConfidence => "low-confidence",
            Loss::LeftFrame => "left-frame",
            Loss::NoPose => "no-pose",
            Loss::Excluded => "excluded",
        }
    }

    /// The name of the reason; `none` where nothing was lost.
    pub fn name_of(loss: Option<Loss>) -> &'static str {
        loss.map_or("none", Loss::name)
    }
}

/// One landmark in the image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Landmark {
    /// Image position, to the right \[px of the upright frame\]; estimated from the rest where the
    /// landmark is hidden.
    pub x: f32,
    /// Image position, downwards \[px of the upright frame\].
    pub y: f32,
    /// Calibrated probability that the landmark lies within a tenth of the inter-ocular distance
    /// of the truth, 0..1. That distance is the one between the outer eye corners (36, 45) of a
    /// frontal face: turning the head does not shorten it.
    pub confidence: f32,
    /// Calibrated probability that neither the head itself nor anything in front of it hides it
    /// from the camera, 0..1.
    pub visibility: f32,
}

impl Landmark {
    /// Nothing seen, all zero.
    pub const EMPTY: Landmark = Landmark {
        x: 0.0,
        y: 0.0,
        confidence: 0.0,
        visibility: 0.0,
    };
}

/// The result of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct TrackResult {
    /// What the tracker is doing.
    pub state: State,
    /// Timestamp of the frame \[µs\].
    pub timestamp_us: i64,
    /// Time since the frame that the fit belongs to \[µs\]; 0 when Tracking.
    pub age_us: i64,
    /// Calibrated probability that this is a face and that the landmarks are right, 0..1: their
    /// mean error is below a tenth of the inter-ocular distance (see [`Landmark::confidence`]).
    pub confidence: f32,
    /// Axis-aligned box of the landmarks: x, y, width, height \[px of the upright frame\].
    pub face_box: [f32; 4],
    /// Head-to-camera rotation as a unit quaternion x, y, z, w.
    pub rotation: [f32; 4],
    /// Relative to the camera's axes, as the next two; > 0: the face turns to the image right
    /// \[deg\].
    pub yaw_deg: f32,
    /// > 0: the face turns up \[deg\].
    pub pitch_deg: f32,
    /// > 0: the head tilts clockwise in the image \[deg\].
    pub roll_deg: f32,
    /// The head's origin (midway between the eye centres) in the camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Openness of the face's own left and right eye: 0 shut, 1 open. Unknown is an eye that is
    /// hidden or moves by more than 0.6 of its width in 1/30 s.
    pub eye_open: [Option<f32>; 2],
    /// Why the target was lost; `None` while it is tracked, and before there was one.
    pub loss: Option<Loss>,
    /// Mean visibility of the landmarks, 0..1.
    pub visible_share: f32,
    /// Standard deviations of the rotation, about the camera's x, y and z axes \[deg\], measured on
    /// rendered heads. At most 180. Where the camera is assumed they hold the unknown focal length.
    pub rotation_sigma_deg: [f32; 3],
    /// Standard deviations of `translation_mm`, camera frame \[mm\], likewise. At most
    /// 100,000.
    pub translation_sigma_mm: [f32; 3],
    /// iBUG 68 landmarks; the jaw (0–16) follows the visible contour.
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    pub landmarks: [Landmark; LANDMARKS],
    /// The landmarks as points of the 3D face, camera frame \[mm\].
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    pub points_mm: [[f32; 3]; LANDMARKS],
    /// Weights of [`crate::ANIMATION_NAMES`], 0..1. With a model without section `WGHT` those after
    /// `mouthLowerDownRight` are 0.
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    pub animation: [f32; ANIMATIONS],
    /// Lids, glasses and gaze by the network of single eyes.
    pub eyes: Eyes,
    /// Yaw relative to the line of sight \[deg\]: 0 where the face looks into the lens, wherever
    /// in the picture it is. Signs and ranges as of `yaw_deg`; hardly depends on the focal length.
    pub facing_yaw_deg: f32,
    /// Pitch relative to the line of sight \[deg\].
    pub facing_pitch_deg: f32,
    /// Roll relative to the line of sight \[deg\].
    pub facing_roll_deg: f32,
    /// Standard deviations of the facing yaw, pitch and roll \[deg\]. At most 180.
    pub facing_sigma_deg: [f32; 3],
    /// Focal length along x with which the face was fitted \[px\].
    pub focal_px: f32,
    /// Whether 60° across the frame were assumed, because the settings have no intrinsics: the
    /// facing angles say where the head is turned to, the axis angles and the position err with
    /// the lens.
    pub camera_assumed: bool,
    /// Angle between the direction of the face and the line to the camera, 0..180 \[deg\]: 0 where
    /// the face looks into the lens.
    pub facing_angle_deg: f32,
    /// Distance between the outer eye corners as if seen from the front \[px\].
    pub interocular_px: f32,
}

impl TrackResult {
    /// Nothing seen: numbers are zero.
    pub const EMPTY: TrackResult = TrackResult {
        state: State::Searching,
        timestamp_us: 0,
        age_us: 0,
        confidence: 0.0,
        face_box: [0.0; 4],
        rotation: [0.0; 4],
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
        translation_mm: [0.0; 3],
        eye_open: [None; 2],
        loss: None,
        visible_share: 0.0,
        rotation_sigma_deg: [0.0; 3],
        translation_sigma_mm: [0.0; 3],
        landmarks: [Landmark::EMPTY; LANDMARKS],
        points_mm: [[0.0; 3]; LANDMARKS],
        animation: [0.0; ANIMATIONS],
        eyes: Eyes::EMPTY,
        facing_yaw_deg: 0.0,
        facing_pitch_deg: 0.0,
        facing_roll_deg: 0.0,
        facing_sigma_deg: [0.0; 3],
        focal_px: 0.0,
        camera_assumed: false,
        facing_angle_deg: 0.0,
        interocular_px: 0.0,
    };
}

impl TrackResult {
    /// As [`TrackResult::EMPTY`], of zero bytes only: its eyes say nothing.
    pub(in crate::track) const ZERO: TrackResult = TrackResult {
        eyes: Eyes::ZERO,
        ..TrackResult::EMPTY
    };
}

impl Default for TrackResult {
    fn default() -> Self {
        Self::EMPTY
    }
}
