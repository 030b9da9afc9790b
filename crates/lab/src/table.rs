//! CSV tables by column name, with errors that name file and line.

use anyhow::{Context, Result, bail};
use std::path::Path;

/// A CSV file in memory.
pub struct Table {
    name: String,
    header: csv::StringRecord,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads the whole file.
    pub fn read(path: &Path) -> Result<Table> {
        let name = path.display().to_string();
        let mut builder = csv::ReaderBuilder::new();
        let reader = builder.trim(csv::Trim::All).from_path(path);
        let mut reader = reader.with_context(|| name.clone())?;
        let header = reader.headers().with_context(|| name.clone())?.clone();
        let rows = reader.records().collect::<Result<_, _>>();
        Ok(Table {
            rows: rows.with_context(|| name.clone())?,
            name,
            header,
        })
    }

    /// Number of rows below the header.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Where this column is, if it is there.
    pub fn find(&self, column: &str) -> Option<usize> {
        self.header.iter().position(|h| h == column)
    }

    /// Where this column is.
    pub fn column(&self, column: &str) -> Result<usize> {
        let found = self.find(column);
        found.with_context(|| format!("{} has no column {column}", self.name))
    }

    /// Where the columns of 68 points are, by the letters before their numbers.
    pub fn points(&self, [x, y]: [&str; 2]) -> Result<[[usize; 2]; 68]> {
        let mut at = [[0; 2]; 68];
        for (i, at) in at.iter_mut().enumerate() {
            *at = [
                self.column(&format!("{x}{i}"))?,
                self.column(&format!("{y}{i}"))?,
            ];
        }
        Ok(at)
    }

    /// A finite number.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        let record = &self.rows[row];
        let text = record.get(column).unwrap_or_default();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => {
                let line = record.position().map_or(0, csv::Position::line);
                bail!("{}, line {line}: {text:?} is not a number", self.name)
            }
        }
    }

    /// A finite number, or `None` of an empty cell.
    pub fn number_if_any(&self, row: usize, column: usize) -> Result<Option<f64>> {
        let is_empty = self.rows[row].get(column).is_none_or(str::is_empty);
        (!is_empty).then(|| self.number(row, column)).transpose()
    }

    /// Finite numbers of one row.
    pub fn numbers<const N: usize>(&self, row: usize, columns: [usize; N]) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for (number, column) in numbers.iter_mut().zip(columns) {
            *number = self.number(row, column)?;
        }
        Ok(numbers)
    }

    /// 68 points of one row.
    pub fn points_of(&self, row: usize, columns: &[[usize; 2]; 68]) -> Result<[[f64; 2]; 68]> {
        let mut points = [[0.0; 2]; 68];
        for (point, at) in points.iter_mut().zip(columns) {
            *point = self.numbers(row, *at)?;
        }
        Ok(points)
    }
}
