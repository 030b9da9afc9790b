//! Pictures with 68 labelled landmarks: `image,x0,y0,…,x67,y67`.

use anyhow::{Context, Result, ensure};
use posewise::shape::LANDMARKS;
use std::path::Path;

/// One labelled picture.
#[derive(Clone, Debug)]
pub struct Label {
    /// File name.
    pub image: String,
    /// iBUG 68 \[px\], centre of the top-left pixel at (0, 0).
    pub points: [[f32; 2]; LANDMARKS],
}

/// Reads the table.
pub fn read(csv: &Path) -> Result<Vec<Label>> {
    let mut reader =
        csv::Reader::from_path(csv).with_context(|| format!("cannot read {}", csv.display()))?;
    reader.records().map(|record| label(&record?)).collect()
}

fn label(record: &csv::StringRecord) -> Result<Label> {
    let image = record.get(0).context("an empty row")?.to_owned();
    let values: Vec<f32> = record
        .iter()
        .skip(1)
        .map(|v| v.trim().parse::<f32>())
        .collect::<Result<_, _>>()
        .with_context(|| format!("row of {image}"))?;
    ensure!(
        values.len() == 2 * LANDMARKS && values.iter().all(|v| v.is_finite()),
        "row of {image}: not 136 finite numbers"
    );
    let points = std::array::from_fn(|i| [values[2 * i], values[2 * i + 1]]);
    Ok(Label { image, points })
}

/// The person in a picture: the file name without its last number (`a_Jane_Roe_03.jpg`) and
/// without the leading letter.
pub fn person(image: &str) -> &str {
    let stem = image.rsplit_once('_').map_or(image, |(stem, _)| stem);
    match stem.split_once('_') {
        Some((prefix, rest)) if prefix.len() == 1 => rest,
        _ => stem,
    }
}

/// Landmark of the other side.
pub fn mirror(landmark: usize) -> usize {
    match landmark {
        0..17 => 16 - landmark,
        17..27 => 43 - landmark,
        31..36 => 66 - landmark,
        36..40 => 81 - landmark,
        42..46 => 81 - landmark,
        40 | 41 | 46 | 47 => 87 - landmark,
        48..55 => 102 - landmark,
        55..60 => 114 - landmark,
        60..65 => 124 - landmark,
        65..68 => 132 - landmark,
        _ => landmark,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_and_names() {
        assert!((0..LANDMARKS).all(|i| mirror(mirror(i)) == i));
        assert_eq!(
            [36, 37, 41, 48, 51, 60, 67].map(mirror),
            [45, 44, 46, 54, 51, 64, 65]
        );
        assert_eq!(person("a_Jane_Roe_03.jpg"), "Jane_Roe");
    }
}
