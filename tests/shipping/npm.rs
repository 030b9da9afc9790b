//! The packed JavaScript package as users install it: in Node, in TypeScript, and bundled.

use crate::common::c::{require, succeed};
use crate::common::{root, scratch};
use crate::web::{has_package, site};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use xtask::release::{Outcome, Packer};

/// Copies the files of a folder of the repository.
fn copy(from: &str, to: &Path) {
    for entry in fs::read_dir(root().join(from)).expect(from) {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name");
        fs::copy(&path, to.join(name)).expect("target/ is writable");
    }
}

/// An app that has the packed package, the examples and the clip, made once.
fn app() -> Option<&'static Path> {
    static APP: OnceLock<Option<PathBuf>> = OnceLock::new();
    let app = APP.get_or_init(|| {
        let has_tools = require("npm") && require("node") && has_package("typescript");
        let site = site().filter(|_| has_tools)?;
        let folder = scratch("npm");
        // Other tests read what is built, so types go into a copy.
        let package = folder.join("package");
        let _ = fs::remove_dir_all(&package);
        succeed(Command::new("cp").arg("-r").arg(site).arg(&package));
        let packer = Packer::new(&folder.join("target"), &folder.join("packed"));
        let packed = packer.expect("target/ is writable").npm_of(&package);
        let Outcome::Made(packed) = packed.expect("npm packs it") else {
            panic!("it has all tools");
        };
        let app = folder.join("app");
        let _ = fs::remove_dir_all(&app);
        fs::create_dir_all(app.join("public")).expect("target/ is writable");
        copy("web/test/app", &app);
        copy("web/examples", &app);
        let clip = xtask::demo_clip(&folder).expect("the demo clip");
        fs::copy(clip, app.join("public/demo.y4m")).expect("target/ is writable");
        let mut npm = Command::new("npm");
        npm.args(["install", "--offline", "--silent", "--ignore-scripts"]);
        succeed(npm.arg(&packed[0]).current_dir(&app));
        Some(app)
    });
    app.as_deref()
}

#[test]
fn examples_run_in_node() {
    let Some(app) = app() else { return };
    let run = |example: &str| {
        let mut node = Command::new("node");
        succeed(node.args([example, "public/demo.y4m"]).current_dir(app))
    };
    let drive = run("drive.mjs");
    assert_eq!(drive.matches("blink from ").count(), 4, "{drive}");
    assert!(
        drive.contains("eyes open (none)") && drive.contains("4 blinks, 0 yawns"),
        "{drive}"
    );
    let faces = run("faces.mjs");
    assert!(faces.starts_with("1 faces\ntracking at "), "{faces}");
    let camera = run("camera.mjs");
    for part in [
        "terms free",
        "acquired, none",
        "forgotten, none",
        "gaze known: along",
    ] {
        assert!(camera.contains(part), "{part}: {camera}");
    }
}

/// A strict program in TypeScript compiles against the package, as bundlers and as Node find it.
#[test]
fn types_of_the_package_fit() {
    let Some(app) = app() else { return };
    let program = fs::read_to_string(root().join("web/test/types.ts")).expect("a file");
    assert!(program.contains("'../posewise.js'"));
    let program = program.replace("'../posewise.js'", "'posewise'");
    fs::write(app.join("types.ts"), program).expect("target/ is writable");
    for (module, resolution) in [("es2022", "bundler"), ("nodenext", "nodenext")] {
        let mut tsc = Command::new("node");
        tsc.arg(root().join("web/node_modules/typescript/bin/tsc"));
        tsc.args(["--strict", "--noEmit", "--target", "es2022"]);
        tsc.args(["--lib", "es2022,dom,dom.iterable", "--module", module]);
        tsc.args(["--moduleResolution", resolution, "types.ts"]);
        succeed(tsc.current_dir(app));
    }
}

/// Vite bundles it and serves it; in Chromium a face is tracked, and the monitor sees its blinks.
#[test]
fn bundled_it_works_in_chromium() {
    let Some(app) = app() else { return };
    if !require("chromium") || !has_package("playwright-core") || !has_package("vite") {
        return;
    }
    let mut node = Command::new("node");
    node.arg(root().join("web/test/bundle.mjs")).arg(app);
    succeed(&mut node);
}
