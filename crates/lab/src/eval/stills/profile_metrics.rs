//! Errors on pictures of which only the landmarks of the seen half are marked.
//!
//! The unit of a picture is the distance from the marked chin to the middle of the marked brow: it
//! hardly changes with yaw. A face counts as found when its landmarks lie within [`SAME_FACE`] of
//! the marked ones on average; errors are means over the found ones.

use posewise_metrics::landmarks::distance;
use posewise_metrics::{mean, median};
use serde::Serialize;

use super::landmark_metrics::Points;

/// Landmarks of the iBUG 68 that are marked.
pub type Marked = [Option<[f64; 2]>; 68];

/// Mean error below which the found face is the marked one.
const SAME_FACE: f64 = 0.25;
/// The first of the landmarks that are not of the jaw.
const INNER: usize = 17;
/// Chin, and the middles of the brows in the left and the right half of the picture.
const CHIN: usize = 8;
const BROWS: [usize; 2] = [19, 24];

/// Bands of |geometric yaw| \[deg\].
pub const BANDS: [(&str, f64, f64); 4] = [
    ("0-30", 0.0, 30.0),
    ("30-60", 30.0, 60.0),
    ("60-75", 60.0, 75.0),
    ("75-", 75.0, f64::INFINITY),
];

/// What was found in a picture.
#[derive(Clone, Debug)]
pub struct Found {
    /// Mean error of the marked inner landmarks, over the unit.
    pub inner: f64,
    /// Mean error of the marked landmarks of the jaw, over the unit.
    pub jaw: f64,
    /// Yaw relative to the line of sight \[deg\], > 0 to the image right.
    pub facing_yaw: f64,
    /// Whether the first step found it.
    pub is_at_once: bool,
}

/// The outcome of one picture.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whether the table calls it a profile.
    pub is_profile: bool,
    /// The yaw that a mean head fitted to the marks has \[deg\], > 0 to the image right.
    pub geometric_yaw: f64,
    /// `None` when the marked face was not found.
    pub found: Option<Found>,
}

/// Distance from chin to brow \[px\]; `None` without these marks.
pub fn unit(marked: &Marked) -> Option<f64> {
    let brow = BROWS.iter().find_map(|at| marked[*at])?;
    Some(distance(marked[CHIN]?, brow)).filter(|length| *length > 0.0)
}

/// Mean errors of the marked landmarks, inner ones and jaw, over the unit; `None` if the landmarks
/// are those of another face.
pub fn errors(marked: &Marked, unit: f64, points: &Points) -> Option<[f64; 2]> {
    let errors = |range: std::ops::Range<usize>| -> Vec<f64> {
        let of = |i: usize| Some(distance(marked[i]?, points[i]) / unit);
        range.filter_map(of).collect()
    };
    let is_same = mean(&errors(0..68))? < SAME_FACE;
    let parts = [mean(&errors(INNER..68))?, mean(&errors(0..INNER))?];
    is_same.then_some(parts)
}

/// The numbers of a set of pictures; `None` where there are none.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Number of pictures.
    pub count: usize,
    /// Share of them found.
    pub found: Option<f64>,
    /// Share of them found in the first step.
    pub at_once: Option<f64>,
    /// Mean errors of the marked landmarks, over the unit: inner ones, jaw.
    pub inner: Option<f64>,
    /// See `inner`.
    pub jaw: Option<f64>,
    /// Medians of |geometric yaw|, and of the yaw relative to the line of sight towards its side.
    pub geometric_deg: Option<f64>,
    /// See `geometric_deg`.
    pub facing_deg: Option<f64>,
    /// Mean absolute difference of the two.
    pub difference_deg: Option<f64>,
}

/// Sums up.
pub fn summarize<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Summary {
    let all: Vec<&Outcome> = outcomes.collect();
    let found = || all.iter().filter_map(|o| Some((*o, o.found.as_ref()?)));
    let values =
        |of: fn(&Outcome, &Found) -> f64| -> Vec<f64> { found().map(|(o, f)| of(o, f)).collect() };
    let share = |part: usize| (!all.is_empty()).then(|| part as f64 / all.len() as f64);
    Summary {
        count: all.len(),
        found: share(found().count()),
        at_once: share(found().filter(|(_, f)| f.is_at_once).count()),
        inner: mean(&values(|_, f| f.inner)),
        jaw: mean(&values(|_, f| f.jaw)),
        geometric_deg: median(&values(|o, _| o.geometric_yaw.abs())),
        facing_deg: median(&values(|o, f| o.geometric_yaw.signum() * f.facing_yaw)),
        difference_deg: mean(&values(|o, f| (f.facing_yaw - o.geometric_yaw).abs())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A left half of which the chin lies 100 px below the brow.
    fn marked() -> Marked {
        let mut marked = [None; 68];
        marked[4] = Some([0.0, 60.0]);
        marked[CHIN] = Some([50.0, 100.0]);
        marked[BROWS[0]] = Some([50.0, 0.0]);
        marked[30] = Some([80.0, 40.0]);
        marked
    }

    fn moved(jaw: f64, inner: f64) -> Points {
        let by = |i: usize| if i < INNER { jaw } else { inner };
        let mut i = 0;
        marked().map(|p| {
            i += 1;
            p.map_or([0.0; 2], |[x, y]| [x + by(i - 1), y])
        })
    }

    #[test]
    fn errors_by_hand() {
        let marked = marked();
        assert_eq!(unit(&marked), Some(100.0));
        let [inner, jaw] = errors(&marked, 100.0, &moved(8.0, 2.0)).unwrap();
        assert!((jaw - 0.08).abs() < 1e-12 && (inner - 0.02).abs() < 1e-12);
        assert!(errors(&marked, 100.0, &moved(30.0, 30.0)).is_none());
        assert_eq!(unit(&[None; 68]), None);
    }

    #[test]
    fn summary_by_hand() {
        let outcome = |geometric_yaw, facing_yaw: Option<f64>| Outcome {
            is_profile: true,
            geometric_yaw,
            found: facing_yaw.map(|facing_yaw| Found {
                inner: 0.02,
                jaw: 0.06,
                facing_yaw,
                is_at_once: facing_yaw < 0.0,
            }),
        };
        let outcomes = [
            outcome(-80.0, Some(-70.0)),
            outcome(70.0, Some(76.0)),
            outcome(85.0, None),
            outcome(60.0, Some(-10.0)),
        ];
        let s = summarize(outcomes.iter());
        assert_eq!((s.count, s.found, s.at_once), (4, Some(0.75), Some(0.5)));
        assert_eq!((s.geometric_deg, s.facing_deg), (Some(70.0), Some(70.0)));
        assert_eq!(s.difference_deg, Some((10.0 + 6.0 + 70.0) / 3.0));
        assert_eq!(summarize([].iter()).found, None);
    }
}
