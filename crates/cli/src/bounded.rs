//! Reading files whole that may be anything: a device without an end, somebody else's video.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, ensure};

/// The bytes of a file of at most `most_mb` MB; `what` it is, for messages.
pub fn read(what: &str, path: &Path, most_mb: u64) -> Result<Vec<u8>> {
    let name = format!("{what} {}", path.display());
    let cannot = || format!("cannot read {name}");
    let most = most_mb << 20;
    let mut bytes = Vec::new();
    let file = File::open(path).with_context(cannot)?;
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .with_context(cannot)?;
    let is_whole = bytes.len() as u64 <= most;
    ensure!(is_whole, "{name} is larger than {most_mb} MB");
    Ok(bytes)
}

/// The same of a text.
pub fn read_text(what: &str, path: &Path, most_mb: u64) -> Result<String> {
    let text = String::from_utf8(read(what, path, most_mb)?);
    text.with_context(|| format!("{what} {} is not UTF-8 text", path.display()))
}
