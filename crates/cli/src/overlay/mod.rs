//! Pictures of what the tracker saw: `paint` draws, `sink` writes videos and folders.

mod colors;
mod legend;
mod mesh;
mod paint;
mod sink;

pub use paint::Painter;
pub use sink::{Overlay, save};
