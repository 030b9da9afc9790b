//! Pictures with labelled landmarks: a table with the columns `image`, `x0,y0,…,x67,y67`, and
//! others before them, of which `spread` is read. Landmarks without a label are empty.

use anyhow::{Context, Result, ensure};
use posewise::shape::LANDMARKS;
use std::path::Path;

/// One labelled picture.
#[derive(Clone, Debug)]
pub struct Label {
    /// File name.
    pub image: String,
    /// iBUG 68 \[px\], centre of the top-left pixel at (0, 0); 0 where there is no label.
    pub points: [[f32; 2]; LANDMARKS],
    /// Which landmarks have a label.
    pub known: [bool; LANDMARKS],
    /// Mean distance of several annotators from their mean, which `points` are \[outer-eye
    /// distances\]; none where one annotator set them.
    pub spread: Option<f32>,
}

/// Where a table has what.
struct Columns {
    /// `x0`; all coordinates follow.
    points: usize,
    spread: Option<usize>,
}

/// Reads the table.
pub fn read(csv: &Path) -> Result<Vec<Label>> {
    let mut reader =
        csv::Reader::from_path(csv).with_context(|| format!("cannot read {}", csv.display()))?;
    let headers = reader.headers()?;
    let at = |name: &str| headers.iter().position(|h| h == name);
    let columns = Columns {
        points: at("x0").with_context(|| format!("{} has no column x0", csv.display()))?,
        spread: at("spread"),
    };
    reader
        .records()
        .map(|record| label(&record?, &columns))
        .collect()
}

fn label(record: &csv::StringRecord, columns: &Columns) -> Result<Label> {
    let image = record.get(0).context("an empty row")?.to_owned();
    let number = |at: usize| -> Result<Option<f32>> {
        let text = record.get(at).unwrap_or_default().trim();
        let value = (!text.is_empty()).then(|| text.parse::<f32>()).transpose();
        let value = value.with_context(|| format!("row of {image}"))?;
        let finite = value.is_none_or(f32::is_finite);
        ensure!(finite, "row of {image}: a number is not finite");
        Ok(value)
    };
    let all = columns.points + 2 * LANDMARKS;
    ensure!(record.len() == all, "row of {image}: not {all} columns");
    let mut points = [[0.0; 2]; LANDMARKS];
    let mut known = [false; LANDMARKS];
    for (i, (point, known)) in points.iter_mut().zip(&mut known).enumerate() {
        let x = columns.points + 2 * i;
        if let (Some(x), Some(y)) = (number(x)?, number(x + 1)?) {
            (*point, *known) = ([x, y], true);
        }
    }
    ensure!(known.contains(&true), "row of {image}: no landmark");
    Ok(Label {
        spread: columns.spread.map(number).transpose()?.flatten(),
        image,
        points,
        known,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_rows(columns: &str, values: &str) -> Result<Vec<Label>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        let points: Vec<String> = (0..LANDMARKS).map(|i| format!("x{i},y{i}")).collect();
        let header = format!("image{columns},{}", points.join(","));
        std::fs::write(&path, format!("{header}\na_b_1.jpg{values}\n")).unwrap();
        read(&path)
    }

    #[test]
    fn reads_the_spread_where_there_is_one() {
        let points = vec!["1.5,2.5"; LANDMARKS].join(",");
        for (column, value, spread) in [("", "", None), (",spread", ",0.02", Some(0.02))] {
            let rows = read_rows(column, &format!("{value},{points}")).unwrap();
            assert_eq!(rows[0].points[67], [1.5, 2.5]);
            assert_eq!(rows[0].spread, spread);
            assert!(rows[0].known.iter().all(|k| *k));
        }
    }

    #[test]
    fn landmarks_without_a_label_are_not_known() {
        let points = format!("1.5,2.5{}", ",".repeat(2 * LANDMARKS - 2));
        let rows = read_rows(",identity,kind", &format!(",7,profile,{points}")).unwrap();
        assert_eq!(rows[0].known.iter().filter(|k| **k).count(), 1);
        assert_eq!(rows[0].points[0], [1.5, 2.5]);
        for bad in [",".repeat(2 * LANDMARKS), format!(",1{}", ",2".repeat(40))] {
            assert!(read_rows("", &bad).is_err());
        }
    }
}
