//! `--monitor` of `track` and `view`: a driver monitor over the tracker's results.
//!
//! | file | what it does |
//! |---|---|
//! | `watch` | the monitor of a run, and the lines of its events |
//! | `json` | what the page of `posewise view` is sent of it |
//! | `keep` | keeps the tracker to the driver |
//! | `zones` | zones from a file |
//! | `columns` | what it adds to the CSV |
//! | `plot` | what it adds to the plot |

pub mod columns;
pub mod json;
mod keep;
pub mod plot;
pub mod watch;
pub mod zones;

pub use keep::Turn;
