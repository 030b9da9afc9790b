//! What a driver does, and when.

use super::super::motion::Moment;
use super::plan::{Clip, Condition, Recipe, TARGETS};
use glam::Vec3;
use posewise::math::HeadAngles;
use posewise_train::render::noise::smoothstep;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::TAU;

/// Least time between what a driver does \[s\].
const APART_S: f32 = 0.35;
/// The share of its way, by [`smoothstep`], at which a lid has the weight of 0.8 from which on the
/// truth has it closed.
const CLOSED_AT: f32 = 0.713;
/// How much of their small jumps eyes still do while they look at something.
const FIXED: f32 = 0.3;
/// How far the head sinks behind the wheel \[mm\].
const SLUMP_MM: f32 = 95.0;
/// How far it sinks when the driver stoops \[mm\]: in the widest view that is out of the picture.
const DUCK_MM: f32 = 620.0;

/// Something a driver does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// Lids close.
    Close,
    /// Head and eyes turn away and come back.
    Glance,
    /// The eyes turn away and come back, and the head hardly moves.
    Look,
    /// The mouth opens wide.
    Yawn,
    /// The head drops with closed eyes.
    Nod,
    /// The mouth moves.
    Talk,
    /// The driver laughs, with narrowed eyes.
    Laugh,
    /// A hand comes before the face, or the driver slumps behind the wheel.
    Cover,
    /// The driver stoops out of the picture.
    Duck,
}

/// It, and when.
#[derive(Clone, Copy, Debug)]
pub struct Act {
    pub what: What,
    pub start_s: f32,
    /// It grows for the first time, stays for the second one, and goes within the third \[s\].
    pub times_s: [f32; 3],
    /// Turn of the head in yaw and pitch \[deg\].
    pub turn_deg: [f32; 2],
    /// Turn of the eyes in the head, to the image right and down \[deg\].
    pub gaze_deg: [f32; 2],
    /// Greatest weight of lids or jaw.
    pub weight: f32,
}

impl Act {
    fn new(what: What, times_s: [f32; 3]) -> Act {
        Act {
            what,
            start_s: 0.0,
            times_s,
            turn_deg: [0.0; 2],
            gaze_deg: [0.0; 2],
            weight: 1.0,
        }
    }

    pub fn length_s(&self) -> f32 {
        self.times_s.iter().sum()
    }

    /// How much of it there is at a time, 0..1.
    fn at(&self, t: f32) -> f32 {
        let [grows, stays, goes] = self.times_s;
        let end = self.start_s + grows + stays;
        smoothstep(self.start_s, self.start_s + grows, t) * (1.0 - smoothstep(end, end + goes, t))
    }

    /// Lids whose weight is at least 0.8 for so long.
    fn closure(rng: &mut ChaCha8Rng, length_s: f32) -> Act {
        let slow = if length_s > 0.6 { 2.0 } else { 1.0 };
        let (down, up) = (
            slow * rng.random_range(0.08..0.12f32),
            slow * rng.random_range(0.1..0.2f32),
        );
        let stays = (length_s - (1.0 - CLOSED_AT) * (down + up)).max(0.0);
        Act::new(What::Close, [down, stays, up])
    }

    fn glance(turn_deg: [f32; 2], gaze_deg: [f32; 2], stays_s: f32, degrees_a_second: f32) -> Act {
        let way = turn_deg[0].hypot(turn_deg[1]);
        let time = (way / degrees_a_second).max(0.25);
        Act {
            turn_deg,
            gaze_deg,
            ..Act::new(What::Glance, [time, stays_s, time])
        }
    }
}

/// The whole script.
pub struct Script {
    road_deg: [f32; 2],
    pub acts: Vec<Act>,
    /// Lids that are open \[weight\], and their droop.
    lids: f32,
    droop: f32,
    /// Phases of slow movements.
    phases: [f32; 8],
    /// When the eyes jump, and where to \[deg\].
    jumps: Vec<(f32, [f32; 2])>,
    is_slumping: bool,
    /// Something is before the face throughout.
    is_covered: bool,
}

impl Script {
    /// A random one.
    pub fn new(rng: &mut ChaCha8Rng, clip: &Clip) -> Script {
        let length_s = clip.sweep.frames as f32 / clip.sweep.fps as f32;
        let (recipe, cover) = (clip.condition.recipe(), clip.sweep.kind.cover());
        // A recipe is for a minute.
        let minutes = ((length_s / 60.0).round() as usize).max(1);
        let acts = (0..minutes).flat_map(|_| acts(rng, &recipe, clip));
        let mut acts: Vec<Act> = acts.collect();
        acts.shuffle(rng);
        lay_out(rng, &mut acts, length_s);
        add_blinks(rng, &mut acts, length_s);
        let mut jumps = Vec::new();
        let mut at = 0.0;
        while at < length_s {
            let to = [rng.random_range(-6.0..6.0), rng.random_range(-3.0..4.0)];
            jumps.push((at, to));
            at += rng.random_range(0.5..2.5f32);
        }
        Script {
            road_deg: clip.road_deg,
            acts,
            lids: rng.random_range(0.0..0.12),
            droop: recipe.droop,
            phases: std::array::from_fn(|_| rng.random_range(0.0..TAU)),
            jumps,
            is_slumping: clip.condition == Condition::Wheel,
            is_covered: clip.condition == Condition::Mask
                || cover.is_some_and(|cover| cover.is_worn_throughout()),
        }
    }

    /// Whether the driver does something of a kind.
    pub fn does(&self, what: What, t: f32) -> bool {
        let within = |act: &&Act| (act.start_s..act.start_s + act.length_s()).contains(&t);
        self.acts.iter().filter(within).any(|act| act.what == what)
    }

    /// Yaw and pitch of the head from the direction of the road \[deg\].
    pub fn off_road_deg(&self, t: f32) -> [f32; 2] {
        let slow = |k: usize, size: f32, hertz: f32| {
            size * (TAU * hertz * t + self.phases[k % self.phases.len()]).sin()
        };
        let mut turn = [
            slow(0, 2.0, 0.11) + slow(1, 0.8, 0.37),
            slow(2, 1.5, 0.09) + slow(3, 0.5, 1.3),
        ];
        for act in &self.acts {
            let share = act.at(t);
            turn[0] += share * act.turn_deg[0];
            turn[1] += share * act.turn_deg[1];
        }
        turn
    }

    /// The moment `t` seconds after the start.
    pub fn at(&self, t: f32) -> Moment {
        let slow = |k: usize, size: f32, hertz: f32| {
            size * (TAU * hertz * t + self.phases[k % self.phases.len()]).sin()
        };
        let [yaw, pitch] = self.off_road_deg(t);
        let sum = |what: What| -> f32 {
            let of = self.acts.iter().filter(|act| act.what == what);
            of.map(|act| act.at(t) * act.weight).fold(0.0, f32::max)
        };
        let (yawn, nod, talk, laugh, cover) = (
            sum(What::Yawn),
            sum(What::Nod),
            sum(What::Talk),
            sum(What::Laugh),
            sum(What::Cover),
        );
        let droop = self.droop * (0.5 + slow(4, 0.5, 0.07));
        // Lids narrow while a mouth yawns.
        let lids = (self.lids + droop).max(0.55 * yawn);
        let slump = if self.is_slumping { cover } else { 0.0 };
        let chatter = 0.18 + 0.16 * (10.5 * t).sin() + 0.08 * (6.1 * t).sin();
        Moment {
            angles: HeadAngles {
                yaw_deg: self.road_deg[0] + yaw,
                pitch_deg: self.road_deg[1] + pitch,
                roll_deg: slow(5, 3.0, 0.13) + 0.1 * yaw,
            },
            sway: Vec3::new(
                slow(6, 8.0, 0.08),
                slow(7, 4.0, 0.21)
                    + slow(0, 0.8, 2.3)
                    + SLUMP_MM * slump
                    + DUCK_MM * sum(What::Duck),
                slow(1, 10.0, 0.05),
            ),
            blink: lids.max(sum(What::Close)).max(smoothstep(0.1, 0.4, nod)),
            jaw: yawn
                .max(talk * chatter.max(0.0))
                .max(0.5 * laugh * chatter.max(0.0)),
            smile: (0.3 * talk * (1.0 + slow(2, 1.0, 0.3))).max(laugh),
            brows: 0.3 * talk * (1.0 + (2.3 * t).sin()) + 0.4 * yawn,
            pucker: 0.2 * talk * (1.0 + (4.3 * t).sin()),
            squint: laugh,
            gaze: self.gaze(t),
            cover: if self.is_covered { 1.0 } else { cover },
            light_turn: 0.0,
        }
    }

    /// To the image right and down \[rad\].
    fn gaze(&self, t: f32) -> (f32, f32) {
        let next = self.jumps.partition_point(|(at, _)| *at <= t);
        let mut gaze = next
            .checked_sub(1)
            .and_then(|i| self.jumps.get(i))
            .map_or([0.0; 2], |(_, to)| *to);
        if self.does(What::Look, t) {
            gaze = gaze.map(|angle| FIXED * angle);
        }
        for act in &self.acts {
            // Eyes arrive before the head.
            let share = act.at(t).powf(0.5);
            gaze[0] += share * act.gaze_deg[0];
            gaze[1] += share * act.gaze_deg[1];
        }
        (gaze[0].to_radians(), gaze[1].to_radians())
    }
}

/// What a recipe asks for, not yet in an order.
fn acts(rng: &mut ChaCha8Rng, recipe: &Recipe, clip: &Clip) -> Vec<Act> {
    let mut all: Vec<Act> = Vec::new();
    // To the image left or right of the driver; nothing is drawn for it.
    let passenger = if clip.sweep.seed.1.is_multiple_of(2) {
        1.0
    } else {
        -1.0
    };
    let closures = recipe.closures_s.iter();
    all.extend(closures.map(|length| Act::closure(rng, *length)));
    for _ in 0..recipe.mirrors {
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let turn = [
            side * rng.random_range(12.0..28.0),
            rng.random_range(-4.0..8.0),
        ];
        let gaze = [
            side * rng.random_range(8.0..18.0),
            rng.random_range(-6.0..4.0),
        ];
        all.push(Act::glance(turn, gaze, rng.random_range(0.4..1.2), 90.0));
    }
    for _ in 0..recipe.laps {
        let turn = [
            rng.random_range(-10.0..10.0),
            rng.random_range(-22.0..-10.0),
        ];
        let gaze = [rng.random_range(-5.0..5.0), rng.random_range(8.0..20.0)];
        all.push(Act::glance(turn, gaze, rng.random_range(0.8..3.0), 60.0));
    }
    for _ in 0..recipe.readings {
        // A telephone on the lap or at the wheel, read with head and eyes or with the eyes alone.
        let turn = [rng.random_range(-8.0..8.0), rng.random_range(-20.0..0.0)];
        let gaze = [rng.random_range(-6.0..6.0), rng.random_range(20.0..36.0)];
        let stays_s = rng.random_range(2.0..7.0);
        all.push(Act::glance(turn, gaze, stays_s, 60.0));
    }
    for _ in 0..recipe.clusters {
        let turn = [rng.random_range(-3.0..3.0), rng.random_range(-5.0..1.0)];
        let gaze = [rng.random_range(-5.0..5.0), rng.random_range(12.0..26.0)];
        all.push(Act::glance(turn, gaze, rng.random_range(0.5..2.5), 90.0));
    }
    for n in 0..recipe.looks {
        let target = &TARGETS[n % TARGETS.len()];
        let within = |rng: &mut ChaCha8Rng, [from, to]: [f32; 2]| rng.random_range(from..to);
        let gaze = [
            passenger * within(rng, target.aside_deg),
            within(rng, target.down_deg),
        ];
        let turn = [
            rng.random_range(0.0..0.1) * gaze[0],
            rng.random_range(0.0..0.1) * -gaze[1],
        ];
        // Most looks are short; one of seven is long.
        let stays_s = match rng.random_range(0..7) {
            0 => rng.random_range(3.0..6.0),
            _ => rng.random_range(0.4..2.6),
        };
        // A saccade.
        let times = [0.08, stays_s, 0.08];
        all.push(Act {
            turn_deg: turn,
            gaze_deg: gaze,
            ..Act::new(What::Look, times)
        });
    }
    for _ in 0..recipe.laughs {
        let stays = rng.random_range(0.8..3.5);
        all.push(Act {
            weight: rng.random_range(0.6..1.0),
            turn_deg: [0.0, rng.random_range(-6.0..6.0)],
            ..Act::new(What::Laugh, [0.4, stays, 0.6])
        });
    }
    for _ in 0..recipe.turns {
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let to = side * rng.random_range(62.0..76.0f32);
        let turn = [to - clip.road_deg[0], rng.random_range(-3.0..5.0)];
        let gaze = [side * rng.random_range(5.0..15.0), 0.0];
        all.push(Act::glance(turn, gaze, rng.random_range(0.8..2.0), 130.0));
    }
    for _ in 0..recipe.yawns {
        let times = [rng.random_range(0.6..1.1), rng.random_range(1.6..3.2), 0.7];
        all.push(Act {
            weight: rng.random_range(0.75..1.0),
            turn_deg: [0.0, rng.random_range(0.0..8.0)],
            ..Act::new(What::Yawn, times)
        });
    }
    for _ in 0..recipe.nods {
        let times = [rng.random_range(0.6..0.9), rng.random_range(0.3..0.8), 0.4];
        all.push(Act {
            turn_deg: [0.0, rng.random_range(-24.0..-16.0)],
            ..Act::new(What::Nod, times)
        });
    }
    for _ in 0..recipe.talks {
        let stays = rng.random_range(1.5..3.5);
        all.push(Act::new(What::Talk, [0.3, stays, 0.3]));
    }
    for _ in 0..recipe.covers {
        let stays = rng.random_range(0.8..3.5);
        let time = rng.random_range(0.35..0.8);
        all.push(Act::new(What::Cover, [time, stays, time]));
    }
    for _ in 0..recipe.ducks {
        let times = [0.7, rng.random_range(2.0..5.0), 0.8];
        all.push(Act {
            turn_deg: [0.0, rng.random_range(-25.0..-10.0)],
            ..Act::new(What::Duck, times)
        });
    }
    all
}

/// Sets when acts begin: one after the other, with random times between. What has no room is left
/// out.
fn lay_out(rng: &mut ChaCha8Rng, acts: &mut Vec<Act>, length_s: f32) {
    let free = |acts: &[Act]| {
        let used: f32 = acts.iter().map(|act| act.length_s() + APART_S).sum();
        length_s - used - APART_S
    };
    while free(acts) < 0.0 && acts.pop().is_some() {}
    let shares: Vec<f32> = (0..=acts.len())
        .map(|_| rng.random_range(0.2..1.0))
        .collect();
    let all: f32 = shares.iter().sum();
    let free = free(acts);
    let mut at = 0.0;
    for (act, share) in acts.iter_mut().zip(&shares) {
        at += APART_S + free * share / all;
        act.start_s = at;
        at += act.length_s();
    }
}

/// Blinks every few seconds where lids are not busy otherwise.
fn add_blinks(rng: &mut ChaCha8Rng, acts: &mut Vec<Act>, length_s: f32) {
    let mut at = rng.random_range(0.5..2.0f32);
    while at < length_s - 1.0 {
        let closed = rng.random_range(0.05..0.15);
        let mut blink = Act::closure(rng, closed);
        blink.start_s = at;
        let end = at + blink.length_s();
        let is_busy = acts.iter().any(|act| {
            matches!(act.what, What::Close | What::Nod)
                && act.start_s < end + APART_S
                && at < act.start_s + act.length_s() + APART_S
        });
        if !is_busy {
            acts.push(blink);
        }
        at += rng.random_range(1.8..5.5f32);
    }
}
