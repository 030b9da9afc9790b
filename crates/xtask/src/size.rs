//! Bytes of code and constants that a program gets when it links the library.

use crate::{Library, Machine, optional_parts, output_of, replay, root};
use anyhow::{Context, Result};
use std::fmt::Write;
use std::path::Path;

/// Frames of a replay that find and fit a face, which takes the deepest stack.
const FRAMES: usize = 100;

/// What the names of functions begin with that are measured by themselves, because they alone reach
/// most of what they need: those of the driver monitor and of the mesh.
pub const ON_TOP: [&str; 2] = ["posewise_monitor_", "posewise_mesh"];

/// Bytes of all that the header's functions reach, without the model and what is on top. The model
/// is linked by `posewise_default_model` alone, which is left out.
pub fn code_size(library: &Library) -> Result<usize> {
    code_of(library, |name| !is_on_top(name))
}

/// Bytes that the functions whose names begin so add to them.
pub fn size_on_top(library: &Library, start: &str) -> Result<usize> {
    let both = code_of(library, |name| name.starts_with(start) || !is_on_top(name));
    Ok(both? - code_size(library)?)
}

fn is_on_top(name: &str) -> bool {
    ON_TOP.iter().any(|start| name.starts_with(start))
}

/// Bytes of what some of the functions reach.
fn code_of(library: &Library, is_wanted: impl Fn(&str) -> bool) -> Result<usize> {
    let machine = Machine::named(library.target.as_deref())?;
    let archive = library.build()?;
    let name = format!("whole-{}.o", library.target_name());
    let whole = library.target_dir.join(name);
    let mut link = machine.compiler();
    link.args(["-r", "-nostdlib", "-Wl,--gc-sections"]);
    let functions = functions_of_the_header()?;
    let reached = functions
        .iter()
        .filter(|name| *name != "posewise_default_model" && is_wanted(name));
    link.args(reached.map(|name| format!("-Wl,-u,{name}")));
    output_of(link.arg(archive).arg("-o").arg(&whole))?;

    let table = String::from_utf8(output_of(machine.size().arg(&whole))?.stdout)?;
    // Below the head: text, data and further columns. Constants are part of text.
    let row = table.lines().nth(1).context("no row of sizes")?;
    let mut columns = row.split_whitespace().map(str::parse::<usize>);
    let mut column = || -> Result<usize> { Ok(columns.next().context("no column")??) };
    Ok(column()? + column()?)
}

/// A Markdown table of the sizes with and without what can be left out.
pub fn size_table(library: &Library, clip: &Path) -> Result<String> {
    let parts = optional_parts()?;
    let mut builds: Vec<Vec<String>> = vec![Vec::new()];
    builds.extend(parts.iter().map(|part| vec![part.clone()]));
    builds.push(parts);
    let mut table = String::from(
        "| built without | code and constants | model | tracker | stack of a step |\n\
         |---|---|---|---|---|\n",
    );
    for without in builds {
        let name = match without.is_empty() {
            true => "nothing".to_string(),
            false => without.join(" "),
        };
        let library = Library {
            without,
            ..library.clone()
        };
        let code = code_size(&library)?;
        let replay = replay(&library, clip, FRAMES, 0)?;
        let figure = |name| match replay.figure(name) {
            Some(bytes) => bytes.to_string(),
            None => "-".into(),
        };
        writeln!(
            table,
            "| {name} | {code} | {} | {} | {} |",
            figure("model"),
            figure("tracker"),
            figure("stack of posewise_step")
        )?;
    }
    Ok(table)
}

/// Names of the functions that posewise.h declares.
pub fn functions_of_the_header() -> Result<Vec<String>> {
    let header = std::fs::read_to_string(root().join("include/posewise.h"))?;
    // A declaration begins with POSEWISE_API, on its line or the one before.
    let names = header
        .split("\nPOSEWISE_API")
        .skip(1)
        .filter_map(|declaration| {
            let before = declaration.split_once('(')?.0;
            let name = before.rsplit([' ', '*', '\n']).next()?;
            name.starts_with("posewise_").then(|| name.to_string())
        });
    Ok(names.collect())
}
