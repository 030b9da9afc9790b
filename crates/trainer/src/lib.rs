//! Trains the models of posewise from photographs and rendered faces.

pub mod align;
mod checkpoint;
pub mod completion;
mod dequantized;
pub mod detect;
pub mod eyes;
pub mod face_section;
pub mod faces;
pub mod fit;
pub mod head;
pub mod labels;
pub mod mesh;
pub mod photographs;
pub mod picture;
pub mod pipeline;
mod places;
mod quantized_layer;
pub mod render;
pub mod ridge;
pub mod single_eyes;
pub mod sources;
pub mod verifier;
pub mod weights;
