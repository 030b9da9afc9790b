//! Errors of 68 landmarks on stills.
//!
//! NME of a face = mean distance between found and labelled landmarks over the distance of the
//! labelled outer eye corners (36, 45). Means and medians run over the faces found; the failure
//! rate and the AUC run over all pictures, a face not found counting as an infinite error.

use posewise_metrics::cumulative::area_under_ced;
use posewise_metrics::landmarks::{
    bounds, box_size, eye_centres, iou, normalized_errors, outer_corners,
};
use posewise_metrics::{calibration_error, mean, median};
use serde::Serialize;
use std::collections::BTreeMap;

/// Labelled or found landmarks \[px\].
pub type Points = [[f64; 2]; 68];

/// NME above which a face counts as failed.
pub const FAILURE_NME: f64 = 0.10;
/// NME at which the area under the cumulative error curve ends.
pub const AUC_NME: f64 = 0.08;
/// The same of a second area, which some papers give.
pub const WIDE_AUC_NME: f64 = 0.10;
/// Overlap of found and labelled box from which on it is the same face.
pub const SAME_FACE_IOU: f64 = 0.3;

/// Refiners of the iBUG 68 scheme: first landmark, one past the last.
pub const PARTS: [(&str, usize, usize); 5] = [
    ("jaw", 0, 17),
    ("brows", 17, 27),
    ("nose", 27, 36),
    ("eyes", 36, 48),
    ("mouth", 48, 68),
];

/// How far the head is turned, estimated from the labels alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YawBand {
    /// Asymmetry below 0.25.
    Frontal,
    /// 0.25 to 0.55.
    Turned,
    /// Above 0.55.
    FarTurned,
}

impl YawBand {
    /// All bands with their names in reports.
    pub const ALL: [(YawBand, &'static str); 3] = [
        (YawBand::Frontal, "frontal"),
        (YawBand::Turned, "turned"),
        (YawBand::FarTurned, "far_turned"),
    ];
}

/// The outcome of one picture.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Yaw band of the labels.
    pub band: YawBand,
    /// Distances per landmark over the inter-ocular distance; `None` when the labelled face was
    /// not found.
    pub errors: Option<[f64; 68]>,
    /// Where the found landmarks lie on average beside the labelled ones, along the labelled eye
    /// line and down across it, over the inter-ocular distance.
    pub shift: Option<[f64; 2]>,
    /// The confidences of that fit, where they are wanted.
    pub confidence: Option<FitConfidence>,
    /// The face's size that confidences refer to, over the inter-ocular distance: 1 towards the
    /// camera, more where turning shortens that distance.
    scale: f64,
    /// The inter-ocular distance over the root of the box's area, and over the distance between the
    /// centres of the eyes: what turns an error into one by these sizes.
    ratios: [f64; 2],
}

/// Probabilities that came with a fit.
#[derive(Clone, Debug)]
pub struct FitConfidence {
    /// That the landmarks are right on average.
    pub face: f64,
    /// That each landmark is right.
    pub landmarks: [f64; 68],
}

impl Outcome {
    /// Compares what was found (if anything) with the labels.
    pub fn new(label: &Points, found: Option<&Points>) -> Self {
        let same = found.filter(|f| iou(&bounds(label), &bounds(*f)) >= SAME_FACE_IOU);
        Outcome {
            band: yaw_band(label),
            errors: same.map(|f| errors(label, f)),
            shift: same.map(|f| shift(label, f)),
            confidence: None,
            scale: scale(label),
            ratios: ratios(label),
        }
    }

    /// Mean errors of landmarks `from..68` by the root of the box's area and by the distance
    /// between the centres of the eyes.
    pub fn nme_by_sizes(&self, from: usize) -> Option<[f64; 2]> {
        self.nme(from, 68).map(|e| self.ratios.map(|r| r * e))
    }

    /// The face's probability and whether it was right.
    fn face(&self) -> Option<(f64, bool)> {
        let right = self.nme(0, 68).is_some_and(|e| e < RIGHT * self.scale);
        Some((self.confidence.as_ref()?.face, right))
    }

    /// The landmarks' probabilities and whether each was right.
    fn landmarks(&self) -> Vec<(f64, bool)> {
        let (Some(confidence), Some(errors)) = (&self.confidence, &self.errors) else {
            return vec![];
        };
        let pairs = confidence.landmarks.iter().zip(errors);
        pairs.map(|(p, e)| (*p, *e <= RIGHT * self.scale)).collect()
    }

    /// Mean error of landmarks `from..to`.
    pub fn nme(&self, from: usize, to: usize) -> Option<f64> {
        mean(self.errors.as_ref()?.get(from..to)?)
    }

    /// Whether the face counts as failed.
    pub fn failed(&self) -> bool {
        // A NaN is a failure too.
        !self.nme(0, 68).is_some_and(|e| e <= FAILURE_NME)
    }
}

/// From the outer corner of the right eye to that of the left one \[px\].
pub fn eye_line(label: &Points) -> [f64; 2] {
    [0, 1].map(|k| label[45][k] - label[36][k])
}

/// A displacement \[px\] along the labelled eye line and down across it, over its length.
fn by_eye_line(label: &Points, [dx, dy]: [f64; 2]) -> [f64; 2] {
    let [x, y] = eye_line(label);
    let squared = (x * x + y * y).max(1e-18);
    [(dx * x + dy * y) / squared, (dy * x - dx * y) / squared]
}

fn shift(label: &Points, found: &Points) -> [f64; 2] {
    let sum = |k: usize| -> f64 { label.iter().zip(found).map(|(l, f)| f[k] - l[k]).sum() };
    by_eye_line(label, [0, 1].map(|k| sum(k) / 68.0))
}

/// A landmark is right within this share of the face's size.
const RIGHT: f64 = 0.1;

/// The eye corners' distance that the face would have if it were not turned (at least 0.42 of the
/// root of its box's area) over the one that it has.
fn scale(label: &Points) -> f64 {
    let iod = outer_corners(label).max(1e-9);
    (0.42 * box_size(label) / iod).max(1.0)
}

/// The inter-ocular distance over the root of the area of the box around the landmarks, and over
/// the distance between the centres of the eyes.
fn ratios(label: &Points) -> [f64; 2] {
    let iod = outer_corners(label);
    [box_size(label), eye_centres(label)].map(|size| iod / size.max(1e-9))
}

fn errors(label: &Points, found: &Points) -> [f64; 68] {
    normalized_errors(label, found, outer_corners(label).max(1e-9))
}

/// |dl − dr| / (dl + dr), dl and dr the distances along the eye line from the nose tip (30) to the
/// outer eye corners 36 and 45: 0 frontal, 1 when the tip is level with a corner or past it.
pub fn asymmetry(label: &Points) -> f64 {
    // dl + dr is the line's length as long as the tip lies between the corners.
    let [to_right, _] = by_eye_line(label, [0, 1].map(|k| label[30][k] - label[36][k]));
    (2.0 * to_right - 1.0).abs().min(1.0)
}

fn yaw_band(label: &Points) -> YawBand {
    match asymmetry(label) {
        a if a < 0.25 => YawBand::Frontal,
        a if a <= 0.55 => YawBand::Turned,
        _ => YawBand::FarTurned,
    }
}

/// The numbers of a set of pictures: shares, and errors as fractions; `None` where nothing was
/// found.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Number of pictures.
    pub images: usize,
    /// Share found.
    pub found: f64,
    /// NME of 68 landmarks.
    pub nme68_mean: Option<f64>,
    /// The same.
    pub nme68_median: Option<f64>,
    /// NME of the 51 inner landmarks.
    pub nme51_mean: Option<f64>,
    /// The same.
    pub nme51_median: Option<f64>,
    /// Share failed.
    pub failure: f64,
    /// Area under the cumulative error curve to [`AUC_NME`], over that.
    pub auc68: f64,
    /// The same of the inner landmarks.
    pub auc51: f64,
    /// The area to [`WIDE_AUC_NME`].
    pub auc68_to_10: f64,
    /// The same of the inner landmarks.
    pub auc51_to_10: f64,
    /// Mean NME by the root of the box's area.
    pub nme68_box: Option<f64>,
    /// The same of the inner landmarks.
    pub nme51_box: Option<f64>,
    /// Mean NME by the distance between the centres of the eyes ("pupils").
    pub nme68_pupils: Option<f64>,
    /// The same of the inner landmarks.
    pub nme51_pupils: Option<f64>,
    /// Mean NME of each of [`PARTS`].
    pub parts: BTreeMap<&'static str, Option<f64>>,
    /// Expected calibration error of the landmarks' confidence.
    pub calibration_landmarks: Option<f64>,
    /// The same of the face's.
    pub calibration_face: Option<f64>,
}

/// Sums up.
pub fn summarize<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Summary {
    let all: Vec<&Outcome> = outcomes.collect();
    let share = |count: usize| count as f64 / all.len().max(1) as f64;
    let nme = |from, to| -> Vec<f64> { all.iter().filter_map(|o| o.nme(from, to)).collect() };
    let auc = |errors: &[f64], limit| area_under_ced(errors, all.len(), limit);
    let by_size = |from: usize, k: usize| -> Option<f64> {
        let errors = all.iter().filter_map(|o| Some(o.nme_by_sizes(from)?[k]));
        mean(&errors.collect::<Vec<_>>())
    };
    let (all68, inner51) = (nme(0, 68), nme(17, 68));
    let landmarks: Vec<(f64, bool)> = all.iter().flat_map(|o| o.landmarks()).collect();
    let faces: Vec<(f64, bool)> = all.iter().filter_map(|o| o.face()).collect();
    Summary {
        images: all.len(),
        found: share(all68.len()),
        nme68_mean: mean(&all68),
        nme68_median: median(&all68),
        nme51_mean: mean(&inner51),
        nme51_median: median(&inner51),
        failure: share(all.iter().filter(|o| o.failed()).count()),
        auc68: auc(&all68, AUC_NME),
        auc51: auc(&inner51, AUC_NME),
        auc68_to_10: auc(&all68, WIDE_AUC_NME),
        auc51_to_10: auc(&inner51, WIDE_AUC_NME),
        nme68_box: by_size(0, 0),
        nme51_box: by_size(17, 0),
        nme68_pupils: by_size(0, 1),
        nme51_pupils: by_size(17, 1),
        parts: BTreeMap::from(PARTS.map(|(name, from, to)| (name, mean(&nme(from, to))))),
        calibration_landmarks: calibration_error(&landmarks),
        calibration_face: calibration_error(&faces),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eye corners 100 px apart, the nose tip at `tip_x`, all others on a small grid.
    fn label(tip_x: f64) -> Points {
        let mut p: Points =
            std::array::from_fn(|i| [(i % 10) as f64 * 10.0, (i / 10) as f64 * 15.0]);
        p[36] = [0.0, 40.0];
        p[45] = [100.0, 40.0];
        p[30] = [tip_x, 70.0];
        p
    }

    fn shifted(p: &Points, range: std::ops::Range<usize>, dx: f64) -> Points {
        let mut out = *p;
        out[range].iter_mut().for_each(|q| q[0] += dx);
        out
    }

    #[test]
    fn bands_by_hand() {
        assert_eq!(asymmetry(&label(50.0)), 0.0);
        assert!((asymmetry(&label(70.0)) - 0.4).abs() < 1e-12);
        assert!((asymmetry(&label(30.0)) - 0.4).abs() < 1e-12);
        assert_eq!(asymmetry(&label(130.0)), 1.0);
        assert_eq!(yaw_band(&label(60.0)), YawBand::Frontal);
        assert_eq!(yaw_band(&label(70.0)), YawBand::Turned);
        assert_eq!(yaw_band(&label(10.0)), YawBand::FarTurned);
    }

    #[test]
    fn errors_by_hand() {
        let l = label(50.0);
        // Jaw 17 px off, everything else exact: 17 · 0.17 / 68 = 0.0425 over all, 0 inside.
        let outcome = Outcome::new(&l, Some(&shifted(&l, 0..17, 17.0)));
        assert!((outcome.nme(0, 68).unwrap() - 0.0425).abs() < 1e-12);
        assert_eq!(outcome.nme(17, 68), Some(0.0));
        assert!((outcome.nme(0, 17).unwrap() - 0.17).abs() < 1e-12);
        assert!(!outcome.failed());
        assert!(Outcome::new(&l, Some(&shifted(&l, 0..68, 11.0))).failed());
        let elsewhere = Outcome::new(&l, Some(&shifted(&l, 0..68, 90.0)));
        assert!(
            elsewhere.errors.is_none() && elsewhere.failed(),
            "another face"
        );
        assert!(Outcome::new(&l, None).failed());
    }

    /// A turned picture: 3 px to the image's right and 4 px down are 5 px along an eye line of
    /// 100 px that falls as steeply.
    #[test]
    fn shift_by_hand() {
        let turned = label(50.0).map(|[x, y]| [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y]);
        let moved = turned.map(|[x, y]| [x + 3.0, y + 4.0]);
        let [along, down] = Outcome::new(&turned, Some(&moved)).shift.unwrap();
        assert!((along - 0.05).abs() < 1e-12 && down.abs() < 1e-12);
        assert_eq!(Outcome::new(&turned, None).shift, None);
    }

    #[test]
    fn summary_by_hand() {
        let l = label(50.0);
        let at = |dx| Outcome::new(&l, Some(&shifted(&l, 0..68, dx)));
        let outcomes = [at(2.0), at(4.0), at(12.0), Outcome::new(&l, None)];
        let s = summarize(outcomes.iter());
        let near = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-9;
        assert_eq!((s.images, s.found, s.failure), (4, 0.75, 0.5));
        assert!(near(s.nme68_mean, 0.06) && near(s.nme68_median, 0.04));
        // (0.75 + 0.5 + 0 + 0) / 4
        assert!(near(Some(s.auc68), 0.3125));
        assert!(s.parts.values().all(|p| near(*p, 0.06)));
        // Eye corners 100 px apart, a box of 100 × 90 px.
        assert!(near(s.nme68_box, 0.06 * 100.0 / 9000f64.sqrt()));
        let apart = |p: &Points, eye: std::ops::Range<usize>, k: usize| -> f64 {
            p[eye].iter().map(|q| q[k]).sum::<f64>() / 6.0
        };
        let pupils = [0, 1].map(|k| apart(&l, 36..42, k) - apart(&l, 42..48, k));
        assert!(near(
            s.nme51_pupils,
            0.06 * 100.0 / pupils[0].hypot(pupils[1])
        ));
        // (0.8 + 0.6 + 0 + 0) / 4
        assert!(near(Some(s.auc68_to_10), 0.35));
        assert_eq!(summarize([].iter()).nme68_mean, None);
    }
}
