//! Trains the models of posewise from photographs and rendered faces.

pub mod adaptive;
pub mod align;
pub mod demo_clip;
pub mod detect;
pub mod face_section;
pub mod faces;
pub mod fit;
pub mod head;
pub mod lab;
pub mod pack;
pub mod pipeline;
pub mod render;
mod ridge;
mod roc;
pub mod score;
pub mod single_eyes;
pub mod templates;
