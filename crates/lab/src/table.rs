//! CSV tables by column name, with errors that name file, line and column.

use anyhow::{Context, Result, bail};
use std::path::Path;

/// A CSV file in memory.
pub struct Table {
    name: String,
    header: csv::StringRecord,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads the whole file, which has at least one row.
    pub fn read(path: &Path) -> Result<Table> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).with_context(|| format!("cannot open {name}"))?;
        Self::parse(name, file)
    }

    /// Reads from anything; `name` is for messages.
    pub fn parse(name: String, reader: impl std::io::Read) -> Result<Table> {
        let mut builder = csv::ReaderBuilder::new();
        let mut reader = builder.trim(csv::Trim::All).from_reader(reader);
        let context = || format!("{name} is not a CSV table");
        let header = reader.headers().with_context(context)?.clone();
        let rows = reader.records().collect::<Result<Vec<_>, _>>();
        let rows = rows.with_context(context)?;
        if rows.is_empty() {
            bail!("{name} has no rows");
        }
        Ok(Table { name, header, rows })
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

    /// Where the columns `prefix0` … `prefix67` are.
    pub fn columns68(&self, prefix: &str) -> Result<[usize; 68]> {
        let mut out = [0; 68];
        for (i, at) in out.iter_mut().enumerate() {
            *at = self.column(&format!("{prefix}{i}"))?;
        }
        Ok(out)
    }

    /// Where the columns of 68 points are, by the letters before their numbers.
    pub fn points(&self, [x, y]: [&str; 2]) -> Result<[[usize; 2]; 68]> {
        let (xs, ys) = (self.columns68(x)?, self.columns68(y)?);
        Ok(std::array::from_fn(|i| [xs[i], ys[i]]))
    }

    /// The focal length \[px\] in the first row's column `fx`, if there is one.
    pub fn focal(&self) -> Option<f32> {
        let column = self.find("fx")?;
        self.number(0, column).ok().map(|f| f as f32)
    }

    /// A cell's text.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].get(column).unwrap_or_default()
    }

    /// A finite number.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        let text = self.text(row, column);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => {
                let line = self.rows[row].position().map_or(0, csv::Position::line);
                let column = self.header.get(column).unwrap_or("?");
                bail!(
                    "{}, line {line}: {column} is {text:?}, not a number",
                    self.name
                )
            }
        }
    }

    /// A finite number, or `None` of an empty cell.
    pub fn number_if_any(&self, row: usize, column: usize) -> Result<Option<f64>> {
        let is_empty = self.text(row, column).is_empty();
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
