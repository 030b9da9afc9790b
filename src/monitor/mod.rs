//! Driver monitoring: eye closures, PERCLOS, yawns, nods and glances from what a tracker reports.
//!
//! A [`Monitor`] sees [`Observation`]s and their timestamps, never pixels. An observation counts
//! until the next one, for at most [`MonitorConfig::gap_us`]; other time is unknown. What is
//! unknown (no face, a head turned away, a hidden eye, a gap between frames) is neither open nor
//! closed, neither on the road nor away: it is left out of every measure, and each measure says how
//! much of its window was known.
//!
//! | file | content |
//! |---|---|
//! | `config`, `preset`, `zone` | settings, where their values come from, zones of interest |
//! | `observation`, `openness`, `reading` | what is observed, and what of it is known |
//! | `clock`, `perclos`, `recent` | time, and exact sums over windows of whole bins |
//! | `closure`, `yawn`, `nod`, `look_down`, `glance`, `drowsiness` | one state machine each |
//! | `lowered` | whether shut lids may follow a gaze that was lowered |
//! | `aim` | what the zones are met by: gaze or head |
//! | `episode` | what yawns and looks down have in common |
//! | `baseline`, `natural` | openness of this person's open eyes, direction of the road |
//! | `place` | where the driver sits |
//! | `quantile` | of the histograms from which both are learnt |
//! | `record` | both as bytes, for the next drive |
//! | `event`, `state`, `driver` | outputs, and the whole |
//!
//! Memory is fixed, work per observation is bounded.

mod aim;
mod baseline;
mod clock;
mod closure;
mod config;
mod driver;
mod drowsiness;
mod episode;
mod event;
mod glance;
mod look_down;
mod lowered;
mod natural;
mod nod;
mod observation;
mod openness;
mod perclos;
mod place;
mod preset;
mod quantile;
mod reading;
mod recent;
mod record;
mod state;
mod yawn;
mod zone;

pub use config::{MonitorConfig, MonitorConfigError, Place, ZonesBy};
pub use driver::{Monitor, MonitorTimeError};
pub use event::{MONITOR_EVENTS, MonitorEvent, MonitorEventKind, MonitorEventLog};
pub use observation::Observation;
#[cfg(feature = "unstable-internals")]
pub use openness::openness;
pub use preset::Preset;
pub use record::MONITOR_RECORD_BYTES;
pub use state::{Drowsiness, EyeState, MonitorState, Perclos, UnknownReason};
pub use zone::{MAX_ZONES, Zone, ZoneShape, ZoneState};
