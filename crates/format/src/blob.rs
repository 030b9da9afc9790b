//! Header, checksum and section table.

use super::{ModelError, Section, Tag};

/// First bytes of every model.
pub const MAGIC: [u8; 8] = *b"POSEWISE";
/// Format version that this build reads and the trainer writes.
pub const FORMAT_VERSION: u32 = 5;
/// Alignment of the blob in memory and of every section inside it \[bytes\].
pub const ALIGN: usize = 64;
/// Bytes before the section table.
pub const HEADER_LEN: usize = 64;
/// Most sections a blob may have.
pub const MAX_SECTIONS: usize = 32;

/// Bytes of one entry of the section table.
pub(crate) const ENTRY_LEN: usize = 16;

/// A blob whose header, checksum and table are valid.
#[derive(Clone, Copy, Debug)]
pub struct Blob<'m> {
    bytes: &'m [u8],
    table: &'m [u8],
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes
        .get(at..)?
        .first_chunk()
        .map(|b| u32::from_le_bytes(*b))
}

impl<'m> Blob<'m> {
    /// Checks header, checksum and section table; O(length).
    ///
    /// # Errors
    /// The first thing found wrong, in the order of [`ModelError`]'s variants.
    pub fn open(bytes: &'m [u8]) -> Result<Self, ModelError> {
        if !(bytes.as_ptr() as usize).is_multiple_of(ALIGN) {
            return Err(ModelError::Misaligned);
        }
        let header = |at| u32_at(bytes, at).ok_or(ModelError::Truncated);
        if bytes.get(..8).ok_or(ModelError::Truncated)? != MAGIC {
            return Err(ModelError::Magic);
        }
        let found = header(8)?;
        if found != FORMAT_VERSION {
            return Err(ModelError::Version { found });
        }
        let (len, crc, count) = (header(12)? as usize, header(16)?, header(20)? as usize);
        let bytes = bytes.get(..len).ok_or(ModelError::Truncated)?;
        let body = bytes.get(HEADER_LEN..).ok_or(ModelError::Truncated)?;
        let (_, rest) = bytes.split_at_checked(24).ok_or(ModelError::Truncated)?;
        let reserved_clear = rest.iter().take(HEADER_LEN - 24).all(|b| *b == 0);
        if crc32(body) != crc || !reserved_clear {
            return Err(ModelError::Checksum);
        }
        if count > MAX_SECTIONS {
            return Err(ModelError::Table);
        }
        let table = body.get(..count * ENTRY_LEN).ok_or(ModelError::Table)?;
        let blob = Blob { bytes, table };
        let mut first = bytes.len();
        for entry in table.chunks_exact(ENTRY_LEN) {
            let offset = u32_at(entry, 4).ok_or(ModelError::Table)? as usize;
            if !offset.is_multiple_of(ALIGN) || offset < HEADER_LEN + table.len() {
                return Err(ModelError::Table);
            }
            blob.content(entry).ok_or(ModelError::Table)?;
            first = first.min(offset);
        }
        // The checksum does not cover the number of sections: an entry too few would show here.
        let gap = bytes.get(HEADER_LEN + table.len()..first);
        if gap.is_none_or(|gap| gap.iter().any(|b| *b != 0)) {
            return Err(ModelError::Table);
        }
        Ok(blob)
    }

    /// Length in bytes, as the header states.
    pub fn total_len(&self) -> usize {
        self.bytes.len()
    }

    /// CRC-32 of what follows the header, as the header states.
    pub fn checksum(&self) -> u32 {
        u32_at(self.bytes, 16).unwrap_or_default()
    }

    /// Tags and bytes of all sections, in file order.
    pub fn sections(&self) -> impl Iterator<Item = (Tag, &'m [u8])> + '_ {
        self.table
            .chunks_exact(ENTRY_LEN)
            .filter_map(|entry| Some((*entry.first_chunk::<4>()?, self.content(entry)?)))
    }

    /// Opens the section of this tag for reading from its start.
    ///
    /// # Errors
    /// [`ModelError::Missing`].
    pub fn section(&self, tag: &Tag) -> Result<Section<'m>, ModelError> {
        self.sections()
            .find(|(found, _)| found == tag)
            .map(|(tag, bytes)| Section::new(tag, bytes))
            .ok_or(ModelError::Missing(*tag))
    }

    fn content(&self, entry: &[u8]) -> Option<&'m [u8]> {
        let offset = u32_at(entry, 4)? as usize;
        let len = u32_at(entry, 8)? as usize;
        self.bytes.get(offset..offset.checked_add(len)?)
    }
}

/// CRC-32 (IEEE 802.3, reflected), four bits at a time.
pub fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 16] = {
        let mut table = [0u32; 16];
        let mut i = 0;
        while i < 16 {
            let mut value = i as u32;
            let mut bit = 0;
            while bit < 4 {
                value = if value & 1 == 1 {
                    value >> 1 ^ 0xEDB8_8320
                } else {
                    value >> 1
                };
                bit += 1;
            }
            table[i] = value;
            i += 1;
        }
        table
    };
    !bytes.iter().fold(!0u32, |crc, byte| {
        let crc = crc ^ *byte as u32;
        let crc = crc >> 4 ^ TABLE[(crc & 15) as usize];
        crc >> 4 ^ TABLE[(crc & 15) as usize]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crc_check_value() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }
}
