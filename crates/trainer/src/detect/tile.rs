//! A tile to train on: its pixels, and what each cell of the network is to answer.

use super::layer::{CELLS, STRIDE};
use super::pictures::Kind;
use posewise::detect::{Detection, TILE};

/// Sizes of faces that a tile is asked for, and those around them that do not count \[tile px\].
pub const SIZES: [f32; 2] = [19.0, 47.0];
const EITHER: [f32; 2] = [14.0, 66.0];
/// Largest roll that is asked for \[rad\]: 60°.
pub const ROLL: f32 = 1.05;
/// Cells nearer to the centre than this share of the size are positive, and those nearer than that
/// are not counted.
const POSITIVE: f32 = 0.2;
const NEAR: f32 = 0.5;
/// Share of a face beyond the tile or the frame from which on it does not count.
const BEYOND: f32 = 0.25;

/// Units of the outputs after the score: of dx and dy \[tile px\], of the logarithm of the size
/// over the middle one, of roll \[rad\], of yaw.
pub const UNITS: [f32; 5] = [8.0, 8.0, 0.4, 0.6, 0.6];
/// \[tile px\].
pub const MIDDLE_SIZE: f32 = 30.0;

/// What a cell is to answer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Cell {
    /// No face.
    #[default]
    No,
    /// A face, or not.
    Either,
    /// A face: dx, dy, log size, roll, yaw in [`UNITS`].
    Face([f32; 5]),
}

/// Pixels and answers.
pub struct Tile {
    pub luma: Vec<u8>,
    pub cells: Vec<Cell>,
    pub faces: Vec<Detection>,
}

/// Place of a cell \[tile px\].
pub fn place(cell: usize) -> [f32; 2] {
    [cell % CELLS, cell / CELLS].map(|c| c as f32 * STRIDE)
}

fn target(face: &Detection, cell: [f32; 2]) -> [f32; 5] {
    let raw = [
        face.x - cell[0],
        face.y - cell[1],
        (face.size / MIDDLE_SIZE).ln(),
        face.roll,
        face.yaw,
    ];
    std::array::from_fn(|k| raw[k] / UNITS[k])
}

fn distance(place: [f32; 2], face: &Detection) -> f32 {
    (place[0] - face.x).hypot(place[1] - face.y)
}

impl Tile {
    /// Black, without a face.
    pub fn new() -> Tile {
        Tile {
            luma: vec![0; TILE * TILE],
            cells: vec![Cell::No; CELLS * CELLS],
            faces: vec![],
        }
    }

    /// Adds a face that the tile shows.
    pub fn label(&mut self, face: &Detection, kind: Kind) {
        let is_rolled = face.roll.abs() > ROLL;
        let good = (SIZES[0]..=SIZES[1]).contains(&face.size) && !is_rolled;
        let either = (EITHER[0]..=EITHER[1]).contains(&face.size) || is_rolled;
        let half = 0.5 * face.size;
        let beyond = |v: f32| (half - v).max(v + half - TILE as f32 + 1.0).max(0.0) / face.size;
        let is_cut = beyond(face.x).max(beyond(face.y)) >= BEYOND;
        let good = good && !is_cut;
        let nearest = [face.x, face.y].map(|v| (v / STRIDE).round() * STRIDE);
        for (k, cell) in self.cells.iter_mut().enumerate() {
            let at = place(k);
            let distance = distance(at, face) / face.size;
            if good && (distance < POSITIVE || at == nearest) {
                *cell = Cell::Face(target(face, at));
            } else if distance < NEAR && (good || either || is_cut) {
                *cell = Cell::Either;
            } else if kind == Kind::Photograph && (0.9..1.9).contains(&distance) {
                // Other people may stand there.
                if *cell == Cell::No {
                    *cell = Cell::Either;
                }
            }
        }
        self.faces.push(*face);
    }

    /// Cells at these distances from a place \[tile px\] that hold no face do not count.
    pub fn ignore(&mut self, at: [f32; 2], distances: std::ops::Range<f32>) {
        for (k, cell) in self.cells.iter_mut().enumerate() {
            let place = place(k);
            let distance = (place[0] - at[0]).hypot(place[1] - at[1]);
            if distances.contains(&distance) && *cell == Cell::No {
                *cell = Cell::Either;
            }
        }
    }

    /// Faces of which much lies beyond these edges of a frame do not count.
    pub fn cut(&mut self, low: [usize; 2], high: [usize; 2]) {
        let is_hidden = |f: &Detection| {
            [f.x, f.y].into_iter().enumerate().any(|(k, v)| {
                let half = 0.5 * f.size;
                let (low, high) = (low[k] as f32, high[k] as f32);
                let beyond = (low - v + half).max(v + half - high);
                let edge =
                    low > 0.0 && low > v - half || high < TILE as f32 - 1.0 && high < v + half;
                edge && beyond > 0.3 * f.size
            })
        };
        let hidden: Vec<Detection> = self.faces.iter().copied().filter(is_hidden).collect();
        for (k, cell) in self.cells.iter_mut().enumerate() {
            let is_near = |f: &Detection| distance(place(k), f) < NEAR * f.size;
            if *cell != Cell::No && hidden.iter().any(is_near) {
                *cell = Cell::Either;
            }
        }
    }

    /// Exchanges left and right.
    pub fn mirror(&mut self) {
        self.luma.chunks_exact_mut(TILE).for_each(<[u8]>::reverse);
        // Cells lie at multiples of the stride: the mirror image of a cell is not a cell, so the
        // targets are made anew from the nearest one.
        let old = self.cells.clone();
        for (k, cell) in self.cells.iter_mut().enumerate() {
            let (x, y) = (k % CELLS, k / CELLS);
            // Its place in the unmirrored tile is one px beside cell 16 − x.
            let from = (CELLS - x).min(CELLS - 1);
            let moved = TILE as f32 - 1.0 - (x + from) as f32 * STRIDE;
            *cell = match old[y * CELLS + from] {
                Cell::Face([dx, dy, size, roll, yaw]) if moved.abs() < 4.0 => {
                    Cell::Face([moved / UNITS[0] - dx, dy, size, -roll, -yaw])
                }
                Cell::Face(_) => Cell::Either,
                other => other,
            };
        }
        for face in &mut self.faces {
            face.x = TILE as f32 - 1.0 - face.x;
            face.roll = -face.roll;
            face.yaw = -face.yaw;
        }
    }
}

impl Default for Tile {
    fn default() -> Self {
        Self::new()
    }
}

/// A tile as the network reads it: as the core's, without its rounding.
pub fn standardise(luma: &[u8], out: &mut [f32]) {
    let n = luma.len() as f32;
    let mean = luma.iter().map(|v| *v as f32).sum::<f32>() / n;
    let squares: f32 = luma.iter().map(|v| (*v as f32 - mean).powi(2)).sum();
    let gain = 1.0 / ((squares / n).sqrt() + 8.0);
    for (o, v) in out.iter_mut().zip(luma) {
        *o = ((*v as f32 - mean) * gain).clamp(-4.0, 3.97);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(x: f32, size: f32) -> Detection {
        Detection {
            x,
            y: 64.0,
            size,
            roll: 0.3,
            yaw: 0.2,
            ..Detection::default()
        }
    }

    #[test]
    fn cells_in_the_middle_of_a_face_are_positive() {
        let mut tile = Tile::new();
        tile.label(&face(66.0, 40.0), Kind::Render);
        let positive = |k: &usize| matches!(tile.cells[*k], Cell::Face(_));
        let found: Vec<[f32; 2]> = (0..tile.cells.len()).filter(positive).map(place).collect();
        assert_eq!(found, [[64.0, 64.0], [72.0, 64.0]]);
        let Cell::Face([dx, dy, ..]) = tile.cells[8 * CELLS + 8] else {
            panic!("the cell at the face");
        };
        assert_eq!([dx * UNITS[0], dy * UNITS[1]], [2.0, 0.0]);
    }

    #[test]
    fn a_mirrored_tile_answers_the_mirror_image() {
        let (mut tile, mut mirrored) = (Tile::new(), Tile::new());
        tile.label(&face(50.0, 30.0), Kind::Render);
        tile.mirror();
        let image = Detection {
            x: TILE as f32 - 1.0 - 50.0,
            roll: -0.3,
            yaw: -0.2,
            ..face(0.0, 30.0)
        };
        mirrored.label(&image, Kind::Render);
        assert_eq!(tile.faces, mirrored.faces);
        let both = tile.cells.iter().zip(&mirrored.cells);
        let mut same = 0;
        for (a, b) in both {
            if let (Cell::Face(a), Cell::Face(b)) = (a, b) {
                assert!(
                    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4),
                    "{a:?} {b:?}"
                );
                same += 1;
            }
        }
        assert!(same > 0);
    }

    #[test]
    fn a_face_beyond_an_edge_does_not_count() {
        let mut tile = Tile::new();
        tile.label(&face(4.0, 40.0), Kind::Render);
        assert!(!tile.cells.iter().any(|c| matches!(c, Cell::Face(_))));
        let mut tile = Tile::new();
        tile.label(&face(60.0, 40.0), Kind::Render);
        tile.cut([56, 0], [TILE - 1; 2]);
        assert!(!tile.cells.iter().any(|c| matches!(c, Cell::Face(_))));
    }
}
