//! Text files of numbers, with errors that name file and line.

use anyhow::{Context, Result, anyhow};
use std::fmt::Display;
use std::path::Path;

/// A text file in memory.
pub struct Text {
    name: String,
    text: String,
}

impl Text {
    /// Reads the whole file.
    pub fn read(path: &Path) -> Result<Text> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).with_context(|| name.clone())?;
        Text::parse(&name, bytes)
    }

    /// From bytes; `name` is for messages.
    pub fn parse(name: &str, bytes: Vec<u8>) -> Result<Text> {
        let text = String::from_utf8(bytes).map_err(|e| {
            let good = e.utf8_error().valid_up_to();
            let breaks = e.as_bytes().iter().take(good).filter(|b| **b == b'\n');
            anyhow!("{name}, line {}: not UTF-8", breaks.count() + 1)
        })?;
        Ok(Text {
            name: name.into(),
            text,
        })
    }

    /// Lines that are not blank, trimmed, with their numbers from 1.
    pub fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let lines = self.text.lines().map(str::trim);
        (1..).zip(lines).filter(|(_, line)| !line.is_empty())
    }

    /// What is wrong in this line.
    pub fn error(&self, line: usize, what: impl Display) -> anyhow::Error {
        anyhow!("{}, line {line}: {what}", self.name)
    }

    /// What is wrong at the end of the file.
    pub fn cut_off(&self, what: impl Display) -> anyhow::Error {
        self.error(self.text.lines().count().max(1), what)
    }

    /// A finite number.
    pub fn number(&self, line: usize, word: &str) -> Result<f64> {
        let number = word.parse().ok().filter(|v: &f64| v.is_finite());
        number.ok_or_else(|| self.error(line, format_args!("{word:?} is not a number")))
    }

    /// The `N` numbers of a line.
    pub fn numbers<const N: usize>(&self, line: usize, text: &str) -> Result<[f64; N]> {
        let words = text.split_whitespace();
        let numbers = words.map(|word| self.number(line, word));
        let numbers = numbers.collect::<Result<Vec<f64>>>()?;
        let count = numbers.len();
        let wrong = |_| self.error(line, format_args!("{count} numbers in place of {N}"));
        numbers.try_into().map_err(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_file_and_line() {
        let text = Text::parse("a.txt", b"1 2\n\n 3 x\n".to_vec()).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines, [(1, "1 2"), (3, "3 x")]);
        assert_eq!(text.numbers(1, lines[0].1).unwrap(), [1.0, 2.0]);
        let error = text.numbers::<2>(3, lines[1].1).unwrap_err().to_string();
        assert_eq!(error, "a.txt, line 3: \"x\" is not a number");
        let error = text.numbers::<3>(1, "1 2").unwrap_err().to_string();
        assert_eq!(error, "a.txt, line 1: 2 numbers in place of 3");
        assert!(text.numbers::<1>(1, "inf").is_err());
        let error = Text::parse("b", b"a\n\xff".to_vec()).err().unwrap();
        assert_eq!(error.to_string(), "b, line 2: not UTF-8");
    }
}
