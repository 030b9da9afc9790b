//! What a soak did.

use crate::ffi::types::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Duration;

const STATES: [&str; 3] = ["searching", "tracking", "coasting"];
const EVENTS: [&str; 9] = [
    "acquired",
    "reacquired",
    "coasting",
    "lost",
    "suppressed",
    "filter on",
    "filter off",
    "reset",
    "forgotten",
];

#[derive(Default)]
pub struct Tally {
    pub sessions: u64,
    /// Sessions that ran twice.
    pub repeated: u64,
    /// Video that was shown \[µs\], without the jumps of its timestamps.
    pub video_us: i64,
    /// Steps from each state to each.
    pub changes: [[u64; 3]; 3],
    pub events: [u64; 9],
    /// Calls by name; those that must fail are `… refused`.
    pub calls: BTreeMap<&'static str, u64>,
    /// Faces that `posewise_detect` gave.
    pub faces: u64,
    /// The longest step.
    pub longest: Duration,
    /// Of all outputs of all sessions.
    pub hash: u64,
}

impl Tally {
    pub fn count(&mut self, call: &'static str) {
        *self.calls.entry(call).or_default() += 1;
    }

    pub fn event(&mut self, event: &posewise_event) {
        self.events[event.kind as usize] += 1;
    }

    /// As text; every line is `what: figures`.
    pub fn report(&self, first_seed: u64, took: Duration) -> String {
        let mut text = String::new();
        let hours = self.video_us as f64 / 3.6e9;
        let steps: u64 = self.changes.iter().flatten().sum();
        let mut line = |what: &str, figures: String| {
            writeln!(text, "{what}: {figures}").expect("a string grows");
        };
        line("findings", "0".into());
        line("video", format!("{hours:.2} h"));
        line("took", format!("{:.1} min", took.as_secs_f64() / 60.0));
        line(
            "sessions",
            format!(
                "{} from seed {first_seed}, {} of them twice",
                self.sessions, self.repeated
            ),
        );
        line("steps", steps.to_string());
        for (from, name) in STATES.iter().enumerate() {
            let to: Vec<String> = (STATES.iter().zip(self.changes[from]))
                .map(|(name, count)| format!("{count} {name}"))
                .collect();
            line(&format!("from {name} to"), to.join(", "));
        }
        let events: Vec<String> = (EVENTS.iter().zip(self.events))
            .map(|(name, count)| format!("{count} {name}"))
            .collect();
        line("events", events.join(", "));
        for (call, count) in &self.calls {
            line(call, count.to_string());
        }
        line("faces detected", self.faces.to_string());
        line(
            "longest step",
            format!("{:.1} ms", self.longest.as_secs_f64() * 1e3),
        );
        line("hash", format!("{:016x}", self.hash));
        text
    }
}
