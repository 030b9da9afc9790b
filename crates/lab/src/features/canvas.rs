//! A face stretched onto a square canvas, and its gradient histograms as of Felzenszwalb et al.,
//! Object Detection with Discriminatively Trained Part-Based Models (2010).

use posewise::align::Shape;
use posewise::image::Frame;
use posewise_metrics::landmarks::bounds;

/// Side of the canvas \[px\].
pub const SIDE: usize = 400;
/// Width and height of what it covers, over those of the shape's box.
const COVER: f32 = 2.0;
/// Side of a landmark's window \[px\]: 0.16 of the canvas.
const WINDOW: usize = 64;
/// Cells along a side of a window.
const CELLS: usize = 2;
/// Directions without sign; with sign there are twice as many.
const DIRECTIONS: usize = 9;
/// Numbers of a cell: directions with sign, without, and four sums.
const CELL_NUMBERS: usize = 3 * DIRECTIONS + 4;
/// Numbers of a window.
pub const NUMBERS: usize = CELLS * CELLS * CELL_NUMBERS;
/// Largest share of a direction in a block.
const CLIP: f32 = 0.2;

/// Where a canvas lies in its frame: each axis has a scale of its own.
#[derive(Clone, Copy)]
pub struct Place {
    /// Frame px of the centre of the canvas' first px.
    corner: [f32; 2],
    /// Frame px per canvas px.
    step: [f32; 2],
}

impl Place {
    /// Around the box of a shape \[frame px\].
    pub fn around(shape: &Shape) -> Place {
        let [left, top, right, bottom] = bounds(shape);
        let size = [right - left, bottom - top].map(|v| v.max(1.0));
        let step = size.map(|v| COVER * v / SIDE as f32);
        let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
        let half = (SIDE as f32 - 1.0) / 2.0;
        Place {
            corner: [0, 1].map(|k| middle[k] - half * step[k]),
            step,
        }
    }

    /// A shape of the frame on the canvas.
    pub fn inward(&self, shape: &Shape) -> Shape {
        shape.map(|p| [0, 1].map(|k| (p[k] - self.corner[k]) / self.step[k]))
    }

    /// A shape of the canvas in the frame.
    pub fn outward(&self, shape: &Shape) -> Shape {
        shape.map(|p| [0, 1].map(|k| p[k] * self.step[k] + self.corner[k]))
    }
}

/// Gradients of a face on its canvas.
pub struct Canvas {
    /// By px, row by row: direction with sign, length (luma of 0 to 1).
    gradients: Vec<(u8, f32)>,
}

impl Canvas {
    /// What a frame shows there.
    pub fn new(frame: &Frame<'_>, place: &Place) -> Canvas {
        let luma: Vec<f32> = (0..SIDE * SIDE)
            .map(|k| {
                let at = [k % SIDE, k / SIDE];
                sample(
                    frame,
                    [0, 1].map(|a| place.corner[a] + at[a] as f32 * place.step[a]),
                )
            })
            .collect();
        let last = SIDE - 1;
        let gradients = (0..SIDE * SIDE).map(|k| {
            let (x, y) = (k % SIDE, k / SIDE);
            let at = |x: usize, y: usize| luma[y * SIDE + x];
            let dx = at((x + 1).min(last), y) - at(x.saturating_sub(1), y);
            let dy = at(x, (y + 1).min(last)) - at(x, y.saturating_sub(1));
            let turn = dy.atan2(dx) / std::f32::consts::TAU * (2 * DIRECTIONS) as f32;
            let direction = (turn.round() as i32).rem_euclid(2 * DIRECTIONS as i32);
            (direction as u8, 0.5 * dx.hypot(dy))
        });
        Canvas {
            gradients: gradients.collect(),
        }
    }

    /// Histograms of the windows around the points of a shape on the canvas, one after the other.
    pub fn histograms(&self, shape: &Shape) -> Vec<f32> {
        shape.iter().flat_map(|p| self.window(*p)).collect()
    }

    fn window(&self, middle: [f32; 2]) -> [f32; NUMBERS] {
        let corner = middle.map(|v| (v - (WINDOW - 1) as f32 / 2.0).round() as i32);
        let within = |k: usize, at: usize| (corner[k] + at as i32).clamp(0, SIDE as i32 - 1);
        let shares: [[f32; CELLS]; WINDOW] = std::array::from_fn(shares);
        let mut cells = [[0.0f32; 2 * DIRECTIONS]; CELLS * CELLS];
        // A window's edge has no gradient of its own.
        for v in 1..WINDOW - 1 {
            let row = &self.gradients[within(1, v) as usize * SIDE..][..SIDE];
            for u in 1..WINDOW - 1 {
                let (direction, length) = row[within(0, u) as usize];
                for (index, cell) in cells.iter_mut().enumerate() {
                    let share = shares[u][index % CELLS] * shares[v][index / CELLS];
                    cell[direction as usize] += length * share;
                }
            }
        }
        normalised(&cells)
    }
}

/// What each cell of a row has of a px of the window: the nearer its middle, the more.
fn shares(at: usize) -> [f32; CELLS] {
    let cell = (at as f32 + 0.5) * CELLS as f32 / WINDOW as f32 - 0.5;
    std::array::from_fn(|c| (1.0 - (cell - c as f32).abs()).max(0.0))
}

/// Each cell's histogram over the energies of the four blocks that hold it.
fn normalised(cells: &[[f32; 2 * DIRECTIONS]; CELLS * CELLS]) -> [f32; NUMBERS] {
    let energies = cells.map(|cell| -> f32 {
        let sums = (0..DIRECTIONS).map(|o| cell[o] + cell[o + DIRECTIONS]);
        sums.map(|v| v * v).sum()
    });
    let last = CELLS as i32 - 1;
    let energy =
        |x: i32, y: i32| energies[y.clamp(0, last) as usize * CELLS + x.clamp(0, last) as usize];
    let mut out = [0.0; NUMBERS];
    for (index, (cell, out)) in cells
        .iter()
        .zip(out.chunks_exact_mut(CELL_NUMBERS))
        .enumerate()
    {
        let (x, y) = ((index % CELLS) as i32, (index / CELLS) as i32);
        for (block, (dx, dy)) in [(-1, -1), (1, -1), (-1, 1), (1, 1)].into_iter().enumerate() {
            let sum = energy(x, y) + energy(x + dx, y) + energy(x, y + dy) + energy(x + dx, y + dy);
            let factor = 1.0 / (sum + 1e-10).sqrt();
            for o in 0..2 * DIRECTIONS {
                let share = (cell[o] * factor).min(CLIP);
                out[o] += 0.5 * share;
                // 0.2357 in the paper.
                out[3 * DIRECTIONS + block] += share / (2.0 * DIRECTIONS as f32).sqrt();
            }
            for o in 0..DIRECTIONS {
                let share = ((cell[o] + cell[o + DIRECTIONS]) * factor).min(CLIP);
                out[2 * DIRECTIONS + o] += 0.5 * share;
            }
        }
    }
    out
}

/// Luma between px, 0 to 1; beyond the edge that of the edge.
fn sample(frame: &Frame<'_>, [x, y]: [f32; 2]) -> f32 {
    let last = [frame.width() - 1, frame.height() - 1];
    let (x, y) = (x.clamp(0.0, last[0] as f32), y.clamp(0.0, last[1] as f32));
    let (u, v) = (x as i32, y as i32);
    let (fx, fy) = (x - u as f32, y - v as f32);
    let at = |x: i32, y: i32| f32::from(frame.luma(x.min(last[0]), y.min(last[1])));
    let upper = at(u, v) * (1.0 - fx) + at(u + 1, v) * fx;
    let lower = at(u, v + 1) * (1.0 - fx) + at(u + 1, v + 1) * fx;
    (upper * (1.0 - fy) + lower * fy) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::shape::LANDMARKS;
    use posewise_train::faces::Picture;

    /// A picture that brightens to the right, around a shape of 100 × 50 px.
    fn slope() -> (Picture, Shape) {
        let luma = (0..200 * 200).map(|k| (k % 200) as u8).collect();
        let size = [200; 2];
        let along = |i: usize| i as f32 / (LANDMARKS - 1) as f32;
        let shape = std::array::from_fn(|i| [50.0 + 100.0 * along(i), 80.0 + 50.0 * along(i)]);
        (Picture { size, luma }, shape)
    }

    #[test]
    fn a_shape_fills_half_of_its_canvas() {
        let (_, shape) = slope();
        let place = Place::around(&shape);
        let inward = place.inward(&shape);
        let [left, top, right, bottom] = bounds(&inward);
        assert!([left, top].iter().all(|v| (v - 99.5).abs() < 1e-3));
        assert!([right, bottom].iter().all(|v| (v - 299.5).abs() < 1e-3));
        let pairs = shape.iter().zip(place.outward(&inward));
        assert!(pairs.into_iter().all(|(a, b)| (a[0] - b[0]).abs() < 1e-3));
    }

    #[test]
    fn histograms_show_the_direction_of_a_slope() {
        let (picture, shape) = slope();
        let place = Place::around(&shape);
        let canvas = Canvas::new(&picture.frame(), &place);
        let all = canvas.histograms(&place.inward(&shape));
        assert_eq!(all.len(), LANDMARKS * NUMBERS);
        // A single direction is clipped in each of the four blocks.
        let cell = &all[..CELL_NUMBERS];
        assert!((cell[0] - 2.0 * CLIP).abs() < 1e-3, "{cell:?}");
        assert!((cell[2 * DIRECTIONS] - 2.0 * CLIP).abs() < 1e-3, "{cell:?}");
        assert!(
            cell[1..2 * DIRECTIONS].iter().all(|v| *v < 1e-3),
            "{cell:?}"
        );
    }
}
