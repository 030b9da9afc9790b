//! What a network's answers cost: the focal loss (Lin et al., "Focal Loss for Dense Object
//! Detection", ICCV 2017) of the scores, with a power of 2, and a smooth distance of the boxes.

use super::layer::OUTPUTS;
use super::tile::Cell;

/// Weights of dx, dy, log size, roll and yaw.
const WEIGHTS: [f32; 5] = [0.5, 0.5, 0.5, 0.25, 0.25];
/// Probability from which on a cell counts as found, for messages; and from which on a tile that
/// has no face there is repeated.
const FOUND: f32 = 0.5;
const FALSE_POSITIVE: f32 = 0.4;

/// Sums over tiles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Losses {
    /// Of cells with a face, and without one.
    pub positive: f32,
    pub negative: f32,
    pub boxes: f32,
    /// Cells with a face, those of them that are found, and tiles with a false positive.
    pub faces: f32,
    pub found: f32,
    pub false_tiles: f32,
}

impl Losses {
    /// Both sums.
    pub fn plus(&self, other: &Losses) -> Losses {
        Losses {
            positive: self.positive + other.positive,
            negative: self.negative + other.negative,
            boxes: self.boxes + other.boxes,
            faces: self.faces + other.faces,
            found: self.found + other.found,
            false_tiles: self.false_tiles + other.false_tiles,
        }
    }

    /// Adds a tile's last map and writes the gradient by it; returns whether a face was found where
    /// there is none.
    pub fn add(&mut self, cells: &[Cell], out: &[f32], by_out: &mut [f32]) -> bool {
        by_out.fill(0.0);
        let mut is_false = false;
        let rows = out
            .chunks_exact(OUTPUTS)
            .zip(by_out.chunks_exact_mut(OUTPUTS));
        for (cell, (out, by)) in cells.iter().zip(rows) {
            let p = 1.0 / (1.0 + (-out[0]).exp());
            match cell {
                Cell::Either => {}
                Cell::No => {
                    // p² · −log(1 − p), and its slope by the logit.
                    let rest = (1.0 - p).max(1e-6);
                    self.negative -= p * p * rest.ln();
                    by[0] = p * p * (p - 2.0 * rest * rest.ln());
                    is_false |= p > FALSE_POSITIVE;
                }
                Cell::Face(target) => self.add_face(p, target, out, by),
            }
        }
        self.false_tiles += f32::from(is_false);
        is_false
    }

    fn add_face(&mut self, p: f32, target: &[f32; 5], out: &[f32], by: &mut [f32]) {
        let q = p.max(1e-6);
        let rest = 1.0 - p;
        self.positive -= rest * rest * q.ln();
        by[0] = rest * rest * (2.0 * p * q.ln() - rest);
        self.faces += 1.0;
        self.found += f32::from(p > FOUND);
        for (i, weight) in WEIGHTS.into_iter().enumerate() {
            let d = out[1 + i] - target[i];
            // Smooth |d|, quadratic below 0.25.
            let (loss, slope) = match d.abs() < 0.25 {
                true => (2.0 * d * d, 4.0 * d),
                false => (d.abs() - 0.125, d.signum()),
            };
            self.boxes += weight * loss;
            by[1 + i] = weight * slope;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let cells = [
            Cell::No,
            Cell::Face([0.3, -0.2, 0.1, 0.9, 0.0]),
            Cell::Either,
        ];
        let mut out: Vec<f32> = (0..24).map(|k| (k * 7 % 11) as f32 / 4.0 - 1.1).collect();
        let mut by = vec![0.0; 24];
        Losses::default().add(&cells, &out, &mut by);
        let total = |out: &[f32]| {
            let mut losses = Losses::default();
            losses.add(&cells, out, &mut [0.0; 24]);
            losses.positive + losses.negative + losses.boxes
        };
        for k in 0..24 {
            let (kept, h) = (out[k], 1e-2);
            out[k] = kept + h;
            let above = total(&out);
            out[k] = kept - h;
            let slope = (above - total(&out)) / (2.0 * h);
            out[k] = kept;
            assert!((slope - by[k]).abs() < 0.02, "{k}: {slope} {}", by[k]);
        }
    }
}
