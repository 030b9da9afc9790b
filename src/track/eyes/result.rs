//! What a result says of the eyes.

/// Why something of an eye is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    pub fn name_of(unknown: Option<EyeUnknown>) -> &'static str {
        unknown.map_or("known", EyeUnknown::name)
    }
}

/// A gaze.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gaze {
    /// Why it is unknown, if it is; all other numbers are 0 then.
    pub unknown: Option<EyeUnknown>,
    /// Unit direction in which the eye looks, camera frame.
    pub camera: [f32; 3],
    /// The same in the head frame: −z is where the nose points.
    pub head: [f32; 3],
    /// Standard deviation about each axis that is perpendicular to it \[deg\].
    pub sigma_deg: f32,
}

/// What is known of one eye.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Eye {
    /// Why the state of the lids is unknown, if it is.
    pub unknown: Option<EyeUnknown>,
    /// Calibrated probability that the eye is open, 0..1; −1 where it is unknown.
    pub open: f32,
    /// Middle of the iris \[px of the upright frame\]; that of the eye where the gaze is unknown.
    pub iris: [f32; 2],
    /// Where it looks.
    pub gaze: Gaze,
}

/// What is known of both eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Eyes {
    /// The person's left and right eye.
    pub each: [Eye; 2],
    /// The gaze of both eyes together, or of the one whose gaze is known.
    pub gaze: Gaze,
    /// Probability that the person wears glasses, 0..1; −1 where no eye is seen.
    pub glasses: f32,
    /// Probability that these are dark, 0..1; −1 where no eye is seen.
    pub dark_glasses: f32,
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
        gaze: Gaze::EMPTY,
        glasses: 0.0,
        dark_glasses: 0.0,
        look: [0.0; EYE_LOOKS],
    };
}

impl Eye {
    /// Nothing seen.
    pub const EMPTY: Eye = Eye {
        unknown: Some(EyeUnknown::NotSeen),
        open: 0.0,
        iris: [0.0; 2],
        gaze: Gaze::EMPTY,
    };

    /// An eye at this place of which nothing more is known.
    pub(super) fn unknown(unknown: EyeUnknown, iris: [f32; 2]) -> Eye {
        Eye {
            unknown: Some(unknown),
            open: -1.0,
            iris,
            gaze: Gaze::unknown(unknown),
        }
    }
}

impl Gaze {
    /// Nothing seen.
    pub const EMPTY: Gaze = Gaze {
        unknown: Some(EyeUnknown::NotSeen),
        camera: [0.0; 3],
        head: [0.0; 3],
        sigma_deg: 0.0,
    };

    pub(super) fn unknown(unknown: EyeUnknown) -> Gaze {
        Gaze {
            unknown: Some(unknown),
            ..Gaze::EMPTY
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

impl Default for Gaze {
    fn default() -> Self {
        Self::EMPTY
    }
}
