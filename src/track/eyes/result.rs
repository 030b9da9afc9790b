//! What a result says of the eyes.

/// Why something of an eye is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum EyeUnknown {
    /// There is no face, or the model has no network for eyes.
    #[default]
    NotSeen,
    /// The head is turned so that it hides the eye.
    Turned,
    /// Something covers the eye, or it is not in the picture.
    Hidden,
    /// The eye is too small in the picture.
    Small,
    /// It moves too fast.
    Blurred,
    /// Light that is too bright, as a reflection on glasses.
    Glare,
    /// Dark glasses.
    DarkGlasses,
    /// The eye is shut; only the gaze is unknown then.
    Shut,
    /// What was found is too uncertain.
    Uncertain,
}

impl EyeUnknown {
    /// Every reason, in the order of the C ABI, which has `known` after the first.
    pub const ALL: [EyeUnknown; 9] = [
        EyeUnknown::NotSeen,
        EyeUnknown::Turned,
        EyeUnknown::Hidden,
        EyeUnknown::Small,
        EyeUnknown::Blurred,
        EyeUnknown::Glare,
        EyeUnknown::DarkGlasses,
        EyeUnknown::Shut,
        EyeUnknown::Uncertain,
    ];

    /// Its name in every table and language, as `dark-glasses`.
    pub const fn name(self) -> &'static str {
        match self {
            EyeUnknown::NotSeen => "not-seen",
            EyeUnknown::Turned => "turned",
            EyeUnknown::Hidden => "hidden",
            EyeUnknown::Small => "small",
            EyeUnknown::Blurred => "blurred",
            EyeUnknown::Glare => "glare",
            EyeUnknown::DarkGlasses => "dark-glasses",
            EyeUnknown::Shut => "shut",
            EyeUnknown::Uncertain => "uncertain",
        }
    }

    /// `known`, or the name of why it is not.
    pub fn name_of<T>(known: Result<T, EyeUnknown>) -> &'static str {
        known.map_or_else(EyeUnknown::name, |_| "known")
    }
}

/// A gaze.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Gaze {
    /// Unit direction in which the eye looks, camera frame.
    pub camera: [f32; 3],
    /// The same in the head frame: −z is where the nose points.
    pub head: [f32; 3],
    /// Standard deviation about each axis that is perpendicular to it \[deg\].
    pub sigma_deg: f32,
}

/// What is known of one eye.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct Eye {
    /// Calibrated probability that the eye is open, 0..1; or why the lids are unknown.
    pub open: Result<f32, EyeUnknown>,
    /// Middle of the iris \[px of the upright frame\]; that of the eye where the gaze is unknown.
    pub iris: [f32; 2],
    /// Where it looks; or why that is unknown.
    pub gaze: Result<Gaze, EyeUnknown>,
}

/// What is known of both eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct Eyes {
    /// The person's left and right eye.
    pub each: [Eye; 2],
    /// The gaze of both eyes together, or of the one whose gaze is known; or why it is unknown.
    pub gaze: Result<Gaze, EyeUnknown>,
    /// Probability that the person wears glasses, 0..1; `None` where no eye is seen.
    pub glasses: Option<f32>,
    /// Probability that these are dark, 0..1; `None` where no eye is seen.
    pub dark_glasses: Option<f32>,
    /// ARKit's weights of the gaze, in the order of [`EYE_LOOK_NAMES`], 0..1; 0 where it is
    /// unknown.
    pub look: [f32; EYE_LOOKS],
}

/// Weights of the gaze.
pub const EYE_LOOKS: usize = 8;

/// Their names, ARKit's.
pub const EYE_LOOK_NAMES: [&str; EYE_LOOKS] = [
    "eyeLookUpLeft",
    "eyeLookUpRight",
    "eyeLookDownLeft",
    "eyeLookDownRight",
    "eyeLookInLeft",
    "eyeLookInRight",
    "eyeLookOutLeft",
    "eyeLookOutRight",
];

impl Eyes {
    /// Nothing seen.
    pub const EMPTY: Eyes = Eyes {
        each: [Eye::EMPTY; 2],
        gaze: Err(EyeUnknown::NotSeen),
        glasses: None,
        dark_glasses: None,
        look: [0.0; EYE_LOOKS],
    };
}

impl Eyes {
    /// Zero bytes: what is not known yet of a tracker that is built in place.
    pub(in crate::track) const ZERO: Eyes = {
        let gaze = Ok(Gaze {
            camera: [0.0; 3],
            head: [0.0; 3],
            sigma_deg: 0.0,
        });
        let eye = Eye {
            open: Ok(0.0),
            iris: [0.0; 2],
            gaze,
        };
        Eyes {
            each: [eye; 2],
            gaze,
            ..Eyes::EMPTY
        }
    };
}

impl Eye {
    /// Nothing seen.
    pub const EMPTY: Eye = Eye::unknown(EyeUnknown::NotSeen, [0.0; 2]);

    /// An eye at this place of which nothing more is known.
    pub(super) const fn unknown(unknown: EyeUnknown, iris: [f32; 2]) -> Eye {
        Eye {
            open: Err(unknown),
            iris,
            gaze: Err(unknown),
        }
    }
}

impl Gaze {
    /// Of unit directions in the camera's and the head's frame, and a standard deviation \[deg\].
    pub const fn new(camera: [f32; 3], head: [f32; 3], sigma_deg: f32) -> Gaze {
        Gaze {
            camera,
            head,
            sigma_deg,
        }
    }
}

impl Default for Eyes {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Default for Eye {
    fn default() -> Self {
        Self::EMPTY
    }
}
