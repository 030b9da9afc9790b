//! The fuzz targets: each is a function of its input alone that panics where the library violates
//! the contract of `posewise.h`.
//!
//! The including crate provides the C ABI as `crate::ffi`.

pub mod calls;
pub mod forged;
pub mod frame;
pub mod input;
pub mod kernels;
pub mod memory;
pub mod mesh;
pub mod model;
pub mod outputs;
pub mod tiny;
pub mod watch;
