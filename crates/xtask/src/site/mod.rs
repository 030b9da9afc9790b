//! `cargo xtask site`: the documentation as a site, with the header, the Rust reference, a gallery
//! and the demo, which may be put on any server or read from a disk. Sphinx makes the pages, and
//! refuses links that lead nowhere.

use crate::figures::history;
use crate::interface::{Table, reference};
use crate::{output_of, root, web, write};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

/// Folders whose pages are in the site, beside those at the top.
const FOLDERS: [&str; 7] = [
    "",
    "docs",
    "docs/dev",
    "models",
    "packaging/android",
    "python",
    "web",
];

/// A page that goes to the top: servers of sites leave its folder out.
const HIDDEN: (&str, &str) = (".github/", "CODE_OF_CONDUCT.md");

/// Files of the site alone.
const OWN: [(&str, &str); 5] = [
    ("conf.py", include_str!("conf.py")),
    ("index.md", include_str!("index.md")),
    ("gallery.md", include_str!("gallery.md")),
    ("header.md", include_str!("header.md")),
    ("history.md", include_str!("history.md")),
];

/// Files that the site's own pages show.
const SHOWN: [&str; 7] = [
    "include/posewise.h",
    "include/posewise.hpp",
    "docs/mesh-page.png",
    "docs/tracked.png",
    "docs/signs.svg",
    "docs/facing.svg",
    "docs/history.json",
];

/// What Sphinx writes for a page that lists a folder.
const LISTING: &str = "index.md";

/// Builds the site in the subfolder `site` of cargo's build folder, and gives its path.
pub fn build(target_dir: &Path) -> Result<PathBuf> {
    let (source, site) = (target_dir.join("site-source"), target_dir.join("site"));
    for folder in [&source, &site] {
        if folder.exists() {
            std::fs::remove_dir_all(folder)?;
        }
    }
    stage_pages(&source)?;
    stage_references(target_dir, &source.join("extra"))?;
    let python = std::env::var("POSEWISE_PYTHON").unwrap_or("python3".into());
    let mut sphinx = Command::new(python);
    sphinx.args(["-m", "sphinx", "--quiet", "--fail-on-warning"]);
    sphinx.args(["--keep-going", "--doctree-dir"]);
    sphinx.arg(target_dir.join("site-doctrees"));
    output_of(sphinx.arg(&source).arg(&site))
        .context("the site needs pip install --requirement .ci/requirements.txt")?;
    Ok(site)
}

/// Copies the pages, and the files and folders of the repository to which they lead.
fn stage_pages(source: &Path) -> Result<()> {
    let mut linked: BTreeSet<PathBuf> = SHOWN.iter().map(PathBuf::from).collect();
    let (folder, name) = HIDDEN;
    let hidden = std::fs::read_to_string(root().join(folder).join(name))?;
    write(&source.join(name), hidden.replace("](../", "]("))?;
    for page in pages()? {
        let text = std::fs::read_to_string(root().join(&page))?;
        let (text, targets) = page_of_site(&page, &text);
        let text = text.replace(&format!("]({folder}{name})"), &format!("]({name})"));
        write(&source.join(&page), &text)?;
        linked.extend(targets);
    }
    for path in linked {
        let from = root().join(&path);
        if from.is_dir() {
            let page = listing(&path, source)?;
            write(&source.join(&path).join(LISTING), &page)?;
        } else if from.extension().is_none_or(|ending| ending != "md") {
            copy(&from, &source.join(&path))?;
        }
    }
    for (name, text) in OWN {
        write(&source.join(name), text)?;
    }
    write(&source.join("history.svg"), history::plot()?)?;
    write(&source.join("reference.md"), reference(&Table::read()?)?)
}

/// The pages, relative to the repository.
fn pages() -> Result<Vec<PathBuf>> {
    let mut pages = Vec::new();
    for folder in FOLDERS {
        for name in names(&root().join(folder))? {
            if name.ends_with(".md") {
                pages.push(Path::new(folder).join(name));
            }
        }
    }
    Ok(pages)
}

/// The text of a page, in which links to folders lead to their listings, and what of the
/// repository it links to.
fn page_of_site(page: &Path, text: &str) -> (String, Vec<PathBuf>) {
    let mut parts = text.split("](");
    let mut out = parts.next().unwrap_or_default().to_owned();
    let mut targets = Vec::new();
    for part in parts {
        out += "](";
        let target = part.split([')', '#']).next().unwrap_or_default();
        let path = inside(&page.with_file_name(target));
        let is_own = !target.is_empty() && !target.contains(':') && root().join(&path).exists();
        if is_own && root().join(&path).is_dir() {
            let _ = write!(out, "{}/{LISTING}", target.trim_end_matches('/'));
            out += &part[target.len()..];
        } else {
            out += part;
        }
        if is_own {
            targets.push(path);
        }
    }
    (out, targets)
}

/// A page that lists the files of a folder, which are copied.
fn listing(folder: &Path, source: &Path) -> Result<String> {
    let mut page = format!("---\norphan: true\n---\n\n# {}\n\n", folder.display());
    for name in names(&root().join(folder))? {
        let from = root().join(folder).join(&name);
        if from.is_file() && !name.starts_with("NOTICES") {
            writeln!(page, "- [{name}]({name})")?;
            if !name.ends_with(".md") {
                copy(&from, &source.join(folder).join(name))?;
            }
        }
    }
    Ok(page)
}

/// The demo as one file, its clip, and what rustdoc makes.
fn stage_references(target_dir: &Path, extra: &Path) -> Result<()> {
    let page = web::build(target_dir)?;
    copy(&page.join("standalone.html"), &extra.join("demo.html"))?;
    copy(&page.join("demo/clip.webm"), &extra.join("clip.webm"))?;
    let mut cargo = Command::new("cargo");
    cargo.args(["doc", "--quiet", "--release", "--no-deps", "--lib"]);
    cargo.args(["--package=posewise", "--package=posewise-format"]);
    cargo.args(["--features=posewise/ffi,posewise/alloc", "--target-dir"]);
    output_of(cargo.arg(target_dir).current_dir(root()))?;
    copy_tree(&target_dir.join("doc"), &extra.join("rust"))?;
    ensure!(
        extra.join("rust/posewise/index.html").exists(),
        "no Rust reference"
    );
    Ok(())
}

/// A path of the repository without `..`.
fn inside(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// Names in a folder, in order.
fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("{folder:?}"))?;
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        anyhow::Ok(entry?.file_name().to_string_lossy().into_owned())
    };
    let mut names: Vec<String> = entries.map(name).collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to.parent().context("no folder")?)?;
    std::fs::copy(from, to).with_context(|| format!("cannot copy {from:?}"))?;
    Ok(())
}

fn copy_tree(from: &Path, to: &Path) -> Result<()> {
    for name in names(from)? {
        let (from, to) = (from.join(&name), to.join(&name));
        match from.is_dir() {
            true => copy_tree(&from, &to)?,
            false => copy(&from, &to)?,
        }
    }
    Ok(())
}
