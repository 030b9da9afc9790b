//! `cargo xtask interface`: everything that says again what the structs, constants and functions of
//! `src/ffi` are. They and their comments are the one description; [`Table`] is what is read of it.

mod command;
mod cpp;
mod facts;
mod header;
mod languages;
pub mod layout;
mod python;
mod python_fields;
mod reference;
mod table;
mod words;

pub mod javascript;

pub use facts::Facts;
pub use reference::reference;
pub use table::{Constant, Field, Function, Kind, Struct, Table, WORDS};

use crate::root;
use anyhow::{Context, Result, ensure};

/// Where the fields of the structs are.
const LAYOUT: &str = "src/ffi/layout.rs";

/// The files that are generated and kept in the repository, because what reads them has no program
/// that could make them: compilers, browsers, Python.
///
/// # Errors
/// If the sources cannot be read.
pub fn files() -> Result<Vec<(&'static str, String)>> {
    let table = Table::read()?;
    Ok(vec![
        ("include/posewise.h", header::text(&table)?),
        ("include/posewise.hpp", cpp::text(&table)?),
        (LAYOUT, layout::rust(&table)?),
        ("crates/cli/src/fields.rs", command::rust(&table)?),
        ("web/demo/columns.js", command::javascript(&table)?),
        ("web/layout.js", javascript::text(&table)?),
        ("python/posewise/_layout.py", python::layout(&table)?),
        ("python/posewise/_fields.py", python_fields::text(&table)?),
    ])
}

/// Writes the files that are not what they are generated from, and gives their names.
///
/// # Errors
/// If a field is no longer where callers look for it.
pub fn write() -> Result<Vec<&'static str>> {
    let files = files()?;
    let stale: Vec<_> = files
        .into_iter()
        .filter(|(path, text)| !is_fresh(path, text))
        .collect();
    if let Some((path, text)) = stale.iter().find(|(path, _)| *path == LAYOUT) {
        let committed = std::fs::read_to_string(root().join(path)).unwrap_or_default();
        layout::check_growth(&committed, text)?;
    }
    for (path, text) in &stale {
        std::fs::write(root().join(path), text).with_context(|| format!("cannot write {path}"))?;
    }
    Ok(stale.into_iter().map(|(path, _)| path).collect())
}

/// # Errors
/// Names the files that are not what they are generated from.
pub fn check() -> Result<()> {
    let files = files()?;
    let stale = files.iter().filter(|(path, text)| !is_fresh(path, text));
    let stale: Vec<&str> = stale.map(|(path, _)| *path).collect();
    ensure!(
        stale.is_empty(),
        "{stale:?} are stale; run: cargo xtask interface"
    );
    Ok(())
}

fn is_fresh(path: &str, text: &str) -> bool {
    let committed = std::fs::read_to_string(root().join(path)).unwrap_or_default();
    committed.replace('\r', "") == text
}
