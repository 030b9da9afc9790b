//! The clip that ships with posewise, `tests/data/demo.y4m.gz`, and its truth, embedded.

use anyhow::Result;

use crate::eval::table::Table;
use crate::source::{Source, Y4mSource, sniff_gzip};

const CLIP: &[u8] = include_bytes!("../../../tests/data/demo.y4m.gz");
const TRUTH: &[u8] = include_bytes!("../../../tests/data/demo.csv");

/// Opens the clip.
pub fn open() -> Result<Box<dyn Source>> {
    let reader = sniff_gzip(CLIP)?;
    Ok(Box::new(Y4mSource::new(reader, "the demo clip")?))
}

/// The clip's per-frame truth.
pub fn truth() -> Result<Table> {
    Table::parse("the demo clip's truth", TRUTH)
}
