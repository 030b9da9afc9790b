//! The folder for Android has the shape of an AAR, the archive from which Gradle takes a library.

use super::{copy, copy_notices, empty, library, objects};
use crate::zip::zip;
use crate::{output_of, root, write};
use anyhow::Result;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Kinds of devices: Android's name, Rust's name, and the machine of the object files. The second
/// are emulators.
pub const ABIS: [(&str, &str, &str); 2] = [
    ("arm64-v8a", "aarch64-linux-android", "Elf Aarch64"),
    ("x86_64", "x86_64-linux-android", "Elf X86_64"),
];

/// The lowest version of Android whose devices may load the library: that of AndroidManifest.xml.
const API: u32 = 21;

/// Files of the repository, and where they are in the folder.
const FILES: [(&str, &str); 6] = [
    (
        "packaging/android/AndroidManifest.xml",
        "AndroidManifest.xml",
    ),
    ("packaging/android/CMakeLists.txt", "CMakeLists.txt"),
    ("packaging/android/README.md", "README.md"),
    ("packaging/android/proguard.txt", "proguard.txt"),
    ("ffi-examples/jni/posewise_jni.c", "posewise_jni.c"),
    (
        "include/posewise.h",
        "prefab/modules/posewise/include/posewise.h",
    ),
];

/// Makes the folder `posewise-android` in a subfolder of cargo's build folder.
pub fn android(target_dir: &Path) -> Result<PathBuf> {
    let folder = target_dir.join("mobile/posewise-android");
    empty(&folder)?;
    copy(FILES, &folder)?;
    copy_notices(&folder)?;
    // Names of resources, of which the library has none.
    write(&folder.join("R.txt"), b"")?;
    write_classes(target_dir, &folder)?;
    let prefab = folder.join("prefab");
    let version = env!("CARGO_PKG_VERSION");
    let package = json!({
        "schema_version": 2, "name": "posewise", "version": version, "dependencies": [],
    });
    write(&prefab.join("prefab.json"), package.to_string().as_bytes())?;
    let module = prefab.join("modules/posewise");
    let about = json!({ "export_libraries": [], "library_name": "libposewise" });
    write(&module.join("module.json"), about.to_string().as_bytes())?;
    for (abi, target, machine) in ABIS {
        let archive = library(target, target_dir).build()?;
        objects::check(&archive, machine)?;
        let libs = module.join("libs").join(format!("android.{abi}"));
        let about = json!({ "abi": abi, "api": API, "ndk": 21, "stl": "none", "static": true });
        write(&libs.join("abi.json"), about.to_string().as_bytes())?;
        write(&libs.join("libposewise.a"), &std::fs::read(archive)?)?;
    }
    Ok(folder)
}

/// Compiles the class for any Android, and packs it.
fn write_classes(target_dir: &Path, folder: &Path) -> Result<()> {
    let classes = target_dir.join("mobile/classes");
    empty(&classes)?;
    let mut javac = Command::new("javac");
    // Newer compilers find Java 8 old.
    javac.args(["--release", "8", "-Xlint:all,-options", "-Werror", "-d"]);
    javac.arg(&classes);
    output_of(javac.arg(root().join("ffi-examples/jni/dev/posewise/Tracker.java")))?;
    zip(&classes, &folder.join("classes.jar"))
}
