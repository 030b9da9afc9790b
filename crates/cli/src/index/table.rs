//! A video's table in Parquet: the columns of the CSV with types, and where they come from.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use posewise::TrackResult;
use serde_json::Value;

use crate::csv::{self, Cell, Row};

/// Frames of a row group. Source: chosen; 9 MB of memory for each thread, and pages of 16 KB.
const GROUP: usize = 4096;
/// Decimals in the CSV from which a number needs double precision: the timestamp's.
const DOUBLE_DECIMALS: usize = 6;
/// Keys of the metadata.
const ORIGIN: &str = "posewise.origin";
const SETTINGS: &str = "posewise.settings";
const SUMMARY: &str = "posewise.summary";

/// What a table was made from.
pub struct Origin {
    /// The video file's size and time of change.
    file: String,
    settings: String,
}

impl Origin {
    /// Of a video as it is now.
    pub fn of(video: &Path, settings: &str) -> Result<Self> {
        let found = std::fs::metadata(video)
            .with_context(|| format!("no such file: {}", video.display()))?;
        let changed = found.modified().ok();
        let changed = changed.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
        let changed_us = changed.map_or(0, |time| time.as_micros());
        Ok(Origin {
            file: format!("{} bytes, changed {changed_us} us", found.len()),
            settings: settings.to_string(),
        })
    }
}

/// Values of a column.
enum Column {
    Whole(Vec<i64>),
    Single(Vec<f32>),
    Double(Vec<f64>),
    Word(Vec<ByteArray>),
}

impl Column {
    /// The type that fits what the CSV writes.
    fn of(cell: &Cell) -> Self {
        match cell {
            Cell::Word(_) => Column::Word(Vec::new()),
            Cell::Number(_, 0) => Column::Whole(Vec::new()),
            Cell::Number(_, DOUBLE_DECIMALS..) => Column::Double(Vec::new()),
            Cell::Number(..) => Column::Single(Vec::new()),
        }
    }

    fn kind(&self) -> (Physical, Option<LogicalType>) {
        match self {
            Column::Whole(_) => (Physical::INT64, None),
            Column::Single(_) => (Physical::FLOAT, None),
            Column::Double(_) => (Physical::DOUBLE, None),
            Column::Word(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        }
    }

    fn push(&mut self, cell: &Cell) -> Result<()> {
        match (self, cell) {
            (Column::Whole(values), Cell::Number(value, _)) => values.push(*value as i64),
            // The numbers were single before.
            (Column::Single(values), Cell::Number(value, _)) => values.push(*value as f32),
            (Column::Double(values), Cell::Number(value, _)) => values.push(*value),
            (Column::Word(values), Cell::Word(word)) => values.push((*word).into()),
            _ => bail!("a column with numbers and words"),
        }
        Ok(())
    }
}

/// A table that is being written.
pub struct Table {
    writer: SerializedFileWriter<File>,
    columns: Vec<Column>,
    rows: usize,
}

impl Table {
    /// Begins a file.
    pub fn create(path: &Path) -> Result<Self> {
        let empty = Row {
            frame: 0,
            face_id: 0,
            result: &TrackResult::EMPTY,
        };
        let columns: Vec<Column> = csv::cells(&empty).map(|cell| Column::of(&cell)).collect();
        let fields = csv::names()
            .into_iter()
            .zip(&columns)
            .map(|(name, column)| {
                let (kind, logical) = column.kind();
                let field = Type::primitive_type_builder(&name, kind)
                    .with_repetition(Repetition::REQUIRED)
                    .with_logical_type(logical);
                Ok(Arc::new(field.build()?))
            });
        let fields = fields.collect::<Result<_>>()?;
        let schema = Type::group_type_builder("posewise").with_fields(fields);
        // Measured values rarely repeat: dictionaries of them would only take place.
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_column_dictionary_enabled("state".into(), true);
        let cannot = || format!("cannot write {}", path.display());
        let file = File::create(path).with_context(cannot)?;
        let (schema, properties) = (schema.build()?.into(), properties.build().into());
        let writer = SerializedFileWriter::new(file, schema, properties).with_context(cannot)?;
        Ok(Table {
            writer,
            columns,
            rows: 0,
        })
    }

    /// Adds a row.
    pub fn write(&mut self, row: &Row<'_>) -> Result<()> {
        for (column, cell) in self.columns.iter_mut().zip(csv::cells(row)) {
            column.push(&cell)?;
        }
        self.rows += 1;
        if self.rows == GROUP {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes the rows so far as a group.
    fn flush(&mut self) -> Result<()> {
        let cannot = "cannot write the table";
        let mut group = self.writer.next_row_group().context(cannot)?;
        for column in &mut self.columns {
            let Some(mut to) = group.next_column().context(cannot)? else {
                bail!("more columns than the table has");
            };
            match column {
                Column::Whole(values) => {
                    to.typed::<Int64Type>().write_batch(values, None, None)?;
                    values.clear();
                }
                Column::Single(values) => {
                    to.typed::<FloatType>().write_batch(values, None, None)?;
                    values.clear();
                }
                Column::Double(values) => {
                    to.typed::<DoubleType>().write_batch(values, None, None)?;
                    values.clear();
                }
                Column::Word(values) => {
                    to.typed::<ByteArrayType>()
                        .write_batch(values, None, None)?;
                    values.clear();
                }
            }
            to.close().context(cannot)?;
        }
        group.close().context(cannot)?;
        self.rows = 0;
        Ok(())
    }

    /// Completes the file.
    pub fn finish(mut self, origin: &Origin, summary: &Value) -> Result<()> {
        if self.rows > 0 {
            self.flush()?;
        }
        for (key, value) in [
            (ORIGIN, &origin.file),
            (SETTINGS, &origin.settings),
            (SUMMARY, &summary.to_string()),
        ] {
            let entry = KeyValue::new(key.to_string(), value.clone());
            self.writer.append_key_value_metadata(entry);
        }
        self.writer.close().context("cannot write the table")?;
        Ok(())
    }
}

/// The summary in a complete table of the same origin.
pub fn summary_of(path: &Path, origin: &Origin) -> Option<Value> {
    let file = File::open(path).ok()?;
    let reader = SerializedFileReader::new(file).ok()?;
    let entries = reader.metadata().file_metadata().key_value_metadata()?;
    let value = |key: &str| -> Option<&String> {
        let entry = entries.iter().find(|entry| entry.key == key)?;
        entry.value.as_ref()
    };
    if value(ORIGIN)? != &origin.file || value(SETTINGS)? != &origin.settings {
        return None;
    }
    serde_json::from_str(value(SUMMARY)?).ok()
}
