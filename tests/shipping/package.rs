//! What `make install` and `make dist` give: programs find it by pkg-config and by CMake, wherever
//! it lies, and track the demo clip with it. What `cargo package` gives: a small crate that builds.

use crate::common::c::{cc, command, example, library, require, succeed};
use crate::common::{demo, root, scratch};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// What `make dist` packs, and manual pages beside these.
const FILES: [&str; 19] = [
    "bin/posewise",
    "include/posewise.h",
    "include/posewise.hpp",
    "lib/cmake/posewise/posewise-config-version.cmake",
    "lib/cmake/posewise/posewise-config.cmake",
    "lib/libposewise.a",
    "lib/libposewise.so",
    "lib/libposewise.so.1",
    "lib/pkgconfig/posewise-shared.pc",
    "lib/pkgconfig/posewise.pc",
    "share/bash-completion/completions/posewise.bash",
    "share/fish/vendor_completions.d/posewise.fish",
    "share/man/man1/posewise.1",
    "share/posewise/LICENSE",
    "share/posewise/NOTICES-command.txt",
    "share/posewise/NOTICES.txt",
    "share/posewise/posewise.md",
    "share/posewise/posewise.posewise",
    "share/zsh/site-functions/_posewise",
];

/// Writes what make would build another program for.
pub fn write_notices() {
    static WRITTEN: OnceLock<()> = OnceLock::new();
    WRITTEN.get_or_init(|| xtask::notices::write().expect("sources of all crates"));
}

fn make(arguments: &[String]) -> String {
    write_notices();
    let mut make = Command::new("make");
    make.arg("-s").arg("-C").arg(root());
    make.arg(format!("TARGET_DIR={}", scratch("dist").display()));
    make.arg(format!("COMMAND={}", command().display()));
    succeed(make.args(arguments))
}

/// An installed tree that was moved after it was made, or nothing where there is no make.
fn installed() -> Option<&'static Path> {
    static INSTALLED: OnceLock<Option<PathBuf>> = OnceLock::new();
    let tree = INSTALLED.get_or_init(|| {
        if !require("make") {
            return None;
        }
        library();
        let (stage, moved) = (scratch("package").join("stage"), scratch("package/moved"));
        std::fs::remove_dir_all(&moved).expect("target/ is writable");
        let destination = format!("DESTDIR={}", stage.display());
        make(&["install".into(), destination, "PREFIX=/opt/p".into()]);
        std::fs::rename(stage.join("opt/p"), &moved).expect("both in target/");
        Some(moved)
    });
    tree.as_deref()
}

/// The archive that `make dist` makes, once: two runs in one folder would disturb each other.
fn archive() -> &'static str {
    static ARCHIVE: OnceLock<String> = OnceLock::new();
    ARCHIVE.get_or_init(|| {
        library();
        make(&["dist".into()])
    })
}

/// The demo clip, unpacked once.
fn clip() -> &'static Path {
    static CLIP: OnceLock<PathBuf> = OnceLock::new();
    CLIP.get_or_init(|| {
        let clip = scratch("package").join("demo.y4m");
        std::fs::write(&clip, &demo().y4m).expect("target/ is writable");
        clip
    })
}

/// What a program makes of the demo clip with a model.
fn track(program: &Path, model: &Path) -> String {
    let mut command = Command::new(program);
    command.arg(model).stdout(Stdio::piped());
    let csv = succeed(command.stdin(std::fs::File::open(clip()).expect("just unpacked")));
    assert!(csv.matches(",tracking,").count() > 100, "{csv}");
    csv
}

/// What the example that cargo's library was linked into makes of it.
pub fn expected() -> String {
    track(example(), &root().join("models/posewise.posewise"))
}

#[test]
fn pkg_config_finds_it() {
    let Some(tree) = installed() else { return };
    if !require("pkg-config") {
        return;
    }
    let ask = |what: &[&str]| {
        let mut command = Command::new("pkg-config");
        command.env("PKG_CONFIG_PATH", tree.join("lib/pkgconfig"));
        succeed(command.args(what)).trim().to_string()
    };
    for name in ["posewise", "posewise-shared"] {
        assert_eq!(ask(&["--modversion", name]), env!("CARGO_PKG_VERSION"));
        let program = scratch("package").join(format!("by-pkg-config-{name}"));
        let mut compile = Command::new(cc());
        compile
            .arg("-std=c99")
            .arg(root().join("ffi-examples/y4m.c"));
        compile.args(ask(&["--cflags", "--libs", name]).split_whitespace());
        // A program that is linked with the shared library has to find it.
        if name == "posewise-shared" {
            compile.arg(format!("-Wl,-rpath,{}", tree.join("lib").display()));
        }
        succeed(compile.arg("-o").arg(&program));
        let needs = succeed(Command::new("readelf").arg("--dynamic").arg(&program));
        let is_shared = needs.contains("[libposewise.so.1]");
        assert_eq!(is_shared, name == "posewise-shared", "{needs}");
        let model = Path::new(&ask(&["--variable=modeldir", name])).join("posewise.posewise");
        assert_eq!(track(&program, &model), expected());
    }
}

#[test]
fn cmake_finds_it() {
    let Some(tree) = installed() else { return };
    if !require("cmake") {
        return;
    }
    for shared in ["OFF", "ON"] {
        let build = scratch("package/cmake").join(shared);
        // CMake refuses a folder that another checkout has configured.
        let _ = std::fs::remove_dir_all(&build);
        let mut configure = Command::new("cmake");
        configure.arg("-S").arg(root().join("ffi-examples"));
        configure.arg("-B").arg(&build);
        configure.arg(format!("-DCMAKE_PREFIX_PATH={}", tree.display()));
        configure.arg(format!("-DPOSEWISE_SHARED={shared}"));
        succeed(&mut configure);
        succeed(Command::new("cmake").arg("--build").arg(&build));
        let model = tree.join("share/posewise/posewise.posewise");
        let program = build.join("y4m");
        let needs = succeed(Command::new("readelf").arg("--dynamic").arg(&program));
        assert_eq!(needs.contains("[libposewise.so.1]"), shared == "ON");
        assert_eq!(track(&program, &model), expected());
    }

    // Another series of versions is refused.
    std::fs::write(scratch("package/other").join("CMakeLists.txt"), OTHER).expect("writable");
    let mut other = Command::new("cmake");
    other.arg("-S").arg(scratch("package/other"));
    other.arg("-B").arg(scratch("package/other/build"));
    other.arg(format!("-DCMAKE_PREFIX_PATH={}", tree.display()));
    print!("{}", succeed(&mut other));
}

const OTHER: &str = "cmake_minimum_required(VERSION 3.16)
project(other C)
find_package(posewise 0.1.0 REQUIRED)
if(NOT posewise_VERSION OR NOT EXISTS ${posewise_MODEL})
  message(FATAL_ERROR \"no version, or no model at ${posewise_MODEL}\")
endif()
foreach(version 0.0.1 0.1.99 0.2 1.0)
  find_package(posewise ${version} QUIET)
  if(posewise_FOUND)
    message(FATAL_ERROR \"${posewise_VERSION} passes for ${version}\")
  endif()
endforeach()
";

#[test]
fn uninstall_removes_what_install_put_there() {
    if !require("make") {
        return;
    }
    library();
    let folder = tempfile::tempdir().expect("a folder");
    let other = folder.path().join("lib/libother.a");
    let prefix = format!("PREFIX={}", folder.path().display());
    make(&["install".into(), prefix.clone()]);
    std::fs::write(&other, "another library").expect("writable");
    make(&["uninstall".into(), prefix]);
    let mut left = Vec::new();
    let mut folders = vec![folder.path().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => folders.push(path),
                false => left.push(path),
            }
        }
    }
    assert_eq!(left, [other]);
}

#[test]
fn notices_are_of_what_is_linked_in() {
    let Some(tree) = installed() else { return };
    for notices in &xtask::notices::NOTICES {
        let name = Path::new(notices.file).file_name().expect("a file");
        let path = tree.join("share/posewise").join(name);
        let installed = std::fs::read_to_string(path).expect("installed");
        assert_eq!(installed, notices.text().expect("sources of all crates"));
    }
}

/// Built in another folder, the archive has the same bytes.
#[test]
#[ignore = "builds the library once more: .ci/nightly"]
fn archive_is_reproducible() {
    if !require("make") {
        return;
    }
    let elsewhere = format!("TARGET_DIR={}", scratch("dist-elsewhere").display());
    let second = make(&["dist".into(), elsewhere]);
    let read = |path: &str| std::fs::read(path.trim()).expect("written");
    let (first, second) = (read(archive()), read(&second));
    assert!(
        first == second,
        "{} and {} bytes",
        first.len(),
        second.len()
    );
}

#[test]
fn archive_holds_all() {
    if !require("make") {
        return;
    }
    let list = succeed(Command::new("tar").arg("-tzf").arg(archive().trim()));
    let mut files: Vec<_> = list
        .lines()
        .filter(|line| !line.ends_with('/'))
        .filter_map(|line| line.split_once('/'))
        .map(|(_, file)| file)
        // One for each subcommand.
        .filter(|file| !file.starts_with("share/man/man1/posewise-"))
        .collect();
    files.sort_unstable();
    assert_eq!(files, FILES);
}

/// Bytes of a compressed crate, at most: of the library's the model, which does not compress, is
/// half, of the command's the demo clip.
const CRATE_LIMIT: usize = 3 << 20;

#[test]
fn crate_is_small_and_builds() {
    let folder = scratch("crate");
    let cargo = |subcommand: &str| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args([subcommand, "--quiet", "--offline", "--target-dir"]);
        cargo.arg(&folder);
        cargo
    };
    // They are published together.
    let names = xtask::release::CRATES;
    let mut pack = cargo("package");
    for name in names {
        pack.args(["--package", name]);
    }
    pack.args(["--allow-dirty", "--no-verify"]);
    succeed(pack.current_dir(root()));

    // Outside of the repository's workspace, with nothing but what is packed.
    let outside = tempfile::tempdir().expect("a folder");
    let unpack = |name: &str| {
        let name = format!("{name}-{}", env!("CARGO_PKG_VERSION"));
        let path = folder.join("package").join(format!("{name}.crate"));
        let bytes = std::fs::read(&path).expect("cargo package writes it");
        println!("{name}: {} bytes", bytes.len());
        assert!(bytes.len() <= CRATE_LIMIT);
        let mut archive = tar::Archive::new(flate2::read::GzDecoder::new(&bytes[..]));
        archive.unpack(outside.path()).expect("a whole archive");
        outside.path().join(name)
    };
    let [format, posewise, metrics, command] = names.map(unpack);
    for folder in [&format, &posewise, &metrics, &command] {
        assert!(folder.join("LICENSE").is_file(), "{}", folder.display());
    }
    let readme = std::fs::read_to_string(posewise.join("README.md")).expect("packed");
    let pictures = readme
        .split("![")
        .skip(1)
        .filter_map(|rest| rest.split_once("]("));
    for (_, rest) in pictures {
        let (picture, _) = rest.split_once(')').expect("a Markdown link");
        assert!(
            posewise.join(picture).is_file(),
            "README.md shows {picture}"
        );
    }
    let mut check = cargo("check");
    // The registry does not have it yet.
    check.arg("--config").arg(format!(
        "patch.crates-io.posewise-format.path = '{}'",
        format.display()
    ));
    succeed(check.args(["--features", "ffi"]).current_dir(posewise));
}
