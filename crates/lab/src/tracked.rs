//! What a tracker found in each frame, as `posewise track --csv` writes it.

use crate::table::Table;
use anyhow::{Result, ensure};
use posewise::{State, TrackResult};
use std::collections::BTreeMap;
use std::path::Path;

/// One frame in which the face was tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// Yaw, pitch, roll of docs/conventions.md \[deg\].
    pub angles: [f64; 3],
    /// Landmarks \[px\].
    pub points: [[f64; 2]; 68],
}

impl Tracked {
    /// The product's result; `None` unless the face was fitted on that frame.
    pub fn of(result: &TrackResult) -> Option<Tracked> {
        (result.state == State::Tracking).then(|| Tracked {
            angles: [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from),
            points: result.landmarks.map(|l| [l.x, l.y].map(f64::from)),
        })
    }
}

/// Frames by their number from 0; those without success are left out.
pub fn read(path: &Path) -> Result<BTreeMap<usize, Tracked>> {
    let table = Table::read(path)?;
    let (frame, success) = (table.column("frame")?, table.column("success")?);
    let angles = [
        table.column("yaw_deg")?,
        table.column("pitch_deg")?,
        table.column("roll_deg")?,
    ];
    let points = table.points(["x_", "y_"])?;
    let mut found = BTreeMap::new();
    for row in 0..table.len() {
        if table.number(row, success)? < 0.5 {
            continue;
        }
        let from_1 = table.number(row, frame)?;
        let shown = path.display();
        ensure!(from_1 >= 1.0, "{shown}: frames count from 1, not {from_1}");
        let tracked = Tracked {
            angles: table.numbers(row, angles)?,
            points: table.points_of(row, &points)?,
        };
        found.insert(from_1 as usize - 1, tracked);
    }
    Ok(found)
}
