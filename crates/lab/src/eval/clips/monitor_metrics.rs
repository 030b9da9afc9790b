//! Scores of a driver monitor against the truth of each frame.

use posewise::monitor::{EyeState, MonitorState, ZoneState};
use posewise_metrics::{correlation, mean};
use serde_json::{Value, json};

use super::gaze_metrics::{GazeScores, TrueGaze};
use super::glance_metrics::{FoundGlances, GazeZone, GlanceScores};
use super::passenger_metrics::{PassengerScores, TrueNoses};
use super::spans::{Events, Span, invented, level};

/// A true `eyeBlink` weight from this one on is a closed eye: 80 % closed.
const CLOSED: f64 = 0.8;
/// A true weight above this is an eye that closes: a closure that the monitor sees there is not
/// false.
const CLOSING: f64 = 0.4;
/// Shortest closure that must be found, and shortest one that is false \[s\].
const CLOSURE_S: f64 = 0.2;
/// Lengths of the levels of a closure \[s\].
const LEVELS_S: [(&str, f64); 5] = [
    ("closures", CLOSURE_S),
    ("long", 0.5),
    ("microsleeps", 1.0),
    ("sleep", 3.0),
    ("unresponsive", 6.0),
];
/// A closure of more than half a second is false if the lids close in at most this share of it.
const FALSE_SHARE: f64 = 0.5;
/// A true `jawOpen` weight above this for so long is a yawn \[s\].
const YAWN: f64 = 0.5;
const YAWN_S: f64 = 1.5;
/// True |yaw| from which on no eye may count \[deg\].
const TURNED_DEG: f64 = 58.0;
/// Longest time of closed eyes that is no fault where they are hidden \[s\].
const HIDDEN_S: f64 = 0.1;
/// Openness up to which an eye is closed by 80 %.
const OPEN_80: f64 = 0.2;

/// One frame of the truth.
pub struct Truth {
    /// From 0.
    pub frame: i64,
    /// From the first frame \[s\].
    pub time_s: f64,
    /// Mean weight of both lids.
    pub blink: f64,
    /// Weight of the jaw.
    pub jaw: f64,
    /// Yaw of the head \[deg\].
    pub yaw_deg: f64,
    /// Something covers at least half of the eyes' landmarks.
    pub is_covered: bool,
    /// Something covers at least half of the mouth's landmarks.
    pub is_mouth_covered: bool,
    /// The head nods, if the truth says so.
    pub is_nod: Option<bool>,
    /// The zone's index, if the truth has it.
    pub zone: Option<f64>,
    /// The index of the zone that the gaze is in, if the truth has it.
    pub gaze_zone: Option<f64>,
    /// Where both eyes look, if the truth has it.
    pub gaze: Option<TrueGaze>,
    /// Where the driver's and a passenger's noses are, if there is one.
    pub noses: Option<TrueNoses>,
}

impl Truth {
    /// No camera sees whether the eyes are open.
    fn is_hidden(&self) -> bool {
        self.is_covered || self.yaw_deg.abs() >= TURNED_DEG
    }
}

/// What the monitor found.
pub struct Found {
    /// The frame, and what was known after it.
    pub states: Vec<(i64, MonitorState)>,
    /// Blinks and longer closures.
    pub closures: Vec<Span>,
    /// Yawns.
    pub yawns: Vec<Span>,
    /// Nods.
    pub nods: Vec<Span>,
    /// Glances away from the road.
    pub glances: FoundGlances,
    /// Angles of both eyes' gaze of each of the states' frames \[rad\], where known; `None` where
    /// the tracker was not asked for it.
    pub gazes: Option<Vec<Option<[f64; 2]>>>,
    /// The tip of the nose in each of the states' frames \[px\].
    pub noses: Vec<[f64; 2]>,
}

/// All numbers of a clip, or of several.
#[derive(Default)]
pub struct Scores {
    minutes: f64,
    levels: [Events; LEVELS_S.len()],
    yawns: Events,
    /// `None` where no truth has them.
    nods: Option<Events>,
    /// Found length less the true one, of the closures that were found \[s\].
    length_errors_s: Vec<f64>,
    /// True and found P80 of a clip, over the frames whose eyes are known.
    p80: Vec<(f64, f64)>,
    /// True P80 of all frames of the window, and that of the state, where the window is full.
    p80_60: Vec<(f64, f64)>,
    /// True openness and that of the state.
    openness: Vec<(f64, f64)>,
    /// Frames with eyes that a camera can see, and those of them that are known.
    seen: (usize, usize),
    /// Frames with covered eyes or a head turned away, and those of them that count as closed.
    hidden: (usize, usize),
    /// Frames with a known zone, and those of them with the true one.
    zones: (usize, usize),
    gaze: GazeScores,
    glances: GlanceScores,
    passenger: PassengerScores,
}

impl Scores {
    /// The scores of one clip.
    pub fn of(truth: &[Truth], found: &Found) -> Scores {
        let mut scores = Scores {
            minutes: length_s(truth) / 60.0,
            ..Scores::default()
        };
        let closures = seen_runs(truth, |t| t.blink >= CLOSED, Truth::is_hidden);
        for (events, (_, least_s)) in scores.levels.iter_mut().zip(LEVELS_S) {
            *events = level(&closures, &found.closures, least_s);
        }
        let closing = runs(truth, |t| t.blink > CLOSING);
        for (k, (events, (_, least_s))) in scores.levels.iter_mut().zip(LEVELS_S).enumerate() {
            // A long one may begin or end with a true blink.
            let share = if k == 0 { 0.0 } else { FALSE_SHARE };
            events.invented = invented(&found.closures, &closing, least_s, share);
        }
        for closure in closures.iter().filter(|c| c.length_s >= CLOSURE_S) {
            let best = found.closures.iter().filter(|f| f.overlap_s(closure) > 0.0);
            let best = best.max_by(|a, b| a.length_s.total_cmp(&b.length_s));
            scores
                .length_errors_s
                .extend(best.map(|f| f.length_s - closure.length_s));
        }
        let yawns = seen_runs(truth, |t| t.jaw > YAWN, |t| t.is_mouth_covered);
        scores.yawns = level(&yawns, &found.yawns, YAWN_S);
        let wide = runs(truth, |t| t.jaw > YAWN);
        scores.yawns.invented = invented(&found.yawns, &wide, 0.0, 0.0);
        if truth.iter().any(|t| t.is_nod.is_some()) {
            let nods = runs(truth, |t| t.is_nod == Some(true));
            let mut events = level(&nods, &found.nods, 0.0);
            events.invented = invented(&found.nods, &nods, 0.0, 0.0);
            scores.nods = Some(events);
        }
        scores.compare_frames(truth, found);
        scores.compare_gazes(truth, found);
        scores.compare_glances(truth, found);
        scores
    }

    fn compare_glances(&mut self, truth: &[Truth], found: &Found) {
        let of = |t: &Truth| {
            Some(GazeZone {
                time_s: t.time_s - truth.first()?.time_s,
                zone: t.gaze_zone?,
            })
        };
        let zones: Vec<GazeZone> = truth.iter().filter_map(of).collect();
        let with_truth = |(frame, state): &(i64, MonitorState)| {
            let at = truth.binary_search_by_key(frame, |t| t.frame).ok()?;
            Some((of(truth.get(at)?)?, *state))
        };
        let states: Vec<_> = found.states.iter().filter_map(with_truth).collect();
        self.glances = GlanceScores::of(&zones, &states, &found.glances);
    }

    fn compare_gazes(&mut self, truth: &[Truth], found: &Found) {
        let gazes = found.gazes.iter().flatten();
        for ((frame, _), gaze) in found.states.iter().zip(gazes) {
            let at = truth.binary_search_by_key(frame, |t| t.frame);
            let t = at.ok().and_then(|at| truth.get(at));
            if let Some((t, true_gaze)) = t.and_then(|t| Some((t, t.gaze?))) {
                self.gaze.compare(&true_gaze, t.yaw_deg, *gaze);
            }
        }
    }

    fn compare_frames(&mut self, truth: &[Truth], found: &Found) {
        let (mut closed, mut known) = ((0, 0), 0);
        let mut hidden_since = None;
        let mut second = None;
        for ((frame, state), nose) in found.states.iter().zip(&found.noses) {
            let at = truth.binary_search_by_key(frame, |t| t.frame);
            let Some(t) = at.ok().and_then(|at| truth.get(at)) else {
                continue;
            };
            if let Some(noses) = &t.noses {
                self.passenger.see(noses, state, *nose);
            }
            let is_hidden = t.is_hidden();
            if is_hidden {
                self.hidden.0 += 1;
                let is_wrong = state.eyes == EyeState::Closed && t.blink < CLOSING;
                let since = hidden_since.get_or_insert(t.time_s);
                if !is_wrong {
                    hidden_since = None;
                } else if t.time_s - *since > HIDDEN_S {
                    self.hidden.1 += 1;
                }
            } else {
                hidden_since = None;
                self.seen.0 += 1;
                self.seen.1 += usize::from(state.openness.is_some());
            }
            if let Some(openness) = state.openness.map(f64::from)
                && !is_hidden
            {
                known += 1;
                closed.0 += usize::from(t.blink >= CLOSED);
                closed.1 += usize::from(openness <= OPEN_80);
                self.openness.push((1.0 - t.blink, openness));
            }
            if let (Some(zone), ZoneState::In(index)) = (t.zone, state.zone) {
                self.zones.0 += 1;
                self.zones.1 += usize::from(zone == f64::from(index));
            }
            // Once a second, when the window has changed.
            let whole = (t.time_s - truth[0].time_s).floor();
            if whole >= 60.0 && second.replace(whole) != Some(whole) {
                let true_p80 = share(truth, truth[0].time_s + whole);
                self.p80_60
                    .push((true_p80, f64::from(state.perclos_60.p80)));
            }
        }
        if known > 0 {
            let of = |count: usize| count as f64 / f64::from(known);
            self.p80.push((of(closed.0), of(closed.1)));
        }
    }

    /// Adds those of another clip.
    pub fn add(&mut self, other: &Scores) {
        self.minutes += other.minutes;
        for (events, more) in self.levels.iter_mut().zip(&other.levels) {
            events.add(more);
        }
        self.yawns.add(&other.yawns);
        if let Some(more) = &other.nods {
            self.nods.get_or_insert_default().add(more);
        }
        self.length_errors_s.extend(&other.length_errors_s);
        self.p80.extend(&other.p80);
        self.p80_60.extend(&other.p80_60);
        self.openness.extend(&other.openness);
        for (sum, more) in [
            (&mut self.seen, other.seen),
            (&mut self.hidden, other.hidden),
            (&mut self.zones, other.zones),
        ] {
            *sum = (sum.0 + more.0, sum.1 + more.1);
        }
        self.gaze.add(&other.gaze);
        self.glances.add(&other.glances);
        self.passenger.add(&other.passenger);
    }

    /// The numbers.
    pub fn json(&self) -> Value {
        let mut value = json!({
            "minutes": self.minutes,
            "length_error_s": mean_of(&self.length_errors_s),
            "p80_error": apart(&self.p80),
            "p80_60_error": apart(&self.p80_60),
            "openness_correlation": correlation(&self.openness),
            "openness_error": apart(&self.openness),
            "eyes_known": part(self.seen),
            "hidden_frames": self.hidden.0,
            "hidden_closed": self.hidden.1,
            "zones_right": part(self.zones),
            "gaze": self.gaze.json(),
            "glances": self.glances.json(),
            "passenger": self.passenger.json(),
        });
        for (name, events) in self.events() {
            value[name] = json!({"truth": events.truth, "found": events.found,
                "false": events.invented,
                "false_per_minute": events.invented as f64 / self.minutes.max(1e-9)});
        }
        value
    }

    fn events(&self) -> impl Iterator<Item = (&'static str, &Events)> {
        let levels = LEVELS_S.iter().map(|(name, _)| *name).zip(&self.levels);
        let nods = self.nods.iter().map(|nods| ("nods", nods));
        levels.chain([("yawns", &self.yawns)]).chain(nods)
    }
}

/// Mean of the distances; `None` of nothing.
fn apart(pairs: &[(f64, f64)]) -> Option<f64> {
    let distances: Vec<f64> = pairs.iter().map(|(a, b)| (a - b).abs()).collect();
    mean(&distances)
}

fn mean_of(errors: &[f64]) -> Option<f64> {
    let sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    mean(&sizes)
}

fn part((all, some): (usize, usize)) -> Option<f64> {
    (all > 0).then(|| some as f64 / all as f64)
}

/// From the first frame to the end of the last one.
fn length_s(truth: &[Truth]) -> f64 {
    match truth {
        [first, .., last] => {
            let frames = (truth.len() - 1) as f64;
            (last.time_s - first.time_s) * (frames + 1.0) / frames
        }
        _ => 0.0,
    }
}

/// True share of closed eyes in the 60 s up to a time, of the frames that show them.
fn share(truth: &[Truth], to_s: f64) -> f64 {
    let within = |t: &&Truth| t.time_s >= to_s - 60.0 && t.time_s < to_s;
    let frames: Vec<f64> = (truth.iter().filter(within))
        .filter(|t| !t.is_hidden())
        .map(|t| f64::from(t.blink >= CLOSED))
        .collect();
    mean(&frames).unwrap_or(0.0)
}

/// The stretches of frames for which something holds.
fn runs(truth: &[Truth], holds: impl Fn(&Truth) -> bool) -> Vec<Span> {
    seen_runs(truth, holds, |_| false)
}

/// Those of them that are hidden for at most half of their frames.
fn seen_runs(
    truth: &[Truth],
    holds: impl Fn(&Truth) -> bool,
    is_hidden: impl Fn(&Truth) -> bool,
) -> Vec<Span> {
    let frame_s = length_s(truth) / truth.len().max(1) as f64;
    let parts = truth.chunk_by(|a, b| holds(a) == holds(b));
    let parts = parts.filter(|part| part.first().is_some_and(&holds));
    let is_seen = |part: &&[Truth]| {
        let hidden = part.iter().filter(|t| is_hidden(t)).count();
        2 * hidden <= part.len()
    };
    let parts = parts.filter(is_seen);
    let span = |part: &[Truth]| Span {
        start_s: part[0].time_s - truth[0].time_s,
        length_s: part.len() as f64 * frame_s,
    };
    parts.map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten seconds at 30 fps; blinks in these frames.
    fn truth(closed: std::ops::Range<i64>) -> Vec<Truth> {
        let frame = |frame| Truth {
            frame,
            time_s: frame as f64 / 30.0,
            blink: f64::from(closed.contains(&frame)),
            jaw: 0.0,
            yaw_deg: 0.0,
            is_covered: false,
            is_mouth_covered: false,
            is_nod: None,
            zone: None,
            gaze_zone: None,
            gaze: None,
            noses: None,
        };
        (0..300).map(frame).collect()
    }

    fn scores(truth: &[Truth], closures: &[(f64, f64)]) -> Scores {
        let span = |(start_s, length_s): &(f64, f64)| Span {
            start_s: *start_s,
            length_s: *length_s,
        };
        let found = Found {
            states: Vec::new(),
            closures: closures.iter().map(span).collect(),
            yawns: Vec::new(),
            nods: Vec::new(),
            glances: FoundGlances::default(),
            gazes: None,
            noses: Vec::new(),
        };
        Scores::of(truth, &found)
    }

    #[test]
    fn closures_are_matched() {
        // 2 s, from second 3 on.
        let truth = truth(90..150);
        let right = scores(&truth, &[(3.1, 1.8)]);
        assert_eq!(
            right.levels.map(|l| (l.truth, l.found)),
            [(1, 1), (1, 1), (1, 1), (0, 0), (0, 0)]
        );
        assert_eq!(right.levels[0].invented, 0);
        assert!((right.length_errors_s[0] + 0.2).abs() < 1e-9);
        let short = scores(&truth, &[(3.1, 0.3)]);
        assert_eq!(short.levels.map(|l| l.found), [1, 1, 0, 0, 0]);
        let elsewhere = scores(&truth, &[(7.0, 0.5), (8.0, 0.1)]);
        assert_eq!(
            (elsewhere.levels[0].found, elsewhere.levels[0].invented),
            (0, 1)
        );
    }

    #[test]
    fn closures_that_no_camera_sees_do_not_count() {
        let mut truth = truth(90..150);
        truth[90..125].iter_mut().for_each(|t| t.is_covered = true);
        assert_eq!(scores(&truth, &[]).levels[0].truth, 0);
        assert_eq!(share(&truth, 10.0), 25.0 / 265.0);
        truth[90..125].iter_mut().for_each(|t| t.is_covered = false);
        assert_eq!(scores(&truth, &[]).levels[0].truth, 1);
    }

    #[test]
    fn sums_are_of_all_clips() {
        let truth = truth(90..150);
        let mut all = Scores::default();
        all.add(&scores(&truth, &[(3.1, 1.8)]));
        all.add(&scores(&truth, &[]));
        assert_eq!((all.levels[0].truth, all.levels[0].found), (2, 1));
        assert!((all.minutes - 1.0 / 3.0).abs() < 1e-9);
        assert_eq!(all.json()["closures"]["truth"], 2);
    }
}
