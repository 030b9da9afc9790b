//! WFLW (Wu et al. 2018): a list with one line a face, `list_98pt_rect_attr_test.txt`: 98 points,
//! the face's box, six attributes (0 or 1), and the picture below `WFLW_images`.
//!
//! 68 of the 98 points are those of 300-W, and these are compared. The unit is the distance of the
//! outer eye corners (points 60 and 72), and the limit 10 %, as papers have them.

use super::landmarks::{Points, nme, outer_corners};
use super::predictions::{Media, Predictions, files, name_below};
use super::report::{Nme, Report};
use super::text::Text;
use anyhow::{Context, Result, ensure};
use std::path::Path;

/// The list's attributes, in order.
const SUBSETS: [&str; 6] = [
    "pose",
    "expression",
    "illumination",
    "make-up",
    "occlusion",
    "blur",
];

/// Numbers of a line before the name of the picture: points, box, attributes.
const NUMBERS: usize = 2 * 98 + 4 + 6;

/// Largest NME of the curves \[%\].
const LIMIT: f64 = 10.0;

/// One face.
pub struct Face {
    /// 300-W's points.
    points: Points,
    /// Left, top, right, bottom \[px\].
    bounds: [f64; 4],
    attributes: [bool; 6],
    picture: String,
}

/// The point of WFLW that is landmark `i` of 300-W.
fn of_300w(i: usize) -> usize {
    match i {
        0..=16 => 2 * i,
        17..=21 => i + 16,
        22..=26 => i + 20,
        27..=35 => i + 24,
        36..=37 => i + 24,
        38..=40 => i + 25,
        41..=43 => i + 26,
        44..=46 => i + 27,
        _ => i + 28,
    }
}

/// The faces of the list.
pub fn parse(text: &Text) -> Result<Vec<Face>> {
    let face = |(line, row): (usize, &str)| -> Result<Face> {
        let words: Vec<&str> = row.split_whitespace().collect();
        let count = words.len();
        let wrong = || {
            text.error(
                line,
                format_args!("{count} words, not {NUMBERS} and a name"),
            )
        };
        ensure!(count == NUMBERS + 1, wrong());
        let numbers = words[..NUMBERS].iter().map(|w| text.number(line, w));
        let numbers = numbers.collect::<Result<Vec<f64>>>()?;
        Ok(Face {
            points: std::array::from_fn(|i| [0, 1].map(|k| numbers[2 * of_300w(i) + k])),
            bounds: std::array::from_fn(|k| numbers[196 + k]),
            attributes: std::array::from_fn(|k| numbers[200 + k] > 0.5),
            picture: words[NUMBERS].into(),
        })
    };
    text.lines().map(face).collect()
}

/// Compares the faces of the one list in the folder. posewise is shown the labelled box, as papers
/// start from it. A table has one face of each picture.
pub fn run(data: &Path, predictions: &Predictions) -> Result<Report> {
    let lists = files(data, &["_test.txt"])?;
    let list = lists.first().context("no …_test.txt in the folder")?;
    let mut all = Nme::default();
    let mut subsets: [Nme; 6] = Default::default();
    for face in parse(&Text::read(list)?)? {
        let media = Media::Still(
            data.join("WFLW_images").join(&face.picture),
            Some(face.bounds),
        );
        let name = name_below(data, Path::new(&face.picture));
        let found = predictions.of(&name, &media, 1)?;
        let unit = outer_corners(&face.points);
        let error = (found[0].as_ref()).map(|t| nme(&face.points, &t.points, 0, unit));
        all.push(error);
        for (subset, is_in) in subsets.iter_mut().zip(face.attributes) {
            if is_in {
                subset.push(error);
            }
        }
    }
    let mut report = Report::default();
    Nme::head(&mut report, LIMIT);
    all.row(&mut report, "all", LIMIT);
    for (subset, name) in subsets.iter().zip(SUBSETS) {
        subset.row(&mut report, name, LIMIT);
    }
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_points_as_300w() {
        let known = [
            (0, 0),
            (16, 32),
            (17, 33),
            (21, 37),
            (22, 42),
            (26, 46),
            (27, 51),
        ];
        let more = [
            (35, 59),
            (36, 60),
            (38, 63),
            (39, 64),
            (40, 65),
            (41, 67),
            (42, 68),
        ];
        let last = [
            (44, 71),
            (45, 72),
            (46, 73),
            (47, 75),
            (48, 76),
            (60, 88),
            (67, 95),
        ];
        for (ours, theirs) in known.into_iter().chain(more).chain(last) {
            assert_eq!(of_300w(ours), theirs);
        }
    }
}
