//! Trains the cascade (sections `ALGN`, `ENSM`, `RFIN` and `SREG`).

mod adam;
mod bend;
pub mod cover;
mod each;
pub mod evaluate;
mod finished;
pub mod global;
mod graph;
mod head;
mod initial;
mod layer;
mod light;
mod mean;
mod network;
mod open;
mod options;
mod quantize;
mod rank;
pub mod refiners;
pub mod rotation_regression;
mod samples;
pub mod shape_regression;
pub mod shut;
mod source;
mod starts;
mod train;

pub use posewise_metrics::BoxJitter as Jitter;

pub use each::each;
pub use evaluate::{Accuracy, Boxes, evaluate, evaluate_float};
pub use finished::parameters;
pub use global::{cascade, ensemble_member};
pub use mean::{align as mean_aligned, mean_shape};
pub use network::{Network, Sizes};
pub use open::with_model;
pub use options::{Aperture, Augment, Options, Start};
pub use quantize::write_regressor;
pub use rank::RANK;
pub use samples::{Sample, disturb, standardise};
pub use source::Source;
pub use starts::{StartShapes, jittered_box, normal, start_from_box};
pub use train::{Trained, train};
