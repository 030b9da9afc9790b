//! The canonical crop: a small square of luma cut out of a frame by a similarity transform.

/// Largest side of a crop \[px\].
pub const CROP_MAX: usize = 128;

/// A square grey image of `side`×`side` pixels, row-major, in fixed memory.
#[derive(Clone)]
pub struct Crop {
    side: usize,
    luma: [u8; CROP_MAX * CROP_MAX],
}

impl Default for Crop {
    fn default() -> Self {
        Self::new()
    }
}

impl Crop {
    /// An empty crop.
    pub const fn new() -> Self {
        Crop {
            side: 0,
            luma: [0; CROP_MAX * CROP_MAX],
        }
    }

    /// Width and height \[px\].
    pub fn side(&self) -> usize {
        self.side
    }

    /// Exchanges left and right.
    pub fn mirror(&mut self) {
        let side = self.side;
        self.luma
            .chunks_exact_mut(side.max(1))
            .take(side)
            .for_each(<[u8]>::reverse);
    }

    /// The pixels of a crop of this side, at most [`CROP_MAX`], to be written.
    pub(super) fn resized(&mut self, side: usize) -> &mut [u8] {
        self.side = side.min(CROP_MAX);
        self.luma_mut()
    }

    /// As [`Self::luma`], to be changed.
    pub(super) fn luma_mut(&mut self) -> &mut [u8] {
        let pixels = self.side * self.side;
        self.luma.get_mut(..pixels).unwrap_or(&mut [])
    }

    /// The pixels, row-major, `side()` to a row.
    pub fn luma(&self) -> &[u8] {
        self.luma.get(..self.side * self.side).unwrap_or(&[])
    }
}
