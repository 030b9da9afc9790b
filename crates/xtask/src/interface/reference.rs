//! The reference page of the documentation's site: every struct, constant and function.

use super::table::{Constant, Field, Kind, Struct, Table};
use crate::root;
use anyhow::{Context, Result};
use std::fmt::Write as _;

const HEAD: &str = "\
# Reference

Every struct, constant and function of `include/posewise.h`. A setting that is 0 has its default. A
field that has no release in the last column is there since 0.1.

JavaScript has the fields of a result in camel case, Python as they are here; states, losses, kinds
and reasons are words there, as `low-confidence` for `POSEWISE_LOSS_LOW_CONFIDENCE`.
[Conventions](docs/conventions.md) has frames, signs, and the names in Rust and CSV.
";

/// The page, in Markdown.
///
/// # Errors
/// If a function is not in the header.
pub fn reference(table: &Table) -> Result<String> {
    let header = std::fs::read_to_string(root().join("include/posewise.h"))?.replace('\r', "");
    let mut out = HEAD.to_owned();
    out += "\n## Structs\n";
    for item in &table.structs {
        write_struct(&mut out, item)?;
    }
    out += "\n## Functions\n";
    for function in &table.functions {
        let name = &function.name;
        let prototype = prototype(&header, name).with_context(|| format!("no {name}"))?;
        writeln!(
            out,
            "\n### {name}\n\n```c\n{prototype}\n```\n\n{}",
            text(&function.comment)
        )?;
    }
    out += "\n## Constants\n";
    let mut previous = None;
    for constant in &table.constants {
        if previous != Some(constant.family) {
            out += "\n| constant | value | meaning |\n|---|---|---|\n";
        }
        previous = Some(constant.family);
        let Constant {
            name,
            value,
            comment,
            ..
        } = constant;
        let value = match name.starts_with("FMT_") || name == "VERSION" {
            true => format!("{value:#x}"),
            false => value.to_string(),
        };
        writeln!(out, "| `POSEWISE_{name}` | {value} | {} |", text(comment))?;
    }
    Ok(out)
}

fn write_struct(out: &mut String, item: &Struct) -> Result<()> {
    writeln!(
        out,
        "\n### posewise_{}\n\n{}\n",
        item.name,
        text(&item.comment)
    )?;
    *out += "| field | type | unit | range | default | meaning | since |\n";
    *out += "|---|---|---|---|---|---|---|\n";
    for field in &item.fields {
        let Field {
            name,
            comment,
            facts,
            ..
        } = field;
        let since = if facts.since == "0.1" {
            ""
        } else {
            &facts.since
        };
        writeln!(
            out,
            "| `{name}` | `{}` | {} | {} | {} | {} | {since} |",
            type_of(field),
            facts.unit.as_deref().unwrap_or_default(),
            facts.range_text(),
            facts.default.as_deref().unwrap_or_default(),
            text(comment),
        )?;
    }
    Ok(())
}

fn type_of(field: &Field) -> String {
    let kind = match &field.kind {
        Kind::U32 => "uint32_t",
        Kind::I64 => "int64_t",
        Kind::F32 => "float",
        Kind::Size => "size_t",
        Kind::Pointer => "const *",
        Kind::Struct(inner) => inner,
    };
    let count = field.count.map_or(String::new(), |n| format!("[{n}]"));
    format!("{kind}{count}")
}

/// The declaration of a function in the header.
fn prototype(header: &str, name: &str) -> Option<String> {
    // Comments name functions too.
    let declared = header.split("\nPOSEWISE_API").skip(1).find(|text| {
        let before = text.split_once(&format!("{name}("));
        before.is_some_and(|(before, _)| {
            !before.contains(['(', ';']) && before.ends_with([' ', '*', '\n'])
        })
    })?;
    let (text, _) = declared.split_once(';')?;
    Some(format!("{};", text.trim_start()))
}

/// A comment as Markdown.
fn text(comment: &str) -> String {
    ["\\", "*", "|", "<", "[", "]"]
        .iter()
        .fold(comment.to_owned(), |text, sign| {
            text.replace(sign, &format!("\\{sign}"))
        })
}
