//! The examples for other languages: Java by JNI tracks the demo frames as Rust does; clang accepts
//! Swift's module map.

mod common;

use common::c::{STRICT, cc, library, require, succeed};
use common::java::jdk;
use common::{root, scratch};
use std::process::Command;

#[test]
fn java_tracks_the_demo() {
    if !require("javac") || !require("java") || !cfg!(target_os = "linux") {
        return;
    }
    let (source, out) = (root().join("ffi-examples/jni"), scratch("jni"));
    let mut compile = Command::new(cc());
    compile
        .args(["-std=c99", "-O2", "-shared", "-fPIC"])
        .args(STRICT);
    compile.arg("-I").arg(root().join("include"));
    compile.arg("-I").arg(jdk().join("include"));
    compile.arg("-I").arg(jdk().join("include/linux"));
    compile.arg(source.join("posewise_jni.c")).arg(library());
    compile.args(["-Wl,--gc-sections", "-Wl,--exclude-libs,ALL", "-o"]);
    succeed(compile.arg(out.join("libposewise_jni.so")));
    let mut javac = Command::new("javac");
    javac.args(["-Xlint:all", "-Werror", "-d"]).arg(&out);
    javac.arg(source.join("dev/posewise/Tracker.java"));
    succeed(&mut javac);
    common::java::check_demo(&out, &out);
}

#[test]
fn swift_can_import_it() {
    if !require("clang") {
        return;
    }
    let source = scratch("swift").join("import.m");
    let text = "@import posewise;\nint main(void) { return posewise_abi() != POSEWISE_ABI; }\n";
    std::fs::write(&source, text).expect("target/ is writable");
    let map = root().join("ffi-examples/swift/module.modulemap");
    let mut clang = Command::new("clang");
    clang.args(["-fmodules", "-fsyntax-only", "-Wall", "-Werror"]);
    clang.arg(format!("-fmodule-map-file={}", map.display()));
    clang.arg(format!(
        "-fmodules-cache-path={}",
        scratch("swift/cache").display()
    ));
    succeed(clang.arg(source));
}
