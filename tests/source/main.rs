//! What is checked of the sources themselves, without running them.

#[path = "../common/mod.rs"]
mod common;
mod imports;
mod interface;
mod languages;
mod layering;
mod links;
mod style;
