//! Meshes that hang on a head: hair, brows, lashes.

use crate::head::npz::Npz;
use crate::render::background::linear;
use crate::render::draw::Prop;
use crate::render::mesh::Mesh;
use crate::render::strands::{Sheet, Strands};
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

/// Light that reaches hair where nothing reaches the skin below.
const LEAST_OPEN: f32 = 0.3;

/// A vertex as a mean of three of the head's, and an offset.
struct Bound {
    to: [u32; 3],
    weights: Vec3,
    offset_mm: Vec3,
}

/// One mesh.
pub struct Proxy {
    /// Its file's name.
    pub name: String,
    vertices: Vec<Bound>,
    /// For each axis two vertices of the head, and their distance on the base head \[mm\].
    scale: [([u32; 2], f32); 3],
    triangles: Vec<[u32; 3]>,
    strands: Strands,
}

impl Proxy {
    /// Reads a picture and the arrays beside it.
    pub fn load(picture: &Path, mesh: &Mesh) -> Result<Proxy> {
        let npz = &mut Npz::open(&picture.with_extension("npz"))?;
        let index = npz.array("bind_index")?.indices()?;
        let weight = npz.array("bind_weight")?.floats()?;
        let offset = npz.array("bind_offset")?.floats()?;
        let reference = npz.array("scale_index")?.indices()?;
        let length = npz.array("scale_length")?.floats()?;
        let below = |v: &u32| (*v as usize) < mesh.mean.len();
        ensure!(
            index.iter().chain(&reference).all(below),
            "what it hangs on"
        );
        ensure!(
            index.len() == weight.len() && index.len() == offset.len(),
            "the vertices' arrays"
        );
        ensure!(reference.len() == 6 && length.len() == 3, "the scale");
        let three = |v: &[u32]| [v[0], v[1], v[2]];
        let vertices: Vec<Bound> = (index.chunks_exact(3).map(three))
            .zip(weight.chunks_exact(3).map(Vec3::from_slice))
            .zip(offset.chunks_exact(3).map(Vec3::from_slice))
            .map(|((to, weights), offset_mm)| Bound {
                to,
                weights,
                offset_mm,
            })
            .collect();
        let triangles = npz.array("triangles")?.indices()?;
        let uv = npz.array("uv")?.floats()?;
        let uv: Vec<Vec2> = uv.chunks_exact(2).map(Vec2::from_slice).collect();
        let triangle_uv = npz.array("tri_uv")?.indices()?;
        let inside = triangles.iter().all(|v| (*v as usize) < vertices.len())
            && triangle_uv.iter().all(|v| (*v as usize) < uv.len());
        ensure!(inside, "a triangle's corner");
        let corner_uv = triangle_uv.chunks_exact(3).map(three);
        let open = vertices.iter().map(|bound| {
            let open = bound.to.map(|v| mesh.open[v as usize]);
            LEAST_OPEN + (1.0 - LEAST_OPEN) * open.into_iter().fold(0.0, f32::max)
        });
        Ok(Proxy {
            name: (picture.file_stem().context("a name")?)
                .to_string_lossy()
                .into_owned(),
            scale: [0, 1, 2].map(|k| ([reference[2 * k], reference[2 * k + 1]], length[k])),
            strands: Strands {
                sheet: Arc::new(sheet(picture)?),
                uv: Arc::new(corner_uv.map(|t| t.map(|i| uv[i as usize])).collect()),
                dense: 1.0,
                open: open.collect(),
                nearer_mm: 0.0,
            },
            triangles: triangles.chunks_exact(3).map(three).collect(),
            vertices,
        })
    }

    /// The mesh on a head that was turned from MakeHuman's axes (head axes).
    pub fn prop(&self, head: &[Vec3], turn: Mat3, tone: f32, dense: f32, gloss: f32) -> Prop {
        let back = turn.inverse();
        let scale = self.scale.map(|([a, b], length)| {
            let apart = back * (head[a as usize] - head[b as usize]);
            apart.abs() / length
        });
        let scale = Vec3::new(scale[0].x, scale[1].y, scale[2].z);
        let place = |bound: &Bound| {
            let [a, b, c] = bound.to.map(|v| head[v as usize]);
            let w = bound.weights;
            a * w.x + b * w.y + c * w.z + turn * (bound.offset_mm * scale)
        };
        Prop {
            vertices: self.vertices.iter().map(place).collect(),
            triangles: self.triangles.clone(),
            albedo: vec![tone; self.vertices.len()],
            strands: Some(Strands {
                dense,
                ..self.strands.clone()
            }),
            ..Prop::opaque(gloss)
        }
    }
}

/// A picture's brightness and opacity.
fn sheet(path: &Path) -> Result<Sheet> {
    let picture = image::open(path).with_context(|| path.display().to_string())?;
    let picture = picture.to_rgba8();
    let value = |p: &image::Rgba<u8>| {
        let [r, g, b, a] = p.0;
        let light = 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
        // Black strands keep their shape, too.
        [light + 0.004, a as f32 / 255.0]
    };
    let size = [picture.width() as usize, picture.height() as usize];
    Ok(Sheet::new(size, picture.pixels().map(value).collect()))
}
