//! Trains the cascade (sections `ALGN`, `ENSM`, `RFIN` and `SREG`).

pub mod correction;
pub mod cover;
pub mod evaluate;
pub mod global;
mod graph;
mod mean;
mod narrow;
mod network;
mod open;
pub mod parts;
mod quantise;
pub mod relabel;
mod samples;
mod starts;
mod train;

pub use posewise_metrics::BoxJitter as Jitter;

pub use evaluate::{Accuracy, Boxes, evaluate, evaluate_float};
pub use global::{cascade, second};
pub use mean::{align as mean_aligned, mean_shape};
pub use narrow::MODES;
pub use network::{Network, Sizes};
pub use open::with_model;
pub use samples::{Augment, Start};
pub use starts::{StartShapes, jittered_box, normal, start_from_box};
pub use train::{Options, Trained, train};
