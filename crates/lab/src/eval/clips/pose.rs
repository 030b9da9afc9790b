//! `posewise-lab eval pose`: what `track --csv` wrote against per-frame truth.

use std::collections::HashMap;
use std::fmt::Write as _;

use anyhow::Result;
use serde_json::{Map, Value};

use super::pairs::{ClipsArgs, clips_of};
use super::pose_metrics::{
    BANDS, FrameOutcome, OFF_DEG, Summary, Tracked, summarize, summarize_band, summarize_covered,
    summarize_occluded, summarize_steps,
};
use super::truth::read_truth;
use crate::output;
use crate::table::Table;

/// Runs the command.
pub fn run(args: &ClipsArgs) -> Result<()> {
    let mut out = String::new();
    let mut clips = Vec::new();
    let mut all = Vec::new();
    for (truth, csv) in clips_of(args)? {
        let outcomes = compare(&Table::read(truth)?, &Table::read(csv)?)?;
        if args.truth.len() > 1 {
            report(&mut out, &truth.display().to_string(), &outcomes);
        }
        clips.push((truth.display().to_string(), to_json(&outcomes)));
        all.extend(outcomes);
    }
    report(&mut out, "all", &all);
    output::print(&out)?;
    if let Some(path) = &args.json {
        let mut value = to_json(&all);
        if let (Value::Object(map), true) = (&mut value, clips.len() > 1) {
            let clips: Map<String, Value> = clips.into_iter().collect();
            map.insert("clips".into(), clips.into());
        }
        output::write_json(path, &value)?;
    }
    Ok(())
}

/// Frame by frame: the truth counts frames from 0, the tracker's table from 1.
fn compare(truth: &Table, csv: &Table) -> Result<Vec<FrameOutcome>> {
    let tracked = read_tracked(csv)?;
    let outcomes: Vec<FrameOutcome> = read_truth(truth)?
        .iter()
        .map(|(frame, truth)| {
            let tracked = tracked.get(&(frame + 1));
            FrameOutcome::new(truth, tracked.and_then(Option::as_ref))
        })
        .collect();
    Ok(outcomes)
}

/// By frame number; `None` for frames without success.
fn read_tracked(table: &Table) -> Result<HashMap<i64, Option<Tracked>>> {
    let column = |name: &str| table.column(name);
    let (frame, success) = (column("frame")?, column("success")?);
    let angles = [
        column("yaw_deg")?,
        column("pitch_deg")?,
        column("roll_deg")?,
    ];
    let translation = [column("pose_Tx")?, column("pose_Ty")?, column("pose_Tz")?];
    let (xs, ys) = (table.columns68("x_")?, table.columns68("y_")?);
    // Other trackers' tables have neither.
    let confidence = table
        .columns68("vis_")
        .and_then(|vis| Ok([vis, table.columns68("c_")?]));
    let confidence = confidence.ok();
    (0..table.len())
        .map(|row| {
            let number = |column: usize| table.number(row, column);
            let frame = number(frame)? as i64;
            if number(success)? < 0.5 {
                return Ok((frame, None));
            }
            let mut tracked = Tracked {
                angles: [0.0; 3],
                translation: [0.0; 3],
                points: [[0.0; 2]; 68],
                confidence: None,
            };
            for i in 0..3 {
                tracked.angles[i] = number(angles[i])?;
                tracked.translation[i] = number(translation[i])?;
            }
            for (i, p) in tracked.points.iter_mut().enumerate() {
                *p = [number(xs[i])?, number(ys[i])?];
            }
            if let Some(columns) = confidence {
                let mut values = [[0.0; 2]; 68];
                for (i, value) in values.iter_mut().enumerate() {
                    *value = [number(columns[0][i])?, number(columns[1][i])?];
                }
                tracked.confidence = Some(values);
            }
            Ok((frame, Some(tracked)))
        })
        .collect()
}

fn to_json(outcomes: &[FrameOutcome]) -> Value {
    let mut value = summarize(outcomes.iter()).json();
    let bands: Map<String, Value> = BANDS
        .iter()
        .map(|(name, from, to)| {
            let band = summarize_band(outcomes, *from, *to);
            (name.to_string(), band.json())
        })
        .collect();
    if let Value::Object(map) = &mut value {
        map.insert("yaw_bands".into(), bands.into());
        let steps = summarize_steps(outcomes).into_iter();
        let steps: Map<String, Value> = steps.map(|(name, s)| (name, s.json())).collect();
        map.insert("yaw_steps".into(), steps.into());
        let occluded = summarize_occluded(outcomes);
        map.insert(
            "occluded".into(),
            occluded.map_or(Value::Null, |o| o.json()),
        );
        for (key, covered) in [("covered", true), ("uncovered", false)] {
            let part = summarize_covered(outcomes, covered);
            map.insert(key.into(), part.map_or(Value::Null, |p| p.json()));
        }
    }
    value
}

fn report(out: &mut String, title: &str, outcomes: &[FrameOutcome]) {
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "{title}\n{:<8}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>9}",
        "|yaw|",
        "frames",
        "P_s %",
        "yaw °",
        "pitch °",
        "roll °",
        "mean °",
        "t mm",
        "depth mm",
        "lmk %"
    );
    let total = summarize(outcomes.iter());
    let bands = BANDS.map(|(name, from, to)| (name, summarize_band(outcomes, from, to)));
    for (name, s) in std::iter::once(("all", &total)).chain(bands.iter().map(|(n, s)| (*n, s))) {
        let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.2}"));
        let axis = |i: usize| cell(s.angles.map(|a| a[i]));
        let _ = writeln!(
            out,
            "{name:<8}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>9}",
            s.counted,
            cell(s.success().map(|v| 100.0 * v)),
            axis(0),
            axis(1),
            axis(2),
            cell(s.mean_angle()),
            cell(s.translation.map(|t| t.0)),
            cell(s.translation.map(|t| t.1)),
            cell(s.landmarks.map(|v| 100.0 * v)),
        );
    }
    report_steps(out, outcomes);
    let area = |k: usize| total.seen_auc[k].map_or("–".into(), |v| format!("{v:.3}"));
    let _ = writeln!(
        out,
        "lost within ±60°: {}; more than 30° off: {}; sign flips beyond ±60°: {}; \
         tracked without a face: {}\n\
         inner landmarks seen or hidden, area under the ROC: visibility {}, confidence {}",
        total.lost_within_60,
        total.wrong,
        total.sign_flips,
        total.false_tracks,
        area(0),
        area(1),
    );
    report_covered(out, outcomes);
}

/// Frames in which something covers the face.
fn report_covered(out: &mut String, outcomes: &[FrameOutcome]) {
    let covered = summarize_covered(outcomes, true).zip(summarize_covered(outcomes, false));
    if let Some((covered, others)) = covered {
        let _ = writeln!(
            out,
            "half of the landmarks covered, or more: {}; the others: {}",
            counted(&covered),
            counted(&others)
        );
    }
    if let Some(occluded) = summarize_occluded(outcomes).filter(|o| o.counted > 0) {
        let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.3}"));
        let _ = writeln!(
            out,
            "something before the face: {}; visible or covered, area under the ROC: {}",
            counted(&occluded),
            cell(occluded.covered_auc)
        );
    }
}

/// Frames, share tracked and mean angle error.
fn counted(s: &Summary) -> String {
    match s.success().zip(s.mean_angle()) {
        Some((share, error)) => {
            format!(
                "{} frames, {:.2} % tracked, mean {error:.2}°",
                s.counted,
                100.0 * share
            )
        }
        None => format!("{} frames, {} tracked", s.counted, s.tracked),
    }
}

/// Errors by steps of true yaw, with the sign of the yaw's.
fn report_steps(out: &mut String, outcomes: &[FrameOutcome]) {
    let _ = writeln!(
        out,
        "{:<8}{:>7}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}",
        "|yaw|",
        "frames",
        "P_s %",
        "yaw °",
        "short °",
        "pitch °",
        "roll °",
        format!(">{OFF_DEG}° %")
    );
    let steps = summarize_steps(outcomes);
    for (name, s) in steps.iter().filter(|(_, s)| s.counted > 0) {
        let cell = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.2}"));
        let axis = |i: usize| cell(s.angles.map(|a| a[i]));
        let _ = writeln!(
            out,
            "{name:<8}{:>7}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}",
            s.counted,
            cell(s.success().map(|v| 100.0 * v)),
            axis(0),
            cell(s.shrinkage),
            axis(1),
            axis(2),
            cell(s.off.map(|v| 100.0 * v)),
        );
    }
}
