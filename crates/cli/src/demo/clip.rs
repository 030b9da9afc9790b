//! The clip that ships with posewise, `tests/data/demo.y4m.gz`, embedded.

use anyhow::Result;

use crate::source::{Source, Y4mSource, sniff_gzip};

const CLIP: &[u8] = include_bytes!("../../assets/data/demo.y4m.gz");

/// Opens the clip.
pub fn open() -> Result<Box<dyn Source>> {
    let reader = sniff_gzip(CLIP)?;
    Ok(Box::new(Y4mSource::new(reader, "the demo clip")?))
}
