//! Scores of glances against the zone that the true gaze is in.

use posewise::monitor::{MonitorState, ZoneState};
use posewise_metrics::mean;
use serde_json::{Value, json};

use super::spans::{Events, Span};

/// The road of the default zones, of which truths have the indices.
const ROAD: f64 = 0.0;
/// Shortest glance that must be found, and that which counts as long \[s\]: 3 s beyond the grace of
/// a second.
const GLANCE_S: f64 = 1.0;
const LONG_S: f64 = 4.0;
/// Glances that are nearer to each other than any fixation is short are one \[s\], ISO 15007.
const APART_S: f64 = 0.12;
/// A glance is found if found ones overlap with this share of it.
const FOUND_SHARE: f64 = 0.5;
/// A long glance that is reported is false if so much of the time that it says was truly on the
/// road \[s\].
const FALSE_S: f64 = 0.5;

/// The true gaze of a frame.
#[derive(Clone, Copy)]
pub struct GazeZone {
    /// From the first frame \[s\].
    pub time_s: f64,
    /// Index of the zone, below 0 outside of all.
    pub zone: f64,
}

/// What the monitor found.
#[derive(Default)]
pub struct FoundGlances {
    /// Glances.
    pub all: Vec<Span>,
    /// From the begin of a long one to when it was reported, and the time away that it says \[s\].
    pub long: Vec<(Span, f64)>,
}

/// All numbers of a clip, or of several.
#[derive(Clone, Default)]
pub struct GlanceScores {
    minutes: f64,
    glances: Events,
    /// The same by the zone that most of a glance is in.
    by_zone: std::collections::BTreeMap<i64, Events>,
    long: Events,
    /// True and found share of the road of each clip.
    road: Vec<(f64, f64)>,
    /// Frames with a known zone, and those of them with the true one.
    zones: (usize, usize),
}

impl GlanceScores {
    /// Of one clip; of the states the truth of the same frame is known.
    pub fn of(
        truth: &[GazeZone],
        states: &[(GazeZone, MonitorState)],
        found: &FoundGlances,
    ) -> Self {
        let mut scores = GlanceScores::default();
        let is_known = |state: &MonitorState| state.zone != ZoneState::Unknown;
        let known: Vec<_> = states.iter().filter(|(_, state)| is_known(state)).collect();
        let (Some((first, _)), Some(last)) = (known.first(), truth.last()) else {
            return scores;
        };
        scores.minutes = (last.time_s - first.time_s) / 60.0;
        for run in away(truth)
            .iter()
            .filter(|run| run.0.start_s >= first.time_s)
        {
            scores.compare(run, truth, found);
        }
        let away_s = |span: &Span| -> f64 {
            let runs = away(truth);
            runs.iter()
                .map(|(run, _)| run.overlap_s(span).max(0.0))
                .sum()
        };
        let is_false = |(span, said_s): &&(Span, f64)| away_s(span) < said_s - FALSE_S;
        scores.long.invented = found.long.iter().filter(is_false).count();
        let (mut on_road, mut right) = ((0, 0), 0);
        for (t, state) in &known {
            let zone = match state.zone {
                ZoneState::In(index) => f64::from(index),
                _ => -2.0,
            };
            on_road.0 += usize::from(t.zone == ROAD);
            on_road.1 += usize::from(zone == ROAD);
            right += usize::from(t.zone == zone);
        }
        let share = |count: usize| count as f64 / known.len() as f64;
        scores.road.push((share(on_road.0), share(on_road.1)));
        scores.zones = (known.len(), right);
        scores
    }

    /// One true glance.
    fn compare(&mut self, (run, zone): &(Span, i64), truth: &[GazeZone], found: &FoundGlances) {
        let is_whole = truth
            .last()
            .is_some_and(|t| t.time_s > run.start_s + run.length_s + GLANCE_S);
        if run.length_s < GLANCE_S || !is_whole {
            return;
        }
        let overlap_s: f64 = found.all.iter().map(|f| f.overlap_s(run).max(0.0)).sum();
        let is_found = overlap_s >= FOUND_SHARE * run.length_s;
        let of_zone = self.by_zone.entry(*zone).or_default();
        for events in [&mut self.glances, of_zone] {
            events.truth += 1;
            events.found += usize::from(is_found);
        }
        if run.length_s >= LONG_S {
            self.long.truth += 1;
            let is_found = found.long.iter().any(|(long, _)| long.overlap_s(run) > 0.0);
            self.long.found += usize::from(is_found);
        }
    }

    /// Adds those of another clip.
    pub fn add(&mut self, other: &GlanceScores) {
        self.minutes += other.minutes;
        self.glances.add(&other.glances);
        for (zone, events) in &other.by_zone {
            self.by_zone.entry(*zone).or_default().add(events);
        }
        self.long.add(&other.long);
        self.road.extend(&other.road);
        self.zones = (self.zones.0 + other.zones.0, self.zones.1 + other.zones.1);
    }

    /// The numbers; null where no truth has gazes in zones.
    pub fn json(&self) -> Value {
        if self.road.is_empty() {
            return Value::Null;
        }
        let of = |events: &Events| json!({"truth": events.truth, "found": events.found});
        let column =
            |which: fn(&(f64, f64)) -> f64| mean(&self.road.iter().map(which).collect::<Vec<_>>());
        let by_zone: serde_json::Map<String, Value> = (self.by_zone.iter())
            .map(|(zone, events)| (zone.to_string(), of(events)))
            .collect();
        json!({
            "minutes": self.minutes,
            "from_1_s": of(&self.glances),
            "recall": self.glances.found as f64 / (self.glances.truth as f64).max(1.0),
            "by_zone": by_zone,
            "long": of(&self.long),
            "false_long": self.long.invented,
            "false_long_per_minute": self.long.invented as f64 / self.minutes.max(1e-9),
            "road_true": column(|(truth, _)| *truth),
            "road_found": column(|(_, found)| *found),
            "road_error": column(|(truth, found)| (truth - found).abs()),
            "zones_right": self.zones.1 as f64 / self.zones.0.max(1) as f64,
        })
    }
}

/// The true glances away from the road, and the zone that most of each is in.
fn away(truth: &[GazeZone]) -> Vec<(Span, i64)> {
    let mut runs: Vec<(Span, Vec<i64>)> = Vec::new();
    for pair in truth.windows(2) {
        let [t, next] = pair else { continue };
        if t.zone == ROAD {
            continue;
        }
        match runs.last_mut() {
            Some((run, zones)) if t.time_s - (run.start_s + run.length_s) < APART_S => {
                run.length_s = next.time_s - run.start_s;
                zones.push(t.zone as i64);
            }
            _ => runs.push((
                Span {
                    start_s: t.time_s,
                    length_s: next.time_s - t.time_s,
                },
                vec![t.zone as i64],
            )),
        }
    }
    let most = |zones: Vec<i64>| {
        let count = |zone: &i64| zones.iter().filter(|z| *z == zone).count();
        zones
            .iter()
            .max_by_key(|zone| count(zone))
            .copied()
            .unwrap_or(-2)
    };
    runs.into_iter()
        .map(|(run, zones)| (run, most(zones)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::monitor::{Monitor, MonitorConfig};

    /// Ten seconds at 10 fps, of which 2 s from second 3 on are in zone 3.
    fn truth() -> Vec<GazeZone> {
        let frame = |n: usize| GazeZone {
            time_s: n as f64 / 10.0,
            zone: if (30..50).contains(&n) { 3.0 } else { 0.0 },
        };
        (0..100).map(frame).collect()
    }

    fn span(start_s: f64, length_s: f64) -> Span {
        Span { start_s, length_s }
    }

    /// A monitor that always sees the road.
    fn scores(found: &FoundGlances) -> GlanceScores {
        let monitor = Monitor::new(&MonitorConfig::default()).unwrap();
        let mut state = monitor.state();
        state.zone = ZoneState::In(0);
        let states: Vec<_> = truth().into_iter().map(|t| (t, state)).collect();
        GlanceScores::of(&truth(), &states, found)
    }

    #[test]
    fn glances_are_matched() {
        let of = |all: &[Span], long: &[(Span, f64)]| {
            let (all, long) = (all.to_vec(), long.to_vec());
            scores(&FoundGlances { all, long })
        };
        let none = of(&[], &[]);
        assert_eq!((none.glances.truth, none.glances.found), (1, 0));
        let [(true_share, found_share)] = none.road[..] else {
            panic!("one clip");
        };
        assert!((true_share - 0.8).abs() < 1e-9 && found_share == 1.0);
        assert_eq!(of(&[span(3.2, 1.2)], &[]).glances.found, 1);
        assert_eq!(of(&[span(3.2, 0.5)], &[]).glances.found, 0);
        assert_eq!(of(&[], &[(span(2.5, 4.0), 3.0)]).long.invented, 1);
        assert_eq!(of(&[], &[(span(2.5, 4.0), 2.4)]).long.invented, 0);
        assert_eq!(none.json()["by_zone"]["3"]["truth"], 1);
        assert_eq!(GlanceScores::default().json(), Value::Null);
    }

    #[test]
    fn short_breaks_do_not_part_a_glance() {
        let mut truth = truth();
        (truth[40].zone, truth[41].zone) = (0.0, 0.0);
        assert_eq!(away(&truth).len(), 2);
        for t in &mut truth {
            t.time_s /= 4.0;
        }
        assert_eq!(away(&truth).len(), 1);
    }
}
