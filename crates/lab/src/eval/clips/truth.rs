//! The truth of a clip's frames.

use anyhow::Result;

use super::pose_metrics::Truth;
use crate::table::Table;

/// Each row's frame number and truth.
pub fn read_truth(table: &Table) -> Result<Vec<(i64, Truth)>> {
    let column = |name: &str| table.column(name);
    let frame = column("frame")?;
    let angles = [column("yaw")?, column("pitch")?, column("roll")?];
    let eye_mid = [
        column("eye_mid_x")?,
        column("eye_mid_y")?,
        column("eye_mid_z")?,
    ];
    let in_frame = column("in_frame").ok();
    let (xs, ys) = (table.columns68("x")?, table.columns68("y")?);
    let hidden = table.columns68("v")?;
    let covered = table.columns68("o").ok();
    let occluder = table.column("occluder").ok();
    (0..table.len())
        .map(|row| {
            let number = |column: usize| table.number(row, column);
            let three = |columns: [usize; 3]| -> Result<[f64; 3]> {
                let [a, b, c] = columns;
                Ok([number(a)?, number(b)?, number(c)?])
            };
            let mut points = [[0.0; 2]; 68];
            let mut visible = [false; 68];
            let mut under = [false; 68];
            for i in 0..68 {
                points[i] = [number(xs[i])?, number(ys[i])?];
                under[i] = covered.map_or(Ok(0.0), |c| number(c[i]))? > 0.5;
                visible[i] = number(hidden[i])? > 0.5 && !under[i];
            }
            let truth = Truth {
                angles: three(angles)?,
                eye_mid: three(eye_mid)?,
                in_frame: in_frame.map_or(Ok(1.0), number)?,
                points,
                visible,
                covered: covered.map(|_| 2 * under.iter().filter(|u| **u).count() >= 68),
                under,
                occluder: occluder.map(number).transpose()?.map(|o| o > 0.5),
            };
            Ok((number(frame)? as i64, truth))
        })
        .collect()
}
