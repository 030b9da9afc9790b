//! Measures of accuracy, without files and without models: numbers in, numbers out.
//!
//! | module | measure |
//! |---|---|
//! | [`statistics`] | mean, median, Pearson correlation |
//! | [`roc`] | area under the receiver operating characteristic |
//! | [`calibration`] | expected calibration error |
//! | [`landmarks`] | distances of landmarks, normalised mean error (NME) |
//! | [`cumulative`] | area under the cumulative error distribution (CED) |
//! | [`jitter`] | how much landmarks jitter from frame to frame |
//! | [`mesh`] | errors of the vertices of a face by region, unrest of still ones |
//! | [`pose`] | errors of head pose, share of frames tracked |
//! | [`box_jitter`] | boxes as far off as a detector's |

pub mod box_jitter;
pub mod calibration;
pub mod cumulative;
pub mod jitter;
pub mod landmarks;
pub mod mesh;
pub mod pose;
pub mod roc;
pub mod statistics;

pub use box_jitter::{BoxJitter, FaceBox};
pub use calibration::calibration_error;
pub use roc::auc;
pub use statistics::{correlation, mean, median};
