//! Lashes and the shape of a lid, drawn over a crop of an eye that is shut by drawing: skin alone
//! shows neither the dark line where lids meet nor how the eyeball raises the lid. Open eyes have
//! some lashes drawn too, so that strokes alone say nothing.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Shares of shut and of open eyes with lashes, and of shut ones with a raised lid.
const SHUT_SHARE: f64 = 0.75;
const OPEN_SHARE: f64 = 0.3;
const RAISED_SHARE: f64 = 0.6;
/// Strokes, their length in widths of the eye, and how much luma they take.
const STROKES: std::ops::Range<usize> = 6..40;
const LENGTH: std::ops::Range<f32> = 0.03..0.24;
const DARK: std::ops::Range<f32> = 0.05..0.6;
/// Half the width of a stroke, and of the line where lids meet \[px\].
const HALF_PX: std::ops::Range<f32> = 0.2..0.6;
const LINE_PX: std::ops::Range<f32> = 0.3..1.3;
/// How much a lid shines over the eyeball, in luma.
const SHINE: std::ops::Range<f32> = -0.1..0.45;

/// The edge of the upper lid in a crop \[px\], from corner to corner, and the way across it: down
/// the cheek, as long as the eye is wide.
pub struct Edge {
    /// Points of it, evenly spaced.
    pub points: Vec<[f32; 2]>,
    /// That way.
    pub down: [f32; 2],
}

/// Draws them on a crop of this side; `shut` is how far the eye is shut.
pub fn draw(crop: &mut [f32], side: usize, edge: &Edge, shut: f32, rng: &mut ChaCha8Rng) {
    let is_shut = shut > 0.5;
    if is_shut && rng.random_bool(RAISED_SHARE) {
        raise(crop, side, edge, rng);
    }
    if !rng.random_bool(if is_shut { SHUT_SHARE } else { OPEN_SHARE }) {
        return;
    }
    let dark = rng.random_range(DARK);
    let line = rng.random_range(LINE_PX);
    for pair in edge.points.windows(2) {
        stroke(crop, side, [pair[0], pair[1]], line, dark);
    }
    let length = rng.random_range(LENGTH);
    let fan = rng.random_range(0.0..1.2f32);
    // Those of open eyes point up.
    let way = if is_shut { 1.0 } else { -1.0 };
    for _ in 0..rng.random_range(STROKES) {
        let at = rng.random_range(0..edge.points.len());
        let out = at as f32 / edge.points.len() as f32 - 0.5;
        let lean = fan * out + 0.25 * rng.random_range(-1.0f32..1.0);
        let long = way * length * rng.random_range(0.6..1.2f32);
        let [dx, dy] = edge.down;
        // The lean is along the edge.
        let tip = [dx * long - dy * long * lean, dy * long + dx * long * lean];
        let [x, y] = edge.points[at];
        let half = rng.random_range(HALF_PX);
        stroke(crop, side, [[x, y], [x + tip[0], y + tip[1]]], half, dark);
    }
}

/// Brightens or darkens the middle of the lid, over the eyeball.
fn raise(crop: &mut [f32], side: usize, edge: &Edge, rng: &mut ChaCha8Rng) {
    let [dx, dy] = edge.down;
    let wide = dx.hypot(dy);
    let middle = edge.points[edge.points.len() / 2];
    let above = rng.random_range(0.1..0.3);
    let [x, y] = [middle[0] - above * dx, middle[1] - above * dy];
    let radius = wide * rng.random_range(0.15..0.4f32);
    let shine = rng.random_range(SHINE);
    for (at, v) in crop.iter_mut().enumerate() {
        let far = ((at % side) as f32 - x).hypot((at / side) as f32 - y) / radius;
        *v = (*v * (1.0 + shine * (-far * far).exp())).clamp(0.0, 255.0);
    }
}

/// A dark line with soft edges.
fn stroke(crop: &mut [f32], side: usize, [a, b]: [[f32; 2]; 2], half: f32, dark: f32) {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = (along[0] * along[0] + along[1] * along[1]).max(1e-6);
    let range = |k: usize| {
        let (low, high) = (a[k].min(b[k]) - half - 1.0, a[k].max(b[k]) + half + 1.0);
        let last = side as f32;
        low.clamp(0.0, last) as usize..high.ceil().clamp(0.0, last) as usize
    };
    for y in range(1) {
        for x in range(0) {
            let from = [x as f32 - a[0], y as f32 - a[1]];
            let t = ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0);
            let far = (from[0] - t * along[0]).hypot(from[1] - t * along[1]);
            let opacity = (half - far + 0.5).clamp(0.0, 1.0);
            crop[y * side + x] *= 1.0 - dark * opacity;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn lashes_of_a_shut_eye_hang_below_its_edge() {
        let edge = Edge {
            points: (0..=12).map(|k| [8.0 + 2.0 * k as f32, 20.0]).collect(),
            down: [0.0, 24.0],
        };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut above, mut below) = (0.0, 0.0);
        for _ in 0..100 {
            let mut crop = vec![100.0; 1600];
            draw(&mut crop, 40, &edge, 1.0, &mut rng);
            assert!(crop.iter().all(|v| (0.0..=255.0).contains(v)));
            let dark = |rows: std::ops::Range<usize>| {
                let rows = &crop[40 * rows.start..40 * rows.end];
                rows.iter().map(|v| (100.0 - v).max(0.0)).sum::<f32>()
            };
            above += dark(10..18);
            below += dark(23..31);
        }
        assert!(below > 5.0 * above, "{above} {below}");
    }
}
