//! Writes the model that the crate embeds: models/posewise.posewise, in smaller builds without the
//! sections that they do not read. Says whether there is a SIMD kernel for the target.

use posewise_format::{Tag, without};
use std::path::Path;

const MODEL: &str = "models/posewise.posewise";

/// Sections that only one feature reads, by the name that cargo gives it here.
const READ_BY: [(&str, Tag); 3] = [
    ("CARGO_FEATURE_REFINERS", *b"RFIN"),
    ("CARGO_FEATURE_REFINERS", *b"SREG"),
    ("CARGO_FEATURE_MESH", *b"MESH"),
];

fn main() {
    println!("cargo:rerun-if-changed={MODEL}");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(simd_kernel)");
    if has_simd_kernel() {
        println!("cargo:rustc-cfg=simd_kernel");
    }
    let on = |feature: &str| std::env::var_os(feature).is_some();
    if !on("CARGO_FEATURE_DEFAULT_MODEL") {
        return;
    }
    let file = std::fs::read(MODEL).expect(MODEL);
    let unread = READ_BY.iter().filter(|(feature, _)| !on(feature));
    let unread: Vec<Tag> = unread.map(|(_, tag)| *tag).collect();
    let embedded = match unread.is_empty() {
        true => file,
        false => without(&file, &unread).expect("the default model is valid"),
    };
    let out = std::env::var_os("OUT_DIR").expect("cargo sets it");
    std::fs::write(Path::new(&out).join("posewise.posewise"), embedded)
        .expect("OUT_DIR is writable");
}

/// Whether src/network/kernel has a kernel that every machine of the target runs. The scalar one
/// is then left out.
fn has_simd_kernel() -> bool {
    let target = |name: &str| std::env::var(format!("CARGO_CFG_TARGET_{name}")).unwrap_or_default();
    match target("ARCH").as_str() {
        "x86_64" | "aarch64" => true,
        "wasm32" => target("FEATURE")
            .split(',')
            .any(|feature| feature == "simd128"),
        _ => false,
    }
}
