//! The figures of the page, per system.

use super::calibration::Calibration;
use crate::compare::{Clip, Comparison, Row, Sums, counts, nme, signed};
use crate::tracked::Frame;
use crate::truth::Truth;
use anyhow::Result;
use indicatif::ProgressBar;
use posewise_metrics::mean;
use serde::Serialize;

/// Points of a curve beside the first.
const STEPS: usize = 100;
/// End of the cumulative distribution of the landmark error \[%\].
const NME_LIMIT: f64 = 20.0;
/// End of the robustness curve \[deg\].
const ANGLE_LIMIT: f64 = 30.0;
/// Width of the bands of the true yaw \[deg\].
const BAND_DEG: f64 = 10.0;
/// Everything that the page shows but pictures.
#[derive(Serialize)]
pub struct Figures {
    /// Names of the clips.
    pub clips: Vec<String>,
    /// By row of the table.
    pub systems: Vec<SystemFigures>,
    /// Index of the clip of the scrubber.
    pub scrub: usize,
    /// True landmarks of that clip.
    #[serde(skip)]
    pub truth: Vec<[[f64; 2]; 68]>,
}

/// Figures of one system.
#[derive(Serialize)]
pub struct SystemFigures {
    /// All clips.
    pub row: Row,
    /// By clip.
    pub clips: Vec<Row>,
    /// Share of the frames with a landmark error of at most this \[%\].
    pub ced: Curve,
    /// Share of the frames with a mean angle error of at most this \[deg\].
    pub robustness: Curve,
    /// By true yaw.
    pub bands: Vec<Band>,
    /// Processor time of a step.
    pub time: Option<Time>,
    /// Of systems that give confidences.
    pub calibration: Option<Calibration>,
    /// The worst frame of each of the worst clips.
    pub worst: Vec<Worst>,
    /// Of the clip of the scrubber, by frame: errors of yaw, pitch and roll with sign.
    #[serde(skip)]
    pub scrub: Vec<Option<[f64; 3]>>,
    /// The same frames.
    #[serde(skip)]
    pub frames: Vec<Frame>,
}

/// A share by error. Frames that are not tracked are above every error.
#[derive(Serialize)]
pub struct Curve {
    /// The last error.
    pub limit: f64,
    /// Shares at errors from 0 to the limit in equal steps.
    pub shares: Vec<f64>,
}

/// Frames whose true yaw is in a band. Errors are found less true angles, with sign.
#[derive(Serialize)]
pub struct Band {
    /// Middle of the band.
    pub yaw_deg: f64,
    /// Frames that count.
    pub frames: usize,
    /// Of these, tracked.
    pub tracked: usize,
    /// Mean error of yaw, pitch, roll.
    pub signed_deg: Option<[f64; 3]>,
    /// Mean absolute error of the three.
    pub mean_deg: Option<f64>,
}

/// Processor times of steps \[ms\].
#[derive(Serialize)]
pub struct Time {
    /// Half are below.
    pub median: f64,
    /// 95 of 100 are below.
    pub p95: f64,
    /// None is above.
    pub max: f64,
}

/// A frame that is shown.
#[derive(Serialize)]
pub struct Worst {
    /// Index of the clip.
    pub clip: usize,
    /// From 0.
    pub frame: usize,
    /// Mean absolute angle error.
    pub mean_deg: f64,
    /// Errors of yaw, pitch and roll with sign.
    pub signed_deg: [f64; 3],
    /// True landmarks \[px\].
    #[serde(skip)]
    pub truth: [[f64; 2]; 68],
    /// Found landmarks \[px\].
    #[serde(skip)]
    pub found: [[f64; 2]; 68],
}

/// A frame that counts.
struct Sample<'a> {
    clip: usize,
    frame: usize,
    truth: &'a Truth,
    found: &'a Frame,
    signed: Option<[f64; 3]>,
}

impl Sample<'_> {
    fn mean_deg(&self) -> Option<f64> {
        self.signed
            .map(|e| e.iter().map(|e| e.abs()).sum::<f64>() / 3.0)
    }
}

impl Figures {
    /// Takes the results of all systems.
    pub fn of(comparison: &Comparison, worst: usize, scrub: usize) -> Result<Figures> {
        let progress = ProgressBar::new(comparison.results());
        let mut systems = Vec::new();
        for system in &comparison.systems {
            let mut results = Vec::new();
            for clip in &comparison.clips {
                results.push(comparison.frames(system, clip)?);
                progress.inc(1);
            }
            let clips = &comparison.clips;
            systems.push(SystemFigures::of(
                system.name(),
                clips,
                results,
                worst,
                scrub,
            ));
        }
        progress.finish_and_clear();
        Ok(Figures {
            clips: comparison.clips.iter().map(|c| c.name.clone()).collect(),
            truth: (comparison.clips[scrub].truth.iter())
                .map(|t| t.points)
                .collect(),
            systems,
            scrub,
        })
    }

    /// The table, all clips and each.
    pub fn csv(&self) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for system in &self.systems {
            writer.serialize(&system.row)?;
            for row in &system.clips {
                writer.serialize(row)?;
            }
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}

impl SystemFigures {
    fn of(
        name: &str,
        clips: &[Clip],
        mut results: Vec<Vec<Frame>>,
        worst_count: usize,
        scrub: usize,
    ) -> SystemFigures {
        let mut all = Sums::default();
        let mut rows = Vec::new();
        let mut samples = Vec::new();
        for (number, (clip, frames)) in clips.iter().zip(&results).enumerate() {
            let mut one = Sums::default();
            for sums in [&mut all, &mut one] {
                sums.add(&clip.truth, frames);
            }
            rows.push(one.row(name, Some(&clip.name)));
            let pairs = clip.truth.iter().zip(frames).enumerate();
            let pairs = pairs.filter(|(_, (truth, _))| counts(truth));
            samples.extend(pairs.map(|(frame, (truth, found))| Sample {
                clip: number,
                frame,
                truth,
                found,
                signed: signed(truth, found),
            }));
        }
        let times = results.iter().flatten().filter_map(|f| f.milliseconds);
        let nmes = samples.iter().filter_map(|s| {
            let found = s.found.tracked.as_ref().filter(|_| s.truth.is_marked())?;
            Some(nme(s.truth, &found.points))
        });
        let marked = samples.iter().filter(|s| s.truth.is_marked());
        let angles = samples.iter().filter_map(Sample::mean_deg);
        let pairs = clips[scrub].truth.iter().zip(&results[scrub]);
        SystemFigures {
            row: all.row(name, None),
            clips: rows,
            ced: Curve::of(nmes.collect(), marked.clone().count(), NME_LIMIT),
            robustness: Curve::of(angles.collect(), samples.len(), ANGLE_LIMIT),
            bands: bands(&samples),
            time: Time::of(times.collect()),
            calibration: Calibration::of(marked.map(|s| (s.truth, s.found))),
            worst: worst(&samples, worst_count),
            scrub: pairs.map(|(truth, found)| signed(truth, found)).collect(),
            frames: results.swap_remove(scrub),
        }
    }
}

impl Curve {
    fn of(mut errors: Vec<f64>, frames: usize, limit: f64) -> Curve {
        errors.sort_by(f64::total_cmp);
        let share = |step: usize| {
            let error = limit * step as f64 / STEPS as f64;
            let below = errors.partition_point(|e| *e <= error);
            below as f64 / frames.max(1) as f64
        };
        Curve {
            limit,
            shares: (0..=STEPS).map(share).collect(),
        }
    }
}

impl Time {
    fn of(mut times: Vec<f64>) -> Option<Time> {
        times.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = times.len().checked_sub(1)?;
            times.get((share * last as f64).round() as usize).copied()
        };
        Some(Time {
            median: at(0.5)?,
            p95: at(0.95)?,
            max: at(1.0)?,
        })
    }
}

fn bands(samples: &[Sample<'_>]) -> Vec<Band> {
    let number = |s: &Sample<'_>| (s.truth.angles[0] / BAND_DEG).floor() as i64;
    let all: Vec<i64> = samples.iter().map(number).collect();
    let (Some(first), Some(last)) = (all.iter().min(), all.iter().max()) else {
        return Vec::new();
    };
    let band = |n: i64| {
        let inside = samples.iter().zip(&all).filter(|(_, own)| **own == n);
        let inside: Vec<&Sample<'_>> = inside.map(|(s, _)| s).collect();
        let errors: Vec<[f64; 3]> = inside.iter().filter_map(|s| s.signed).collect();
        let axis = |i: usize| errors.iter().map(|e| e[i]).sum::<f64>() / errors.len() as f64;
        let means: Vec<f64> = inside.iter().filter_map(|s| s.mean_deg()).collect();
        Band {
            yaw_deg: (n as f64 + 0.5) * BAND_DEG,
            frames: inside.len(),
            tracked: errors.len(),
            signed_deg: (!errors.is_empty()).then(|| [0, 1, 2].map(axis)),
            mean_deg: mean(&means),
        }
    };
    (*first..=*last)
        .map(band)
        .filter(|b| b.frames > 0)
        .collect()
}

/// The worst tracked frame of each clip, the worst of these first.
fn worst(samples: &[Sample<'_>], count: usize) -> Vec<Worst> {
    let mut shown: Vec<Worst> = Vec::new();
    for clip in samples.chunk_by(|a, b| a.clip == b.clip) {
        let errors = clip.iter().filter_map(|s| {
            let (found, signed) = (s.found.tracked.as_ref()?, s.signed?);
            Some((s.mean_deg()?, s, found, signed))
        });
        if let Some((mean_deg, s, found, signed_deg)) = errors.max_by(|a, b| a.0.total_cmp(&b.0)) {
            shown.push(Worst {
                clip: s.clip,
                frame: s.frame,
                mean_deg,
                signed_deg,
                truth: s.truth.points,
                found: found.points,
            });
        }
    }
    shown.sort_by(|a, b| b.mean_deg.total_cmp(&a.mean_deg));
    shown.truncate(count);
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracked::{Confidence, Tracked};

    fn truth(yaw: f64) -> Truth {
        let points = std::array::from_fn(|i| [i as f64, (i % 7) as f64 * 10.0]);
        Truth::new([yaw, 0.0, 0.0], points)
    }

    /// A result that is so far off in yaw and in all landmarks.
    fn frame(truth: &Truth, off_deg: f64, off_px: f64) -> Frame {
        Frame {
            tracked: Some(Tracked {
                angles: [truth.angles[0] + off_deg, 0.0, 0.0],
                points: truth.points.map(|[x, y]| [x + off_px, y]),
            }),
            confidence: Some(Confidence {
                face: 0.75,
                landmarks: [0.25; 68],
                visibility: None,
            }),
            milliseconds: Some(off_deg.abs()),
            ..Frame::default()
        }
    }

    fn figures() -> SystemFigures {
        let clip = |name: &str, yaws: [f64; 3]| Clip {
            path: name.into(),
            name: name.into(),
            truth: yaws.map(truth).to_vec(),
        };
        let clips = [clip("a", [-5.0, 5.0, 5.0]), clip("b", [178.0, 12.0, 14.0])];
        let result = |c: usize, f: usize, deg, px| frame(&clips[c].truth[f], deg, px);
        let a = vec![
            result(0, 0, -3.0, 0.0),
            result(0, 1, 6.0, 0.0),
            Frame::default(),
        ];
        let b = vec![
            result(1, 0, 9.0, 500.0),
            result(1, 1, 3.0, 0.0),
            result(1, 2, -6.0, 0.0),
        ];
        SystemFigures::of("x", &clips, vec![a, b], 1, 1)
    }

    #[test]
    fn figures_by_hand() {
        let figures = figures();
        let share = |degrees: f64| figures.robustness.shares[(degrees / 0.3) as usize];
        // Mean errors of 1, 2, 3, 1 and 2 degrees, and a frame that is not tracked.
        assert_eq!(
            [0.3, 1.2, 2.1, 30.0].map(share),
            [0.0, 2.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0]
        );
        let band = |yaw| figures.bands.iter().find(|b| b.yaw_deg == yaw).unwrap();
        assert_eq!(band(5.0).signed_deg, Some([6.0, 0.0, 0.0]));
        assert_eq!((band(5.0).frames, band(5.0).tracked), (2, 1));
        assert_eq!(band(15.0).signed_deg, Some([-1.5, 0.0, 0.0]));
        assert_eq!(band(15.0).mean_deg, Some(1.5));
        let time = figures.time.as_ref().unwrap();
        assert_eq!((time.median, time.max), (6.0, 9.0));
        let calibration = figures.calibration.as_ref().unwrap();
        let bin = &calibration.face[0];
        assert_eq!((bin.count, bin.confidence, bin.right), (5, 0.75, 0.8));
        assert_eq!(calibration.landmarks[0].count, 5 * 51);
        let [worst] = &figures.worst[..] else {
            panic!("one")
        };
        assert_eq!((worst.clip, worst.frame, worst.mean_deg), (1, 0, 3.0));
        assert_eq!(figures.scrub[0], Some([9.0, 0.0, 0.0]));
    }
}
