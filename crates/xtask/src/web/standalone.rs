//! The page as one file, `standalone.html`, which also works when it is opened from a disk:
//! browsers load neither modules nor other files there.

use anyhow::{Context, Result, ensure};
use base64::Engine as _;
use flate2::{Compression, write::GzEncoder};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// What the page fetches otherwise.
const DATA: [&str; 7] = [
    "posewise.posewise",
    "research.posewise",
    "posewise.wasm",
    "posewise-simd128.wasm",
    "posewise-relaxed.wasm",
    "demo/clip.webm",
    "demo/avatar/head.bin",
];

/// The page, from the folder of the page that is served.
pub fn page(folder: &Path) -> Result<String> {
    let read = |name: &str| std::fs::read(folder.join(name)).context(name.to_owned());
    let text = |name: &str| Ok::<_, anyhow::Error>(String::from_utf8(read(name)?)?);
    // The worker is a classic script, in which only modules' own words are unknown.
    let worker = joined(folder, "worker.js")?.replace("import.meta.url", "location.href");
    let mut blocks = block("worker.js", format!("'use strict';\n{worker}").as_bytes())?;
    for name in DATA {
        blocks += &block(name, &read(name)?)?;
    }
    let changes = [
        (
            "script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self';",
            "script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'unsafe-inline';"
                .to_owned(),
        ),
        (
            "<link rel=\"stylesheet\" href=\"./demo/style.css\">",
            format!("<style>\n{}</style>", text("demo/style.css")?),
        ),
        (
            "<script type=\"module\" src=\"./demo/app.js\"></script>",
            format!(
                "{blocks}<script type=\"module\">\n{}</script>",
                joined(folder, "demo/app.js")?
            ),
        ),
    ];
    let html = text("index.html")?;
    let lines = html.lines();
    let mut page: String = lines
        .filter(|line| {
            let early = [
                "<link rel=\"modulepreload\"",
                "<script type=\"module\" async",
            ];
            !early.iter().any(|start| line.starts_with(start))
        })
        .flat_map(|line| [line, "\n"])
        .collect();
    for (old, new) in changes {
        ensure!(page.matches(old).count() == 1, "index.html: {old}");
        page = page.replace(old, &new);
    }
    Ok(page)
}

/// A block of data that the page reads; the browser does not run it.
fn block(name: &str, bytes: &[u8]) -> Result<String> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(bytes)?;
    let packed = base64::engine::general_purpose::STANDARD.encode(packed.finish()?);
    let mut out = String::new();
    writeln!(
        out,
        "<script type=\"text/plain\" id=\"asset:{name}\">{packed}</script>"
    )?;
    Ok(out)
}

/// Whether a line imports something later.
fn imports_later(line: &str) -> bool {
    line.contains("} = await import(")
}

/// A module and those that it imports, each after those that it imports itself.
pub fn modules(folder: &Path, name: &str) -> Result<Vec<String>> {
    let mut found = Vec::new();
    follow(folder, name.to_owned(), &mut found)?;
    Ok(found)
}

fn follow(folder: &Path, name: String, found: &mut Vec<String>) -> Result<()> {
    if found.contains(&name) {
        return Ok(());
    }
    let text = std::fs::read_to_string(folder.join(&name)).context(name.clone())?;
    let at = name.rsplit_once('/').map_or("", |(at, _)| at);
    for line in text.lines() {
        let names = line.contains(" from '") || line.starts_with("import '") || imports_later(line);
        let path = line.split('\'').nth(1).filter(|_| names);
        let Some(path) = path.filter(|path| path.starts_with('.')) else {
            continue;
        };
        let path = match path.strip_prefix("../") {
            Some(path) => Path::new(at).parent().unwrap_or(Path::new("")).join(path),
            None => Path::new(at).join(path.trim_start_matches("./")),
        };
        follow(folder, path.display().to_string(), found)?;
    }
    found.push(name);
    Ok(())
}

/// Modules as one: without imports, and nothing is exported.
fn joined(folder: &Path, last: &str) -> Result<String> {
    let mut out = String::new();
    for module in modules(folder, last)? {
        let text = std::fs::read_to_string(folder.join(&module)).context(module)?;
        // A statement that names other modules goes on to its semicolon.
        let mut inside = false;
        for line in text.lines() {
            let starts = ["import ", "export {"].iter().any(|s| line.starts_with(s));
            // What is imported later has its name from the beginning.
            inside |= starts || imports_later(line);
            if !inside {
                writeln!(out, "{}", line.strip_prefix("export ").unwrap_or(line))?;
            }
            inside &= !line.ends_with(';');
        }
    }
    ensure!(!out.contains("</script"), "a module ends the script");
    Ok(out)
}
