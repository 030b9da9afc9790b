//! Writes `.posewise` blobs.

pub use posewise_format::{SectionWriter, blob};

use posewise_format::{Tag, without};

/// A model's file without some of its sections, as builds that do not read them can use it.
pub fn trimmed(bytes: &[u8], tags: &[String]) -> anyhow::Result<Vec<u8>> {
    let tags = tags.iter().filter_map(|tag| tag.as_bytes().try_into().ok());
    Ok(without(bytes, &tags.collect::<Vec<Tag>>())?)
}
