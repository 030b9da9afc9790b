//! Tells the code whether the repository's demo clip is there to be embedded; nothing clever.
use std::path::Path;

fn main() {
    println!("cargo:rustc-check-cfg=cfg(has_demo_clip, has_demo_truth)");
    for (file, cfg) in [
        ("../tests/data/demo.y4m.gz", "has_demo_clip"),
        ("../tests/data/demo.csv", "has_demo_truth"),
    ] {
        println!("cargo:rerun-if-changed={file}");
        if Path::new(file).is_file() {
            println!("cargo:rustc-cfg={cfg}");
        }
    }
    println!("cargo:rerun-if-changed=build.rs");
}
