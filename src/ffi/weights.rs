//! Indices of the weights of `include/posewise.h`, by ARKit's names. As for `types`, the comments
//! are written for the C reader; a test compares them with the names that the functions give.

/// The left brow goes down.
pub const POSEWISE_ANIMATION_BROW_DOWN_LEFT: u32 = 0;
/// The right brow goes down.
pub const POSEWISE_ANIMATION_BROW_DOWN_RIGHT: u32 = 1;
/// The inner ends of the brows go up.
pub const POSEWISE_ANIMATION_BROW_INNER_UP: u32 = 2;
/// The outer end of the left brow goes up.
pub const POSEWISE_ANIMATION_BROW_OUTER_UP_LEFT: u32 = 3;
/// The outer end of the right brow goes up.
pub const POSEWISE_ANIMATION_BROW_OUTER_UP_RIGHT: u32 = 4;
/// The left eye shuts.
pub const POSEWISE_ANIMATION_EYE_BLINK_LEFT: u32 = 5;
/// The right eye shuts.
pub const POSEWISE_ANIMATION_EYE_BLINK_RIGHT: u32 = 6;
/// The left eye opens wide.
pub const POSEWISE_ANIMATION_EYE_WIDE_LEFT: u32 = 7;
/// The right eye opens wide.
pub const POSEWISE_ANIMATION_EYE_WIDE_RIGHT: u32 = 8;
/// The jaw opens.
pub const POSEWISE_ANIMATION_JAW_OPEN: u32 = 9;
/// The jaw goes to the left.
pub const POSEWISE_ANIMATION_JAW_LEFT: u32 = 10;
/// The jaw goes to the right.
pub const POSEWISE_ANIMATION_JAW_RIGHT: u32 = 11;
/// The lips form an open ring.
pub const POSEWISE_ANIMATION_MOUTH_FUNNEL: u32 = 12;
/// The lips are pushed together.
pub const POSEWISE_ANIMATION_MOUTH_PUCKER: u32 = 13;
/// The left mouth corner goes up.
pub const POSEWISE_ANIMATION_MOUTH_SMILE_LEFT: u32 = 14;
/// The right mouth corner goes up.
pub const POSEWISE_ANIMATION_MOUTH_SMILE_RIGHT: u32 = 15;
/// The left mouth corner goes down.
pub const POSEWISE_ANIMATION_MOUTH_FROWN_LEFT: u32 = 16;
/// The right mouth corner goes down.
pub const POSEWISE_ANIMATION_MOUTH_FROWN_RIGHT: u32 = 17;
/// The left mouth corner goes outwards.
pub const POSEWISE_ANIMATION_MOUTH_STRETCH_LEFT: u32 = 18;
/// The right mouth corner goes outwards.
pub const POSEWISE_ANIMATION_MOUTH_STRETCH_RIGHT: u32 = 19;
/// The left of the upper lip goes up.
pub const POSEWISE_ANIMATION_MOUTH_UPPER_UP_LEFT: u32 = 20;
/// The right of the upper lip goes up.
pub const POSEWISE_ANIMATION_MOUTH_UPPER_UP_RIGHT: u32 = 21;
/// The left of the lower lip goes down.
pub const POSEWISE_ANIMATION_MOUTH_LOWER_DOWN_LEFT: u32 = 22;
/// The right of the lower lip goes down.
pub const POSEWISE_ANIMATION_MOUTH_LOWER_DOWN_RIGHT: u32 = 23;
/// The cheeks are puffed out.
pub const POSEWISE_ANIMATION_CHEEK_PUFF: u32 = 24;
/// The lips close over an open jaw.
pub const POSEWISE_ANIMATION_MOUTH_CLOSE: u32 = 25;
/// The lips go to the left.
pub const POSEWISE_ANIMATION_MOUTH_LEFT: u32 = 26;
/// The lips go to the right.
pub const POSEWISE_ANIMATION_MOUTH_RIGHT: u32 = 27;
/// The lower lip is rolled inwards.
pub const POSEWISE_ANIMATION_MOUTH_ROLL_LOWER: u32 = 28;

/// The left eye looks up.
pub const POSEWISE_EYE_LOOK_UP_LEFT: u32 = 0;
/// The right eye looks up.
pub const POSEWISE_EYE_LOOK_UP_RIGHT: u32 = 1;
/// The left eye looks down.
pub const POSEWISE_EYE_LOOK_DOWN_LEFT: u32 = 2;
/// The right eye looks down.
pub const POSEWISE_EYE_LOOK_DOWN_RIGHT: u32 = 3;
/// The left eye looks towards the nose.
pub const POSEWISE_EYE_LOOK_IN_LEFT: u32 = 4;
/// The right eye looks towards the nose.
pub const POSEWISE_EYE_LOOK_IN_RIGHT: u32 = 5;
/// The left eye looks away from the nose.
pub const POSEWISE_EYE_LOOK_OUT_LEFT: u32 = 6;
/// The right eye looks away from the nose.
pub const POSEWISE_EYE_LOOK_OUT_RIGHT: u32 = 7;
