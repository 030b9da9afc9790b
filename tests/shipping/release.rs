//! The packages of `make release`: packed twice they have the same bytes, and what Debian's hold is
//! found and used by a C program.

use crate::common::c::{command, library, require, succeed};
use crate::common::skip::need;
use crate::common::{root, scratch};
use crate::python::building_a_wheel;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::process::Command;
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
    }
    if require("lintian") {
        let mut lintian = Command::new("lintian");
        lintian.args([
            "--allow-root",
            "--pedantic",
            "--display-info",
            "--tag-display-limit",
            "0",
        ]);
        lintian.args(["--fail-on", "error,warning,info,pedantic"]);
        // Machine code that reads like words.
        lintian.args(["--suppress-tags", "spelling-error-in-binary"]);
        println!("{}", succeed(lintian.args(&packages)));
    }
    Some(tree)
}

#[test]
#[ignore = "makes three packages: .ci/nightly"]
fn debian_packages_are_used() {
    let Some(tree) = unpacked() else { return };
    if !require("pkg-config") {
        return;
    }
    // What autopkgtest runs where the packages are installed.
    let folder = |name: &str| tree.join("usr").join(name);
    let mut architecture = Command::new("dpkg-architecture");
    let triplet = succeed(architecture.arg("-qDEB_HOST_MULTIARCH"));
    let libraries = folder("lib").join(triplet.trim());
    let path = std::env::var("PATH").expect("a PATH");
    let mut test = Command::new(root().join("packaging/debian/tests/example"));
    test.current_dir(root());
    test.env("AUTOPKGTEST_TMP", scratch("release/installed"));
    test.env("PATH", format!("{}:{path}", folder("bin").display()));
    test.env("PKG_CONFIG_PATH", libraries.join("pkgconfig"));
    test.env("LD_LIBRARY_PATH", &libraries);
    print!("{}", succeed(&mut test));
}
