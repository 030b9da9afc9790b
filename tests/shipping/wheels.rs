//! The wheels of `make release`: the names say what their libraries need, and programs for every
//! machine and C library that these name track the demo clip with them.

use crate::common::c::{require, succeed};
use crate::common::{root, scratch};
use crate::package::expected;
use crate::python::{building_a_wheel, python};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask::release::{Outcome, Packer};

/// A wheel for a machine of this name in Rust, and the library in it.
fn wheel(target: Option<&str>) -> Option<(PathBuf, PathBuf)> {
    let python = python()?;
    let _alone = building_a_wheel();
    let build = Path::new(env!("CARGO_TARGET_TMPDIR")).parent()?;
    let folder = scratch("wheels").join(target.unwrap_or("host"));
    let packer = Packer::new(build, &folder).expect("target/ is writable");
    let wheel = match packer.wheel(target).expect("the wheel is built") {
        Outcome::Made(files) => files.into_iter().next()?,
        Outcome::Skipped(why) => {
            crate::common::skip::need(&why, false);
            return None;
        }
    };
    let mut unzip = Command::new(python);
    succeed(unzip.args(["-m", "zipfile", "-e"]).arg(&wheel).arg(&folder));
    // Programs look for it by the name of its ABI.
    let library = folder.join("posewise/libposewise.so.1");
    std::fs::rename(library.with_extension(""), &library).expect("the library is in it");
    Some((wheel, library))
}

/// What the library asks for: no library by name, no version, and only what every C library has.
fn check_needs(library: &Path) {
    let readelf = |what: &str| succeed(Command::new("readelf").args(["-W", what]).arg(library));
    let dynamic = readelf("--dynamic");
    assert!(!dynamic.contains("(NEEDED)"), "{dynamic}");
    assert!(!readelf("--version-info").contains("GLIBC"));
    let symbols = readelf("--dyn-syms");
    let undefined = symbols.lines().filter(|line| line.contains(" UND "));
    for name in undefined.filter_map(|line| line.split_whitespace().nth(7)) {
        assert!(
            ["memcpy", "memmove", "memset", "memcmp", "bcmp"].contains(&name),
            "{name}"
        );
    }
}

/// Tracks the clip with a program that this compiler links with the library, run by an emulator.
fn track(compiler: &str, library: &Path, emulator: &[&str]) {
    if !require(compiler) || !emulator.first().is_none_or(|program| require(program)) {
        return;
    }
    let folder = library.parent().expect("a folder");
    let program = folder.join(format!("y4m-{compiler}"));
    let mut compile = Command::new(compiler);
    compile
        .args(["-std=c99", "-O2"])
        .arg(root().join("ffi-examples/y4m.c"));
    compile.arg("-I").arg(root().join("include")).arg(library);
    compile.arg(format!("-Wl,-rpath,{}", folder.display()));
    succeed(compile.arg("-o").arg(&program));
    let mut run = match emulator {
        [first, rest @ ..] => {
            let mut run = Command::new(first);
            run.args(rest).arg(&program);
            run
        }
        [] => Command::new(&program),
    };
    let clip = xtask::demo_clip(folder).expect("the demo clip");
    run.arg(root().join("models/posewise.posewise"));
    let clip = std::fs::File::open(clip).expect("just unpacked");
    assert_eq!(
        succeed(run.stdin(Stdio::from(clip))),
        expected(),
        "{compiler}"
    );
}

#[test]
#[ignore = "needs musl's compiler: .ci/nightly"]
fn glibc_and_musl_take_it() {
    let Some((wheel, library)) = wheel(None) else {
        return;
    };
    let name = wheel.file_name().expect("a name").to_string_lossy();
    for tag in ["manylinux_2_17", "musllinux_1_1"] {
        assert!(
            name.contains(&format!("{tag}_{}", std::env::consts::ARCH)),
            "{name}"
        );
    }
    check_needs(&library);
    track("cc", &library, &[]);
    track("musl-gcc", &library, &[]);
}

#[test]
#[ignore = "builds the library for another machine: .ci/nightly"]
fn aarch64_has_one() {
    let target = "aarch64-unknown-linux-gnu";
    let Some((wheel, library)) = wheel(Some(target)) else {
        return;
    };
    let name = wheel.file_name().expect("a name").to_string_lossy();
    let tags = "-py3-none-manylinux_2_17_aarch64.musllinux_1_1_aarch64.whl";
    assert!(name.ends_with(tags), "{name}");
    check_needs(&library);
    let root = "/usr/aarch64-linux-gnu";
    track(
        "aarch64-linux-gnu-gcc",
        &library,
        &["qemu-aarch64-static", "-L", root],
    );
}
