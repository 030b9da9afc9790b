//! Descriptors of the image around a landmark, in axes that turn and scale with the face.

use super::picture::Picture;

/// Points of an intensity patch along a side, and their distance \[mm\].
const PATCH: usize = 9;
const PATCH_MM: f32 = 3.0;

/// Cells of gradients along a side, points of a cell along a side, and their distance \[mm\].
const CELLS: usize = 4;
const CELL: usize = 3;
const GRADIENT_MM: f32 = 2.5;
/// Directions of gradients.
const DIRECTIONS: usize = 8;
/// Largest share of one direction in a cell, as of SIFT (Lowe 2004).
const CLIP: f32 = 0.2;

/// Standard deviation of the blur before \[mm\]: half the distance of the points.
pub const BLUR_MM: f32 = 1.2;

/// Kinds of descriptors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
pub enum Descriptor {
    /// Intensities of a patch, less their mean, of unit length.
    Intensity,
    /// Gradients by cell and direction, as SIFT's.
    Gradients,
}

impl Descriptor {
    /// Length.
    pub fn len(self) -> usize {
        match self {
            Descriptor::Intensity => PATCH * PATCH,
            Descriptor::Gradients => CELLS * CELLS * DIRECTIONS,
        }
    }

    /// Reads the descriptor at a point; `axes` are the image directions of x and y \[px/mm\].
    pub fn read(self, picture: &Picture, at: [f32; 2], axes: [[f32; 2]; 2], out: &mut [f32]) {
        match self {
            Descriptor::Intensity => intensity(picture, at, axes, out),
            Descriptor::Gradients => gradients(picture, at, axes, out),
        }
    }
}

/// The image point at (x, y) mm from `at`.
fn point(at: [f32; 2], axes: [[f32; 2]; 2], x: f32, y: f32) -> [f32; 2] {
    [0, 1].map(|k| at[k] + x * axes[0][k] + y * axes[1][k])
}

fn intensity(picture: &Picture, at: [f32; 2], axes: [[f32; 2]; 2], out: &mut [f32]) {
    let offset = |k: usize| (k as f32 - (PATCH / 2) as f32) * PATCH_MM;
    for (k, value) in out.iter_mut().enumerate() {
        *value = picture.at(point(at, axes, offset(k % PATCH), offset(k / PATCH)));
    }
    let mean = out.iter().sum::<f32>() / out.len() as f32;
    out.iter_mut().for_each(|v| *v -= mean);
    normalize(out);
}

fn gradients(picture: &Picture, at: [f32; 2], axes: [[f32; 2]; 2], out: &mut [f32]) {
    const SIDE: usize = CELLS * CELL + 2;
    let offset = |k: usize| (k as f32 - (SIDE - 1) as f32 / 2.0) * GRADIENT_MM;
    let mut values = [[0.0; SIDE]; SIDE];
    for (y, row) in values.iter_mut().enumerate() {
        for (x, value) in row.iter_mut().enumerate() {
            *value = picture.at(point(at, axes, offset(x), offset(y)));
        }
    }
    // Unit vectors of the eight directions.
    const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;
    const UNITS: [[f32; 2]; DIRECTIONS] = [
        [1.0, 0.0],
        [HALF, HALF],
        [0.0, 1.0],
        [-HALF, HALF],
        [-1.0, 0.0],
        [-HALF, -HALF],
        [0.0, -1.0],
        [HALF, -HALF],
    ];
    out.fill(0.0);
    for (y, x) in (1..SIDE - 1).flat_map(|y| (1..SIDE - 1).map(move |x| (y, x))) {
        let dx = values[y][x + 1] - values[y][x - 1];
        let dy = values[y + 1][x] - values[y - 1][x];
        let cell = (y - 1) / CELL * CELLS + (x - 1) / CELL;
        let sums = &mut out[cell * DIRECTIONS..][..DIRECTIONS];
        for (sum, [ux, uy]) in sums.iter_mut().zip(UNITS) {
            *sum += (dx * ux + dy * uy).max(0.0);
        }
    }
    normalize(out);
    out.iter_mut().for_each(|v| *v = v.min(CLIP));
    normalize(out);
}

/// To unit length; flat patches stay near 0.
fn normalize(values: &mut [f32]) {
    let length = values.iter().map(|v| v * v).sum::<f32>().sqrt();
    let scale = 1.0 / length.max(1.0);
    // Values below one grey level are noise; a second call gets unit vectors.
    let scale = if length > 0.5 { 1.0 / length } else { scale };
    values.iter_mut().for_each(|v| *v *= scale);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A blob that is brighter to the right.
    fn picture(gain: f32) -> Picture {
        let at = |i: usize| {
            let (x, y) = ((i % 64) as f32, (i / 64) as f32);
            gain * (x + 30.0 * ((x / 5.0).sin() + (y / 7.0).cos())) + 20.0
        };
        Picture {
            width: 64,
            height: 64,
            pixels: (0..64 * 64).map(at).collect(),
        }
    }

    #[test]
    fn gain_and_offset_of_the_light_do_not_matter() {
        for kind in [Descriptor::Intensity, Descriptor::Gradients] {
            let read = |gain| {
                let mut out = vec![0.0; kind.len()];
                let axes = [[1.0, 0.0], [0.0, 1.0]];
                kind.read(&picture(gain), [32.0, 30.0], axes, &mut out);
                out
            };
            let (a, b) = (read(1.0), read(0.5));
            let off: f32 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
            assert!(off < 1e-6, "{kind:?}: {off}");
            let length: f32 = a.iter().map(|v| v * v).sum();
            assert!((length - 1.0).abs() < 1e-4);
        }
    }
}
