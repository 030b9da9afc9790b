//! Writes `web/layout.js`: sizes and offsets of the header's structs in WebAssembly, its constants,
//! and the types of the structs as JSDoc.

use crate::header::{Field, Header, Struct, WORDS, read, word};
use anyhow::{Context, Result};
use std::fmt::Write as _;

/// Where the constants are.
pub const FILE: &str = "web/layout.js";

const HEAD: &str = "\
// Structs and constants of include/posewise.h, as they lie in WebAssembly's memory.
// Generated. To change it, edit src/ffi and run
//     POSEWISE_BLESS=1 cargo test --release --test source
";

/// Fields that JavaScript does not see.
const HIDDEN: [&str; 5] = ["struct_size", "flags", "reserved", "data", "data_len"];

/// Fields whose numbers are named: struct, field, what the constants begin with.
const NAMED: [(&str, &str, &str); 8] = [
    ("result", "state", "STATE"),
    ("result", "loss", "LOSS"),
    ("event", "kind", "EVENT"),
    ("event", "loss", "LOSS"),
    ("result", "eye_status", "EYE"),
    ("result", "gaze_status", "EYE"),
    ("lens", "model", "LENS"),
    ("model_details", "terms", "TERMS"),
];

/// Structs of which a caller may leave out fields.
const OPTIONAL: [&str; 2] = ["config", "hint"];

/// Whether a caller may leave out a field.
fn is_optional(item: &Struct, field: &Field) -> bool {
    OPTIONAL.contains(&&*item.name) && field.name != "face_box"
}

/// What the file has to hold.
pub fn text() -> Result<String> {
    let header = read()?;
    let mut out = HEAD.to_owned();
    write_constants(&mut out, &header)?;
    for item in &header.structs {
        write_type(&mut out, item)?;
        write_layout(&mut out, item, &header.structs)?;
    }
    Ok(out)
}

/// Size of a struct in WebAssembly \[bytes\] and the offset of each field.
pub fn offsets(item: &Struct, all: &[Struct]) -> Result<(usize, Vec<usize>)> {
    let (mut end, mut widest) = (0_usize, 1);
    let mut found = Vec::new();
    for field in &item.fields {
        let (size, align) = size_of(&field.kind, all)?;
        let start = end.next_multiple_of(align);
        found.push(start);
        end = start + size * field.count.unwrap_or(1);
        widest = widest.max(align);
    }
    Ok((end.next_multiple_of(widest), found))
}

/// Size and alignment of a C type in WebAssembly \[bytes\].
fn size_of(kind: &str, all: &[Struct]) -> Result<(usize, usize)> {
    Ok(match kind {
        "uint32_t" | "float" | "size_t" | "*" => (4, 4),
        "int64_t" => (8, 8),
        _ => {
            let inner = all.iter().find(|item| item.name == kind);
            let inner = inner.with_context(|| format!("unknown type {kind}"))?;
            // None of the structs within structs has 64-bit fields.
            (offsets(inner, all)?.0, 4)
        }
    })
}

fn write_constants(out: &mut String, header: &Header) -> Result<()> {
    for name in ["ABI", "ALIGN", "LANDMARKS", "ANIMATIONS", "EYE_LOOKS"] {
        let value = header.with_prefix(name)[0].1;
        writeln!(out, "\nexport const {name} = {value};")?;
    }
    let unread = header.constants.iter().find(|(name, _)| name == "EVENTS");
    let unread = unread.context("POSEWISE_EVENTS")?.1;
    writeln!(out, "\nexport const UNREAD_EVENTS = {unread};")?;
    writeln!(
        out,
        "\n/** Status codes by name. */\nexport const STATUS = {{\n  OK: 0,"
    )?;
    for (name, value) in header.with_prefix("E_") {
        writeln!(out, "  E_{name}: {value},")?;
    }
    writeln!(
        out,
        "}};\n\n/** Pixel formats by name. */\nexport const FORMATS = {{"
    )?;
    for (name, value) in header.with_prefix("FMT_") {
        writeln!(out, "  {name}: 0x{value:08x},")?;
    }
    out.push_str("};\n\n/** Bits of the optional parts by name. */\nexport const PARTS = {\n");
    for (name, value) in header.with_prefix("PART_") {
        writeln!(out, "  '{}': {value},", word(name))?;
    }
    out.push_str("};\n");
    for kind in WORDS {
        write_words(out, kind, &header.words(kind)?)?;
    }
    Ok(())
}

/// A list of words and the type of them.
fn write_words(out: &mut String, kind: &str, words: &[String]) -> Result<()> {
    let (list, name) = list_of_words(kind);
    writeln!(out, "\n/** @typedef {{(typeof {list})[number]}} {name} */")?;
    writeln!(out, "export const {list} = /** @type {{const}} */ ([")?;
    for line in words.chunks(4) {
        writeln!(out, "  '{}',", line.join("', '"))?;
    }
    out.push_str("]);\n");
    Ok(())
}

/// The name of a list of words, and of the type of which it holds all values.
fn list_of_words(kind: &str) -> (&'static str, &'static str) {
    match kind {
        "STATE" => ("STATES", "State"),
        "LOSS" => ("LOSSES", "Loss"),
        "EVENT" => ("EVENTS", "EventKind"),
        "EYE" => ("EYES", "EyeStatus"),
        "TERMS" => ("TERMS", "Terms"),
        _ => ("LENSES", "LensModel"),
    }
}

/// The name of a struct's type in JavaScript. `Event` is a type of the browser.
fn type_name(item: &str) -> String {
    match item {
        "event" => "FaceEvent".to_owned(),
        _ => item[..1].to_uppercase() + &item[1..],
    }
}

fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |out, word| match word.is_empty() {
        true => out,
        false => out + &word[..1].to_uppercase() + &word[1..],
    })
}

fn list_of(item: &Struct, field: &Field) -> Option<(&'static str, &'static str)> {
    let named = NAMED.iter().find(|n| n.0 == item.name && n.1 == field.name);
    named.map(|(_, _, kind)| list_of_words(kind))
}

/// A typedef for JSDoc. Those of frames and of what a model says are written by hand: pixels are an
/// array, and texts are strings.
fn write_type(out: &mut String, item: &Struct) -> Result<()> {
    if ["frame", "model_details"].contains(&&*item.name) {
        return Ok(());
    }
    out.push_str("\n/**\n");
    wrapped(out, &item.comment);
    writeln!(out, " * @typedef {{object}} {}", type_name(&item.name))?;
    for field in &item.fields {
        if HIDDEN.contains(&&*field.name) {
            continue;
        }
        let kind = match (list_of(item, field), field.count) {
            (Some((_, words)), Some(count)) => format!("[{}]", vec![words; count].join(", ")),
            (Some((_, words)), _) => words.to_owned(),
            (_, Some(count)) => format!("[{}]", vec!["number"; count].join(", ")),
            _ if ["intrinsics", "lens", "roi"].contains(&&*field.kind) => type_name(&field.kind),
            _ => "number".to_owned(),
        };
        let name = camel(&field.name);
        let name = match is_optional(item, field) {
            true => format!("[{name}]"),
            false => name,
        };
        wrapped(
            out,
            &format!("@property {{{kind}}} {name} {}", field.comment),
        );
    }
    out.push_str(" */\n");
    Ok(())
}

/// Lines of a JSDoc comment, broken at 100 columns.
fn wrapped(out: &mut String, text: &str) {
    // An asterisk and a slash would end the comment.
    let text = text.replace("*/", "* /");
    let mut line = String::from(" *");
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 100 {
            *out += &format!("{line}\n");
            line = String::from(" *  ");
        }
        line += " ";
        line += word;
    }
    *out += &format!("{line}\n");
}

fn write_layout(out: &mut String, item: &Struct, all: &[Struct]) -> Result<()> {
    let (size, starts) = offsets(item, all)?;
    // With its type, offsets are not in the declarations for TypeScript.
    out.push_str("/** @type {import('./struct.js').Layout} */\n");
    writeln!(out, "export const {} = {{", item.name.to_uppercase())?;
    writeln!(out, "  size: {size},\n  fields: {{")?;
    for (field, start) in item.fields.iter().zip(starts) {
        let kind = match &*field.kind {
            "uint32_t" | "size_t" | "*" => "type: 'u32'".to_owned(),
            "float" => "type: 'f32'".to_owned(),
            "int64_t" => "type: 'i64'".to_owned(),
            inner => format!("struct: {}", inner.to_uppercase()),
        };
        let count = field
            .count
            .map_or(String::new(), |n| format!(", count: {n}"));
        let names = list_of(item, field);
        let names = names.map_or(String::new(), |(list, _)| format!(", names: {list}"));
        let optional = match is_optional(item, field) {
            true => ", optional: true",
            false => "",
        };
        let name = camel(&field.name);
        writeln!(
            out,
            "    {name}: {{ at: {start}, {kind}{count}{names}{optional} }},"
        )?;
    }
    out.push_str("  },\n};\n");
    Ok(())
}
