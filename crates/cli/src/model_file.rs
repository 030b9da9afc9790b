//! Model bytes in memory, aligned as the reader requires.

use std::path::Path;

use anyhow::{Result, anyhow};
use posewise::Model;
use posewise_format::AlignedBytes;

use crate::bounded;

/// Largest model file \[MB\]. Source: chosen; the models have 1 MB.
const MOST_MB: u64 = 64;

/// The bytes of a `.posewise` file, 64-byte aligned, or those of the embedded model.
pub struct ModelFile {
    name: String,
    /// `None` for the embedded model.
    read: Option<AlignedBytes>,
}

impl ModelFile {
    /// Reads `path`, or takes the embedded model when there is none.
    pub fn read(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path else {
            return Ok(ModelFile {
                name: "embedded model".into(),
                read: None,
            });
        };
        let bytes = bounded::read("model", path, MOST_MB)?;
        Ok(ModelFile {
            name: path.display().to_string(),
            read: Some(AlignedBytes::new(&bytes)),
        })
    }

    /// The aligned bytes.
    pub fn bytes(&self) -> &[u8] {
        self.read.as_deref().unwrap_or(posewise::DEFAULT_MODEL)
    }

    /// Where the bytes came from, for messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The checked model.
    pub fn model(&self) -> Result<Model<'_>> {
        Model::load(self.bytes()).map_err(|e| anyhow!("{}: {e}", self.name))
    }
}
