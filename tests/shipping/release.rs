//! The packages of `make release`: packed twice they have the same bytes, and what Debian's hold is
//! found and used by a C program.

use crate::common::c::{cc, command, library, require, succeed};
use crate::common::skip::need;
use crate::common::{root, scratch};
use crate::python::building_a_wheel;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask::release::{Outcome, Packer};

/// Where cargo builds, and where `cargo xtask` builds too.
fn target() -> &'static Path {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    tmp.parent().expect("a build folder")
}

/// The files of a package, or nothing where the machine has no tools for it.
fn made<E: Debug>(what: &str, outcome: Result<Outcome, E>) -> Vec<PathBuf> {
    match outcome.unwrap_or_else(|error| panic!("{what}: {error:?}")) {
        Outcome::Made(files) => files,
        Outcome::Skipped(why) => {
            need(&format!("{what}: {why}"), false);
            Vec::new()
        }
    }
}

/// What is packed from builds that exist has the same bytes each time.
#[test]
#[ignore = "packs everything twice: .ci/nightly"]
fn packing_is_reproducible() {
    let _alone = building_a_wheel();
    let pack = |folder: &str| {
        let folder = scratch("release").join(folder);
        let packer = Packer::new(target(), &folder).expect("target/ is writable");
        let mut files = made("wheel", packer.wheel(None));
        files.extend(made("npm", packer.npm()));
        files.extend(made("crates", packer.crates()));
        files.extend(made("SBOM", packer.sbom()));
        files.extend(made("checksums", packer.checksums()));
        files
    };
    let (first, second) = (pack("first"), pack("second"));
    for (first, second) in first.iter().zip(&second) {
        let read = |path| std::fs::read(path).expect("just written");
        assert!(
            first.file_name() == second.file_name() && read(first) == read(second),
            "{first:?}"
        );
    }
    assert_eq!(first.len(), second.len());
    // sha256sum accepts the list.
    let mut check = Command::new("sha256sum");
    check.args(["--check", "--strict", "--quiet", "SHA256SUMS"]);
    succeed(check.current_dir(scratch("release/first")));
}

/// The whole release, built twice in folders that share nothing.
#[test]
#[ignore = "takes half an hour: .ci/nightly"]
fn release_is_reproducible() {
    // The tool of the bills writes beside the sources, too.
    let _alone = building_a_wheel();
    let release = |name: &str| {
        let folder = scratch("release").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        let packages = folder.join("packages");
        let packer = Packer::new(&folder.join("target"), &packages).expect("writable");
        for (what, outcome) in packer.pack(&[]).expect("all packages are made") {
            made(&what, Ok::<_, ()>(outcome));
        }
        std::fs::read_to_string(packages.join("SHA256SUMS")).expect("just written")
    };
    assert_eq!(release("one"), release("other"));
}

/// Debian's packages, unpacked over each other into an empty folder, as dpkg would do it.
fn unpacked() -> Option<PathBuf> {
    let folder = scratch("release/debian");
    library();
    // Where the other tests have their library.
    let packer = Packer::new(&scratch("dist"), &folder.join("packages"));
    let packer = packer.expect("target/ is writable").with_command(command());
    let packages = made("Debian packages", packer.debian());
    if packages.is_empty() {
        return None;
    }
    let names: Vec<_> = packages
        .iter()
        .map(|path| path.file_name().expect("a name").to_string_lossy())
        .map(|name| name.split_once('_').expect("NAME_VERSION").0.to_string())
        .collect();
    assert_eq!(names, ["libposewise-dev", "libposewise1", "posewise"]);
    let tree = folder.join("root");
    let _ = std::fs::remove_dir_all(&tree);
    for package in &packages {
        let size = std::fs::metadata(package).expect("a file").len();
        println!("{}: {size} bytes", package.display());
        succeed(Command::new("dpkg-deb").arg("-x").arg(package).arg(&tree));
        let mut lintian = Command::new("lintian");
        lintian.args(["--fail-on", "error", "--allow-root"]);
        if require("lintian") {
            println!("{}", succeed(lintian.arg(package)));
        }
    }
    Some(tree)
}

#[test]
#[ignore = "makes three packages: .ci/nightly"]
fn debian_packages_are_used() {
    let Some(tree) = unpacked() else { return };
    let clip = xtask::demo_clip(&scratch("release")).expect("the demo clip");

    let csv = scratch("release").join("debian.csv");
    let mut track = Command::new(tree.join("usr/bin/posewise"));
    track
        .arg("track")
        .arg(&clip)
        .arg("--quiet")
        .arg("--csv")
        .arg(&csv);
    succeed(&mut track);
    let rows = std::fs::read_to_string(csv).expect("just written");
    assert!(rows.lines().count() > 100, "{rows}");

    if !require("pkg-config") {
        return;
    }
    for (name, library) in [("posewise", "static"), ("posewise-shared", "shared")] {
        let mut ask = Command::new("pkg-config");
        ask.env("PKG_CONFIG_PATH", tree.join("usr/lib/pkgconfig"));
        let flags = succeed(ask.args(["--cflags", "--libs", name]));
        let program = scratch("release").join(format!("y4m-{library}"));
        let mut compile = Command::new(cc());
        compile
            .args(["-std=c99", "-O2"])
            .arg(root().join("ffi-examples/y4m.c"));
        compile.args(flags.split_whitespace()).arg("-o");
        succeed(compile.arg(&program));
        let mut run = Command::new(&program);
        run.env("LD_LIBRARY_PATH", tree.join("usr/lib"));
        run.arg(tree.join("usr/share/posewise/posewise.posewise"));
        run.stdin(std::fs::File::open(&clip).expect("just unpacked"));
        let tracked = succeed(run.stdout(Stdio::piped()));
        assert!(tracked.matches(",tracking,").count() > 100, "{library}");
    }
}
