//! Trains the cascade (section `ALGN`).

mod basis;
pub mod evaluate;
mod quantise;
mod ridge;
mod starts;
mod train;

pub use evaluate::{Accuracy, evaluate};
pub(crate) use quantise::RegressorWeights;
pub(crate) use ridge::{Normal, predict};
pub(crate) use starts::normal;
pub use starts::{Jitter, StartShapes, face_box, start_from_box};
pub use train::{Options, StageOptions, train};
