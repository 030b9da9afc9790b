//! Times of steps by what the tracker did in them, without the noise of the machine.
//!
//! A tracker does the same work on the same frames. All steps are taken several times, each time
//! by a fresh tracker, and a step's time is the shortest of these: what an interrupt or another
//! process adds to one run is dropped, what the step itself needs is not.

use std::time::Instant;

use anyhow::{Result, anyhow, ensure};
use image::GrayImage;
use posewise::track::{Config, Model, State, Tracker};
use serde_json::{Value, json};

use crate::picture::Picture;
use crate::scenes::Scenes;

/// How often all steps are taken.
pub const RUNS: usize = 5;
const STEP_US: i64 = 33_333;

/// What the tracker did in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From Tracking to Tracking.
    Tracking,
    /// A face was found in this step, in Searching or Holding.
    Acquiring,
    /// From Searching to Searching.
    Searching,
    /// The face was lost in this step, or not found while holding.
    Holding,
}

impl Kind {
    /// All kinds with their names in reports.
    pub const ALL: [(Kind, &'static str); 4] = [
        (Kind::Tracking, "tracking"),
        (Kind::Acquiring, "acquiring"),
        (Kind::Searching, "searching"),
        (Kind::Holding, "holding"),
    ];

    fn of(before: State, after: State) -> Kind {
        match (before, after) {
            (State::Tracking, State::Tracking) => Kind::Tracking,
            (_, State::Tracking) => Kind::Acquiring,
            (State::Searching, _) => Kind::Searching,
            _ => Kind::Holding,
        }
    }
}

/// Kind and time \[ns\] of each step.
pub struct Steps(Vec<(Kind, u64)>);

impl Steps {
    /// Takes all steps [`RUNS`] times.
    pub fn time(model: &Model<'_>, scenes: &Scenes<'_>) -> Result<Self> {
        let mut steps = run(model, scenes)?;
        for _ in 1..RUNS {
            let again = run(model, scenes)?;
            let same = steps.iter().map(|s| s.0).eq(again.iter().map(|s| s.0));
            ensure!(same, "the same frames gave other answers the second time");
            for (step, other) in steps.iter_mut().zip(again) {
                step.1 = step.1.min(other.1);
            }
        }
        Ok(Steps(steps))
    }

    /// Times of one kind, or of all.
    pub fn of(&self, kind: Option<Kind>) -> Times {
        let steps = self.0.iter().filter(|s| kind.is_none_or(|k| k == s.0));
        let mut ns: Vec<u64> = steps.map(|s| s.1).collect();
        ns.sort_unstable();
        Times(ns)
    }

    /// The dearest step.
    pub fn worst(&self) -> Option<(Kind, u64)> {
        self.0.iter().max_by_key(|s| s.1).copied()
    }
}

/// A fresh tracker with a camera's settings.
pub fn fresh() -> Result<Box<Tracker>> {
    let tracker = Tracker::new(&Config::default()).map_err(|e| anyhow!("{e}"))?;
    Ok(Box::new(tracker))
}

/// One step on that picture, as the n-th frame; its state and its time \[ns\].
pub fn step(
    tracker: &mut Tracker,
    model: &Model<'_>,
    image: GrayImage,
    n: usize,
) -> Result<(State, u64)> {
    let picture = Picture::from_grey(image);
    let frame = picture.frame()?;
    let start = Instant::now();
    let result = tracker.step(model, &frame, n as i64 * STEP_US);
    let ns = start.elapsed().as_nanos() as u64;
    Ok((result.map_err(|e| anyhow!("{e}"))?.state, ns))
}

fn run(model: &Model<'_>, scenes: &Scenes<'_>) -> Result<Vec<(Kind, u64)>> {
    let mut tracker = fresh()?;
    let mut before = State::Searching;
    let mut steps = Vec::new();
    for (n, image) in scenes.pictures().enumerate() {
        let (after, ns) = step(&mut tracker, model, image, n)?;
        steps.push((Kind::of(before, after), ns));
        before = after;
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
        let steps = Steps(kinds.into_iter().zip([5, 3, 9]).collect());
        assert_eq!(steps.of(Some(Kind::Tracking)).quantile(0.0), Some(3));
        assert_eq!(steps.of(None).quantile(0.5), Some(5));
        assert_eq!(steps.of(Some(Kind::Holding)).quantile(0.5), None);
        assert_eq!(steps.worst(), Some((Kind::Searching, 9)));
    }

    #[test]
    fn steps_are_told_apart() {
        use State::{Holding, Searching, Tracking};
        assert_eq!(Kind::of(Tracking, Tracking), Kind::Tracking);
        assert_eq!(Kind::of(Searching, Tracking), Kind::Acquiring);
        assert_eq!(Kind::of(Holding, Tracking), Kind::Acquiring);
        assert_eq!(Kind::of(Searching, Searching), Kind::Searching);
        assert_eq!(Kind::of(Tracking, Holding), Kind::Holding);
        assert_eq!(Kind::of(Holding, Searching), Kind::Holding);
    }
}
