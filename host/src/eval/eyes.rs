//! `posewise eval eyes`: do the lids follow the truth?
//!
//! Frames that count are those tracked with both true and reported yaw within ±45°. Closures are
//! runs of at least 200 ms; missed is one of the truth in which fewer than half of the frames are
//! closed for the tracker, invented one of the tracker's in which none is closing in truth.

use std::fmt::Write as _;

use anyhow::Result;
use serde_json::json;

use super::table::Table;
use super::{clips_of, mean};
use crate::cli::ClipsArgs;
use crate::output;

/// Largest |yaw| that counts \[deg\].
const YAW_DEG: f64 = 45.0;
/// A true `eyeBlink` weight above this is a closed eye.
const CLOSED: f64 = 0.8;
/// A true weight above this is an eye that closes.
const CLOSING: f64 = 0.4;
/// The tracker's `eye_open` below this is a closed eye.
const OPEN: f64 = 0.35;
/// Shortest closure \[s\].
const CLOSURE_S: f64 = 0.2;
/// Frames per second of a truth without times.
const FPS: f64 = 30.0;

/// One frame that counts, means over both eyes where both are seen.
#[derive(Clone, Copy, Debug)]
struct Frame {
    number: i64,
    /// Eye aspect ratio: truth in 3D, and of the landmarks.
    ear: (f64, f64),
    /// Blink weight: truth, and 1 − `eye_open`.
    blink: (f64, f64),
}

/// Runs the command.
pub fn run(args: &ClipsArgs) -> Result<()> {
    let mut out = String::new();
    let (mut clips, mut all) = (Vec::new(), Vec::new());
    let (mut missed, mut invented, mut closures) = (0, 0, 0);
    for (truth, csv) in clips_of(args)? {
        let frames = compare(&Table::read(truth)?, &Table::read(csv)?)?;
        let (m, i, n) = count(&frames);
        let name = truth.display().to_string();
        let ear = correlation(frames.iter().map(|f| f.ear));
        let blink = correlation(frames.iter().map(|f| f.blink));
        writeln!(
            out,
            "{name}: {} frames, correlation of the eye aspect ratio {}, of eye_open {}; {n} closures, {m} missed, {i} invented",
            frames.len(),
            shown(ear),
            shown(blink),
        )?;
        clips.push(
            json!({"clip": name, "frames": frames.len(), "ear": ear, "eye_open": blink,
            "closures": n, "missed": m, "invented": i}),
        );
        (missed, invented, closures) = (missed + m, invented + i, closures + n);
        // Faces differ in how far their eyes open: correlations are pooled clip by clip.
        all.extend(centred(&frames));
    }
    let ear = correlation(all.iter().map(|f| f.ear));
    let blink = correlation(all.iter().map(|f| f.blink));
    writeln!(
        out,
        "all: {} frames, correlation of the eye aspect ratio {}, of eye_open {}; {closures} closures, {missed} missed, {invented} invented",
        all.len(),
        shown(ear),
        shown(blink),
    )?;
    output::print(&out)?;
    if let Some(path) = &args.json {
        let value = json!({"frames": all.len(), "ear": ear, "eye_open": blink,
            "closures": closures, "missed": missed, "invented": invented, "clips": clips});
        output::write_json(path, &value)?;
    }
    Ok(())
}

fn shown(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{v:.3}"))
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
        if let (Some(open), true) = (mean(&seen), turn[0].abs() <= YAW_DEG) {
            tracked.insert(csv.number(row, number)? as i64, (ratio * view, open));
        }
    }
    let column = |name: &str| truth.column(name);
    let (number, yaw) = (column("frame")?, column("yaw")?);
    let ears = [column("ear_R")?, column("ear_L")?];
    let blinks = [column("eyeBlink_R")?, column("eyeBlink_L")?];
    let mut frames = Vec::new();
    for row in 0..truth.len() {
        let at = truth.number(row, number)? as i64;
        let both = |columns: [usize; 2]| -> Result<f64> {
            Ok((truth.number(row, columns[0])? + truth.number(row, columns[1])?) / 2.0)
        };
        let Some((ratio, open)) = tracked.get(&(at + 1)) else {
            continue;
        };
        if truth.number(row, yaw)?.abs() <= YAW_DEG {
            frames.push(Frame {
                number: at,
                ear: (both(ears)?, *ratio),
                blink: (both(blinks)?, 1.0 - open),
            });
        }
    }
    Ok(frames)
}

/// Missed and invented closures, and those of the truth.
fn count(frames: &[Frame]) -> (usize, usize, usize) {
    let shortest = (CLOSURE_S * FPS).round() as usize;
    let closed = |f: &Frame| 1.0 - f.blink.1 < OPEN;
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
    let truth = runs(&|f| f.blink.0 > CLOSED);
    let missed = truth
        .iter()
        .filter(|run| 2 * run.iter().filter(|f| closed(f)).count() < run.len())
        .count();
    let invented = runs(&closed)
        .iter()
        .filter(|run| run.iter().all(|f| f.blink.0 < CLOSING))
        .count();
    (missed, invented, truth.len())
}

/// Values less their means over the clip.
fn centred(frames: &[Frame]) -> Vec<Frame> {
    let of = |value: &dyn Fn(&Frame) -> f64| {
        let values: Vec<f64> = frames.iter().map(value).collect();
        mean(&values).unwrap_or(0.0)
    };
    let ear = (of(&|f| f.ear.0), of(&|f| f.ear.1));
    let blink = (of(&|f| f.blink.0), of(&|f| f.blink.1));
    let less = |f: &Frame| Frame {
        ear: (f.ear.0 - ear.0, f.ear.1 - ear.1),
        blink: (f.blink.0 - blink.0, f.blink.1 - blink.1),
        ..*f
    };
    frames.iter().map(less).collect()
}

/// Pearson's; `None` when either side does not vary.
fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let pairs: Vec<(f64, f64)> = pairs.collect();
    let n = pairs.len() as f64;
    let (mx, my) = pairs
        .iter()
        .fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in &pairs {
        xy += (x - mx) * (y - my);
        xx += (x - mx).powi(2);
        yy += (y - my).powi(2);
    }
    (xx > 1e-12 && yy > 1e-12).then(|| xy / (xx * yy).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: i64, truth: f64, found: f64) -> Frame {
        Frame {
            number,
            ear: (truth, found),
            blink: (truth, found),
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
        assert_eq!(count(&clip(0)), (0, 0, 1));
        assert_eq!(count(&clip(4)), (0, 0, 1), "late, yet the same closure");
        assert_eq!(count(&clip(15)), (1, 1, 1));
    }

    #[test]
    fn correlation_of_a_line_is_one() {
        let line = (0..9).map(|k| (f64::from(k), 3.0 * f64::from(k) - 1.0));
        assert!((correlation(line).expect("it varies") - 1.0).abs() < 1e-12);
        assert_eq!(correlation([(1.0, 2.0), (1.0, 3.0)].into_iter()), None);
    }
}
