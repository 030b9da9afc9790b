//! Rendered heads and the 3D face, of a head of no one.

mod common;
mod render;
mod shape;
