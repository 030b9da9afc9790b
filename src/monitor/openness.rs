//! How far eyes are open, by lids, by the network that sees each eye, and by where they look.

use crate::shape::SHUT;
use crate::track::{Eye, EyeUnknown, Eyes, Gaze};

/// Openness of an eye by the logarithm of the odds that it is open, as the network has them:
/// medians on rendered clips. Half-shut lids are in between.
const BY_ODDS: [(f32, f32); 9] = [
    (-3.2, 0.0),
    (-2.0, 0.15),
    (-0.15, 0.25),
    (1.15, 0.35),
    (2.6, 0.45),
    (3.1, 0.55),
    (3.35, 0.66),
    (3.6, 0.78),
    (3.7, 1.0),
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

/// The logarithm of the odds of a probability.
fn odds(p: f32) -> f32 {
    let p = p.clamp(1e-3, 1.0 - 1e-3);
    libm::logf(p / (1.0 - p))
}

/// Openness by the logarithm of the odds that an eye is open.
fn by_network(odds: f32) -> f32 {
    let [(first, mut openness), ..] = BY_ODDS;
    let mut from = first;
    for (to, next) in BY_ODDS {
        let share = ((odds - from) / (to - from).max(1e-3)).clamp(0.0, 1.0);
        openness += share * (next - openness);
        from = to;
    }
    openness
}

/// From so far down on \[deg, in the head\] lids follow a lowered gaze, and how far they have come
/// per degree: the upper lid of an eye that looks 30° down leaves half of the distance.
const LOWERED_FROM_DEG: f32 = 4.0;
const LOWERED_PER_DEG: f32 = 0.0188;
/// Least share of the distance of open lids that a gaze leaves.
const LOWERED_LEAST: f32 = 0.3;
/// Lids count as lowered from this pitch of the gaze \[deg\], or below this distance, in part from
/// the other one on.
const LOWERED_DEG: f32 = 14.0;
const LOW: f32 = 0.3;
const LOW_FROM: f32 = 0.6;
/// Share of the network in the openness of a lowered eye: lids tell little there.
const LOWERED_SHARE: f32 = 0.8;
/// How much less sure the network is of open eyes that look down \[logarithm of the odds\].
const LOWERED_ODDS: f32 = 1.2;
/// An eye that is open by these odds says the same of the other one, because lids move together.
/// From above or the side, lashes and lids hide what is open of the farther one.
const SURE_OPEN_ODDS: f32 = 1.7;
/// Lids of both eyes that are nearer than this are shut, if by these odds one eye is: what the
/// network says of the other counts for less than three that agree.
const SHUT_DISTANCE: f32 = 0.25;
const SURE_SHUT_ODDS: f32 = -1.7;
/// Lids that are as good as shut, and odds above which neither eye need be: it may look down.
const SHUT_LIDS: f32 = 0.35;
const MAYBE_OPEN_ODDS: f32 = -2.0;

/// How the lids of an eye count.
#[derive(Clone, Copy)]
struct Lids {
    /// Their distance in that of open ones that look where these do, if it is known.
    distance: Option<f32>,
    /// 0 for those of an eye that looks ahead, 1 for those that follow a lowered gaze.
    lowered: f32,
}

impl Lids {
    /// By the reading `eye_open`.
    fn new(reading: Option<f32>, gaze: Option<&Gaze>) -> Lids {
        let (Some(reading), Some(gaze)) = (reading, gaze) else {
            return Lids {
                distance: reading.map(distance),
                lowered: 0.0,
            };
        };
        let [_, down, _] = gaze.head;
        let down_deg = libm::asinf(down.clamp(-1.0, 1.0)).to_degrees() - LOWERED_FROM_DEG;
        let allowed = (1.0 - LOWERED_PER_DEG * down_deg).clamp(LOWERED_LEAST, 1.0);
        let distance = (distance(reading) / allowed).min(1.0);
        let by_gaze = down_deg / (LOWERED_DEG - LOWERED_FROM_DEG);
        // A gaze is known of open eyes alone: lids that are low all the same follow it, or laugh.
        let by_lids = (LOW_FROM - distance) / (LOW_FROM - LOW);
        Lids {
            distance: Some(distance),
            lowered: by_gaze.max(by_lids).clamp(0.0, 1.0),
        }
    }
}

/// Openness of an eye, where it is known, by what is known of the other eye.
#[derive(Clone, Copy)]
struct OfEye {
    /// Where the other is known too.
    with_other: Option<f32>,
    /// Where the other is unknown.
    alone: Option<f32>,
    /// Where a lens hides the other: dark glasses or a reflection.
    beside_lens: Option<f32>,
}

impl OfEye {
    /// The same whatever is known of the other.
    const fn always(openness: Option<f32>) -> OfEye {
        OfEye {
            with_other: openness,
            alone: openness,
            beside_lens: openness,
        }
    }

    /// By the lids and the network; `are_shut`: those of both eyes are.
    fn new(lids: &Lids, eye: &Eye, other: &Eye, are_shut: bool) -> OfEye {
        match eye.open {
            Ok(open) => {
                let (own, others) = (odds(open), odds(other.open.unwrap_or(open)));
                let odds = match others >= SURE_OPEN_ODDS {
                    _ if are_shut => own.min(others),
                    true => own.max(others),
                    false => own,
                };
                OfEye::of_seen(lids, odds)
            }
            Err(
                EyeUnknown::DarkGlasses
                | EyeUnknown::Glare
                | EyeUnknown::Hidden
                | EyeUnknown::Uncertain,
            ) => OfEye::always(None),
            Err(_) => OfEye::always(lids.distance),
        }
    }

    /// Of an eye that the network sees, by the lids and the logarithm of the odds that it is open.
    fn of_seen(lids: &Lids, odds: f32) -> OfEye {
        let network = by_network(odds + LOWERED_ODDS * lids.lowered);
        let sure_from = |least: f32| odds.abs() >= least;
        let Some(distance) = lids.distance else {
            return OfEye::always(sure_from(ALONE_ODDS).then_some(network));
        };
        let apart = (network - distance).abs();
        let share = NETWORK_SHARE + (LOWERED_SHARE - NETWORK_SHARE) * lids.lowered;
        let mean = distance + share * (network - distance);
        let is_sure = sure_from(UNSURE_ODDS) || apart <= APART;
        let with_other = is_sure.then_some(mean);
        let alone = (sure_from(ALONE_ODDS) && apart <= ALONE_APART).then_some(mean);
        let are_shut = sure_from(UNSURE_ODDS) && network.max(distance) < LENS_SHUT;
        let beside_lens = match alone.is_none() && sure_from(LENS_ODDS) {
            true => Some(network),
            false if are_shut => Some(mean),
            false => alone,
        };
        OfEye {
            with_other,
            alone,
            beside_lens,
        }
    }
}

/// How far both eyes are open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Openness {
    /// Distance of the lids of the left and the right eye in that of open ones that look where
    /// these do, where it is known.
    pub eye_open: [Option<f32>; 2],
    /// Both eyes are shut, though a gaze may seem to be known.
    pub are_shut: bool,
    /// No lids are known to be open and the gaze is unknown, but the network is not sure that they
    /// are shut: they may follow a lowered gaze.
    pub may_look_down: bool,
}

/// Whether the lids of both eyes are shut and the network is sure of one. Lids move together.
fn are_shut(lids: &[Option<f32>; 2], eyes: &[Eye; 2]) -> bool {
    let are_near = (lids.iter()).all(|lids| lids.is_some_and(|d| distance(d) < SHUT_DISTANCE));
    let [left, right] = eyes.each_ref().map(|eye| eye.open.ok().map(odds));
    let is_sure = |left: f32, right: f32| left.min(right) <= SURE_SHUT_ODDS;
    are_near && left.zip(right).is_some_and(|(l, r)| is_sure(l, r))
}

/// Openness by the lids and by the network that sees them. Behind dark glasses and reflections and
/// where something covers it, an eye is unknown, as it is where the network is not sure and
/// contradicts the lids; one that is known alone sooner than two, unless it is a lens that hides
/// the other. Lids that follow a gaze that is known are open.
pub fn openness(lids: [Option<f32>; 2], eyes: &Eyes) -> Openness {
    let [left_eye, right_eye] = &eyes.each;
    let are_shut = are_shut(&lids, &eyes.each);
    let gaze = eyes.gaze.as_ref().ok().filter(|_| !are_shut);
    let lids = lids.map(|reading| Lids::new(reading, gaze));
    let left = OfEye::new(&lids[0], left_eye, right_eye, are_shut);
    let right = OfEye::new(&lids[1], right_eye, left_eye, are_shut);
    let beside = |this: OfEye, other: OfEye, other_eye: &Eye| match other_eye.open {
        _ if other.with_other.is_some() => this.with_other,
        Err(EyeUnknown::DarkGlasses | EyeUnknown::Glare) => this.beside_lens,
        _ => this.alone,
    };
    let seem_shut = |lids: &Lids| lids.distance.is_none_or(|distance| distance < SHUT_LIDS);
    Openness {
        eye_open: [
            beside(left, right, right_eye),
            beside(right, left, left_eye),
        ],
        are_shut,
        may_look_down: eyes.gaze.is_err()
            && lids.iter().all(seem_shut)
            && (eyes.each.iter().flat_map(|eye| eye.open)).any(|open| odds(open) > MAYBE_OPEN_ODDS),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eyes whose gaze is known, so far down.
    fn looking(each: [Eye; 2], down_deg: f32) -> Eyes {
        let (down, level) = down_deg.to_radians().sin_cos();
        let mut eyes = Eyes {
            each,
            ..Eyes::EMPTY
        };
        let head = [0.0, down, -level];
        eyes.gaze = Ok(Gaze {
            camera: head,
            head,
            sigma_deg: 5.0,
        });
        eyes
    }

    #[test]
    fn lids_and_network_are_fused() {
        let eye = |open| Eye { open, ..Eye::EMPTY };
        let near = |a: Option<f32>, b: f32| assert!((a.unwrap() - b).abs() < 1e-5, "{a:?} {b}");
        let of = |lids, each| openness(lids, &looking(each, 0.0)).eye_open;
        let both = |lids, eye: Eye| of([lids; 2], [eye; 2])[0];
        near(both(Some(0.4), eye(Err(EyeUnknown::NotSeen))), 0.496);
        near(both(Some(0.04), eye(Err(EyeUnknown::NotSeen))), 0.16);
        assert_eq!(both(Some(0.0), eye(Err(EyeUnknown::NotSeen))), Some(0.0));
        for hides in [
            EyeUnknown::DarkGlasses,
            EyeUnknown::Glare,
            EyeUnknown::Hidden,
            EyeUnknown::Uncertain,
        ] {
            assert_eq!(both(Some(0.1), eye(Err(hides))), None);
        }
        near(both(Some(0.0), eye(Ok(0.0))), 0.0);
        near(both(Some(1.0), eye(Ok(1.0))), 1.0);
        near(both(Some(0.0), eye(Ok(1.0))), 0.8);
        // The gaze is unknown: they may look down.
        let unknown = Eyes {
            each: [eye(Ok(1.0)); 2],
            ..Eyes::EMPTY
        };
        let seen = openness([Some(0.0); 2], &unknown);
        assert!(seen.may_look_down);
        near(seen.eye_open[0], 0.5);
        assert!(!openness([Some(0.6); 2], &unknown).may_look_down);
        // Lids move together: one eye is surely open.
        let apart = |other: f32| of([Some(0.5); 2], [eye(Ok(0.93)), eye(Ok(other))]);
        assert_eq!(apart(0.2)[0], apart(0.2)[1]);
        assert!(apart(0.2)[1] > Some(0.45));
        // Odds of 1: half shut.
        assert_eq!(both(Some(1.0), eye(Ok(0.5))), None);
        let half = both(Some(0.4), eye(Ok(0.5)));
        assert!(
            half.is_some_and(|half| (0.35..0.4).contains(&half)),
            "{half:?}"
        );
        // Hidden landmarks: the network alone, if it is sure.
        near(both(None, eye(Ok(1.0))), 1.0);
        assert_eq!(both(None, eye(Ok(0.6))), None);
        let one = |lids: f32, open: f32| {
            let eyes = [eye(Ok(open)), eye(Err(EyeUnknown::Hidden))];
            of([Some(lids), None], eyes)
        };
        near(one(0.0, 0.01)[0], 0.0);
        assert_eq!(one(0.4, 0.5), [None; 2]);
        assert_eq!(one(0.4, 0.01), [None; 2]);
        let beside_lens = |lids: f32, open: f32| {
            let eyes = [eye(Ok(open)), eye(Err(EyeUnknown::Glare))];
            of([Some(lids), None], eyes)
        };
        near(beside_lens(0.4, 0.01)[0], 0.0);
        near(beside_lens(0.0, 0.15)[0], 0.18337);
        assert_eq!(beside_lens(0.4, 0.2), [None; 2]);
    }

    #[test]
    fn lids_of_both_eyes_and_one_network_outvote_the_other() {
        let of = |lids, open: [f32; 2]| {
            let each = open.map(|open| Eye {
                open: Ok(open),
                ..Eye::EMPTY
            });
            openness(lids, &looking(each, 18.0))
        };
        let shut = of([Some(0.0), Some(0.04)], [0.05, 0.96]);
        assert!(shut.are_shut);
        assert!(shut.eye_open.iter().flatten().all(|open| *open < 0.2));
        // One lid is not shut, or the network is not sure, or one eye is hidden.
        for (lids, open) in [
            ([Some(0.0), Some(0.15)], [0.05, 0.96]),
            ([Some(0.0), Some(0.0)], [0.3, 0.96]),
            ([Some(0.0), None], [0.05, 0.96]),
        ] {
            let seen = of(lids, open);
            assert!(!seen.are_shut && seen.eye_open[0] > Some(0.35), "{seen:?}");
        }
    }

    #[test]
    fn lids_that_follow_a_lowered_gaze_are_open() {
        let lowered = |down_deg: f32, lids: f32, open: f32| {
            let eye = Eye {
                open: Ok(open),
                ..Eye::EMPTY
            };
            let seen = openness([Some(lids); 2], &looking([eye; 2], down_deg));
            seen.eye_open[0].unwrap()
        };
        // A reading of 0.1 is a distance of 0.24.
        assert!(
            lowered(0.0, 0.1, 0.97) > 0.7,
            "they laugh, or the gaze is lower than it seems"
        );
        assert!(lowered(40.0, 0.1, 0.97) > 0.7);
        assert!(lowered(40.0, 0.0, 0.01) < 0.01, "shut");
    }
}
