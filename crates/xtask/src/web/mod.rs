//! The web page and the JavaScript package, ready to be served: `cargo xtask web`.

mod serve;
mod standalone;

use crate::{notices, output_of, root};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::process::Command;

pub use serve::Site;

/// Files of the package and of the page, beside the modules, that are served as they are in web/.
const FILES: [&str; 6] = [
    "README.md",
    "package.json",
    "index.html",
    "demo/avatar/head.bin",
    "demo/clip.webm",
    "demo/style.css",
];

/// Models that the page can load.
const MODELS: [&str; 2] = ["posewise.posewise", "research.posewise"];

/// The modules that `make wasm` builds: for browsers with relaxed SIMD, with SIMD, and without it.
const MODULES: [&str; 3] = [
    "posewise-relaxed.wasm",
    "posewise-simd128.wasm",
    "posewise.wasm",
];

/// Builds everything in the subfolder `web` of cargo's build folder, and gives its path.
pub fn build(target_dir: &Path) -> Result<PathBuf> {
    let modules = build_modules(target_dir)?;
    let out = target_dir.join("web");
    let copy = |from: PathBuf, name: &str| {
        let to = out.join(name);
        std::fs::create_dir_all(to.parent().unwrap_or(&out))?;
        std::fs::copy(&from, to).with_context(|| format!("cannot copy {from:?}"))
    };
    let web = root().join("web");
    let files = FILES.map(str::to_owned).into_iter();
    let worker = standalone::modules(&web, "worker.js")?;
    for file in files
        .chain(worker)
        .chain(standalone::modules(&web, "demo/app.js")?)
    {
        copy(web.join(&file), &file)?;
    }
    for model in MODELS {
        copy(root().join("models").join(model), model)?;
    }
    copy(root().join("LICENSE"), "LICENSE")?;
    notices::write()?;
    copy(root().join(notices::NOTICES[0].file), "NOTICES.txt")?;
    for module in MODULES {
        copy(modules.join(module), module)?;
    }
    let page = standalone::page(&out)?;
    std::fs::write(out.join("standalone.html"), page)?;
    Ok(out)
}

/// The compiler of TypeScript for a project, if it is installed: `npm ci --prefix web`.
pub fn typescript(project: &str) -> Option<Command> {
    let folder = root().join("web");
    let compiler = folder.join("node_modules/typescript/bin/tsc");
    let mut node = Command::new("node");
    node.arg(&compiler).arg("--project");
    node.arg(folder.join(project));
    compiler.exists().then_some(node)
}

/// Writes the package's declarations for TypeScript, from the comments in its code. False where the
/// compiler is not installed.
pub fn declarations(out: &Path) -> Result<bool> {
    let Some(mut compiler) = typescript("tsconfig.json") else {
        return Ok(false);
    };
    output_of(compiler.arg("--outDir").arg(out))?;
    Ok(true)
}

/// Builds the WebAssembly modules, and gives their folder.
pub fn build_modules(target_dir: &Path) -> Result<PathBuf> {
    output_of(&mut make(target_dir)).context(
        "WebAssembly needs either `rustup target add wasm32-unknown-unknown`, or Debian's \
         packages rustc-web, cargo-web, rust-web-src and lld",
    )?;
    Ok(target_dir.join("wasm"))
}

/// Whether this machine has a Rust that knows WebAssembly.
pub fn can_be_built(target_dir: &Path) -> bool {
    let mut lib = make(target_dir);
    lib.args(["--dry-run", "TARGET=wasm32-unknown-unknown"]);
    output_of(&mut lib).is_ok()
}

fn make(target_dir: &Path) -> Command {
    let mut make = Command::new("make");
    make.args(["--silent", "--directory"]).arg(root());
    make.arg("wasm");
    make.arg(format!("TARGET_DIR={}", target_dir.display()));
    make
}
