//! Reports and figures: what `eval` and `bench` print and write.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
pub use posewise_cli::output::{create, print};

/// Writes a JSON file, indented.
pub fn write_json(path: &Path, value: &serde_json::Value) -> Result<()> {
    let mut out = create(path)?;
    serde_json::to_writer_pretty(&mut out, value)
        .map_err(std::io::Error::from)
        .and_then(|()| writeln!(out))
        .and_then(|()| out.flush())
        .with_context(|| format!("cannot write {}", path.display()))
}
