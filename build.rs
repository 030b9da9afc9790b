//! Rebuilds when the embedded default model changes; nothing clever.
fn main() {
    println!("cargo:rerun-if-changed=models/default.posewise");
    println!("cargo:rerun-if-changed=build.rs");
}
