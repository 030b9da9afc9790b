//! What a monitor sees of one frame.

use crate::shape::SHUT;
use crate::track::{Eye, EyeUnknown, Eyes, Gaze, State, TrackResult};

/// One frame as a monitor sees it: a subset of [`TrackResult`]. A number that is not finite is
/// unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Observation {
    /// Only a face that is tracked is observed: a coasted one repeats an earlier frame.
    pub state: State,
    /// As [`TrackResult::confidence`].
    pub confidence: f32,
    /// Yaw relative to the camera's axes \[deg\], > 0: the face turns to the image right.
    pub yaw_deg: f32,
    /// Pitch relative to the camera's axes \[deg\], > 0: the face turns up.
    pub pitch_deg: f32,
    /// Midway between the eyeballs, camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Standard deviations of the rotation about the camera's axes \[deg\].
    pub rotation_sigma_deg: [f32; 3],
    /// Distance of the lids in that of open ones that look where these do, of the person's left
    /// and right eye: 0 shut, 1 open, below 0 unknown (`fused_openness`).
    pub eye_open: [f32; 2],
    /// Animation weight `jawOpen`, 0..1, below 0 unknown.
    pub jaw_open: f32,
    /// Unit gaze of both eyes, camera frame; zeros where it is unknown.
    pub gaze: [f32; 3],
    /// As [`TrackResult::camera_assumed`]: a natural pose that is learnt, and the angles from the
    /// road with it, are relative to the line of sight then.
    pub camera_assumed: bool,
}

impl Observation {
    /// No face.
    pub const NONE: Observation = Observation {
        state: State::Searching,
        confidence: 0.0,
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        translation_mm: [0.0; 3],
        rotation_sigma_deg: [0.0; 3],
        eye_open: [-1.0; 2],
        jaw_open: -1.0,
        gaze: [0.0; 3],
        camera_assumed: false,
    };
}

impl Default for Observation {
    fn default() -> Self {
        Self::NONE
    }
}

/// Index of `jawOpen` in [`crate::ANIMATION_NAMES`]; a test compares them.
const JAW_OPEN: usize = 9;
/// The landmarks of the mouth.
const MOUTH: core::ops::Range<usize> = 48..68;
/// Least mean visibility of the mouth's landmarks for a known `jaw_open`: a hand before the mouth
/// hides more than half of them.
const MOUTH_VISIBILITY: f32 = 0.5;

/// Openness of an eye by the logarithm of the odds that it is open, as the network has them:
/// medians on rendered clips. Half-shut lids are in between.
const BY_ODDS: [(f32, f32); 8] = [
    (-3.3, 0.0),
    (-2.9, 0.13),
    (-1.35, 0.25),
    (-0.4, 0.35),
    (1.0, 0.45),
    (2.1, 0.55),
    (3.75, 0.72),
    (4.2, 1.0),
];
/// Share of the network in the openness of an eye; the rest is that of the lids.
const NETWORK_SHARE: f32 = 0.5;
/// Where the network is less sure than these odds, and the lids are so far from what it says, the
/// eye is unknown.
const UNSURE_ODDS: f32 = 1.1;
const APART: f32 = 0.25;
/// An eye that is known alone needs better odds than these, and nearer lids if they are known.
const ALONE_ODDS: f32 = 2.0;
const ALONE_APART: f32 = 0.2;
/// Where a lens hides the other eye, the network is sure from these odds on, whatever the lids
/// are: landmarks err behind glasses.
const LENS_ODDS: f32 = 2.5;
/// There, lids and network that are both below this are shut.
const LENS_SHUT: f32 = 0.35;

/// Below this reading of the lids their distance falls steeply to 0 \[per reading\]: a reading of 0
/// is that of any distance that is shorter than [`SHUT`].
const STEEP: f32 = 4.0;

/// Distance of the lids in that of open ones, by the reading `eye_open`, which has 0 at [`SHUT`]
/// already. Lids that are shut by 80 % have 0.2 here, where P80 has its limit; they read 0.05.
fn distance(lids: f32) -> f32 {
    (SHUT + (1.0 - SHUT) * lids).min(STEEP * lids)
}

/// Openness by the probability that an eye is open, and the logarithm of its odds.
fn by_network(open: f32) -> (f32, f32) {
    let p = open.clamp(1e-3, 1.0 - 1e-3);
    let odds = libm::logf(p / (1.0 - p));
    let [(first, mut openness), ..] = BY_ODDS;
    let mut from = first;
    for (to, next) in BY_ODDS {
        let share = ((odds - from) / (to - from).max(1e-3)).clamp(0.0, 1.0);
        openness += share * (next - openness);
        from = to;
    }
    (openness, odds)
}

/// From so far down on \[deg, in the head\] lids follow a lowered gaze, and how far they have come
/// per degree: the upper lid of an eye that looks 30° down leaves half of the distance.
const LOWERED_FROM_DEG: f32 = 4.0;
const LOWERED_PER_DEG: f32 = 0.0188;
/// Least share of the distance of open lids that a gaze leaves.
const LOWERED_LEAST: f32 = 0.3;
/// Share of the network where the gaze is so far down \[deg\]: lids tell little there.
const LOWERED_SHARE: f32 = 0.8;
const LOWERED_SHARE_DEG: f32 = 14.0;

/// How lids count that follow a gaze.
#[derive(Clone, Copy)]
struct Lowered {
    /// Distance of lids that are open, as far as the gaze lets them, in that of an eye that looks
    /// ahead.
    allowed: f32,
    /// Share of the network in the openness of an eye.
    network_share: f32,
}

impl Lowered {
    fn new(gaze: &Gaze) -> Lowered {
        let [_, down, _] = gaze.head;
        let down_deg = libm::asinf(down.clamp(-1.0, 1.0)).to_degrees() - LOWERED_FROM_DEG;
        let share = (down_deg / (LOWERED_SHARE_DEG - LOWERED_FROM_DEG)).clamp(0.0, 1.0);
        Lowered {
            allowed: (1.0 - LOWERED_PER_DEG * down_deg).clamp(LOWERED_LEAST, 1.0),
            network_share: NETWORK_SHARE + (LOWERED_SHARE - NETWORK_SHARE) * share,
        }
    }
}

/// Openness of an eye, below 0 unknown, by what is known of the other eye.
#[derive(Clone, Copy)]
struct Openness {
    /// Where the other is known too.
    with_other: f32,
    /// Where the other is unknown.
    alone: f32,
    /// Where a lens hides the other: dark glasses or a reflection.
    beside_lens: f32,
}

impl Openness {
    /// The same whatever is known of the other.
    const fn always(openness: f32) -> Openness {
        Openness {
            with_other: openness,
            alone: openness,
            beside_lens: openness,
        }
    }

    /// By the lids, which follow the gaze, and the network.
    fn new(lids: f32, eye: &Eye, lowered: Lowered) -> Openness {
        let lids = if lids > 0.0 { distance(lids) } else { lids };
        match eye.unknown {
            None => Openness::of_seen(lids, eye.open, lowered),
            Some(
                EyeUnknown::DarkGlasses
                | EyeUnknown::Glare
                | EyeUnknown::Hidden
                | EyeUnknown::Uncertain,
            ) => Openness::always(-1.0),
            _ => Openness::always(lids),
        }
    }

    /// Of an eye that the network sees, by the distance of the lids and the probability that it is
    /// open.
    fn of_seen(lids: f32, open: f32, lowered: Lowered) -> Openness {
        let (network, odds) = by_network(open);
        let sure_from = |least: f32| odds.abs() >= least;
        let only_if = |is: bool, openness: f32| if is { openness } else { -1.0 };
        if lids < 0.0 {
            return Openness::always(only_if(sure_from(ALONE_ODDS), network));
        }
        let lids = (lids / lowered.allowed).min(1.0);
        let apart = (network - lids).abs();
        let mean = lids + lowered.network_share * (network - lids);
        let with_other = only_if(sure_from(UNSURE_ODDS) || apart <= APART, mean);
        let alone = only_if(sure_from(ALONE_ODDS) && apart <= ALONE_APART, mean);
        let are_shut = sure_from(UNSURE_ODDS) && network.max(lids) < LENS_SHUT;
        let beside_lens = match alone < 0.0 && sure_from(LENS_ODDS) {
            true => network,
            false if are_shut => mean,
            false => alone,
        };
        Openness {
            with_other,
            alone,
            beside_lens,
        }
    }
}

/// Openness of the left and the right eye by their lids and by the network that sees them. Behind
/// dark glasses and reflections and where something covers it, an eye is unknown, −1, as it is
/// where the network is not sure and contradicts the lids; one that is known alone sooner than two,
/// unless it is a lens that hides the other.
pub fn fused_openness(lids: [f32; 2], eyes: &Eyes) -> [f32; 2] {
    let ([left_lids, right_lids], [left_eye, right_eye]) = (lids, &eyes.each);
    let lowered = Lowered::new(&eyes.gaze);
    let left = Openness::new(left_lids, left_eye, lowered);
    let right = Openness::new(right_lids, right_eye, lowered);
    let beside = |this: Openness, other: Openness, other_eye: &Eye| match other_eye.unknown {
        _ if other.with_other >= 0.0 => this.with_other,
        Some(EyeUnknown::DarkGlasses | EyeUnknown::Glare) => this.beside_lens,
        _ => this.alone,
    };
    [
        beside(left, right, right_eye),
        beside(right, left, left_eye),
    ]
}

impl From<&TrackResult> for Observation {
    fn from(result: &TrackResult) -> Self {
        let mouth = result.landmarks.get(MOUTH).unwrap_or_default();
        let visibility: f32 = mouth.iter().map(|landmark| landmark.visibility).sum();
        let is_visible = visibility >= MOUTH_VISIBILITY * MOUTH.len() as f32;
        let jaw_open = result.animation.get(JAW_OPEN).filter(|_| is_visible);
        Observation {
            state: result.state,
            confidence: result.confidence,
            yaw_deg: result.yaw_deg,
            pitch_deg: result.pitch_deg,
            translation_mm: result.translation_mm,
            rotation_sigma_deg: result.rotation_sigma_deg,
            eye_open: fused_openness(result.eye_open, &result.eyes),
            jaw_open: jaw_open.copied().unwrap_or(-1.0),
            gaze: result.eyes.gaze.camera,
            camera_assumed: result.camera_assumed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jaw_is_where_the_names_say() {
        assert_eq!(crate::shape::ANIMATION_NAMES[JAW_OPEN], "jawOpen");
    }

    #[test]
    fn lids_and_network_are_fused() {
        let eye = |unknown, open| Eye {
            unknown,
            open,
            ..Eye::EMPTY
        };
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} {b}");
        let of = |lids: [f32; 2], each: [Eye; 2]| {
            let eyes = Eyes {
                each,
                ..Eyes::EMPTY
            };
            fused_openness(lids, &eyes)
        };
        let both = |lids: f32, eye: Eye| of([lids; 2], [eye; 2])[0];
        near(both(0.4, eye(Some(EyeUnknown::NotSeen), 0.0)), 0.496);
        near(both(0.04, eye(Some(EyeUnknown::NotSeen), 0.0)), 0.16);
        assert_eq!(both(0.0, eye(Some(EyeUnknown::NotSeen), 0.0)), 0.0);
        for hides in [
            EyeUnknown::DarkGlasses,
            EyeUnknown::Glare,
            EyeUnknown::Hidden,
            EyeUnknown::Uncertain,
        ] {
            assert_eq!(both(0.1, eye(Some(hides), 0.0)), -1.0);
        }
        near(both(0.0, eye(None, 0.0)), 0.0);
        near(both(1.0, eye(None, 1.0)), 1.0);
        near(both(0.0, eye(None, 1.0)), 0.5);
        // Odds of 1: half shut.
        assert_eq!(both(1.0, eye(None, 0.5)), -1.0);
        let half = both(0.4, eye(None, 0.5));
        assert!((0.4..0.5).contains(&half), "{half}");
        // Hidden landmarks: the network alone, if it is sure.
        near(both(-1.0, eye(None, 1.0)), 1.0);
        assert_eq!(both(-1.0, eye(None, 0.6)), -1.0);
        let one = |lids: f32, open: f32| {
            let eyes = [eye(None, open), eye(Some(EyeUnknown::Hidden), 0.0)];
            of([lids, -1.0], eyes)
        };
        near(one(0.0, 0.01)[0], 0.0);
        assert_eq!(one(0.4, 0.5), [-1.0; 2]);
        assert_eq!(one(0.4, 0.01), [-1.0; 2]);
        let beside_lens = |lids: f32, open: f32| {
            let eyes = [eye(None, open), eye(Some(EyeUnknown::Glare), 0.0)];
            of([lids, -1.0], eyes)
        };
        near(beside_lens(0.4, 0.01)[0], 0.0);
        near(beside_lens(0.0, 0.15)[0], 0.11011);
        assert_eq!(beside_lens(0.4, 0.2), [-1.0; 2]);
    }

    #[test]
    fn lids_that_follow_a_lowered_gaze_are_open() {
        let lowered = |down_deg: f32, lids: f32, open: f32| {
            let (down, level) = (down_deg.to_radians().sin(), down_deg.to_radians().cos());
            let eye = Eye {
                unknown: None,
                open,
                ..Eye::EMPTY
            };
            let mut eyes = Eyes {
                each: [eye; 2],
                ..Eyes::EMPTY
            };
            (eyes.gaze.unknown, eyes.gaze.head) = (None, [0.0, down, -level]);
            fused_openness([lids; 2], &eyes)[0]
        };
        // A reading of 0.1 is a distance of 0.24.
        assert!(lowered(0.0, 0.1, 0.97) < 0.5);
        assert!(lowered(40.0, 0.1, 0.97) > 0.7);
        assert!(lowered(40.0, 0.0, 0.01) < 0.01, "shut");
    }

    #[test]
    fn a_hidden_mouth_is_unknown() {
        let mut result = TrackResult::EMPTY;
        result.animation[JAW_OPEN] = 0.7;
        assert_eq!(Observation::from(&result).jaw_open, -1.0);
        for landmark in &mut result.landmarks[48..60] {
            landmark.visibility = 1.0;
        }
        assert_eq!(Observation::from(&result).jaw_open, 0.7);
    }
}
