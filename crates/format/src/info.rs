//! What a model says of itself: name and terms, of its data sheet.

use super::{Blob, ModelError, Tag};

/// The section of the data sheet: a text in Markdown.
pub const SHEET_TAG: Tag = *b"INFO";
/// The first line of a data sheet begins so; the name follows.
pub const SHEET_TITLE: &str = "# Data sheet of ";
/// A line of a data sheet begins so where everything may be used for anything.
pub const SHEET_FREE: &str = "The terms of all of these allow any use";
/// A line of a data sheet begins so where some of the data are for research.
pub const SHEET_RESEARCH: &str = "Research terms on some of these";

/// What the terms of the data that a model was trained on allow, as its data sheet says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ModelTerms {
    /// The data sheet has no line on it.
    #[default]
    Unknown,
    /// Any use, in products too.
    Free,
    /// Some of them may restrict the use to research.
    Research,
}

/// What a model says of itself. It may be read of a model with faults in its sections.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ModelInfo<'m> {
    /// Its name, as "posewise.posewise"; empty where it has none.
    pub name: &'m str,
    /// What the terms of its data allow.
    pub terms: ModelTerms,
    /// The whole data sheet; empty where there is none.
    pub sheet: &'m str,
    /// CRC-32 of what follows the header, by which models are told apart.
    pub checksum: u32,
    /// Header and sections.
    pub blob: Blob<'m>,
}

impl<'m> ModelInfo<'m> {
    /// Reads header, section table and data sheet.
    ///
    /// # Errors
    /// As [`Blob::open`].
    pub fn read(bytes: &'m [u8]) -> Result<Self, ModelError> {
        let blob = Blob::open(bytes)?;
        let sheet = blob.sections().find(|(tag, _)| *tag == SHEET_TAG);
        let sheet = trimmed(sheet.map_or(&[], |(_, text)| text));
        let title = lines(sheet).next().unwrap_or_default();
        let name = title.strip_prefix(SHEET_TITLE.as_bytes());
        Ok(ModelInfo {
            name: text(name.unwrap_or_default()),
            terms: terms_of(sheet),
            sheet: text(sheet),
            checksum: blob.checksum(),
            blob,
        })
    }
}

// On bytes: the methods of `str` would bring panics into a program that has none.

/// A text; empty where the bytes are none.
fn text(bytes: &[u8]) -> &str {
    core::str::from_utf8(bytes).unwrap_or_default()
}

/// Without empty lines and padding at the end.
fn trimmed(mut bytes: &[u8]) -> &[u8] {
    while let [rest @ .., b'\0' | b'\n'] = bytes {
        bytes = rest;
    }
    bytes
}

fn lines(sheet: &[u8]) -> impl Iterator<Item = &[u8]> {
    sheet.split(|byte| *byte == b'\n')
}

/// The strictest that a line states.
fn terms_of(sheet: &[u8]) -> ModelTerms {
    let states = |start: &str| lines(sheet).any(|line| line.starts_with(start.as_bytes()));
    match (states(SHEET_RESEARCH), states(SHEET_FREE)) {
        (true, _) => ModelTerms::Research,
        (false, true) => ModelTerms::Free,
        (false, false) => ModelTerms::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_the_strictest() {
        let research = b"# Data sheet of a\n\nResearch terms on some of these may restrict it.";
        let free = b"The terms of all of these allow any use, also in products.";
        assert_eq!(terms_of(research), ModelTerms::Research);
        assert_eq!(terms_of(free), ModelTerms::Free);
        let both = b"The terms of all of these allow any use.\nResearch terms on some of these.";
        assert_eq!(terms_of(both), ModelTerms::Research);
        assert_eq!(
            terms_of(b"No research terms on some of these."),
            ModelTerms::Unknown
        );
    }
}
