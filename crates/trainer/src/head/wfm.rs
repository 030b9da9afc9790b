//! Candide-3 wireframes (`.wfm`, Ahlberg 2001): the file, and a [`Head`] made of it.

use super::morphable::{Expression, Head};
use anyhow::{Context, Result, ensure};
use posewise::shape::LANDMARKS;
use std::path::Path;

/// A wireframe file. Units of its own: x the subject's left, y up, z out of the face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wfm {
    /// Vertex positions.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles as vertex numbers.
    pub faces: Vec<[u32; 3]>,
    /// Animation units.
    pub animation_units: Vec<Unit>,
    /// Shape units.
    pub shape_units: Vec<Unit>,
}

/// One unit: the vertices that it moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unit {
    /// Name, from the comment before it.
    pub name: String,
    /// Vertex number and displacement at weight 1.
    pub moves: Vec<(u32, [f32; 3])>,
}

/// Millimetres per Candide unit: eye centres 0.608 apart become 63 mm.
const UNIT_MM: f32 = 104.0;
/// Midway between the eyeball centres: 12 mm behind the lids.
const EYES: [f32; 3] = [0.0, 0.148, -0.115];
/// Standard deviation that is taken for every shape unit; the file gives none.
const SHAPE_SIGMA: f32 = 0.25;

/// Lines of numbers, with the comment last seen.
struct Lines<'t> {
    lines: std::str::Lines<'t>,
    comment: &'t str,
}

impl<'t> Lines<'t> {
    /// The next `N` numbers; extra ones on the line are ignored.
    fn numbers<const N: usize>(&mut self) -> Result<[f32; N]> {
        for line in self.lines.by_ref().map(str::trim) {
            if let Some(comment) = line.strip_prefix('#') {
                self.comment = comment.trim();
            } else if !line.is_empty() {
                let values = line.split_whitespace().take(N).map(str::parse);
                let values: Vec<f32> = values
                    .collect::<Result<_, _>>()
                    .with_context(|| format!("not numbers: {line:?}"))?;
                ensure!(values.iter().all(|v| v.is_finite()), "not finite: {line:?}");
                let values = <[f32; N]>::try_from(values);
                return values
                    .ok()
                    .with_context(|| format!("too few numbers: {line:?}"));
            }
        }
        anyhow::bail!("the file ends after {:?}", self.comment)
    }

    fn count(&mut self) -> Result<usize> {
        let [n] = self.numbers()?;
        ensure!(
            (0.0..1e5).contains(&n) && n.fract() == 0.0,
            "{n} is not a count"
        );
        Ok(n as usize)
    }

    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        (0..self.count()?).map(|_| item(self)).collect()
    }

    fn unit(&mut self, vertices: usize) -> Result<Unit> {
        let moves = self.list(|lines| {
            let [v, x, y, z] = lines.numbers()?;
            Ok((index(v, vertices)?, [x, y, z]))
        });
        // The name stands before the count, and no comment stands inside a unit.
        let name = self.comment.to_owned();
        Ok(Unit {
            moves: moves.with_context(|| format!("unit {name:?}"))?,
            name,
        })
    }
}

fn index(value: f32, below: usize) -> Result<u32> {
    ensure!(
        value >= 0.0 && value < below as f32 && value.fract() == 0.0,
        "{value} is not the number of a vertex"
    );
    Ok(value as u32)
}

impl Wfm {
    /// Parses the text of a file.
    pub fn parse(text: &str) -> Result<Wfm> {
        let lines = &mut Lines {
            lines: text.lines(),
            comment: "",
        };
        let vertices = lines.list(Lines::numbers::<3>)?;
        let n = vertices.len();
        let faces = lines.list(|lines| {
            let [a, b, c] = lines.numbers()?;
            Ok([index(a, n)?, index(b, n)?, index(c, n)?])
        })?;
        Ok(Wfm {
            vertices,
            faces,
            animation_units: lines.list(|lines| lines.unit(n))?,
            shape_units: lines.list(|lines| lines.unit(n))?,
        })
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Wfm> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        Wfm::parse(&text).with_context(|| format!("{} is not a wireframe", path.display()))
    }
}

/// The subject's right half of the 68 landmarks and the middle, each halfway (or as weighted)
/// between two Candide vertices; the left half follows by mirroring the vertices.
const RIGHT: [(usize, u32, u32, f32); 39] = [
    (0, 62, 62, 0.0),
    (1, 62, 61, 0.5),
    (2, 61, 61, 0.0),
    (3, 61, 63, 0.5),
    (4, 63, 63, 0.0),
    (5, 63, 65, 0.33),
    (6, 63, 65, 0.67),
    (7, 65, 65, 0.0),
    (8, 10, 10, 0.0),
    (17, 48, 48, 0.0),
    (18, 48, 49, 0.5),
    (19, 49, 51, 0.5),
    (20, 49, 50, 0.5),
    (21, 50, 50, 0.0),
    (27, 4, 94, 0.5),
    (28, 94, 94, 0.0),
    (29, 94, 5, 0.5),
    (30, 5, 5, 0.0),
    (31, 59, 59, 0.0),
    (32, 112, 112, 0.0),
    (33, 6, 6, 0.0),
    (36, 53, 53, 0.0),
    (37, 98, 98, 0.0),
    (38, 106, 106, 0.0),
    (39, 56, 56, 0.0),
    (40, 108, 108, 0.0),
    (41, 100, 100, 0.0),
    (48, 64, 64, 0.0),
    (49, 80, 80, 0.0),
    (50, 66, 66, 0.0),
    (51, 7, 7, 0.0),
    (57, 8, 8, 0.0),
    (58, 86, 8, 0.5),
    (59, 86, 86, 0.0),
    (60, 89, 89, 0.0),
    (61, 82, 82, 0.0),
    (62, 87, 87, 0.0),
    (66, 40, 40, 0.0),
    (67, 84, 84, 0.0),
];

/// Animation units by the ARKit names nearest to them, with a factor; units without a side are
/// split at the middle line where ARKit has two shapes.
const ARKIT: [(&str, &str, f32); 21] = [
    ("browDownLeft", "Brow lowerer", 1.0),
    ("browDownRight", "Brow lowerer", 1.0),
    ("browInnerUp", "Inner brows raiser", 1.0),
    ("browOuterUpLeft", "Outer brow raiser", 1.0),
    ("browOuterUpRight", "Outer brow raiser", 1.0),
    ("eyeBlinkLeft", "Eyes closed", 1.0),
    ("eyeBlinkRight", "Eyes closed", 1.0),
    ("eyeWideLeft", "Upper lid raiser", 1.0),
    ("eyeWideRight", "Upper lid raiser", 1.0),
    ("jawOpen", "Jaw drop", 1.0),
    ("jawLeft", "Jaw x-push", 1.0),
    ("jawRight", "Jaw x-push", -1.0),
    ("mouthPucker", "Lip stretcher", -1.0),
    ("mouthSmileLeft", "Lip corner depressor", -1.0),
    ("mouthSmileRight", "Lip corner depressor", -1.0),
    ("mouthFrownLeft", "Lip corner depressor", 1.0),
    ("mouthFrownRight", "Lip corner depressor", 1.0),
    ("mouthStretchLeft", "Lip stretcher", 1.0),
    ("mouthStretchRight", "Lip stretcher", 1.0),
    ("mouthUpperUpLeft", "Upper lip raiser", 1.0),
    ("mouthUpperUpRight", "Upper lip raiser", 1.0),
];

fn to_mm(v: [f32; 3]) -> [f32; 3] {
    [v[0] * UNIT_MM, -v[1] * UNIT_MM, -v[2] * UNIT_MM]
}

impl Head {
    /// A head made of Candide-3: 113 vertices and, as further vertices without triangles, the 68
    /// landmarks. Good enough for section `FACE`; it has no eyeballs, no neck and no texture.
    pub fn of_wfm(wfm: &Wfm) -> Result<Head> {
        ensure!(
            wfm.vertices.len() == 113,
            "landmarks are known for Candide-3's 113 vertices only"
        );
        let mixes = landmark_mixes(&wfm.vertices)?;
        let extended = |mut values: Vec<[f32; 3]>| {
            for (a, b, t) in &mixes {
                let (a, b) = (values[*a as usize], values[*b as usize]);
                values.push(std::array::from_fn(|k| a[k] + t * (b[k] - a[k])));
            }
            values
        };
        let origin = to_mm(EYES);
        let centred = |v: &[f32; 3]| {
            let v = to_mm(*v);
            [v[0] - origin[0], v[1] - origin[1], v[2] - origin[2]]
        };
        let mean = extended(wfm.vertices.iter().map(centred).collect());
        let moved = |unit: &Unit, factor: &dyn Fn(f32) -> f32| {
            let mut delta = vec![[0.0; 3]; wfm.vertices.len()];
            for (v, d) in &unit.moves {
                let scale = factor(wfm.vertices[*v as usize][0]);
                let d = to_mm(*d);
                (0..3).for_each(|k| delta[*v as usize][k] += scale * d[k]);
            }
            extended(delta)
        };
        let shape_units = wfm.shape_units.iter();
        let identity = shape_units.map(|u| moved(u, &|_| SHAPE_SIGMA)).collect();
        let mut expressions = Vec::new();
        for (name, unit, factor) in ARKIT {
            let mut units = wfm.animation_units.iter();
            let found = units.find(|u| u.name.eq_ignore_ascii_case(unit));
            let unit = found.with_context(|| format!("no animation unit {unit:?}"))?;
            expressions.push(Expression {
                name: name.to_owned(),
                delta: moved(unit, &|x| factor * side_share(name, x)),
            });
        }
        let first = wfm.vertices.len() as u32;
        let landmarks: [u32; LANDMARKS] = std::array::from_fn(|i| first + i as u32);
        let triangles = outward_faces(&mean, &wfm.faces);
        Ok(Head::of_one_part(
            mean,
            triangles,
            landmarks,
            identity,
            expressions,
        ))
    }
}

/// Share of an animation unit at `x` that belongs to the ARKit shape `name`: a shape of one side
/// moves that side alone, and half the middle line.
fn side_share(name: &str, x: f32) -> f32 {
    let side = match name {
        // These two move the whole jaw.
        "jawLeft" | "jawRight" => return 1.0,
        _ if name.ends_with("Left") => 1.0,
        _ if name.ends_with("Right") => -1.0,
        _ => return 1.0,
    };
    match side * x {
        s if s > 1e-3 => 1.0,
        s if s < -1e-3 => 0.0,
        _ => 0.5,
    }
}

/// All 68 landmarks as mixes of two vertices.
fn landmark_mixes(vertices: &[[f32; 3]]) -> Result<Vec<(u32, u32, f32)>> {
    let mirrored = |v: u32| {
        let [x, y, z] = vertices[v as usize];
        // Some vertices have equal positions and only move differently; their order decides.
        let same = |w: &[f32; 3]| (w[0] + x).abs() + (w[1] - y).abs() + (w[2] - z).abs() < 1e-3;
        let twins = |w: &[f32; 3]| (w[0] - x).abs() + (w[1] - y).abs() + (w[2] - z).abs() < 1e-3;
        let rank = vertices[..v as usize].iter().filter(|w| twins(w)).count();
        let found = vertices
            .iter()
            .enumerate()
            .filter(|(_, w)| same(w))
            .nth(rank);
        let found = if x == 0.0 {
            Some(v)
        } else {
            found.map(|(i, _)| i as u32)
        };
        found.with_context(|| format!("vertex {v} has no mirror image"))
    };
    let mut mixes = vec![None; LANDMARKS];
    for (landmark, a, b, t) in RIGHT {
        mixes[landmark] = Some((a, b, t));
        let other = posewise::shape::MIRROR[landmark];
        mixes[other] = Some((mirrored(a)?, mirrored(b)?, t));
    }
    mixes
        .into_iter()
        .map(|m| m.context("a landmark has no vertex"))
        .collect()
}

/// Faces turned so that their normals point away from the middle of the head.
fn outward_faces(mean: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    // Well behind the face and at its mid height, inside any head.
    let middle = glam::Vec3::new(0.0, 30.0, 60.0);
    let turned = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| glam::Vec3::from(mean[v as usize]));
        let outward = (b - a).cross(c - a).dot(a - middle) > 0.0;
        if outward { *f } else { [f[0], f[2], f[1]] }
    };
    faces.iter().map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "# VERTEX LIST:\n3\n0 0 0\n1 0 0\n0 1 0.5\n\n# FACE LIST:\n1\n0 1 2\n\n\
        # ANIMATION UNITS LIST:\n1\n\n# Jaw drop\n2\n1 0 -0.1 0\n2 0 -0.2 0.3\n\n\
        # SHAPE UNITS LIST:\n1\n\n# Head height\n1\n0 0 1 0\n\n# TEXTURE:\n0 0\n";

    #[test]
    fn reads_a_small_file() {
        let wfm = Wfm::parse(SMALL).unwrap();
        assert_eq!((wfm.vertices.len(), &wfm.faces[..]), (3, &[[0, 1, 2]][..]));
        assert_eq!(wfm.animation_units[0].name, "Jaw drop");
        assert_eq!(wfm.animation_units[0].moves[1], (2, [0.0, -0.2, 0.3]));
        assert_eq!(wfm.shape_units[0].name, "Head height");
    }

    #[test]
    fn refuses_bad_files() {
        for (good, bad) in [("0 1 2", "0 1 3"), ("1 0 0", "1 x 0"), ("\n3\n", "\n-3\n")] {
            assert!(Wfm::parse(&SMALL.replacen(good, bad, 1)).is_err(), "{bad}");
        }
        assert!(Wfm::parse(&SMALL[..60]).is_err(), "truncated");
        assert!(
            Head::of_wfm(&Wfm::parse(SMALL).unwrap()).is_err(),
            "not Candide-3"
        );
    }
}
