//! Where the visible face contour can run: paths over the cheek from each jaw landmark.
//!
//! Photographs label the jaw on the visible outline, which slides over the cheek as the head turns.
//! As in landmark marching (Zhu et al., CVPR 2015), each jaw landmark gets a path of vertices that
//! lead from it inwards; whichever of them is outermost in the image lies on the outline. On the
//! side that turns towards the camera nothing is hidden: there the line is the lower jaw's edge
//! below the ear, up to 22 mm behind the outline of the frontal view, and under the chin it is the
//! lowest point.

use glam::{Vec2, Vec3};
use posewise::shape::{JAW, LANDMARKS};

/// Vertices of one path, the landmark and the one behind it included.
const PATH: usize = 8;

/// How far from its landmark the lowest point of the chin may lie \[mm\].
pub const BELOW_MM: f32 = 12.0;

/// Half the width of the strip of skin that a path may wander in \[mm\].
const STRIP_MM: f32 = 6.0;

/// Share of the way from a jaw landmark to the face's middle line (or, for the chin, to the
/// mouth) that a path covers: the outline never gets further in before the nose hides it.
const REACH: f32 = 0.6;

/// Unit outward normals of vertices, area-weighted over their triangles.
pub fn normals(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| Vec3::from(vertices[v as usize]));
        let area = (b - a).cross(c - a);
        t.iter().for_each(|v| sums[*v as usize] += area);
    }
    sums.iter().map(|n| n.normalize_or_zero().into()).collect()
}

/// Outward directions of the jaw landmarks in the frontal view (x, y): normals of the jaw line.
pub fn outward(points: &[[f32; 3]; LANDMARKS]) -> [[f32; 2]; JAW] {
    std::array::from_fn(|i| {
        let (a, b) = (points[i.saturating_sub(1)], points[(i + 1).min(JAW - 1)]);
        // The jaw line runs from the image left over the chin to the right.
        Vec2::new(a[1] - b[1], b[0] - a[0])
            .normalize_or_zero()
            .into()
    })
}

/// Places along a line, in numbers of its points, that cut it into parts of even length.
pub fn even_places<const N: usize>(line: &[Vec3]) -> [f32; N] {
    let lengths: Vec<f32> = line.windows(2).map(|w| w[0].distance(w[1])).collect();
    let step = lengths.iter().sum::<f32>() / (N - 1) as f32;
    let (mut segment, mut before) = (0, 0.0);
    std::array::from_fn(|k| {
        let want = k as f32 * step;
        while segment + 1 < lengths.len() && before + lengths[segment] < want {
            before += lengths[segment];
            segment += 1;
        }
        segment as f32 + ((want - before) / lengths[segment].max(1e-6)).min(1.0)
    })
}

/// The point at a place of a line.
pub fn at_place(line: &[Vec3], place: f32) -> Vec3 {
    let before = (place as usize).min(line.len() - 2);
    line[before].lerp(line[before + 1], place - before as f32)
}

/// Vertices at even distances along the lower jaw's edge, down to the chin and up again; none for
/// the five landmarks of the chin, which lie on it. `lines`: vertices along each side of the edge,
/// the uppermost first; what lies above the first landmark is left out.
pub fn jaw_edge(
    mean: &[[f32; 3]],
    landmarks: &[u32; LANDMARKS],
    lines: [&[u32]; 2],
    skin: impl Fn(usize) -> bool,
) -> [Option<u32>; JAW] {
    const CHIN: usize = JAW / 2;
    let at = |v: u32| Vec3::from(mean[v as usize]);
    let sides = [(lines[0], 0), (lines[1], JAW - 1)].map(|(line, first): (&[u32], usize)| {
        let top = at(landmarks[first]).y;
        let below = line.iter().map(|v| at(*v)).filter(|p| p.y > top);
        let line: Vec<Vec3> = below.chain([at(landmarks[CHIN])]).collect();
        even_places::<{ CHIN + 1 }>(&line).map(|place| at_place(&line, place))
    });
    std::array::from_fn(|i| {
        let point = match i {
            0..6 => sides[0][i],
            6..=10 => return None,
            _ => sides[1][JAW - 1 - i],
        };
        let nearest = (0..mean.len()).filter(|v| skin(*v)).min_by(|a, b| {
            let far = |v: &usize| Vec3::from(mean[*v]).distance_squared(point);
            far(a).total_cmp(&far(b))
        });
        nearest.map(|v| v as u32)
    })
}

/// Paths of up to [`PATH`] vertices for the 17 jaw landmarks; only vertices with `skin` are used.
/// `edge`: the vertex of each on the lower jaw's edge ([`jaw_edge`]); where there is none the path
/// goes on to the lowest point.
pub fn contour_paths(
    mean: &[[f32; 3]],
    triangles: &[[u32; 3]],
    landmarks: &[u32; LANDMARKS],
    edge: &[Option<u32>; JAW],
    skin: impl Fn(usize) -> bool,
) -> [Vec<u32>; JAW] {
    let normals = normals(mean, triangles);
    let points = landmarks.map(|v| mean[v as usize]);
    let directions = outward(&points);
    let mouth = Vec3::from(points[57]);
    std::array::from_fn(|i| {
        let out = Vec3::new(directions[i][0], directions[i][1], 0.0);
        let side = Vec3::new(-out.y, out.x, 0.0);
        let start = Vec3::from(points[i]);
        let reach = REACH * out.dot(start - mouth * Vec3::new(0.0, 1.0, 0.0)).max(20.0);
        // The skin in a strip that runs inwards and forwards, by its way from the landmark.
        let strip: Vec<(f32, f32, u32)> = (0..mean.len())
            .filter(|v| skin(*v))
            .filter_map(|v| {
                let way = Vec3::from(mean[v]) - start;
                let (inward, forward) = (-way.dot(out), -way.z);
                let facing = Vec3::from(normals[v]).dot(out - 0.5 * Vec3::Z);
                let inside = inward > -2.0 && inward < reach && forward > -3.0 && facing > 0.0;
                let off = way.dot(side).abs();
                (inside && off < STRIP_MM).then_some((inward + forward, off, v as u32))
            })
            .collect();
        let end = strip.iter().fold(0.0f32, |m, s| m.max(s.0));
        let lowest = (0..mean.len()).filter(|v| skin(*v)).filter_map(|v| {
            let way = Vec3::from(mean[v]) - start;
            let near = way.length() < BELOW_MM;
            near.then_some((way.dot(out) - way.dot(side).abs(), v as u32))
        });
        let behind = edge[i].or_else(|| lowest.max_by(|a, b| a.0.total_cmp(&b.0)).map(|l| l.1));
        let mut path = vec![landmarks[i]];
        path.extend(behind.filter(|v| !path.contains(v)));
        let steps = PATH - path.len();
        for k in 1..=steps {
            let want = end * k as f32 / steps as f32;
            let cost = |s: &(f32, f32, u32)| (s.0 - want).abs() + 0.5 * s.1;
            let best = strip.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
            path.extend(best.map(|b| b.2).filter(|v| !path.contains(v)));
        }
        path
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_has_even_steps_and_spares_the_chin() {
        // Two lines that run down 40 mm behind the landmarks, which are 1 mm apart.
        let mut mean: Vec<[f32; 3]> = (0..LANDMARKS).map(|i| [i as f32, 0.0, 0.0]).collect();
        mean[JAW / 2] = [0.0, 80.0, 40.0];
        let mut line = |x: f32| -> Vec<u32> {
            let first = mean.len() as u32;
            mean.extend((0..80).map(|y| [x, y as f32, 40.0]));
            (first..mean.len() as u32).collect()
        };
        let lines = [line(-1.0), line(1.0)];
        let landmarks = std::array::from_fn(|i| i as u32);
        let edge = jaw_edge(&mean, &landmarks, [&lines[0], &lines[1]], |v| {
            v >= LANDMARKS
        });
        for (i, vertex) in edge.iter().enumerate() {
            let from_top = i.min(JAW - 1 - i);
            match vertex.map(|v| mean[v as usize]) {
                Some([x, y, z]) => {
                    assert!(
                        (y - 10.0 * from_top as f32).abs() <= 2.0 && z == 40.0,
                        "{i}: {y}"
                    );
                    assert_eq!(x < 0.0, i < JAW / 2);
                }
                None => assert!(from_top > 5, "{i}"),
            }
        }
    }
}
