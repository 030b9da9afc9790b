//! Frames in, luma out.
//!
//! In: the caller's bytes in one of the V4L2 layouts of [`PixelFormat`]. Out: 8-bit luma, read
//! pixel by pixel or warped straight into a small square [`Crop`]; a full-frame copy is never
//! made, so the cost of a step does not grow with the frame. A frame that is mostly noise
//! ([`noise_share`]) can be read [box_filtered](Frame::box_filtered).
//!
//! Pixel coordinates: x right, y down, the centre of the top-left pixel is (0, 0), in the
//! *upright* image, that is after [`Rotation`] and mirroring.

mod crop;
mod frame;
mod noise;

pub use crop::{CROP_MAX, Crop, warp};
pub use frame::{Frame, FrameError, FrameLayout, MAX_SIDE, PixelFormat, Rotation};
pub use noise::noise_share;
