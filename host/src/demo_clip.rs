//! The clip that ships with posewise, `tests/data/demo.y4m.gz`, and its truth, embedded.

use anyhow::{Result, bail};

use crate::eval::table::Table;
use crate::source::{Source, Y4mSource, sniff_gzip};

#[cfg(has_demo_clip)]
const CLIP: &[u8] = include_bytes!("../../tests/data/demo.y4m.gz");
#[cfg(not(has_demo_clip))]
const CLIP: &[u8] = &[];

#[cfg(has_demo_truth)]
const TRUTH: &[u8] = include_bytes!("../../tests/data/demo.csv");
#[cfg(not(has_demo_truth))]
const TRUTH: &[u8] = &[];

/// Opens the clip.
pub fn open() -> Result<Box<dyn Source>> {
    if CLIP.is_empty() {
        bail!("this build has no demo clip: tests/data/demo.y4m.gz was missing");
    }
    let reader = sniff_gzip(CLIP)?;
    Ok(Box::new(Y4mSource::new(reader, "the demo clip")?))
}

/// The clip's per-frame truth, if there is one.
pub fn truth() -> Result<Option<Table>> {
    if TRUTH.is_empty() {
        return Ok(None);
    }
    Table::parse("the demo clip's truth", TRUTH).map(Some)
}
