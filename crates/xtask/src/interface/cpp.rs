//! The part of `include/posewise.hpp` that the structs determine.

use super::table::Table;
use crate::root;
use anyhow::{Context, Result};
use std::fmt::Write as _;

const BEGIN: &str = "// Structs with struct_size set and all other fields 0, their defaults.\n";
/// The longest line \[columns\].
const MAX_COLUMNS: usize = 100;
const END: &str = "\n// A grey image ";

/// The wrapper, with a function for each struct that starts with its size.
pub fn text(table: &Table) -> Result<String> {
    let text = std::fs::read_to_string(root().join("include/posewise.hpp"))?.replace('\r', "");
    let (before, rest) = text.split_once(BEGIN).context("the functions' comment")?;
    let (_, after) = rest.split_once(END).context("what follows them")?;
    let mut out = format!("{before}{BEGIN}");
    for item in table.structs.iter().filter(|item| item.grows()) {
        let (name, upper) = (&item.name, item.name.to_uppercase());
        let kind = format!("posewise_{name}");
        let (head, body) = (
            format!("inline {kind} {name}() {{"),
            format!("return POSEWISE_{upper}_INIT;"),
        );
        match head.len() + body.len() + 4 > MAX_COLUMNS {
            true => writeln!(out, "{head}\n    {body}\n}}")?,
            false => writeln!(out, "{head} {body} }}")?,
        }
    }
    Ok(format!("{out}{END}{after}"))
}
