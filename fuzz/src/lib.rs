//! The fuzz targets of posewise. What they do lies in [`targets`], which `tests/fuzz.rs` includes
//! too, to replay the inputs in `seeds.tar.gz`.

pub use posewise::ffi;

pub mod targets;
