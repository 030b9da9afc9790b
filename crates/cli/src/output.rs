//! Writing to files and standard output without surprises.

use std::fs::File;
use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use anyhow::{Context, Result};
use image::{ImageFormat, RgbImage};

use crate::destination::Destination;

/// Opens a destination for writing.
pub fn open(destination: &Destination) -> Result<Box<dyn Write>> {
    create(destination.path())
}

/// Opens a file for writing; `-` is standard output.
pub fn create(path: &Path) -> Result<Box<dyn Write>> {
    if path == Path::new("-") {
        return Ok(Box::new(BufWriter::new(std::io::stdout())));
    }
    let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(Box::new(BufWriter::new(file)))
}

/// Prints a report to standard output.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()?;
    Ok(())
}

/// Writes a PNG.
pub fn write_png(path: &Path, image: &RgbImage) -> Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    // In memory first: what a buffer holds at its end is written without a word if that fails.
    let mut bytes = Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::Png)
        .with_context(cannot)?;
    std::fs::write(path, bytes.get_ref()).with_context(cannot)
}

/// Whether the reader of our output has gone away (`posewise … | head`), which is no failure.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io = cause.downcast_ref::<std::io::Error>().map(|e| e.kind());
        let csv = cause
            .downcast_ref::<csv::Error>()
            .and_then(|e| match e.kind() {
                csv::ErrorKind::Io(e) => Some(e.kind()),
                _ => None,
            });
        io.or(csv) == Some(std::io::ErrorKind::BrokenPipe)
    })
}
