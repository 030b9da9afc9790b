//! `include/posewise.h`: cbindgen prints it, and what it leaves to be wished is done here.

use super::table::{Field, Kind, SOURCES, Struct, Table};
use crate::root;
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The longest line \[columns\].
const MAX_COLUMNS: usize = 100;

/// The header.
pub fn text(table: &Table) -> Result<String> {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml"));
    let config = config.map_err(anyhow::Error::msg)?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for path in SOURCES {
        builder = builder.with_src(root().join(path));
    }
    let mut bytes = Vec::new();
    builder.generate()?.write(&mut bytes);
    let text = with_initialisers(&tidy(&String::from_utf8(bytes)?, table), table)?;
    for line in text.lines() {
        ensure!(line.chars().count() <= MAX_COLUMNS, "too long: {line}");
    }
    Ok(text)
}

/// Adds, after each struct that starts with `struct_size`, a macro that initialises it: the size
/// and zeros. It names every field, because compilers warn where some are missing.
fn with_initialisers(header: &str, table: &Table) -> Result<String> {
    let mut out = String::new();
    for line in header.lines() {
        writeln!(out, "{line}")?;
        let name = line.strip_prefix("} posewise_");
        if let Some(name) = name.and_then(|rest| rest.strip_suffix(';')) {
            let item = table.get(name)?;
            if item.grows() {
                out += &initialiser(item, table)?;
            }
        }
    }
    Ok(out)
}

/// The initial value of a field.
fn zero(field: &Field, table: &Table) -> Result<String> {
    let of_all = |item: &Struct| -> Result<String> {
        let zeros = item.fields.iter().map(|field| zero(field, table));
        Ok(format!(
            "{{{}}}",
            zeros.collect::<Result<Vec<_>>>()?.join(", ")
        ))
    };
    Ok(match (&field.kind, field.count) {
        // Of an array that does not fit into a line, the elements that are not named are 0 too.
        (_, Some(0..=16)) => format!("{{{}}}", vec!["0"; field.count.unwrap_or(0)].join(", ")),
        (_, Some(_)) => "{0}".to_owned(),
        (Kind::Pointer, None) => "NULL".to_owned(),
        (Kind::Struct(inner), None) => of_all(table.get(inner)?)?,
        _ => "0".to_owned(),
    })
}

/// The macro that initialises a struct.
fn initialiser(item: &Struct, table: &Table) -> Result<String> {
    let name = format!("posewise_{}", item.name);
    let macro_name = format!("{}_INIT", name.to_uppercase());
    let mut lines = vec![String::from("    {")];
    for (i, field) in item.fields.iter().enumerate() {
        let value = match i {
            0 => format!("sizeof({name})"),
            _ => zero(field, table)?,
        };
        let end = if i + 1 < item.fields.len() { "," } else { "}" };
        let line = lines.last_mut().context("at least one line")?;
        // A blank before it, a comma after it, and the backslash that continues the macro.
        if line.len() + value.len() + 4 > MAX_COLUMNS {
            lines.push(format!("     {value}{end}"));
        } else {
            let blank = if i == 0 { "" } else { " " };
            *line += &format!("{blank}{value}{end}");
        }
    }
    let values = lines.join(" \\\n");
    Ok(format!(
        "/// Initialises a {name}: struct_size is set, all other fields are 0.\n\
         #define {macro_name} \\\n{values}\n"
    ))
}

/// Formats the constants: suffixes, hexadecimal for bit patterns, values and comments in columns,
/// an empty line between families. Removes rustdoc's escapes and names types by their typedef.
fn tidy(header: &str, table: &Table) -> String {
    let header = header.replace("\\[", "[").replace("\\]", "]");
    let known = table.constants.iter();
    let families: BTreeMap<&str, usize> = known.map(|c| (&*c.name, c.family)).collect();
    let family = |name: &str| families.get(name.trim_start_matches("POSEWISE_"));
    let mut out = String::new();
    let mut widths = BTreeMap::<_, (usize, usize)>::new();
    for (name, value) in header.lines().filter_map(constant) {
        let (names, values) = widths.entry(family(name)).or_default();
        (*names, *values) = (name.len().max(*names), value.len().max(*values));
    }
    let mut lines = header.lines().peekable();
    let mut previous_family = None;
    while let Some(line) = lines.next() {
        let comment = line.strip_prefix("/// ");
        let define = comment.and(lines.peek()).and_then(|next| constant(next));
        if let (Some(comment), Some((name, value))) = (comment, define) {
            lines.next();
            let family = family(name);
            if Some(family) == previous_family && out.ends_with("\n\n") {
                out.pop();
            }
            previous_family = Some(family);
            let comment = comment.trim_end_matches('.');
            let (name_width, value_width) = widths[&family];
            out += &format!("#define {name:<name_width$} {value:<value_width$} ///< {comment}\n");
        } else {
            if !line.is_empty() {
                previous_family = None;
            }
            let line = match line.starts_with("typedef") {
                true => line.to_string(),
                false => line.replace("struct posewise_", "posewise_"),
            };
            out += &line;
            out.push('\n');
        }
    }
    out
}

/// Name and rewritten value of a `#define` line.
fn constant(line: &str) -> Option<(&str, String)> {
    let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
    if !name.starts_with("POSEWISE_") || ["POSEWISE_H", "POSEWISE_API"].contains(&name) {
        return None;
    }
    let value = if name.starts_with("POSEWISE_E_") {
        format!("({value})")
    } else if name == "POSEWISE_OK" {
        value.to_string()
    } else if name.starts_with("POSEWISE_FMT_")
        || ["POSEWISE_VERSION", "POSEWISE_MESH_NEUTRAL"].contains(&name)
    {
        let value: u32 = value.parse().ok()?;
        let digits = if value > 0xFFFFFF { 8 } else { 6 };
        format!("0x{value:0digits$X}u")
    } else if value.parse::<u32>().is_ok() {
        format!("{value}u")
    } else {
        value.to_string()
    };
    Some((name, value))
}
