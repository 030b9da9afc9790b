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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_people() {
        assert_eq!(person("a_Jane_Roe_03.jpg"), "Jane_Roe");
    }
}
