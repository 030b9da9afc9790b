//! MakeHuman's heads: read from their folder, and mixed to new people. Its README says what each
//! array is; axes are those of the head frame.

use super::npz::Npz;
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Vec2, Vec3};
use posewise::shape::{JAW, LANDMARKS};
use serde::Deserialize;
use std::path::Path;

/// A point of the skin: vertices and weights.
pub type Mix = Vec<(u32, f32)>;

/// Displacements of some vertices \[mm\].
pub type Moves = Vec<(u32, Vec3)>;

/// A parameter of the shape.
pub struct Detail {
    /// Its group and name.
    pub name: String,
    /// Sensible lowest and highest value.
    pub range: [f32; 2],
    /// What it moves at −1 and at 1.
    pub sides: [Moves; 2],
}

/// Everything that heads are mixed from.
pub struct MakeHuman {
    /// The base head \[mm\].
    pub base: Vec<Vec3>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners, v down.
    pub corner_uv: Vec<[Vec2; 3]>,
    /// Number into `part_names` for each triangle.
    pub triangle_part: Vec<u8>,
    /// `skin`, `eye_l`, `teeth` …
    pub part_names: Vec<String>,
    /// Vertices whose mean is the middle of the image left's and the image right's eyeball.
    pub eye_centres: [Vec<u32>; 2],
    /// Vertices of these eyeballs.
    pub eyes: [Vec<u32>; 2],
    /// Whole heads by ethnicity, sex and age, as the way from the base.
    pub macros: Vec<(String, Vec<Vec3>)>,
    /// Thin, heavy, weak and strong ones of each sex and age, as the way from the mean.
    pub bodies: Vec<(String, Vec<Vec3>)>,
    /// Parameters of the shape.
    pub details: Vec<Detail>,
    /// Facial units and what they move at 1.
    pub units: Vec<(String, Moves)>,
    /// The landmarks.
    pub landmarks: [Mix; LANDMARKS],
    /// Lines from the cheek back to the lower jaw's edge.
    pub jaw_lines: [Vec<Mix>; JAW],
}

#[derive(Deserialize)]
struct Landmarks {
    points: Vec<Point>,
    jaw_lines: Vec<Line>,
}

#[derive(Deserialize)]
struct Point {
    vertices: Vec<u32>,
    weights: Vec<f32>,
}

#[derive(Deserialize)]
struct Line {
    points: Vec<Point>,
}

impl Point {
    fn mix(self) -> Mix {
        self.vertices.into_iter().zip(self.weights).collect()
    }
}

fn points(values: &[f32]) -> Vec<Vec3> {
    values.chunks_exact(3).map(Vec3::from_slice).collect()
}

fn corners(indices: &[u32]) -> Vec<[u32; 3]> {
    let triples = indices.chunks_exact(3);
    triples.map(|c| [c[0], c[1], c[2]]).collect()
}

/// Names and displacements of all vertices.
fn whole(npz: &mut Npz, name: &str, vertices: usize) -> Result<Vec<(String, Vec<Vec3>)>> {
    let names = npz.array(&format!("{name}_names"))?.strings()?;
    let array = npz.array(name)?;
    ensure!(array.shape == [names.len(), vertices, 3], "{name}'s shape");
    let values = array.floats()?;
    let heads = values.chunks_exact(3 * vertices).map(points);
    Ok(names.into_iter().zip(heads).collect())
}

/// Sparse columns.
fn columns(npz: &mut Npz, name: &str, vertices: usize) -> Result<Vec<Moves>> {
    let ends = npz.array(&format!("{name}_ptr"))?.indices()?;
    let index = npz.array(&format!("{name}_index"))?.indices()?;
    let value = points(&npz.array(&format!("{name}_value"))?.floats()?);
    ensure!(
        index.len() == value.len() && index.iter().all(|v| (*v as usize) < vertices),
        "{name}'s vertices"
    );
    let column = |w: &[u32]| {
        let range = w[0] as usize..w[1] as usize;
        let index = index.get(range.clone()).context("a column")?;
        Ok(index.iter().copied().zip(value[range].to_vec()).collect())
    };
    ends.windows(2).map(column).collect()
}

/// A fixed number of items.
fn exactly<T, const N: usize>(items: Vec<T>, what: &str) -> Result<[T; N]> {
    let count = items.len();
    let items = items.try_into().ok();
    items.with_context(|| format!("{count} {what}, not {N}"))
}

impl MakeHuman {
    /// Reads the folder.
    pub fn load(folder: &Path) -> Result<MakeHuman> {
        let head = &mut Npz::open(&folder.join("head.npz"))?;
        let base = points(&head.array("vertices")?.floats()?);
        let n = base.len();
        let triangles = corners(&head.array("triangles")?.indices()?);
        let uv = head.array("uv")?.floats()?;
        let uv: Vec<Vec2> = uv.chunks_exact(2).map(Vec2::from_slice).collect();
        let triangle_uv = corners(&head.array("tri_uv")?.indices()?);
        let below = |triangles: &[[u32; 3]], n: usize| {
            triangles.iter().flatten().all(|v| (*v as usize) < n)
        };
        ensure!(
            below(&triangles, n) && below(&triangle_uv, uv.len()),
            "a triangle's corner"
        );
        let mut list = |name: &str| head.array(name)?.indices();
        let eye_centres = [list("eye_r_centre")?, list("eye_l_centre")?];
        let eyes = [list("eye_r_vertices")?, list("eye_l_vertices")?];
        let triangle_part = list("tri_part")?.iter().map(|p| *p as u8).collect();
        let part_names = head.array("part_names")?.strings()?;
        let shapes = &mut Npz::open(&folder.join("shapes.npz"))?;
        let path = folder.join("landmarks.json");
        let text = std::fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
        let Landmarks { points, jaw_lines } = serde_json::from_slice(&text)?;
        let points = points.into_iter().map(Point::mix).collect();
        let line = |line: Line| line.points.into_iter().map(Point::mix).collect();
        Ok(MakeHuman {
            corner_uv: triangle_uv
                .iter()
                .map(|t| t.map(|i| uv[i as usize]))
                .collect(),
            base,
            triangles,
            triangle_part,
            part_names,
            eye_centres,
            eyes,
            macros: whole(shapes, "macro", n)?,
            bodies: whole(shapes, "body", n)?,
            details: details(shapes, n)?,
            units: units(shapes, n)?,
            landmarks: exactly(points, "landmarks")?,
            jaw_lines: exactly(jaw_lines.into_iter().map(line).collect(), "jaw lines")?,
        })
    }

    /// Turns and scales everything about the origin.
    pub fn turn(&mut self, turn: Mat3) {
        let place = |v: &mut Vec3| *v = turn * *v;
        self.base.iter_mut().for_each(place);
        let heads = self.macros.iter_mut().chain(&mut self.bodies);
        heads.flat_map(|(_, head)| head).for_each(place);
        let details = self.details.iter_mut().flat_map(|d| &mut d.sides);
        let units = self.units.iter_mut().map(|(_, moves)| moves);
        let moves = details.chain(units).flatten();
        moves.for_each(|(_, d)| place(d));
    }

    /// Number of a part.
    pub fn part(&self, name: &str) -> Option<u8> {
        let at = self.part_names.iter().position(|p| p == name);
        at.map(|at| at as u8)
    }

    /// What a unit moves at 1.
    pub fn unit(&self, name: &str) -> Option<&Moves> {
        let found = self.units.iter().find(|(n, _)| n == name);
        found.map(|(_, moves)| moves)
    }

    /// A neutral head of places in `macros` and weights that sum to 1, places in `bodies` and
    /// weights, and values of all details; the origin is midway between the eyeballs.
    pub fn mixed(
        &self,
        macros: &[(usize, f32)],
        bodies: &[(usize, f32)],
        details: &[f32],
    ) -> Vec<Vec3> {
        let mut head = self.base.clone();
        let macros = macros.iter().map(|(at, w)| (&self.macros[*at].1, w));
        let bodies = bodies.iter().map(|(at, w)| (&self.bodies[*at].1, w));
        for (shape, w) in macros.chain(bodies) {
            head.iter_mut().zip(shape).for_each(|(v, d)| *v += *w * *d);
        }
        for (detail, value) in self.details.iter().zip(details) {
            let moves = &detail.sides[usize::from(*value > 0.0)];
            for (v, d) in moves {
                head[*v as usize] += value.abs() * *d;
            }
        }
        let [right, left] = self.eye_middles(&head);
        let middle = (right + left) / 2.0;
        head.iter_mut().for_each(|v| *v -= middle);
        head
    }

    /// Middles of the image left's and the image right's eyeball.
    pub fn eye_middles(&self, head: &[Vec3]) -> [Vec3; 2] {
        [0, 1].map(|k| {
            let centre = &self.eye_centres[k];
            let sum: Vec3 = centre.iter().map(|v| head[*v as usize]).sum();
            sum / centre.len() as f32
        })
    }
}

/// A weighted mean of vertices.
pub fn mix(points: &[Vec3], mix: &Mix) -> Vec3 {
    mix.iter().map(|(v, w)| points[*v as usize] * *w).sum()
}

fn details(npz: &mut Npz, vertices: usize) -> Result<Vec<Detail>> {
    let names = npz.array("detail_names")?.strings()?;
    let ranges = npz.array("detail_range")?.floats()?;
    let mut columns = columns(npz, "detail", vertices)?.into_iter();
    ensure!(
        columns.len() == 2 * names.len() && ranges.len() == 2 * names.len(),
        "the details' arrays"
    );
    let names = names.into_iter().zip(ranges.chunks_exact(2));
    Ok(names
        .map(|(name, range)| Detail {
            name,
            range: [range[0], range[1]],
            sides: [0, 1].map(|_| columns.next().unwrap_or_default()),
        })
        .collect())
}

fn units(npz: &mut Npz, vertices: usize) -> Result<Vec<(String, Moves)>> {
    let names = npz.array("unit_names")?.strings()?;
    let columns = columns(npz, "unit", vertices)?;
    ensure!(columns.len() == names.len(), "the units' arrays");
    Ok(names.into_iter().zip(columns).collect())
}
