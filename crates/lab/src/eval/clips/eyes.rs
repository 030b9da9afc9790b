//! `posewise-lab eval eyes`: do the lids follow the truth?
//!
//! Frames that count are those tracked with both true and reported yaw within ±45°; for the
//! correlations those of them in which the openness of an eye is known. Closures are runs of at
//! least 200 ms. A closure of the truth is missed when fewer than half of its frames are closed for
//! the tracker (unknown is not closed); one of the tracker is invented when no eye is closing in
//! truth.

use anyhow::Result;
use posewise_metrics::statistics::centred;
use posewise_metrics::{correlation, mean};
use serde_json::{Value, json};

use super::pairs::{ClipsArgs, clips_of};
use crate::output;
use crate::table::Table;

/// Largest |yaw| that counts \[deg\].
const YAW_DEG: f64 = 45.0;
/// A true `eyeBlink` weight above this is a closed eye.
const CLOSED: f64 = 0.8;
/// A true weight above this is an eye that closes.
const CLOSING: f64 = 0.4;
/// The tracker's `eye_open` below this is a closed eye.
const CLOSED_BELOW: f64 = 0.35;
/// Shortest closure \[s\].
const CLOSURE_S: f64 = 0.2;
/// Frames per second of a truth without times.
const FPS: f64 = 30.0;

/// One frame that counts, means over both eyes where both are seen.
#[derive(Clone, Copy, Debug)]
struct Frame {
    number: i64,
    /// True eye aspect ratio, in 3D.
    ear: f64,
    /// True blink weight.
    blink: f64,
    /// Aspect ratio of the landmarks, less foreshortening.
    ratio: f64,
    /// `eye_open`; `None` where neither eye is known.
    open: Option<f64>,
}

/// Truth and finding of the frames in which an eye is known.
struct Pairs {
    /// True aspect ratio and that of the landmarks.
    ear: Vec<(f64, f64)>,
    /// True aspect ratio and `eye_open`.
    open: Vec<(f64, f64)>,
    /// True blink weight and 1 − `eye_open`.
    blink: Vec<(f64, f64)>,
}

impl Pairs {
    fn of(frames: &[Frame]) -> Pairs {
        let pairs = |pair: &dyn Fn(&Frame, f64) -> (f64, f64)| {
            let known = frames.iter().filter_map(|f| f.open.map(|open| (f, open)));
            known.map(|(f, open)| pair(f, open)).collect()
        };
        Pairs {
            ear: pairs(&|f, _| (f.ear, f.ratio)),
            open: pairs(&|f, open| (f.ear, open)),
            blink: pairs(&|f, open| (f.blink, 1.0 - open)),
        }
    }

    /// Adds another clip's, less their means: faces differ in how far their eyes open.
    fn pool(&mut self, clip: &Pairs) {
        self.ear.extend(centred(&clip.ear));
        self.open.extend(centred(&clip.open));
        self.blink.extend(centred(&clip.blink));
    }

    /// All numbers of `frames` frames.
    fn figures(&self, frames: usize, closures: &Closures) -> Value {
        json!({
            "frames": frames,
            "known": self.blink.len(),
            "ear": correlation(&self.ear),
            "eye_open": correlation(&self.blink),
            "eye_open_ear": correlation(&self.open),
            "closures": closures.truth,
            "missed": closures.missed,
            "invented": closures.invented,
        })
    }
}

/// Closures of the truth, those of them missed, and invented ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Closures {
    truth: usize,
    missed: usize,
    invented: usize,
}

/// Runs the command.
pub fn run(args: &ClipsArgs) -> Result<()> {
    let (mut clips, mut all) = (Vec::new(), Pairs::of(&[]));
    let (mut frames, mut closures) = (0, Closures::default());
    for (truth, csv) in clips_of(args)? {
        let clip = compare(&Table::read(truth)?, &Table::read(csv)?)?;
        let (pairs, counted) = (Pairs::of(&clip), count(&clip));
        let mut value = pairs.figures(clip.len(), &counted);
        value["clip"] = truth.display().to_string().into();
        clips.push(value);
        frames += clip.len();
        closures.truth += counted.truth;
        closures.missed += counted.missed;
        closures.invented += counted.invented;
        all.pool(&pairs);
    }
    let mut value = all.figures(frames, &closures);
    value["clips"] = clips.into();
    output::show(&value, args.json.as_deref())
}

fn compare(truth: &Table, csv: &Table) -> Result<Vec<Frame>> {
    let column = |name: &str| csv.column(name);
    let (number, success) = (column("frame")?, column("success")?);
    let (yaw, pitch) = (column("yaw_deg")?, column("pitch_deg")?);
    let open = [column("eye_open_right")?, column("eye_open_left")?];
    let (xs, ys) = (csv.columns68("x_")?, csv.columns68("y_")?);
    let mut tracked = std::collections::HashMap::new();
    for row in 0..csv.len() {
        if csv.number(row, success)? < 0.5 {
            continue;
        }
        let point =
            |i: usize| Ok::<_, anyhow::Error>([csv.number(row, xs[i])?, csv.number(row, ys[i])?]);
        let turn = [csv.number(row, yaw)?, csv.number(row, pitch)?];
        // What foreshortening does to width and height.
        let view = turn[0].to_radians().cos() / turn[1].to_radians().cos();
        let mut ratio = 0.0;
        for first in [36, 42] {
            let p = (first..first + 6).map(point).collect::<Result<Vec<_>>>()?;
            let apart = |a: usize, b: usize| (p[a][0] - p[b][0]).hypot(p[a][1] - p[b][1]);
            ratio += (apart(1, 5) + apart(2, 4)) / (2.0 * apart(0, 3)).max(1e-6) / 2.0;
        }
        let mut seen = Vec::new();
        for eye in open {
            let value = csv.number(row, eye)?;
            if value >= 0.0 {
                seen.push(value);
            }
        }
        if turn[0].abs() <= YAW_DEG {
            tracked.insert(csv.number(row, number)? as i64, (ratio * view, mean(&seen)));
        }
    }
    let column = |name: &str| truth.column(name);
    let (number, yaw) = (column("frame")?, column("yaw")?);
    let ears = [column("ear_R")?, column("ear_L")?];
    let blinks = [column("eyeBlink_R")?, column("eyeBlink_L")?];
    let mut frames = Vec::new();
    for row in 0..truth.len() {
        let at = truth.number(row, number)? as i64;
        // The truth counts frames from 0, the table of `track` from 1.
        let in_table = at + 1;
        let both = |columns: [usize; 2]| -> Result<f64> {
            Ok((truth.number(row, columns[0])? + truth.number(row, columns[1])?) / 2.0)
        };
        let Some((ratio, open)) = tracked.get(&in_table) else {
            continue;
        };
        if truth.number(row, yaw)?.abs() <= YAW_DEG {
            frames.push(Frame {
                number: at,
                ear: both(ears)?,
                blink: both(blinks)?,
                ratio: *ratio,
                open: *open,
            });
        }
    }
    Ok(frames)
}

fn count(frames: &[Frame]) -> Closures {
    let shortest = (CLOSURE_S * FPS).round() as usize;
    let closed = |f: &Frame| f.open.is_some_and(|open| open < CLOSED_BELOW);
    let runs = |closed: &dyn Fn(&Frame) -> bool| -> Vec<Vec<Frame>> {
        let mut runs: Vec<Vec<Frame>> = vec![vec![]];
        for frame in frames {
            let last = runs.last_mut().expect("never empty");
            let follows = last.last().is_none_or(|l| l.number + 1 == frame.number);
            match (closed(frame), follows) {
                (true, true) => last.push(*frame),
                (true, false) => runs.push(vec![*frame]),
                (false, _) => runs.push(vec![]),
            }
        }
        runs.retain(|r| r.len() >= shortest);
        runs
    };
    let truth = runs(&|f| f.blink > CLOSED);
    let missed = truth
        .iter()
        .filter(|run| 2 * run.iter().filter(|f| closed(f)).count() < run.len())
        .count();
    let invented = runs(&closed)
        .iter()
        .filter(|run| run.iter().all(|f| f.blink < CLOSING))
        .count();
    Closures {
        truth: truth.len(),
        missed,
        invented,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: i64, truth: f64, found: f64) -> Frame {
        Frame {
            number,
            ear: truth,
            blink: truth,
            ratio: found,
            open: Some(1.0 - found),
        }
    }

    #[test]
    fn closures_are_counted() {
        let closed = |n: i64| (10..20).contains(&n);
        let clip = |shift: i64| -> Vec<Frame> {
            (0..40)
                .map(|n| frame(n, f64::from(closed(n)), f64::from(closed(n - shift))))
                .collect()
        };
        let found = |frames: &[Frame]| {
            let closures = count(frames);
            assert_eq!(closures.truth, 1);
            (closures.missed, closures.invented)
        };
        assert_eq!(found(&clip(0)), (0, 0));
        assert_eq!(found(&clip(4)), (0, 0), "late, yet the same closure");
        assert_eq!(found(&clip(15)), (1, 1));
        let mut unknown = clip(0);
        unknown[12..18].iter_mut().for_each(|f| f.open = None);
        assert_eq!(found(&unknown), (1, 0), "unknown is not closed");
        assert_eq!(Pairs::of(&unknown).blink.len(), 34);
    }
}
