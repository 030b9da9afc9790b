//! The folders for Android and iOS: their shape, what is in the libraries, and as much of Android's
//! as a desktop can run. None of it was run on a phone.

use crate::common::c::{require, succeed};
use crate::common::skip::need;
use crate::common::{root, scratch};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use xtask::mobile::{self, ABIS, PLATFORMS};

/// Files of a folder, with paths from there.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(inner) = folders.pop() {
        for entry in std::fs::read_dir(inner).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let name = path.strip_prefix(folder).expect("inside");
                    found.insert(name.display().to_string());
                }
            }
        }
    }
    found
}

/// Whether this machine has Rust for all of these.
fn has_rust_for<'a>(targets: impl Iterator<Item = &'a str>) -> bool {
    let missing = mobile::missing(targets, &scratch("dist"));
    need(&format!("Rust for {missing:?}"), missing.is_empty())
}

/// The folder for Android, made once.
fn android() -> Option<&'static Path> {
    static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();
    let made = FOLDER.get_or_init(|| {
        let rust = has_rust_for(ABIS.iter().map(|(_, target, _)| *target));
        if !rust || !require("make") || !require("javac") {
            return None;
        }
        Some(mobile::android(&scratch("dist")).unwrap_or_else(|error| panic!("{error:#}")))
    });
    made.as_deref()
}

#[test]
#[ignore = "builds the library twice more: .ci/nightly"]
fn android_folder_is_whole() {
    let Some(folder) = android() else { return };
    let module = "prefab/modules/posewise";
    let mut expected: BTreeSet<String> = [
        "AndroidManifest.xml",
        "CMakeLists.txt",
        "LICENSE",
        "NOTICES.txt",
        "R.txt",
        "README.md",
        "classes.jar",
        "posewise.md",
        "posewise_jni.c",
        "prefab/modules/posewise/include/posewise.h",
        "prefab/modules/posewise/module.json",
        "prefab/prefab.json",
        "proguard.txt",
    ]
    .map(String::from)
    .into();
    for (abi, ..) in ABIS {
        for file in ["abi.json", "libposewise.a"] {
            expected.insert(format!("{module}/libs/android.{abi}/{file}"));
        }
    }
    assert_eq!(files(folder), expected);

    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("a header");
    for (abi, ..) in ABIS {
        let archive = folder.join(format!("{module}/libs/android.{abi}/libposewise.a"));
        let contents = mobile::contents(&archive).expect("object files");
        println!("{abi}: {contents:?}");
        // All functions of the header, and nothing else.
        for name in &contents.exported {
            assert!(header.contains(&format!("{name}(")), "{name}");
        }
        assert!(contents.imported.iter().all(|name| name.starts_with("mem")));
    }
}

/// The JVM of this machine loads what CMake makes of the folder.
#[test]
#[ignore = "builds the library twice more: .ci/nightly"]
fn android_classes_track_the_demo() {
    let Some(folder) = android() else { return };
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) || !require("cmake") {
        return;
    }
    let build = scratch("mobile/jni");
    let _ = std::fs::remove_dir_all(&build);
    let jdk = crate::common::java::jdk().join("include");
    let flags = format!("-I{} -I{}", jdk.display(), jdk.join("linux").display());
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(folder).arg("-B").arg(&build);
    configure
        .arg("-DANDROID_ABI=x86_64")
        .arg(format!("-DCMAKE_C_FLAGS={flags}"));
    succeed(&mut configure);
    succeed(Command::new("cmake").arg("--build").arg(&build));
    crate::common::java::check_demo(&build, &folder.join("classes.jar"));
}

/// A Linux program links Android's library, which asks of no system.
#[test]
#[ignore = "builds the library twice more: .ci/nightly"]
fn android_library_gives_the_same_results() {
    let Some(_) = android() else { return };
    if !require("aarch64-linux-gnu-gcc") || !require("qemu-aarch64-static") {
        return;
    }
    let clip = xtask::demo_clip(&scratch("mobile")).expect("the demo clip");
    let replay = |target: Option<&str>| {
        let library = xtask::Library {
            target: target.map(String::from),
            without: Vec::new(),
            target_dir: scratch("dist"),
        };
        let replay = xtask::replay(&library, &clip, FRAMES, 0);
        replay.unwrap_or_else(|error| panic!("{error:#}")).line
    };
    let here = replay(None);
    for (_, target, _) in ABIS {
        assert_eq!(replay(Some(target)), here, "{target}");
    }
}

/// Enough to find the face and to track it.
const FRAMES: usize = 20;

#[test]
#[ignore = "builds the library twice more: .ci/nightly"]
fn ios_framework_is_whole() {
    if !has_rust_for(PLATFORMS.iter().map(|platform| platform.1)) || !require("make") {
        return;
    }
    let made = mobile::ios(&scratch("dist"));
    let folder = made.unwrap_or_else(|error| panic!("{error:#}"));
    let mut expected: BTreeSet<String> = ["Info.plist", "LICENSE", "NOTICES.txt", "posewise.md"]
        .map(String::from)
        .into();
    for (platform, ..) in PLATFORMS {
        for file in [
            "Headers/module.modulemap",
            "Headers/posewise.h",
            "libposewise.a",
        ] {
            expected.insert(format!("{platform}/{file}"));
        }
    }
    assert_eq!(files(&folder), expected);
    // Each kind of device is in the list.
    let list = std::fs::read_to_string(folder.join("Info.plist")).expect("just written");
    for (platform, ..) in PLATFORMS {
        assert!(
            list.contains(&format!("<string>{platform}</string>")),
            "{platform}"
        );
    }
    if require("clang") {
        let source = scratch("mobile").join("import.m");
        let text = "@import posewise;\nint main(void) { return posewise_abi() != POSEWISE_ABI; }\n";
        std::fs::write(&source, text).expect("target/ is writable");
        for (platform, ..) in PLATFORMS {
            let headers = folder.join(platform).join("Headers");
            let mut clang = Command::new("clang");
            clang.args(["-fmodules", "-fsyntax-only", "-Wall", "-Werror", "-I"]);
            clang.arg(headers).arg(format!(
                "-fmodules-cache-path={}",
                scratch("mobile/cache").display()
            ));
            succeed(clang.arg(&source));
        }
    }
}
