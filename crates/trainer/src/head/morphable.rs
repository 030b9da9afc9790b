//! The morphable head: read from the face kit, and moved by identity and expression.

use anyhow::{Context, Result, ensure};
use posewise::shape::{FITTED, FITTED_NAMES, JAW, LANDMARKS};
use std::path::Path;

use super::contour::{contour_paths, jaw_edge, normals};
use super::npz::Npz;

/// A morphable head: `mean + Σ identity_k·w_k + Σ expression_j·a_j`.
#[derive(Clone, Debug)]
pub struct Head {
    /// Neutral mean vertices \[mm\].
    pub mean: Vec<[f32; 3]>,
    /// Vertex numbers, counter-clockwise seen from outside: (b − a) × (c − a) points outwards.
    /// (The change of axes is a rotation, so the kit's winding is kept.)
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates, v up; UDIM-like: u in 0..1 is the face and the eyes (see FACEKIT.md).
    pub uv: Vec<[f32; 2]>,
    /// Numbers into `uv` for each corner of `triangles`.
    pub triangle_uv: Vec<[u32; 3]>,
    /// Identity modes, each a displacement of every vertex per standard deviation \[mm\].
    pub identity: Vec<Vec<[f32; 3]>>,
    /// Expressions by ARKit name (`eyeBlinkLeft`), displacement at weight 1 \[mm\].
    pub expressions: Vec<Expression>,
    /// Vertex of each iBUG landmark.
    pub landmarks: [u32; LANDMARKS],
    /// Per jaw landmark 0–16: the landmark itself, what lies behind or below it, and vertices
    /// marching inwards over the cheek. Whichever is outermost in the image is on the visible
    /// contour.
    pub jaw: [Vec<u32>; JAW],
    /// Per jaw landmark 0–16 the vertex on the lower jaw's edge, from below one ear to the other;
    /// none at the chin, which lies on it.
    pub jaw_edge: [Option<u32>; JAW],
    /// Number into `part_names` for each vertex.
    pub vertex_part: Vec<u8>,
    /// Number into `part_names` for each triangle.
    pub triangle_part: Vec<u8>,
    /// `face`, `head_neck`, `sclera_L` …
    pub part_names: Vec<String>,
    /// Index into `expressions` of each animation mode; `None` where the head has no such mode.
    pub animation: [Option<usize>; FITTED],
}

/// One expression of a head.
#[derive(Clone, Debug)]
pub struct Expression {
    /// ARKit's name, or the kit's own for those that ARKit lacks.
    pub name: String,
    /// Displacement of every vertex at weight 1 \[mm\].
    pub delta: Vec<[f32; 3]>,
}

/// Kit axes (x subject's left, y up, z out of the face; cm) → ours.
fn to_head_axes(v: &[f32]) -> [f32; 3] {
    [10.0 * v[0], -10.0 * v[1], -10.0 * v[2]]
}

fn triples(values: &[f32]) -> Vec<[f32; 3]> {
    values.chunks_exact(3).map(to_head_axes).collect()
}

/// The kit's `eyeBlink_L` → ARKit's `eyeBlinkLeft`.
fn arkit_name(kit: &str) -> String {
    match (kit.strip_suffix("_L"), kit.strip_suffix("_R")) {
        // ARKit has one shape for both sides of these.
        (Some(stem), _) | (_, Some(stem)) if matches!(stem, "browInnerUp" | "cheekPuff") => {
            stem.to_owned()
        }
        (Some(stem), _) => format!("{stem}Left"),
        (_, Some(stem)) => format!("{stem}Right"),
        _ => kit.to_owned(),
    }
}

fn modes(npz: &mut Npz, name: &str, vertices: usize) -> Result<Vec<Vec<[f32; 3]>>> {
    let array = npz.array(name)?;
    ensure!(
        array.shape.len() == 3 && array.shape[1..] == [vertices, 3],
        "{name} has the wrong shape"
    );
    let values = array.floats()?;
    Ok(values.chunks_exact(3 * vertices).map(triples).collect())
}

fn corners(indices: Vec<u32>, below: usize) -> Result<Vec<[u32; 3]>> {
    ensure!(
        indices.iter().all(|i| (*i as usize) < below),
        "a triangle corner is out of range"
    );
    Ok(indices
        .chunks_exact(3)
        .map(|c| [c[0], c[1], c[2]])
        .collect())
}

fn bytes(values: Vec<u32>) -> Result<Vec<u8>> {
    values.into_iter().map(|v| Ok(u8::try_from(v)?)).collect()
}

fn part_mean(vertices: &[[f32; 3]], part: &[u8], wanted: u8) -> [f32; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (v, _) in vertices.iter().zip(part).filter(|(_, p)| **p == wanted) {
        (0..3).for_each(|k| sum[k] += v[k]);
        count += 1.0;
    }
    sum.map(|s| s / count)
}

/// Kit expressions under ARKit's names; the halves of one-piece ARKit shapes are summed.
fn expressions(names: &[String], deltas: Vec<Vec<[f32; 3]>>) -> Result<Vec<Expression>> {
    ensure!(
        names.len() == deltas.len(),
        "ex_names and ex_delta differ in length"
    );
    let mut all: Vec<Expression> = Vec::new();
    for (kit, delta) in names.iter().zip(deltas) {
        let name = arkit_name(kit);
        match all.iter_mut().find(|e| e.name == name) {
            Some(half) => add_scaled(&mut half.delta, &delta, 1.0),
            None => all.push(Expression { name, delta }),
        }
    }
    Ok(all)
}

fn animation_index(expressions: &[Expression]) -> [Option<usize>; FITTED] {
    FITTED_NAMES.map(|name| expressions.iter().position(|e| e.name == name))
}

fn add_scaled(sum: &mut [[f32; 3]], delta: &[[f32; 3]], weight: f32) {
    for (s, d) in sum.iter_mut().zip(delta) {
        (0..3).for_each(|k| s[k] += weight * d[k]);
    }
}

/// Vertices along the lower jaw's edge on both sides, the uppermost first.
fn jaw_lines(
    npz: &mut Npz,
    mean: &[[f32; 3]],
    landmarks: &[u32; LANDMARKS],
) -> Result<[Vec<u32>; 2]> {
    let right = npz.array("jaw_right_ext")?.indices()?;
    // The kit's left line runs up from the chin.
    let mut left = npz.array("jaw_left_ext")?.indices()?;
    left.reverse();
    ensure!(
        right
            .iter()
            .chain(&left)
            .all(|v| (*v as usize) < mean.len()),
        "the jaw's edge is out of range"
    );
    let below = |v: &u32, i: usize| mean[*v as usize][1] > mean[landmarks[i] as usize][1];
    ensure!(
        right.iter().any(|v| below(v, 0)) && left.iter().any(|v| below(v, JAW - 1)),
        "the jaw's edge ends above its landmarks"
    );
    Ok([right, left])
}

impl Head {
    /// Reads `facekit.npz` (the ICT Face Model Light, see FACEKIT.md beside it).
    ///
    /// The origin moves midway between the eyeballs, each taken as the mean of its sclera shell's
    /// vertices. Identity modes are shifted likewise, so the origin is there for everybody.
    pub fn load(path: &Path) -> Result<Head> {
        let npz = &mut Npz::open(path)?;
        let mut mean = triples(&npz.array("mean")?.floats()?);
        let n = mean.len();
        let vertex_part = bytes(npz.array("vpart")?.indices()?)?;
        let part_names = npz.array("part_names")?.strings()?;
        ensure!(vertex_part.len() == n, "vpart and mean differ in length");
        let part = |name: &str| {
            let found = part_names.iter().position(|p| p == name);
            found
                .map(|p| p as u8)
                .with_context(|| format!("no part {name}"))
        };
        let eyes = [part("sclera_L")?, part("sclera_R")?];
        let face = part("face")?;
        let to_eyes = |vertices: &mut [[f32; 3]]| {
            let [left, right] = eyes.map(|eye| part_mean(vertices, &vertex_part, eye));
            for v in vertices {
                (0..3).for_each(|k| v[k] -= (left[k] + right[k]) / 2.0);
            }
        };
        to_eyes(&mut mean);
        let mut identity = modes(npz, "id_delta", n)?;
        identity.iter_mut().for_each(|mode| to_eyes(mode));
        let landmarks = npz.array("lm68")?.indices()?;
        ensure!(
            landmarks.iter().all(|v| (*v as usize) < n),
            "lm68 is out of range"
        );
        let landmarks: [u32; LANDMARKS] =
            landmarks.try_into().ok().context("lm68 is not 68 long")?;
        let triangles = corners(npz.array("tri")?.indices()?, n)?;
        let uv = npz.array("uv")?.floats()?;
        let uv: Vec<[f32; 2]> = uv.chunks_exact(2).map(|c| [c[0], c[1]]).collect();
        let names = npz.array("ex_names")?.strings()?;
        let expressions = expressions(&names, modes(npz, "ex_delta", n)?)?;
        let skin = |v: usize| vertex_part[v] == face;
        let [right, left] = jaw_lines(npz, &mean, &landmarks)?;
        let jaw_edge = jaw_edge(&mean, &landmarks, [&right, &left], skin);
        Ok(Head {
            jaw: contour_paths(&mean, &triangles, &landmarks, &jaw_edge, skin),
            jaw_edge,
            triangle_uv: corners(npz.array("tri_uv")?.indices()?, uv.len())?,
            triangle_part: bytes(npz.array("tpart")?.indices()?)?,
            animation: animation_index(&expressions),
            mean,
            triangles,
            uv,
            identity,
            expressions,
            landmarks,
            vertex_part,
            part_names,
        })
    }

    /// A head that is all face, without a texture; the edge of its jaw is not known.
    pub fn of_one_part(
        mean: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        landmarks: [u32; LANDMARKS],
        identity: Vec<Vec<[f32; 3]>>,
        expressions: Vec<Expression>,
    ) -> Self {
        let jaw_edge = [None; JAW];
        Head {
            jaw: contour_paths(&mean, &triangles, &landmarks, &jaw_edge, |_| true),
            jaw_edge,
            uv: vec![[0.0; 2]],
            triangle_uv: vec![[0; 3]; triangles.len()],
            animation: animation_index(&expressions),
            vertex_part: vec![0; mean.len()],
            triangle_part: vec![0; triangles.len()],
            part_names: vec!["face".to_owned()],
            mean,
            triangles,
            identity,
            expressions,
            landmarks,
        }
    }

    /// All vertices \[mm\] of a person (leading identity weights in standard deviations) with an
    /// expression (weights of `posewise::shape::FITTED_NAMES`).
    pub fn vertices(&self, identity: &[f32], animation: &[f32; FITTED]) -> Vec<[f32; 3]> {
        let mut out = self.mean.clone();
        for (mode, w) in self.identity.iter().zip(identity) {
            add_scaled(&mut out, mode, *w);
        }
        for (mode, w) in self.animation.iter().zip(animation) {
            if let (Some(mode), true) = (mode, *w != 0.0) {
                add_scaled(&mut out, &self.expressions[*mode].delta, *w);
            }
        }
        out
    }

    /// Unit outward normals of these vertices, area-weighted over the triangles.
    pub fn normals(&self, vertices: &[[f32; 3]]) -> Vec<[f32; 3]> {
        normals(vertices, &self.triangles)
    }

    /// Number of a part in `vertex_part` and `triangle_part`.
    pub fn part(&self, name: &str) -> Option<u8> {
        self.part_names
            .iter()
            .position(|p| p == name)
            .map(|p| p as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arkit_names() {
        assert_eq!(arkit_name("eyeBlink_L"), "eyeBlinkLeft");
        assert_eq!(arkit_name("browInnerUp_R"), "browInnerUp");
        assert_eq!(arkit_name("jawOpen"), "jawOpen");
    }
}
