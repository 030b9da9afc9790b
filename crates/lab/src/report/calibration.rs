//! How often a system is as right as it says.

use crate::compare::size;
use crate::tracked::Frame;
use crate::truth::Truth;
use posewise_metrics::landmarks::{INNER, distance};
use posewise_metrics::{calibration_error, mean};
use serde::Serialize;

/// Parts of the range of confidences.
const BINS: usize = 10;
/// A landmark is right within this share of the inter-ocular distance, as `Landmark::confidence`
/// says.
const RIGHT: f64 = 0.1;
/// Inter-ocular distance of a frontal face over the root of the area of its landmarks' box, as in
/// `posewise-lab eval landmarks`: the least that is assumed of a turned face.
const EYES_OVER_BOX: f64 = 0.42;

/// How often what has a confidence is right.
#[derive(Serialize)]
pub struct Calibration {
    /// Of the face: the mean error of the inner landmarks is below the limit.
    pub face: Vec<Bin>,
    /// Of the inner landmarks.
    pub landmarks: Vec<Bin>,
    /// Expected calibration errors of both.
    pub errors: [Option<f64>; 2],
}

/// Confidences in one part of the range.
#[derive(Serialize)]
pub struct Bin {
    /// How many.
    pub count: usize,
    /// Their mean.
    pub confidence: f64,
    /// Share that is right.
    pub right: f64,
}

impl Calibration {
    /// Of frames that count; `None` if none of them has a confidence.
    pub fn of<'a>(frames: impl Iterator<Item = (&'a Truth, &'a Frame)>) -> Option<Calibration> {
        let (mut faces, mut landmarks) = (Vec::new(), Vec::new());
        for (truth, frame) in frames {
            let (Some(found), Some(confidence)) = (&frame.tracked, &frame.confidence) else {
                continue;
            };
            let points = &truth.points;
            let eyes = distance(points[36], points[45]).max(EYES_OVER_BOX * size(truth));
            let inner = INNER..points.len();
            let errors = inner
                .clone()
                .map(|i| distance(points[i], found.points[i]) / eyes);
            let errors: Vec<f64> = errors.collect();
            faces.push((confidence.face, mean(&errors)? < RIGHT));
            let right = errors.iter().map(|e| *e < RIGHT);
            landmarks.extend(inner.map(|i| confidence.landmarks[i]).zip(right));
        }
        (!faces.is_empty()).then(|| Calibration {
            face: bins(&faces),
            landmarks: bins(&landmarks),
            errors: [&faces, &landmarks].map(|pairs| calibration_error(pairs)),
        })
    }
}

fn bins(pairs: &[(f64, bool)]) -> Vec<Bin> {
    let mut sums = [(0, 0.0, 0); BINS];
    for (confidence, is_right) in pairs {
        let bin = &mut sums[((confidence * BINS as f64) as usize).min(BINS - 1)];
        *bin = (
            bin.0 + 1,
            bin.1 + confidence,
            bin.2 + usize::from(*is_right),
        );
    }
    let filled = sums.into_iter().filter(|(count, ..)| *count > 0);
    let bin = |(count, sum, right): (usize, f64, usize)| Bin {
        count,
        confidence: sum / count as f64,
        right: right as f64 / count as f64,
    };
    filled.map(bin).collect()
}
