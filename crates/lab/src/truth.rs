//! Truth of rendered clips: one row per frame, as `posewise-lab eval pose` reads it.

use crate::table::Table;
use anyhow::Result;
use std::path::Path;

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Yaw, pitch, roll \[deg\].
    pub angles: [f64; 3],
    /// Landmarks, the jaw as fixed points of the head \[px\].
    pub points: [[f64; 2]; 68],
    /// Share of the landmarks in the picture.
    pub in_frame: f64,
    /// Focal length \[px\], if the table has it.
    pub focal: Option<f64>,
}

/// Frames in order.
pub fn read(path: &Path) -> Result<Vec<Truth>> {
    let table = Table::read(path)?;
    let angles = [
        table.column("yaw")?,
        table.column("pitch")?,
        table.column("roll")?,
    ];
    let points = table.points(["x", "y"])?;
    let (in_frame, focal) = (table.find("in_frame"), table.find("fx"));
    let frame = |row| -> Result<Truth> {
        let number = |column| table.number(row, column);
        Ok(Truth {
            angles: table.numbers(row, angles)?,
            points: table.points_of(row, &points)?,
            in_frame: in_frame.map_or(Ok(1.0), number)?,
            focal: focal.map(number).transpose()?,
        })
    };
    (0..table.len()).map(frame).collect()
}
