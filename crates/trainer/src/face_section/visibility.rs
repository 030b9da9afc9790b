//! Which landmarks the mean head hides from which side, by an orthographic depth buffer.

use crate::head::Head;
use posewise::shape::{LANDMARKS, VIEW_AZIMUTHS, VIEW_BYTES, VIEW_ELEVATIONS, VIEW_STEP_DEG};
use rayon::prelude::*;

/// Side of a depth pixel \[mm\].
const PIXEL_MM: f32 = 1.0;
/// Half of the buffer's side \[pixels\]; the head is less than 0.4 m from its origin.
const HALF: i32 = 300;
/// A landmark this far behind the surface still counts as on it \[mm\]; lids and lips are thin.
const BIAS_MM: f32 = 4.0;

/// The bits that `FaceModel` reads; all set for a head without triangles.
pub fn table(head: &Head) -> Vec<u8> {
    // The kit's eyeballs are larger than life and would hide the far corner too early.
    let solid = ["face", "head_neck"].map(|name| head.part(name));
    let triangles: Vec<[u32; 3]> = head
        .triangles
        .iter()
        .zip(&head.triangle_part)
        .filter(|(_, part)| solid.contains(&Some(**part)))
        .map(|(t, _)| *t)
        .collect();
    let views: Vec<[bool; LANDMARKS]> = (0..VIEW_AZIMUTHS * VIEW_ELEVATIONS)
        .into_par_iter()
        .map(|view| {
            let angle = |cell: usize, cells: usize| {
                ((cell as f32 - (cells / 2) as f32) * VIEW_STEP_DEG).to_radians()
            };
            let azimuth = angle(view / VIEW_ELEVATIONS, VIEW_AZIMUTHS);
            let elevation = angle(view % VIEW_ELEVATIONS, VIEW_ELEVATIONS);
            seen(head, &triangles, azimuth, elevation)
        })
        .collect();
    let mut bits = vec![0u8; LANDMARKS * VIEW_BYTES];
    for (view, seen) in views.iter().enumerate() {
        for landmark in (0..LANDMARKS).filter(|l| seen[*l]) {
            bits[landmark * VIEW_BYTES + view / 8] |= 1 << (view % 8);
        }
    }
    bits
}

/// The landmarks that a camera far away in this direction from the head sees \[rad\].
fn seen(head: &Head, triangles: &[[u32; 3]], azimuth: f32, elevation: f32) -> [bool; LANDMARKS] {
    let (sa, ca) = azimuth.sin_cos();
    let (se, ce) = elevation.sin_cos();
    // Towards the camera, and two axes at right angles to it.
    let view = [ce * sa, -se, -ce * ca];
    let right = [ca, 0.0, sa];
    let down = [se * sa, ce, -se * ca];
    let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    // x, y in pixels, and height towards the camera in mm.
    let flat: Vec<[f32; 3]> = head
        .mean
        .iter()
        .map(|v| {
            [
                dot(v, &right) / PIXEL_MM,
                dot(v, &down) / PIXEL_MM,
                dot(v, &view),
            ]
        })
        .collect();
    let mut heights = vec![f32::NEG_INFINITY; (4 * HALF * HALF) as usize];
    for t in triangles {
        raster(&mut heights, t.map(|v| flat[v as usize]));
    }
    std::array::from_fn(|landmark| {
        let [x, y, height] = flat[head.landmarks[landmark] as usize];
        let top = cell(x.round() as i32, y.round() as i32).map_or(height, |c| heights[c]);
        height + BIAS_MM > top
    })
}

fn cell(x: i32, y: i32) -> Option<usize> {
    let inside = (-HALF..HALF).contains(&x) && (-HALF..HALF).contains(&y);
    inside.then(|| ((y + HALF) * 2 * HALF + x + HALF) as usize)
}

/// Keeps the greatest height of a triangle over each pixel centre that it covers.
fn raster(heights: &mut [f32], [a, b, c]: [[f32; 3]; 3]) {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area.abs() < 1e-9 {
        return;
    }
    let range = |k: usize| {
        let low = a[k].min(b[k]).min(c[k]).ceil() as i32;
        low..=a[k].max(b[k]).max(c[k]).floor() as i32
    };
    for y in range(1) {
        for x in range(0) {
            let (px, py) = (x as f32, y as f32);
            let part = |p: [f32; 3], q: [f32; 3]| {
                ((p[0] - px) * (q[1] - py) - (p[1] - py) * (q[0] - px)) / area
            };
            let (u, v, w) = (part(b, c), part(c, a), part(a, b));
            if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                let height = u * a[2] + v * b[2] + w * c[2];
                if let Some(cell) = cell(x, y) {
                    heights[cell] = heights[cell].max(height);
                }
            }
        }
    }
}
