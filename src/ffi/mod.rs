//! The C ABI: `include/posewise.h`, which is generated from [`types`], [`weights`], [`api`],
//! [`names`], [`group`], [`mesh`] and their likes for driver monitoring.
//!
//! `convert` checks the caller's structs and converts them to the crate's types, and results back.
//! `gates` has what is asked of addresses and lengths, `memory` does all pointer work, `block`
//! holds the tracker in the caller's memory, `events` writes unread events.
//! `layout` holds the structs to their sizes.
//! `group` has the functions for several trackers, `mesh` those of the dense mesh, `identity` those
//! that remember a person's head.
//! `monitor`, `monitor_types` and `monitor_convert` are the same for driver monitoring.
//! `float_env` sets the floating-point environment for the time of a call.

// C names; raw pointers need `unsafe`.
#![allow(non_camel_case_types, unsafe_code)]

/// An address, a length or a size.
type Word = usize;

pub mod api;
mod block;
mod convert;
mod events;
mod float_env;
mod gates;
pub mod group;
pub mod identity;
mod layout;
mod memory;
pub mod mesh;
#[cfg(feature = "monitor")]
pub mod monitor;
#[cfg(feature = "monitor")]
mod monitor_convert;
#[allow(missing_docs)] // as for `types`
pub mod monitor_types;
pub mod names;
#[cfg(feature = "panic-handler")]
mod panic;
#[allow(missing_docs)] // one comment documents a group of fields, as in the header
pub mod types;
#[allow(missing_docs)] // as for `types`
pub mod weights;
