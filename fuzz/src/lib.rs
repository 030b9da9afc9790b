//! The fuzz targets of posewise. `tests/fuzz.rs` includes [`targets`] too, to replay the inputs in
//! `seeds.tar.gz`.

pub use posewise::ffi;

pub mod targets;
