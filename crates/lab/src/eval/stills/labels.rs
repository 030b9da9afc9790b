//! Labels of pictures.

use std::path::Path;

use anyhow::Result;

use super::landmark_metrics::Points;
use crate::table::Table;

/// One labelled picture.
pub struct Label {
    pub image: String,
    pub points: Points,
}

/// Reads `image,x0,y0,…,x67,y67`.
pub fn read_labels(path: &Path) -> Result<Vec<Label>> {
    let table = Table::read(path)?;
    let image = table.column("image")?;
    let points = table.points(["x", "y"])?;
    (0..table.len())
        .map(|row| {
            Ok(Label {
                image: table.text(row, image).to_string(),
                points: table.points_of(row, &points)?,
            })
        })
        .collect()
}
