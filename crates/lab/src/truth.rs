//! Truth of rendered clips: one row per frame, as [`crate::sweeps`] writes it.

use crate::table::Table;
use anyhow::Result;
use std::path::Path;

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Number, from 0.
    pub frame: usize,
    /// Yaw, pitch, roll \[deg\].
    pub angles: [f64; 3],
    /// Midpoint of the eyeballs, camera frame \[mm\], if the table has it.
    pub eye_mid: Option<[f64; 3]>,
    /// Landmarks, the jaw as fixed points of the head \[px\]; NaN if the table has none.
    pub points: [[f64; 2]; 68],
    /// Share of the landmarks in the picture.
    pub in_frame: f64,
    /// Landmarks that are neither hidden by the head nor covered, as far as the table knows.
    pub visible: [bool; 68],
    /// Landmarks that something covers, whether or not the head hides them too; `None` if the table
    /// has no such columns.
    pub covered: Option<[bool; 68]>,
    /// Whether something passes before the face; `None` if the table has no such column.
    pub occluder: Option<bool>,
    /// Focal length \[px\], if the table has it.
    pub focal: Option<f64>,
}

impl Truth {
    /// A face of which everything is seen, and no more is known.
    pub fn new(angles: [f64; 3], points: [[f64; 2]; 68]) -> Truth {
        Truth {
            frame: 0,
            angles,
            eye_mid: None,
            points,
            in_frame: 1.0,
            visible: [true; 68],
            covered: None,
            occluder: None,
            focal: None,
        }
    }

    /// Whether the landmarks are known.
    pub fn is_marked(&self) -> bool {
        self.points[0][0].is_finite()
    }

    /// Whether something covers at least half of the landmarks.
    pub fn is_covered(&self) -> Option<bool> {
        let count = |covered: [bool; 68]| covered.iter().filter(|c| **c).count();
        self.covered.map(|covered| 2 * count(covered) >= 68)
    }
}

/// Frames in order.
pub fn read(path: &Path) -> Result<Vec<Truth>> {
    of(&Table::read(path)?)
}

/// Frames of a table that says what is seen and where the head is.
pub fn whole(table: &Table) -> Result<Vec<Truth>> {
    table.columns68("v")?;
    table.points(["x", "y"])?;
    table.column("eye_mid_x")?;
    of(table)
}

fn of(table: &Table) -> Result<Vec<Truth>> {
    let three = |[a, b, c]: [&str; 3]| -> Result<[usize; 3]> {
        Ok([table.column(a)?, table.column(b)?, table.column(c)?])
    };
    let angles = three(["yaw", "pitch", "roll"])?;
    let eye_mid = three(["eye_mid_x", "eye_mid_y", "eye_mid_z"]).ok();
    let has_points = table.find("x0").is_some();
    let points = has_points.then(|| table.points(["x", "y"])).transpose()?;
    let [seen, covered] = ["v", "o"].map(|letter| table.columns68(letter).ok());
    let [frame, in_frame, occluder, focal] =
        ["frame", "in_frame", "occluder", "fx"].map(|name| table.find(name));
    let row = |row| -> Result<Truth> {
        let number = |column: Option<usize>| column.map(|c| table.number(row, c)).transpose();
        let marks = |columns: Option<[usize; 68]>| -> Result<Option<[bool; 68]>> {
            let values = columns.map(|c| table.numbers(row, c)).transpose()?;
            Ok(values.map(|values| values.map(|v| v > 0.5)))
        };
        let points = points.as_ref().map(|points| table.points_of(row, points));
        let points = points.transpose()?.unwrap_or([[f64::NAN; 2]; 68]);
        let (seen, covered) = (marks(seen)?.unwrap_or([true; 68]), marks(covered)?);
        let uncovered = covered.unwrap_or([false; 68]).map(|c| !c);
        Ok(Truth {
            frame: number(frame)?.map_or(row, |frame| frame as usize),
            eye_mid: eye_mid.map(|c| table.numbers(row, c)).transpose()?,
            in_frame: number(in_frame)?.unwrap_or(1.0),
            visible: std::array::from_fn(|i| seen[i] && uncovered[i]),
            covered,
            occluder: number(occluder)?.map(|o| o > 0.5),
            focal: number(focal)?,
            ..Truth::new(table.numbers(row, angles)?, points)
        })
    };
    (0..table.len()).map(row).collect()
}
