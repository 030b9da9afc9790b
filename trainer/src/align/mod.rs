//! Trains the cascade (section `ALGN`).

mod basis;
mod evaluate;
mod quantise;
mod ridge;
mod starts;
mod train;

pub use evaluate::{Accuracy, evaluate};
pub use starts::{Jitter, StartShapes, face_box, start_from_box};
pub use train::{Options, StageOptions, train};
