//! The XCFramework for iOS: a folder with a library for each kind of device, from which Xcode and
//! Swift packages take the one that they need.

use super::{copy, copy_notices, empty, library, objects};
use crate::{root, write};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Kinds of devices: the name in the framework's Info.plist, and Rust's name.
pub const PLATFORMS: [(&str, &str); 2] = [
    ("ios-arm64", "aarch64-apple-ios"),
    ("ios-arm64-simulator", "aarch64-apple-ios-sim"),
];

/// Makes the folder `posewise.xcframework`, alone in a folder of cargo's build folder.
pub fn ios(target_dir: &Path) -> Result<PathBuf> {
    let folder = target_dir.join("mobile/ios/posewise.xcframework");
    empty(&folder)?;
    copy_notices(&folder)?;
    copy([("packaging/ios/Info.plist", "Info.plist")], &folder)?;
    let map = std::fs::read_to_string(root().join("ffi-examples/swift/module.modulemap"))?;
    let map = map.replace("../../include/posewise.h", "posewise.h");
    for (platform, target) in PLATFORMS {
        let archive = library(target, target_dir).build()?;
        objects::check(&archive, "MachO Aarch64")?;
        let platform = folder.join(platform);
        write(&platform.join("libposewise.a"), &std::fs::read(archive)?)?;
        let headers = platform.join("Headers");
        copy([("include/posewise.h", "posewise.h")], &headers)?;
        write(&headers.join("module.modulemap"), map.as_bytes())?;
    }
    Ok(folder)
}
