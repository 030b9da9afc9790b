//! Pictures with 68 labelled landmarks: `image,x0,y0,…,x67,y67`, or `image,spread,x0,…`.

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
    /// Mean distance of several annotators from their mean, which `points` are \[outer-eye
    /// distances\]; none where one annotator set them.
    pub spread: Option<f32>,
}

/// Reads the table.
pub fn read(csv: &Path) -> Result<Vec<Label>> {
    let mut reader =
        csv::Reader::from_path(csv).with_context(|| format!("cannot read {}", csv.display()))?;
    let spread = reader.headers()?.get(1) == Some("spread");
    reader
        .records()
        .map(|record| label(&record?, spread))
        .collect()
}

fn label(record: &csv::StringRecord, spread: bool) -> Result<Label> {
    let image = record.get(0).context("an empty row")?.to_owned();
    let mut values: Vec<f32> = record
        .iter()
        .skip(1)
        .map(|v| v.trim().parse::<f32>())
        .collect::<Result<_, _>>()
        .with_context(|| format!("row of {image}"))?;
    let numbers = 2 * LANDMARKS + usize::from(spread);
    ensure!(
        values.len() == numbers && values.iter().all(|v| v.is_finite()),
        "row of {image}: not {numbers} finite numbers"
    );
    let spread = spread.then(|| values.remove(0));
    let points = std::array::from_fn(|i| [values[2 * i], values[2 * i + 1]]);
    Ok(Label {
        image,
        points,
        spread,
    })
}

/// The person in a picture: the file name without its folders, without its last number
/// (`a_Jane_Roe_03.jpg`) and without the leading letter.
pub fn person(image: &str) -> &str {
    let name = image.rsplit_once('/').map_or(image, |(_, name)| name);
    let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
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
        assert_eq!(person("faces-many/mux/Jane_Roe_0001.jpg"), "Jane_Roe");
    }

    #[test]
    fn reads_the_spread_where_there_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        let columns: Vec<String> = (0..LANDMARKS).map(|i| format!("x{i},y{i}")).collect();
        let points = vec!["1.5,2.5"; LANDMARKS].join(",");
        for (column, value, spread) in [("", "", None), (",spread", ",0.02", Some(0.02))] {
            let header = format!("image{column},{}", columns.join(","));
            std::fs::write(&path, format!("{header}\na_b_1.jpg{value},{points}\n")).unwrap();
            let rows = read(&path).unwrap();
            assert_eq!(rows[0].points[67], [1.5, 2.5]);
            assert_eq!(rows[0].spread, spread);
        }
    }
}
