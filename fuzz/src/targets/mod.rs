//! What each fuzz target does with its input: a function of the input's bytes alone, which panics
//! where the library breaks a promise of `posewise.h`.
//!
//! The file that includes this module has the C ABI as `crate::ffi`.

pub mod answer;
pub mod calls;
pub mod frame;
pub mod input;
pub mod memory;
pub mod model;
pub mod tiny;
