//! The C ABI: `include/posewise.h`, which is generated from [`types`] and [`api`].
//!
//! C structs and bytes come in, are checked, and become the crate's own types; results go out the
//! same way (`convert`). All pointer work is in `memory`.

// C names, and the only place besides the model's typed views where DESIGN allows `unsafe`.
#![allow(non_camel_case_types, unsafe_code)]

pub mod api;
mod convert;
mod memory;
#[cfg(feature = "panic-handler")]
mod panic;
#[allow(missing_docs)] // one comment stands for a pair of fields, as in the header
pub mod types;
