//! Frames in, luma out.
//!
//! In: the caller's bytes in one of the V4L2 layouts of [`PixelFormat`]. Out: 8-bit luma, read
//! pixel by pixel, or warped or reduced straight into a small square [`Crop`]. A full frame is
//! never copied, so the cost of a step does not grow with the frame. A frame with much noise
//! ([`noise_share`]) can be read through a 3×3 box filter ([`Frame::box_filtered`]).
//!
//! Pixel coordinates: x right, y down, the centre of the top-left pixel is (0, 0), in the *upright*
//! image, that is after [`Rotation`] and mirroring are undone.

mod box_filter;
mod crop;
mod format;
mod frame;
mod layout;
mod noise;
mod reduce;
mod roi;
mod standardise;
mod warp;

pub use crop::{CROP_MAX, Crop};
pub use format::PixelFormat;
pub use frame::Frame;
pub use layout::{FrameError, FrameLayout, MAX_SIDE, Rotation};
pub use noise::noise_share;
pub use reduce::reduce;
pub use roi::Roi;
pub use warp::warp;
