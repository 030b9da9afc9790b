//! Model bytes in memory, aligned as `posewise::model` wants them.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use posewise::model::ALIGN;
use posewise::track::Model;

/// The bytes of a `.posewise` file, 64-byte aligned, or those of the embedded model.
pub struct ModelFile {
    name: String,
    storage: Vec<u8>,
    start: usize,
    embedded: bool,
}

impl ModelFile {
    /// Reads `path`, or takes the embedded model when there is none.
    pub fn read(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path else {
            return Ok(ModelFile {
                name: "embedded model".into(),
                storage: Vec::new(),
                start: 0,
                embedded: true,
            });
        };
        let bytes =
            std::fs::read(path).with_context(|| format!("cannot read model {}", path.display()))?;
        let mut storage = vec![0; bytes.len() + ALIGN];
        // The heap block does not move when the struct does, so the offset stays right.
        let start = storage.as_ptr().align_offset(ALIGN).min(ALIGN);
        storage[start..start + bytes.len()].copy_from_slice(&bytes);
        storage.truncate(start + bytes.len());
        Ok(ModelFile {
            name: path.display().to_string(),
            storage,
            start,
            embedded: false,
        })
    }

    /// The aligned bytes.
    pub fn bytes(&self) -> &[u8] {
        if self.embedded {
            posewise::DEFAULT_MODEL
        } else {
            &self.storage[self.start..]
        }
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
