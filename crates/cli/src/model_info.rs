//! `posewise model info`: header, sections and data sheet of a model file.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Result, anyhow};
use posewise::Model;
use posewise_format::{FORMAT_VERSION, ModelInfo, SHEET_TAG};

use crate::model_file::ModelFile;
use crate::output;

/// Runs the command.
pub fn run(path: &Path) -> Result<()> {
    let file = ModelFile::read(Some(path))?;
    let bytes = file.bytes();
    let info = ModelInfo::read(bytes).map_err(|e| anyhow!("{}: {e}", file.name()))?;
    let blob = info.blob;
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "{}\nformat version {FORMAT_VERSION}, {} bytes, CRC-32 {:08x}",
        file.name(),
        blob.total_len(),
        info.checksum
    );
    if bytes.len() > blob.total_len() {
        let _ = writeln!(
            out,
            "{} bytes follow the model in the file",
            bytes.len() - blob.total_len()
        );
    }
    let _ = writeln!(
        out,
        "\n{:<8}{:>10}{:>10}{:>9}",
        "section", "offset", "bytes", "share %"
    );
    let mut sheet = None;
    for (tag, content) in blob.sections() {
        let offset = content.as_ptr() as usize - bytes.as_ptr() as usize;
        let _ = writeln!(
            out,
            "{:<8}{offset:>10}{:>10}{:>9.1}",
            tag.escape_ascii().to_string(),
            content.len(),
            100.0 * content.len() as f64 / blob.total_len() as f64
        );
        if tag == SHEET_TAG {
            sheet = Some(String::from_utf8_lossy(content).into_owned());
        }
    }
    match sheet {
        Some(text) => {
            let _ = writeln!(out, "\n{}", text.trim_end_matches(['\0', '\n']));
        }
        None => out += "\nno data sheet (section INFO)\n",
    }
    // The blob may hold together and yet not be a model that this build can track with.
    match Model::load(bytes) {
        Ok(_) => out += "\nthis build can track with it\n",
        Err(e) => {
            output::print(&out)?;
            return Err(anyhow!("{}: {e}", file.name()));
        }
    }
    output::print(&out)
}
