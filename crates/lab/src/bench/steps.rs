//! Times of steps by what the tracker did in them, without the noise of the machine.
//!
//! A tracker does the same work on the same frames. All steps run several times, each time with a
//! fresh tracker, and a step's time is the shortest of these: what an interrupt or another process
//! adds to one run is dropped, what the step itself needs is not. There are five runs, and more as
//! long as they lower the time of the worst-case step by more than 1 %.

use std::time::Instant;

use anyhow::{Result, anyhow, ensure};
use image::GrayImage;
use posewise::{Config, Model, State, Tracker};
use posewise_cli::picture::Picture;
use serde_json::{Value, json};

/// Least and greatest number of runs over all steps.
const RUNS: (usize, usize) = (5, 20);
/// Runs without a lower worst-case step after which its time is accepted.
const QUIET_RUNS: usize = 2;
/// Time between frames \[µs\].
pub const STEP_US: i64 = 33_333;

/// What the tracker did in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From Tracking to Tracking.
    Tracking,
    /// A face was found in this step, in Searching or Coasting.
    Acquiring,
    /// From Searching to Searching.
    Searching,
    /// The face was lost in this step, or not found while holding.
    Coasting,
}

impl Kind {
    /// All kinds with their names in reports.
    pub const ALL: [(Kind, &'static str); 4] = [
        (Kind::Tracking, "tracking"),
        (Kind::Acquiring, "acquiring"),
        (Kind::Searching, "searching"),
        (Kind::Coasting, "coasting"),
    ];

    fn of(before: State, after: State) -> Kind {
        match (before, after) {
            (State::Tracking, State::Tracking) => Kind::Tracking,
            (_, State::Tracking) => Kind::Acquiring,
            (State::Searching, _) => Kind::Searching,
            _ => Kind::Coasting,
        }
    }
}

/// Kind and time \[ns\] of a step.
pub type Step = (Kind, u64);

/// All steps.
pub struct Steps {
    /// How often they were taken.
    pub runs: usize,
    steps: Vec<Step>,
}

impl Steps {
    /// Takes a step on each picture, often enough. `pictures` gives the same ones each time.
    pub fn time<P>(model: &Model<'_>, pictures: impl Fn() -> P) -> Result<Self>
    where
        P: Iterator<Item = GrayImage>,
    {
        Self::time_shared(model, 1, pictures)
    }

    /// The same for several trackers, which take a step in turn on each picture.
    pub fn time_shared<P>(
        model: &Model<'_>,
        trackers: usize,
        pictures: impl Fn() -> P,
    ) -> Result<Self>
    where
        P: Iterator<Item = GrayImage>,
    {
        let mut timed = Steps {
            runs: 1,
            steps: run(model, trackers, pictures())?,
        };
        let mut quiet = 0;
        while timed.runs < RUNS.0 || (quiet < QUIET_RUNS && timed.runs < RUNS.1) {
            let before = timed.worst();
            timed.join(&run(model, trackers, pictures())?)?;
            let cheaper = |(before, now): (Step, Step)| 100 * now.1 < 99 * before.1;
            let is_cheaper = before.zip(timed.worst()).is_some_and(cheaper);
            quiet = if is_cheaper { 0 } else { quiet + 1 };
        }
        Ok(timed)
    }

    /// Adds another run.
    fn join(&mut self, again: &[Step]) -> Result<()> {
        let same = self.steps.iter().map(|s| s.0).eq(again.iter().map(|s| s.0));
        ensure!(same, "a second run on the same frames gave other results");
        for (step, other) in self.steps.iter_mut().zip(again) {
            step.1 = step.1.min(other.1);
        }
        self.runs += 1;
        Ok(())
    }

    /// Times of one kind, or of all.
    pub fn of(&self, kind: Option<Kind>) -> Times {
        let steps = self.steps.iter().filter(|s| kind.is_none_or(|k| k == s.0));
        let mut ns: Vec<u64> = steps.map(|s| s.1).collect();
        ns.sort_unstable();
        Times(ns)
    }

    /// The worst-case step.
    pub fn worst(&self) -> Option<Step> {
        self.steps.iter().max_by_key(|s| s.1).copied()
    }
}

/// A fresh tracker with a camera's settings.
pub fn fresh() -> Result<Box<Tracker>> {
    let tracker = Tracker::new(&Config::default()).map_err(|e| anyhow!("{e}"))?;
    Ok(Box::new(tracker))
}

fn run(
    model: &Model<'_>,
    trackers: usize,
    pictures: impl Iterator<Item = GrayImage>,
) -> Result<Vec<Step>> {
    let mut trackers = (0..trackers).map(|_| fresh()).collect::<Result<Vec<_>>>()?;
    let mut steps = Vec::new();
    for (n, image) in pictures.enumerate() {
        let picture = Picture::from_grey(image);
        let frame = picture.frame()?;
        for tracker in &mut trackers {
            let before = tracker.result().state;
            let start = Instant::now();
            let result = tracker.step(model, &frame, n as i64 * STEP_US);
            let ns = start.elapsed().as_nanos() as u64;
            let after = result.map_err(|e| anyhow!("{e}"))?.state;
            steps.push((Kind::of(before, after), ns));
        }
    }
    Ok(steps)
}

/// Times \[ns\], sorted.
pub struct Times(Vec<u64>);

impl Times {
    /// The value below which that share of the times lies; `None` of none.
    pub fn quantile(&self, q: f64) -> Option<u64> {
        let last = self.0.len().checked_sub(1)?;
        self.0.get((q * last as f64).round() as usize).copied()
    }

    /// The numbers as JSON.
    pub fn json(&self) -> Value {
        json!({
            "steps": self.0.len(),
            "median_ns": self.quantile(0.5),
            "p99_ns": self.quantile(0.99),
            "max_ns": self.0.last(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_worst_by_hand() {
        let kinds = [Kind::Tracking, Kind::Tracking, Kind::Searching];
        let run = |ns: [u64; 3]| -> Vec<Step> { kinds.into_iter().zip(ns).collect() };
        let mut steps = Steps {
            runs: 1,
            steps: run([5, 8, 9]),
        };
        steps.join(&run([7, 3, 10])).unwrap();
        assert_eq!(steps.of(Some(Kind::Tracking)).quantile(0.0), Some(3));
        assert_eq!(steps.of(None).quantile(0.5), Some(5));
        assert_eq!(steps.of(Some(Kind::Coasting)).quantile(0.5), None);
        assert_eq!(steps.worst(), Some((Kind::Searching, 9)));
        assert_eq!(steps.runs, 2);
        assert!(steps.join(&run([1; 3])[..2]).is_err());
    }

    #[test]
    fn steps_are_told_apart() {
        use State::{Coasting, Searching, Tracking};
        assert_eq!(Kind::of(Tracking, Tracking), Kind::Tracking);
        assert_eq!(Kind::of(Searching, Tracking), Kind::Acquiring);
        assert_eq!(Kind::of(Coasting, Tracking), Kind::Acquiring);
        assert_eq!(Kind::of(Searching, Searching), Kind::Searching);
        assert_eq!(Kind::of(Tracking, Coasting), Kind::Coasting);
        assert_eq!(Kind::of(Coasting, Searching), Kind::Coasting);
    }
}
