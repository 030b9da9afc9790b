//! Lashes and the shape of a lid, drawn over a crop of an eye that is shut by drawing: skin alone
//! shows neither the dark line where lids meet nor how the eyeball raises the lid. Open eyes have
//! some lashes drawn too, so that strokes alone say nothing.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Shares of shut and of open eyes with lashes, of shut ones with a raised lid, and of both with a
/// crease above the lid.
const SHUT_SHARE: f64 = 0.75;
const OPEN_SHARE: f64 = 0.3;
const RAISED_SHARE: f64 = 0.7;
const SHUT_CREASE_SHARE: f64 = 0.4;
const OPEN_CREASE_SHARE: f64 = 0.2;
/// Share of eyes with lashes whose lashes are a soft dark band, by itself or below strokes.
const BAND_SHARE: f64 = 0.7;
const ONLY_BAND_SHARE: f64 = 0.4;
/// Strokes, their length in widths of the eye, and how much luma they take.
const STROKES: std::ops::Range<usize> = 6..60;
const LENGTH: std::ops::Range<f32> = 0.03..0.24;
const DARK: std::ops::Range<f32> = 0.05..0.6;
/// Half the width of a stroke, and of the line where lids meet \[px\].
const HALF_PX: std::ops::Range<f32> = 0.2..0.6;
const LINE_PX: std::ops::Range<f32> = 0.3..1.3;
/// How far a band reaches above and below the edge, in widths of the eye.
const BAND_ABOVE: std::ops::Range<f32> = 0.01..0.04;
const BAND_BELOW: std::ops::Range<f32> = 0.02..0.16;
/// How high a crease is above the line between the corners, in widths of the eye, half its width
/// \[px\], and how much luma it takes.
const CREASE: std::ops::Range<f32> = 0.1..0.4;
const CREASE_PX: std::ops::Range<f32> = 0.4..1.6;
const CREASE_DARK: std::ops::Range<f32> = 0.03..0.3;
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
    let creases = if is_shut {
        SHUT_CREASE_SHARE
    } else {
        OPEN_CREASE_SHARE
    };
    if rng.random_bool(creases) {
        crease(crop, side, edge, rng);
    }
    if !rng.random_bool(if is_shut { SHUT_SHARE } else { OPEN_SHARE }) {
        return;
    }
    let dark = rng.random_range(DARK);
    let has_band = rng.random_bool(BAND_SHARE);
    if has_band {
        band(crop, side, edge, is_shut, dark, rng);
    }
    if !has_band || !rng.random_bool(ONLY_BAND_SHARE) {
        strokes(crop, side, edge, is_shut, dark, rng);
    }
}

/// Single lashes, and the line where lids meet.
fn strokes(
    crop: &mut [f32],
    side: usize,
    edge: &Edge,
    is_shut: bool,
    dark: f32,
    rng: &mut ChaCha8Rng,
) {
    let line = rng.random_range(LINE_PX);
    draw_line(crop, side, &edge.points, line, dark);
    let length = rng.random_range(LENGTH);
    let fan = rng.random_range(0.0..1.2f32);
    // Those of open eyes point up.
    let way = if is_shut { 1.0 } else { -1.0 };
    for _ in 0..rng.random_range(STROKES) {
        let along = rng.random_range(0.0..(edge.points.len() - 1) as f32);
        let [a, b] = [0, 1].map(|k| edge.points[along as usize + k]);
        let [x, y] = [0, 1].map(|k| a[k] + along.fract() * (b[k] - a[k]));
        let out = along / (edge.points.len() - 1) as f32 - 0.5;
        let lean = fan * out + 0.25 * rng.random_range(-1.0f32..1.0);
        let long = way * length * rng.random_range(0.6..1.2f32);
        let [dx, dy] = edge.down;
        // The lean is along the edge.
        let tip = [dx * long - dy * long * lean, dy * long + dx * long * lean];
        let half = rng.random_range(HALF_PX);
        let dark = dark * rng.random_range(0.2..0.9f32);
        draw_line(crop, side, &[[x, y], [x + tip[0], y + tip[1]]], half, dark);
    }
}

/// Lashes that are too fine for pixels: a band that is darkest at the edge and fades away from it,
/// down the cheek where the eye is shut, with thicker and thinner places.
fn band(
    crop: &mut [f32],
    side: usize,
    edge: &Edge,
    is_shut: bool,
    dark: f32,
    rng: &mut ChaCha8Rng,
) {
    let [dx, dy] = edge.down;
    let wide = dx.hypot(dy);
    let (way, across) = ([dx / wide, dy / wide], [dy / wide, -dx / wide]);
    let (near, far) = (
        wide * rng.random_range(BAND_ABOVE),
        wide * rng.random_range(BAND_BELOW),
    );
    let [above, below] = if is_shut { [near, far] } else { [far, near] };
    let (tilt, ripple, phase) = (
        rng.random_range(-0.7..0.7f32),
        rng.random_range(0.0..0.4f32),
        rng.random_range(0.0..std::f32::consts::TAU),
    );
    let in_edge = |p: [f32; 2]| {
        let [x, y] = [p[0] - edge.points[0][0], p[1] - edge.points[0][1]];
        [x * across[0] + y * across[1], x * way[0] + y * way[1]]
    };
    let line: Vec<[f32; 2]> = edge.points.iter().map(|p| in_edge(*p)).collect();
    let end = line[line.len() - 1][0];
    for (at, v) in crop.iter_mut().enumerate() {
        let [x, y] = in_edge([(at % side) as f32, (at / side) as f32]);
        let t = x / end;
        if !(0.0..1.0).contains(&t) {
            continue;
        }
        let along = t * (line.len() - 1) as f32;
        let [a, b] = [0, 1].map(|k| line[(along as usize + k).min(line.len() - 1)][1]);
        let from = y - (a + along.fract() * (b - a));
        let reach = if from < 0.0 { above } else { below }.max(0.5);
        let ends = (8.0 * t * (1.0 - t)).min(1.0);
        let thick = (1.0 + tilt * (2.0 * t - 1.0)) * (1.0 + ripple * (25.0 * t + phase).sin());
        let opacity = ends * thick.clamp(0.0, 1.5) * (-from * from / (reach * reach)).exp();
        *v *= 1.0 - (dark * opacity).min(0.95);
    }
}

/// A dark line over the lid, from corner to corner.
fn crease(crop: &mut [f32], side: usize, edge: &Edge, rng: &mut ChaCha8Rng) {
    let [a, b] = [edge.points[0], edge.points[edge.points.len() - 1]];
    let (high, flat) = (rng.random_range(CREASE), rng.random_range(0.3..1.2f32));
    let (half, dark) = (rng.random_range(CREASE_PX), rng.random_range(CREASE_DARK));
    let lean = rng.random_range(-0.4..0.4f32);
    let [from, to] = [rng.random_range(-0.05..0.25), rng.random_range(0.8..1.1f32)];
    let steps = edge.points.len();
    let at = |k: usize| {
        let t = from + (to - from) * k as f32 / steps as f32;
        let s = (k as f32 / steps as f32 * std::f32::consts::PI)
            .sin()
            .max(0.0);
        let up = high * (s.powf(flat) + lean * (t - 0.5));
        [0, 1].map(|k| a[k] + t * (b[k] - a[k]) - up * edge.down[k])
    };
    let points: Vec<_> = (0..=steps).map(at).collect();
    draw_line(crop, side, &points, half, dark);
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

/// A dark line with soft edges through these points.
fn draw_line(crop: &mut [f32], side: usize, points: &[[f32; 2]], half: f32, dark: f32) {
    let range = |k: usize| {
        let values = points.iter().map(|p| p[k]);
        let low = values.clone().fold(f32::MAX, f32::min) - half - 1.0;
        let high = values.fold(f32::MIN, f32::max) + half + 1.0;
        let last = side as f32;
        low.clamp(0.0, last) as usize..high.ceil().clamp(0.0, last) as usize
    };
    for y in range(1) {
        for x in range(0) {
            let far = points
                .windows(2)
                .map(|pair| distance([x as f32, y as f32], pair[0], pair[1]))
                .fold(f32::MAX, f32::min);
            let opacity = (half - far + 0.5).clamp(0.0, 1.0);
            crop[y * side + x] *= 1.0 - dark * opacity;
        }
    }
}

/// From a point to the line between two others.
fn distance([x, y]: [f32; 2], a: [f32; 2], b: [f32; 2]) -> f32 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = (along[0] * along[0] + along[1] * along[1]).max(1e-6);
    let from = [x - a[0], y - a[1]];
    let t = ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0);
    (from[0] - t * along[0]).hypot(from[1] - t * along[1])
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
            strokes(&mut crop, 40, &edge, true, 0.5, &mut rng);
            band(&mut crop, 40, &edge, true, 0.5, &mut rng);
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

    #[test]
    fn a_band_follows_a_hanging_edge_and_a_crease_is_above_it() {
        let t = |k: usize| k as f32 / 12.0;
        let hang = |k: usize| 20.0 + 24.0 * 0.4 * t(k) * (1.0 - t(k));
        let edge = Edge {
            points: (0..=12).map(|k| [8.0 + 2.0 * k as f32, hang(k)]).collect(),
            down: [0.0, 24.0],
        };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let [mut banded, mut creased] = [0; 2].map(|_| vec![100.0f32; 1600]);
        band(&mut banded, 40, &edge, true, 0.5, &mut rng);
        crease(&mut creased, 40, &edge, &mut rng);
        let darkest = |crop: &[f32], x: usize| {
            (0..40).min_by(|a, b| crop[a * 40 + x].total_cmp(&crop[b * 40 + x]))
        };
        // The edge is at 22.4 there.
        assert!(matches!(darkest(&banded, 20), Some(22 | 23)));
        assert!(banded[40 * 20 + 2] == 100.0 && banded[40 * 8 + 20] > 99.0);
        assert!(
            darkest(&creased, 20) < Some(19),
            "{:?}",
            darkest(&creased, 20)
        );
    }
}
