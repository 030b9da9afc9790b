//! All of a model's sections, opened and checked once.

use crate::model::{Blob, ModelError};

/// A checked model: views into the blob's bytes. Many trackers can share one.
#[derive(Clone, Copy, Debug)]
pub struct Model<'m> {
    blob: Blob<'m>,
}

impl<'m> Model<'m> {
    /// Checks the whole blob: header, checksum, table and the content of every section that this
    /// build reads. `bytes` must start at a multiple of [`crate::model::ALIGN`].
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn load(bytes: &'m [u8]) -> Result<Self, ModelError> {
        Ok(Model {
            blob: Blob::open(bytes)?,
        })
    }

    /// The blob that the model was read from.
    pub fn blob(&self) -> &Blob<'m> {
        &self.blob
    }
}
