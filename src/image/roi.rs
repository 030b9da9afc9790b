//! A region of interest: a rectangle of the upright image.

use super::{Frame, MAX_SIDE};

/// A rectangle of the upright image \[px\]: where faces are searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Roi {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Width, at least 1.
    pub width: u32,
    /// Height, at least 1.
    pub height: u32,
}

impl Roi {
    /// A rectangle by its upper left corner, width and height \[px\].
    pub const fn new(x: u32, y: u32, width: u32, height: u32) -> Self {
        Roi {
            x,
            y,
            width,
            height,
        }
    }

    /// The whole frame.
    pub fn whole(frame: &Frame<'_>) -> Self {
        Roi::new(0, 0, frame.width() as u32, frame.height() as u32)
    }

    /// Whether it holds a pixel and lies in the largest frame.
    pub(crate) fn is_valid(&self) -> bool {
        self.width > 0
            && self.height > 0
            && self.right() <= u64::from(MAX_SIDE)
            && self.lower() <= u64::from(MAX_SIDE)
    }

    /// Whether it holds a pixel and all of it lies in the frame.
    pub(crate) fn is_in(&self, frame: &Frame<'_>) -> bool {
        self.is_valid()
            && self.right() <= frame.width() as u64
            && self.lower() <= frame.height() as u64
    }

    /// Whether a point lies in it; the edges count.
    pub(crate) fn contains(&self, [x, y]: [f32; 2]) -> bool {
        (self.x as f32..=self.right() as f32).contains(&x)
            && (self.y as f32..=self.lower() as f32).contains(&y)
    }

    fn right(&self) -> u64 {
        u64::from(self.x) + u64::from(self.width)
    }

    fn lower(&self) -> u64 {
        u64::from(self.y) + u64::from(self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FrameLayout;

    #[test]
    fn it_lies_in_a_frame_or_not() {
        let bytes = [0; 30 * 20];
        let frame = Frame::new(&FrameLayout::grey(30, 20), &bytes).unwrap();
        assert!(Roi::whole(&frame).is_in(&frame));
        assert!(Roi::new(29, 19, 1, 1).is_in(&frame));
        assert!(!Roi::new(29, 19, 2, 1).is_in(&frame));
        assert!(!Roi::new(29, 19, 1, 2).is_in(&frame));
        let (most, no) = (u32::MAX, MAX_SIDE);
        for invalid in [
            Roi::new(0, 0, 0, 1),
            Roi::new(0, 0, 1, 0),
            Roi::new(most, 0, most, 1),
            Roi::new(0, most, 1, most),
            Roi::new(1, 0, no, 1),
        ] {
            assert!(!invalid.is_valid(), "{invalid:?}");
            assert!(!invalid.is_in(&frame), "{invalid:?}");
        }
        assert!(Roi::new(0, 0, no, no).is_valid());
    }

    #[test]
    fn its_edges_belong_to_it() {
        let roi = Roi::new(10, 20, 5, 5);
        assert!(roi.contains([10.0, 25.0]) && roi.contains([15.0, 20.0]));
        assert!(!roi.contains([9.9, 22.0]) && !roi.contains([12.0, 25.1]));
        assert!(!roi.contains([f32::NAN, 22.0]));
    }
}
