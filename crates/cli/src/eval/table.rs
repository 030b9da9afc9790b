//! Reading tables by column name, with errors that name file, row and column.

use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};

/// A CSV file in memory.
pub struct Table {
    name: String,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads the whole file.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).with_context(|| format!("cannot open {name}"))?;
        Self::parse(&name, file)
    }

    /// Reads from anything; `name` is for messages.
    pub fn parse(name: &str, reader: impl std::io::Read) -> Result<Self> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(reader);
        let context = || format!("{name} is not a CSV table");
        let header = reader.headers().with_context(context)?;
        let header = header.iter().map(String::from).collect();
        let rows: Vec<csv::StringRecord> = reader
            .records()
            .collect::<Result<_, _>>()
            .with_context(context)?;
        if rows.is_empty() {
            bail!("{name} has no rows");
        }
        Ok(Table {
            name: name.into(),
            header,
            rows,
        })
    }

    /// Number of rows below the header.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Where the column of this name is.
    pub fn column(&self, name: &str) -> Result<usize> {
        let at = self.header.iter().position(|h| h == name);
        at.ok_or_else(|| anyhow!("{} has no column {name}", self.name))
    }

    /// Where the columns `prefix0` … `prefix67` are.
    pub fn columns68(&self, prefix: &str) -> Result<[usize; 68]> {
        let mut out = [0; 68];
        for (i, at) in out.iter_mut().enumerate() {
            *at = self.column(&format!("{prefix}{i}"))?;
        }
        Ok(out)
    }

    /// The focal length \[px\] in the first row's column `fx`, if there is one.
    pub fn focal(&self) -> Option<f32> {
        let column = self.column("fx").ok()?;
        self.number(0, column).ok().map(|f| f as f32)
    }

    /// A cell's text.
    pub fn text(&self, row: usize, column: usize) -> &str {
        let row = self.rows.get(row);
        row.and_then(|r| r.get(column)).unwrap_or("")
    }

    /// A cell's number; must be finite.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        let text = self.text(row, column);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => bail!(
                "{}, line {}: {} is {text:?}, not a number",
                self.name,
                row + 2,
                self.header.get(column).map_or("?", String::as_str)
            ),
        }
    }
}
