//! A head of no one: an ellipsoid with a nose, for tests that need no data.

use posewise::shape::LANDMARKS;
use posewise_train::head::{Expression, Head};

const COLUMNS: usize = 121;
const ROWS: usize = 91;

/// Front surface of the head at a frontal position \[mm\], or `None` beside the head.
fn depth(x: f32, y: f32) -> Option<f32> {
    let inside = 1.0 - (x / 75.0).powi(2) - ((y - 30.0) / 110.0).powi(2);
    let nose = 22.0 * (-(x / 11.0).powi(2) - ((y - 30.0) / 18.0).powi(2)).exp();
    (inside >= 0.0).then(|| 75.0 - 95.0 * inside.sqrt() - nose)
}

fn surface() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for r in 0..ROWS {
        let latitude = (-80.0 + 160.0 * r as f32 / (ROWS - 1) as f32).to_radians();
        for c in 0..COLUMNS {
            let longitude = (-110.0 + 220.0 * c as f32 / (COLUMNS - 1) as f32).to_radians();
            let x = 75.0 * latitude.cos() * longitude.sin();
            let y = 30.0 + 110.0 * latitude.sin();
            let back = 75.0 - 95.0 * latitude.cos() * longitude.cos();
            let front = longitude.cos() > 0.3;
            vertices.push([
                x,
                y,
                if front {
                    depth(x, y).unwrap_or(back)
                } else {
                    back
                },
            ]);
        }
    }
    let mut triangles = Vec::new();
    for r in 0..ROWS - 1 {
        for c in 0..COLUMNS - 1 {
            let at = |r: usize, c: usize| (r * COLUMNS + c) as u32;
            let (a, b, d, e) = (at(r, c), at(r, c + 1), at(r + 1, c), at(r + 1, c + 1));
            triangles.extend([[a, d, b], [b, d, e]]);
        }
    }
    (vertices, triangles)
}

/// Frontal positions of the landmarks \[mm\].
fn places() -> [[f32; 2]; LANDMARKS] {
    let arc = |i: usize, n: usize, from: f32, to: f32| {
        (from + (to - from) * i as f32 / (n - 1) as f32).to_radians()
    };
    let ring = |i: usize, n: usize, centre: [f32; 2], radius: [f32; 2]| {
        let angle = (180.0 + 360.0 * i as f32 / n as f32).to_radians();
        [
            centre[0] + radius[0] * angle.cos(),
            centre[1] + radius[1] * angle.sin(),
        ]
    };
    std::array::from_fn(|i| match i {
        0..17 => {
            let a = arc(i, 17, 195.0, -15.0);
            [72.0 * a.cos(), 30.0 + 85.0 * a.sin()]
        }
        17..22 => [
            -58.0 + 11.0 * (i - 17) as f32,
            -18.0 - 4.0 * arc(i - 17, 5, 0.0, 180.0).sin(),
        ],
        22..27 => [
            14.0 + 11.0 * (i - 22) as f32,
            -18.0 - 4.0 * arc(i - 22, 5, 0.0, 180.0).sin(),
        ],
        27..31 => [0.0, 10.0 * (i - 27) as f32],
        31..36 => [-14.0 + 7.0 * (i - 31) as f32, 44.0],
        36..42 => ring(i - 36, 6, [-32.0, 0.0], [14.0, 6.0]),
        42..48 => ring(i - 42, 6, [32.0, 0.0], [14.0, 6.0]),
        48..60 => ring(i - 48, 12, [0.0, 72.0], [25.0, 9.0]),
        _ => ring(i - 60, 8, [0.0, 72.0], [17.0, 3.0]),
    })
}

/// Displaces every vertex by a function of its position.
fn mode(vertices: &[[f32; 3]], by: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<[f32; 3]> {
    vertices.iter().map(|v| by(*v)).collect()
}

/// The head: six identity modes, and jaw, lids and brows that move.
pub fn head() -> Head {
    let (mean, triangles) = surface();
    let landmarks = places().map(|[x, y]| {
        let distance =
            |v: &[f32; 3]| (v[0] - x).hypot(v[1] - y) + if v[2] > 74.0 { 9.0 } else { 0.0 };
        let nearest =
            (0..mean.len()).min_by(|a, b| distance(&mean[*a]).total_cmp(&distance(&mean[*b])));
        nearest.unwrap() as u32
    });
    let bump = |v: [f32; 3], x: f32, y: f32, size: f32| {
        (-((v[0] - x) / size).powi(2) - ((v[1] - y) / size).powi(2)).exp()
    };
    let identity = vec![
        mode(&mean, |v| [0.05 * v[0], 0.0, 0.0]),
        mode(&mean, |v| [0.0, 0.05 * v[1], 0.0]),
        mode(&mean, |v| [0.0, 0.0, 0.05 * v[2]]),
        mode(&mean, |v| [0.0, 0.0, -3.0 * bump(v, 0.0, 30.0, 20.0)]),
        mode(&mean, |v| [0.0, 3.0 * bump(v, 0.0, 72.0, 30.0), 0.0]),
        mode(&mean, |v| [0.03 * v[0] * (v[1] / 110.0).max(0.0), 0.0, 0.0]),
    ];
    let expression = |name: &str, delta| Expression {
        name: name.to_owned(),
        delta,
    };
    let below = |v: [f32; 3]| if v[1] > 72.0 { 1.0 } else { 0.0 };
    let expressions = vec![
        expression(
            "jawOpen",
            mode(&mean, |v| [0.0, 30.0 * below(v), 5.0 * below(v)]),
        ),
        expression(
            "eyeBlinkLeft",
            mode(&mean, |v| [0.0, 8.0 * bump(v, 32.0, -6.0, 8.0), 0.0]),
        ),
        expression(
            "eyeBlinkRight",
            mode(&mean, |v| [0.0, 8.0 * bump(v, -32.0, -6.0, 8.0), 0.0]),
        ),
        expression(
            "browInnerUp",
            mode(&mean, |v| [0.0, -8.0 * bump(v, 0.0, -20.0, 20.0), 0.0]),
        ),
    ];
    Head::of_one_part(mean, triangles, landmarks, identity, expressions)
}
