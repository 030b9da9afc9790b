//! Where the target was last trusted or last seen, and what surrounded its face there.
//!
//! A face that is covered as a whole shows nothing that could be verified. But hair, neck and what
//! else is around it stay, whereas a person who leaves takes them along.

use crate::align::Shape;
use crate::image::Frame;
use crate::shape::LANDMARKS;
use crate::track::geometry::bounds;
use crate::track::policy::{COMMON_LUMA, UNCHANGED_LUMA};

/// Cells along a side of the square around the face.
const SIDE: usize = 16;
/// Samples along a side of a cell.
const SAMPLES: usize = 4;
/// Squared distances from the centre of the cells that surround the face \[cells²\]: a ring whose
/// inner edge is the square's circle of half its width.
const RING: core::ops::RangeInclusive<f32> = 16.0..=31.4;
/// Largest luma.
const LUMA_MAX: usize = 255;
/// Cells of the ring at most.
const CELLS: usize = 64;

/// The landmarks of a frame and the mean luma of the cells around them.
#[derive(Clone)]
pub struct Anchor {
    /// Width of the square whose edge is compared \[widths of the face\].
    width: f32,
    is_set: bool,
    shape: Shape,
    luma: [u8; CELLS],
}

impl Anchor {
    // All zeros, as most of a tracker that has not begun: else the whole of it would be data.
    pub const EMPTY: Anchor = Anchor {
        width: 0.0,
        is_set: false,
        shape: [[0.0; 2]; LANDMARKS],
        luma: [0; CELLS],
    };

    /// Landmarks of the last trusted frame, if the face has not turned away since.
    pub fn shape(&self) -> Option<&Shape> {
        self.is_set.then_some(&self.shape)
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        self.is_set = false;
    }

    /// Takes what surrounds the face on this frame: the edge of a square of this width, in widths
    /// of the face.
    pub fn set(&mut self, shape: &Shape, frame: &Frame<'_>, width: f32) {
        self.width = width;
        self.is_set = true;
        self.shape = *shape;
        let square = Square::around(shape, width);
        for (luma, cell) in self.luma.iter_mut().zip(ring()) {
            *luma = square.luma(frame, cell);
        }
    }

    /// Whether there is one.
    pub fn is_set(&self) -> bool {
        self.is_set
    }

    /// How much of what surrounded the face is as it was, in place and around this centre.
    pub fn unchanged(&self, frame: &Frame<'_>, centre: [f32; 2]) -> Unchanged {
        let in_place = Square::around(&self.shape, self.width);
        Unchanged {
            in_place: self.unchanged_in(frame, &in_place),
            moved: self.unchanged_in(frame, &in_place.at(centre)),
        }
    }

    /// Share of the cells of this square's ring whose luma is as it was, but for a small change
    /// that all have in common, as by the camera's exposure.
    #[inline(never)]
    fn unchanged_in(&self, frame: &Frame<'_>, square: &Square) -> f32 {
        // Of a sort the code would take several kilobytes.
        let mut histogram = [0u8; 2 * LUMA_MAX + 1];
        let mut count = 0;
        for (before, cell) in self.luma.iter().zip(ring()) {
            let now = usize::from(square.luma(frame, cell));
            if let Some(cells) = histogram.get_mut(LUMA_MAX + now - usize::from(*before)) {
                *cells += 1;
                count += 1;
            }
        }
        let mut below = 0;
        let common = histogram.iter().position(|cells| {
            below += usize::from(*cells);
            below > count / 2
        });
        let common = common.filter(|common| common.abs_diff(LUMA_MAX) <= COMMON_LUMA);
        let common = common.unwrap_or(LUMA_MAX);
        let first = common.saturating_sub(UNCHANGED_LUMA);
        let same = histogram.iter().skip(first);
        let same = same.take(common + UNCHANGED_LUMA + 1 - first);
        same.map(|cells| f32::from(*cells)).sum::<f32>() / count.max(1) as f32
    }
}

/// Shares of what surrounded a face that are as they were.
pub struct Unchanged {
    /// Where they were.
    pub in_place: f32,
    /// Where they are if they moved along with the face.
    pub moved: f32,
}

impl Unchanged {
    /// The larger one.
    pub fn most(&self) -> f32 {
        self.in_place.max(self.moved)
    }
}

/// Columns and rows of the ring's cells.
fn ring() -> impl Iterator<Item = (usize, usize)> {
    let half = (SIDE as f32 - 1.0) / 2.0;
    let cells = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (column, row)));
    cells.filter(move |(x, y)| {
        let (dx, dy) = (*x as f32 - half, *y as f32 - half);
        RING.contains(&(dx * dx + dy * dy))
    })
}

/// The square around a face, in cells.
struct Square {
    /// Its first sample \[px\].
    first: [f32; 2],
    /// Distance of samples along each axis \[px\].
    step: f32,
}

impl Square {
    /// Centred on the face's box, its side `widths` times the box's longer one.
    fn around(shape: &Shape, widths: f32) -> Square {
        let [left, top, width, height] = bounds(shape);
        let half = widths / 2.0 * width.max(height);
        let step = 2.0 * half / (SIDE * SAMPLES) as f32;
        Square {
            first: [left + width / 2.0, top + height / 2.0]
                .map(|centre| centre - half + step / 2.0),
            step,
        }
    }

    /// The same square with this centre.
    fn at(&self, centre: [f32; 2]) -> Square {
        let half = self.step * ((SIDE * SAMPLES) as f32 - 1.0) / 2.0;
        Square {
            first: centre.map(|centre| centre - half),
            ..*self
        }
    }

    /// Mean luma of the cell in this column and row.
    fn luma(&self, frame: &Frame<'_>, (column, row): (usize, usize)) -> u8 {
        let [x, y] = self.first;
        let at = |first: f32, cell: usize| {
            let of_sample = |n: usize| first + self.step * (SAMPLES * cell + n) as f32;
            core::array::from_fn(|n| libm::floorf(of_sample(n)) as i32)
        };
        let (columns, rows): ([i32; SAMPLES], [i32; SAMPLES]) = (at(x, column), at(y, row));
        let lumas = rows
            .iter()
            .flat_map(|y| columns.map(|x| u32::from(frame.raw_luma(x, *y))));
        (lumas.sum::<u32>() / (SAMPLES * SAMPLES) as u32) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FrameLayout;

    const WIDTH: usize = 160;

    /// A textured picture; `luma` changes it.
    fn picture(luma: impl Fn(usize, usize, u8) -> u8) -> [u8; WIDTH * WIDTH] {
        core::array::from_fn(|i| {
            let (x, y) = (i % WIDTH, i / WIDTH);
            luma(x, y, 60 + ((x / 7 * 31 + y / 5 * 17) % 97) as u8)
        })
    }

    fn unchanged(after: &[u8; WIDTH * WIDTH], centre: [f32; 2]) -> Unchanged {
        let before = picture(|_, _, luma| luma);
        let layout = FrameLayout::grey(WIDTH as u32, WIDTH as u32);
        let before = &Frame::new(&layout, &before).unwrap();
        let after = &Frame::new(&layout, after).unwrap();
        // A face 50 px wide in the middle.
        let shape = core::array::from_fn(|i| {
            let (sin, cos) = (i as f32 * 0.0924).sin_cos();
            [80.0 + 25.0 * cos, 80.0 + 25.0 * sin]
        });
        let mut anchor = Anchor::EMPTY;
        assert!(!anchor.is_set());
        anchor.set(&shape, before, 2.0);
        anchor.unchanged(after, centre)
    }

    fn share(after: &[u8; WIDTH * WIDTH]) -> f32 {
        unchanged(after, [80.0, 80.0]).in_place
    }

    #[test]
    fn what_covers_the_face_alone_or_brightens_all_leaves_the_surroundings() {
        assert_eq!(share(&picture(|_, _, luma| luma)), 1.0);
        assert_eq!(share(&picture(|_, _, luma| luma + 12)), 1.0);
        let face = |x: usize, y: usize| x.abs_diff(80).max(y.abs_diff(80)) < 18;
        assert_eq!(
            share(&picture(|x, y, luma| if face(x, y) { 0 } else { luma })),
            1.0
        );
    }

    #[test]
    fn what_covers_a_side_leaves_the_other_and_another_picture_little() {
        let side = share(&picture(|x, _, luma| if x < 65 { 255 } else { luma }));
        assert!((0.5..0.8).contains(&side), "{side}");
        let other = share(&picture(|x, y, _| ((x / 9 * 57 + y / 8 * 101) % 251) as u8));
        assert!(other < 0.3, "{other}");
    }

    #[test]
    fn what_moves_along_with_the_face_is_unchanged() {
        let before = picture(|_, _, luma| luma);
        let moved = core::array::from_fn(|i| before[i.saturating_sub(10 * WIDTH + 20)]);
        let share = unchanged(&moved, [100.0, 90.0]);
        assert_eq!(share.moved, 1.0);
        assert!(share.in_place < 0.5, "{}", share.in_place);
    }
}
