//! Reads the structs and constants of `include/posewise.h`, which cbindgen writes in a fixed form.

use crate::root;
use anyhow::{Context, Result, bail};

/// A field of a struct.
pub struct Field {
    /// Its name in C.
    pub name: String,
    /// Its type in C, without the brackets of an array; `*` for a pointer.
    pub kind: String,
    /// Elements of an array.
    pub count: Option<usize>,
    /// Its comment, or that of the group of fields before it.
    pub comment: String,
}

/// A struct whose fields the header shows.
pub struct Struct {
    /// Its name in C without `posewise_`.
    pub name: String,
    /// Its comment.
    pub comment: String,
    /// Its fields, in order.
    pub fields: Vec<Field>,
}

/// What the header declares.
pub struct Header {
    /// Constants without `POSEWISE_`.
    pub constants: Vec<(String, i64)>,
    /// Structs.
    pub structs: Vec<Struct>,
}

impl Header {
    /// Constants whose names begin so, without that beginning.
    pub fn with_prefix<'a>(&'a self, prefix: &str) -> Vec<(&'a str, i64)> {
        let named = self.constants.iter();
        named
            .filter_map(|(name, value)| Some((name.strip_prefix(prefix)?, *value)))
            .collect()
    }

    /// The words of one of [`WORDS`], by number.
    ///
    /// # Errors
    /// If the constants do not count from 0.
    pub fn words(&self, kind: &str) -> Result<Vec<String>> {
        let found = match kind {
            "STATE" => STATES.map(|name| (name, self.value(name))).to_vec(),
            _ => self.with_prefix(&format!("{kind}_")),
        };
        // Indices of weights, not reasons.
        let found = found.iter().filter(|(name, _)| !name.starts_with("LOOK"));
        let words = found.zip(0..).map(|((name, value), i)| match *value == i {
            true => Ok(word(name)),
            false => bail!("POSEWISE_{kind}_{name} is not {i}"),
        });
        words.collect()
    }

    fn value(&self, name: &str) -> i64 {
        let found = self.constants.iter().find(|(known, _)| known == name);
        found.map_or(-1, |(_, value)| *value)
    }
}

/// What the constants of words begin with, of which each counts from 0.
pub const WORDS: [&str; 6] = ["STATE", "LOSS", "EVENT", "EYE", "LENS", "TERMS"];

/// Words that have no such beginning.
const STATES: [&str; 3] = ["SEARCHING", "TRACKING", "COASTING"];

/// A constant's name as a word, as the library's functions give it: `low-confidence`.
pub fn word(name: &str) -> String {
    name.to_lowercase().replace('_', "-")
}

/// Reads the header of the repository.
pub fn read() -> Result<Header> {
    let text = std::fs::read_to_string(root().join("include/posewise.h"))?;
    Ok(Header {
        constants: text.lines().filter_map(constant).collect(),
        structs: structs(&text)?,
    })
}

/// Name and value of a line that defines a number.
fn constant(line: &str) -> Option<(String, i64)> {
    let rest = line.strip_prefix("#define POSEWISE_")?;
    let (name, value) = rest.split_once(' ')?;
    let value = value.split("//").next()?.trim();
    let value = value.trim_matches(['(', ')']).trim_end_matches('u');
    let number = match value.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).ok()?,
        None => value
            .split('*')
            .map(|factor| factor.trim().parse::<i64>().ok())
            .product::<Option<i64>>()?,
    };
    Some((name.to_owned(), number))
}

fn structs(text: &str) -> Result<Vec<Struct>> {
    let mut found: Vec<Struct> = Vec::new();
    let mut comment = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        let line = line.trim();
        if let Some(words) = line.strip_prefix("/// ") {
            comment.push(words);
            continue;
        }
        if let Some(name) = line
            .strip_prefix("typedef struct posewise_")
            .and_then(|rest| rest.strip_suffix(" {"))
        {
            found.push(Struct {
                name: name.to_owned(),
                comment: comment.join(" "),
                fields: Vec::new(),
            });
            inside = true;
        } else if line.starts_with('}') {
            inside = false;
        } else if let (true, Some(open)) = (inside, found.last_mut()) {
            let before = open.fields.last().map_or("", |field| &field.comment);
            let comment = match comment.is_empty() {
                true => before.to_owned(),
                false => comment.join(" "),
            };
            open.fields.push(field(line, comment)?);
        }
        comment.clear();
    }
    Ok(found)
}

fn field(line: &str, comment: String) -> Result<Field> {
    let declaration = line.strip_suffix(';').context("a field ends with ;")?;
    let (kind, name) = declaration.rsplit_once(' ').context("a type and a name")?;
    let (name, count) = match name.trim_end_matches(']').split_once('[') {
        Some((name, count)) => (name, Some(count.parse()?)),
        None => (name, None),
    };
    let kind = match name.starts_with('*') {
        true => "*",
        false => kind.trim_start_matches("posewise_"),
    };
    Ok(Field {
        name: name.trim_start_matches('*').to_owned(),
        kind: kind.to_owned(),
        count,
        comment,
    })
}
