//! The program, as developers run it.

mod bench;
mod common;
mod eval;
mod report;
