//! Writes `.posewise` blobs: the counterpart of `posewise::model`.

use posewise::model::{ALIGN, FORMAT_VERSION, HEADER_LEN, MAGIC, Tag, crc32};

/// Arrays inside a section start at multiples of this many bytes (see `posewise::model::Section`).
const ARRAY_ALIGN: usize = 16;

/// Numbers that a section may hold arrays of.
pub trait Value: Copy {
    /// Appends the little-endian bytes.
    fn put(self, out: &mut Vec<u8>);
}

macro_rules! value {
    ($($t:ty),*) => {$(impl Value for $t {
        fn put(self, out: &mut Vec<u8>) {
            out.extend_from_slice(&self.to_le_bytes());
        }
    })*};
}
value!(u8, i8, u16, i16, i32, u32, f32);

/// One section being written.
#[derive(Clone)]
pub struct SectionWriter {
    tag: Tag,
    bytes: Vec<u8>,
}

impl SectionWriter {
    /// An empty section.
    pub fn new(tag: Tag) -> Self {
        SectionWriter {
            tag,
            bytes: Vec::new(),
        }
    }

    /// A section of these bytes, as [`SectionWriter::bytes`] gave them.
    pub fn of_bytes(tag: Tag, bytes: Vec<u8>) -> Self {
        SectionWriter { tag, bytes }
    }

    /// What was written so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// A single `u32` or `f32`; read back with `Section::u32`, `count` or `f32`.
    pub fn scalar(&mut self, value: impl Value) -> &mut Self {
        let before = self.bytes.len();
        value.put(&mut self.bytes);
        assert_eq!(self.bytes.len() - before, 4, "scalars are four bytes");
        self
    }

    /// An array; read back with `Section::f32s` and friends.
    pub fn array<T: Value>(&mut self, values: &[T]) -> &mut Self {
        self.bytes
            .resize(self.bytes.len().next_multiple_of(ARRAY_ALIGN), 0);
        values.iter().for_each(|v| v.put(&mut self.bytes));
        // A scalar may follow an odd number of bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self
    }
}

/// The finished file of these sections.
pub fn blob(sections: &[SectionWriter]) -> Vec<u8> {
    let mut table = Vec::new();
    let mut content = Vec::new();
    let start = (HEADER_LEN + 16 * sections.len()).next_multiple_of(ALIGN);
    for section in sections {
        content.resize(content.len().next_multiple_of(ALIGN), 0);
        table.extend_from_slice(&section.tag);
        ((start + content.len()) as u32).put(&mut table);
        (section.bytes.len() as u32).put(&mut table);
        0u32.put(&mut table);
        content.extend_from_slice(&section.bytes);
    }
    table.resize(start - HEADER_LEN, 0);
    let body = [table, content].concat();
    let mut out = Vec::from(MAGIC);
    FORMAT_VERSION.put(&mut out);
    ((HEADER_LEN + body.len()) as u32).put(&mut out);
    crc32(&body).put(&mut out);
    (sections.len() as u32).put(&mut out);
    out.resize(HEADER_LEN, 0);
    out.extend(body);
    out
}

/// A model's file without some of its sections, as builds that do not read them can use it.
pub fn trimmed(bytes: &[u8], without: &[String]) -> anyhow::Result<Vec<u8>> {
    let aligned = crate::fit::AlignedBlob::new(bytes);
    let opened = posewise::model::Blob::open(aligned.bytes())?;
    let kept: Vec<SectionWriter> = opened
        .sections()
        .filter(|(tag, _)| !without.iter().any(|w| w.as_bytes() == tag))
        .map(|(tag, content)| SectionWriter::of_bytes(tag, content.to_vec()))
        .collect();
    Ok(blob(&kept))
}
