//! The C ABI: `include/posewise.h`, which is generated from [`types`] and [`api`].
//!
//! `convert` checks the caller's structs and converts them to the crate's types, and results back.
//! `memory` does all pointer work, `block` holds the tracker in the caller's memory.
//! `float_env` sets the floating-point environment for the time of a call.

// C names; raw pointers need `unsafe`.
#![allow(non_camel_case_types, unsafe_code)]

pub mod api;
mod block;
mod convert;
mod float_env;
mod memory;
#[cfg(feature = "panic-handler")]
mod panic;
#[allow(missing_docs)] // one comment documents a group of fields, as in the header
pub mod types;
