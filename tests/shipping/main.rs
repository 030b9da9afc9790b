//! What is shipped, as its users meet it: libraries and header, packages, programs for other
//! machines and languages, and what a step costs. Tests without their programs are skipped.

mod abi;
mod bindings;
mod c;
mod camera;
#[path = "../common/mod.rs"]
mod common;
mod cost;
mod examples;
mod gates;
mod link;
mod mobile;
mod npm;
mod package;
mod python;
mod release;
mod smaller;
mod targets;
mod web;
mod wheels;
