//! Writes `python/posewise/_layout.py`: the header's structs for ctypes, and its constants.

use crate::header::{Header, Struct, WORDS, read, word};
use anyhow::{Context, Result};
use std::fmt::Write as _;

/// Where the constants are.
pub const FILE: &str = "python/posewise/_layout.py";

const HEAD: &str = "\
\"\"\"Structs and constants of include/posewise.h.

Generated. To change it, edit src/ffi and run
    POSEWISE_BLESS=1 cargo test --release --test source
\"\"\"

from __future__ import annotations

from ctypes import Structure, c_float, c_int64, c_size_t, c_uint32, c_void_p
";

/// Names of the lists of words.
fn list_of(kind: &str) -> &'static str {
    match kind {
        "STATE" => "STATES",
        "LOSS" => "LOSSES",
        "EVENT" => "EVENTS",
        "EYE" => "EYES",
        "TERMS" => "TERMS",
        _ => "LENSES",
    }
}

/// What the file has to hold.
pub fn text() -> Result<String> {
    let header = read()?;
    let mut out = HEAD.to_owned();
    out.push('\n');
    for name in ["ABI", "ALIGN", "LANDMARKS", "ANIMATIONS", "EYE_LOOKS"] {
        writeln!(out, "{name} = {}", value(&header, name)?)?;
    }
    writeln!(out, "UNREAD_EVENTS = {}", value(&header, "EVENTS")?)?;
    out.push('\n');
    for kind in WORDS {
        writeln!(out, "{} = (", list_of(kind))?;
        for word in header.words(kind)? {
            writeln!(out, "    \"{word}\",")?;
        }
        out.push_str(")\n");
    }
    out.push_str("\n# Pixel formats by name.\nFORMATS = {\n");
    for (name, value) in header.with_prefix("FMT_") {
        writeln!(out, "    \"{name}\": 0x{value:08X},")?;
    }
    out.push_str("}\n\n# Bits of the optional parts by name.\nPARTS = {\n");
    for (name, value) in header.with_prefix("PART_") {
        writeln!(out, "    \"{}\": {value},", word(name))?;
    }
    out.push_str("}\n");
    for item in &header.structs {
        write_struct(&mut out, item)?;
    }
    Ok(out)
}

fn value(header: &Header, name: &str) -> Result<i64> {
    let found = header.constants.iter().find(|(known, _)| known == name);
    Ok(found.with_context(|| format!("no POSEWISE_{name}"))?.1)
}

fn class(name: &str) -> String {
    name[..1].to_uppercase() + &name[1..]
}

fn write_struct(out: &mut String, item: &Struct) -> Result<()> {
    writeln!(out, "\n\nclass {}(Structure):", class(&item.name))?;
    out.push_str("    _fields_ = [\n");
    for field in &item.fields {
        let kind = match &*field.kind {
            "uint32_t" => "c_uint32".to_owned(),
            "int64_t" => "c_int64".to_owned(),
            "size_t" => "c_size_t".to_owned(),
            "float" => "c_float".to_owned(),
            "*" => "c_void_p".to_owned(),
            inner => class(inner),
        };
        let count = field.count.map_or(String::new(), |n| format!(" * {n}"));
        writeln!(out, "        (\"{}\", {kind}{count}),", field.name)?;
    }
    out.push_str("    ]\n");
    Ok(())
}
