//! The dense mesh of a face (section `MESH`): vertices of the morphable head with its identity and
//! animation modes, its triangles, and what draws vertices towards landmarks.
//!
//! The first 68 vertices are those of the landmarks. Of the jaw these are fixed points of the head,
//! as `points_mm` of a result.

use super::{ANIMATIONS, Identity, LANDMARKS, MAX_IDENTITIES, Pose};
use glam::Vec3;
use posewise_format::{Blob, ModelError, Section, Tag};

/// Name of the section.
pub const MESH_TAG: Tag = *b"MESH";

/// Capacity: vertices of a mesh.
pub const MAX_VERTICES: usize = 800;
/// Capacity: triangles of a mesh.
const MAX_TRIANGLES: usize = 2 * MAX_VERTICES;
/// Capacity: indices of all loops and lines together.
const MAX_LISTED: usize = 1024;

/// Vertices whose modes stand together: a mode has one run of bytes of those that it moves, and
/// none of others.
pub const MESH_BLOCK: usize = 8;
/// Coordinates of these.
const BLOCK_NUMBERS: usize = 3 * MESH_BLOCK;

/// Capacity: runs of all modes together.
const MAX_RUNS: usize = MAX_VERTICES.div_ceil(MESH_BLOCK) * 8 * bytes_of(MAX_IDENTITIES);

/// Bytes with a bit for each mode.
const fn bytes_of(identities: usize) -> usize {
    (identities + ANIMATIONS).div_ceil(8)
}

/// Landmarks that draw a vertex.
pub const MESH_PULLS: usize = 6;
/// A pull of this many goes the landmark's whole way.
pub const WHOLE_PULL: i8 = 64;

/// Vertices around a vertex, by which its normal is found.
pub const MESH_RING: usize = 4;

/// One vertex of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct MeshVertex {
    /// To the right \[mm\], or in the picture \[px\].
    pub x: f32,
    /// Downwards, likewise.
    pub y: f32,
    /// Away from the camera, or of the face \[mm\].
    pub z: f32,
    /// By the direction of the surface, 0..1: 0 where it turns away from the camera, 1 where it is
    /// seen at 12° or more, half way at its edge. What covers it does not count.
    pub visibility: f32,
}

impl MeshVertex {
    pub(crate) fn position(&self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }

    pub(crate) fn set_position(&mut self, position: Vec3) {
        [self.x, self.y, self.z] = position.to_array();
    }
}

/// A loop or a line of a mesh. Of a loop the last vertex is joined to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MeshLine {
    /// The landmarks, which are no line: in the order of the 68.
    Landmarks,
    /// The outer edge of the lips, from the corner at the image's left along the upper lip.
    OuterLips,
    /// The inner edge of the lips, likewise.
    InnerLips,
    /// The lids of the person's left eye, from the inner corner along the upper lid.
    LeftEye,
    /// The lids of the person's right eye, from the outer corner along the upper lid.
    RightEye,
    /// The person's left brow, a line from the nose outwards.
    LeftBrow,
    /// The person's right brow, a line towards the nose.
    RightBrow,
    /// The edge of the mesh.
    Edge,
}

impl MeshLine {
    /// Every one, in the order of the section and of the C ABI.
    pub const ALL: [MeshLine; 8] = [
        MeshLine::Landmarks,
        MeshLine::OuterLips,
        MeshLine::InnerLips,
        MeshLine::LeftEye,
        MeshLine::RightEye,
        MeshLine::LeftBrow,
        MeshLine::RightBrow,
        MeshLine::Edge,
    ];
}

/// What of a mesh is the same for every face: how its vertices are joined, and where they lie in a
/// texture.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct MeshTopology<'m> {
    /// Number of vertices.
    pub vertices: usize,
    /// Three vertices each, counter-clockwise seen from outside with y upwards.
    pub triangles: &'m [[u16; 3]],
    /// By vertex: u to the right and v upwards in a picture of the face, 0..1.
    pub uvs: &'m [[f32; 2]],
    lengths: &'m [u16],
    listed: &'m [u16],
}

impl<'m> MeshTopology<'m> {
    /// The vertices of all lines of [`MeshLine::ALL`], one after the other, and how many each has.
    pub fn lines(&self) -> (&'m [u16], &'m [u16]) {
        (self.listed, self.lengths)
    }

    /// The vertices of a loop or a line.
    pub fn line(&self, line: MeshLine) -> &'m [u16] {
        let place = line as usize;
        let before = self.lengths.iter().take(place);
        let start: usize = before.map(|length| usize::from(*length)).sum();
        let length = self.lengths.get(place).copied().unwrap_or_default();
        let end = start + usize::from(length);
        self.listed.get(start..end).unwrap_or_default()
    }
}

/// A checked view of section `MESH`; empty where the model lacks it.
///
/// Content, in this order: `vertices, identities, triangles, listed, runs: u32`;
/// `mean: f32[vertices·3]` \[mm\]; `identity_scale: f32[identities]`; `animation_scale: f32[29]`;
/// `moved: u8[blocks][(identities + 29) / 8]`, rounded up: whether each mode moves a block of 8
/// vertices, least significant bit first, the last block filled up; `modes: i8[runs][24]`, block by
/// block, of the modes that move it;
/// `pulled_by: u8[vertices·6]`; `pulls: i8[vertices·6]`; `rings: u16[vertices·4]`;
/// `triangles: u16[triangles·3]`; `uvs: f32[vertices·2]`; `lengths: u16[8]` of the lines of
/// [`MeshLine::ALL`]; `listed: u16[listed]`, the lines one after the other.
///
/// The section is parsed again for each mesh, which takes two microseconds: its slices would make a
/// model larger.
#[derive(Clone, Debug, Default)]
pub struct MeshModel<'m> {
    content: Option<Section<'m>>,
}

impl<'m> MeshModel<'m> {
    /// Reads and checks the section.
    ///
    /// # Errors
    /// [`ModelError::Section`] when it is too short or a number is out of range.
    #[inline(never)]
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        let section = match blob.section(&MESH_TAG) {
            Err(ModelError::Missing(_)) => return Ok(MeshModel::default()),
            other => other?,
        };
        let is_whole = Mesh::read(&mut section.clone()).is_some_and(|mesh| mesh.is_consistent());
        section.require(is_whole, "it is too short, or a number is out of range")?;
        let content = Some(section);
        Ok(MeshModel { content })
    }

    /// The mesh, if the model has one.
    pub fn mesh(&self) -> Option<Mesh<'m>> {
        // Reading cannot fail: `open` checked the section.
        Mesh::read(&mut self.content.clone()?)
    }
}

/// The slices of a section.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'m> {
    /// What is the same for every face.
    pub topology: MeshTopology<'m>,
    mean: &'m [[f32; 3]],
    identity_scale: &'m [f32],
    animation_scale: &'m [f32],
    /// By block which modes move it, a bit each.
    moved: &'m [u8],
    /// Of each block those.
    modes: &'m [[i8; BLOCK_NUMBERS]],
    pulled_by: &'m [[u8; MESH_PULLS]],
    pulls: &'m [[i8; MESH_PULLS]],
    rings: &'m [[u16; MESH_RING]],
}

impl<'m> Mesh<'m> {
    /// `None` where it is too short or a number is out of range. Not the first error, which would
    /// take more code than the rest.
    fn read(s: &mut Section<'m>) -> Option<Self> {
        let mut count = || Some(s.u32().ok()? as usize);
        let (vertices, identities, triangles, listed) = (count()?, count()?, count()?, count()?);
        let runs = count()?;
        let is_valid = (LANDMARKS..=MAX_VERTICES).contains(&vertices)
            && identities <= MAX_IDENTITIES
            && triangles <= MAX_TRIANGLES
            && listed <= MAX_LISTED
            && runs <= MAX_RUNS;
        if !is_valid {
            return None;
        }
        // Whatever they are, up to what every float of a model may be, products of them are finite.
        let mean = s.f32s(3 * vertices).ok()?;
        let identity_scale = s.f32s(identities).ok()?;
        let animation_scale = s.f32s(ANIMATIONS).ok()?;
        let blocks = vertices.div_ceil(MESH_BLOCK);
        let moved = s.u8s(blocks * bytes_of(identities)).ok()?;
        let modes = s.i8s(runs * BLOCK_NUMBERS).ok()?;
        let pulled_by = s.u8s(MESH_PULLS * vertices).ok()?;
        let pulls = s.i8s(MESH_PULLS * vertices).ok()?;
        let rings = s.u16s(MESH_RING * vertices).ok()?;
        let triangles = s.u16s(3 * triangles).ok()?;
        let uvs = s.f32s(2 * vertices).ok()?;
        let topology = MeshTopology {
            vertices,
            triangles: triangles.as_chunks().0,
            uvs: uvs.as_chunks().0,
            lengths: s.u16s(MeshLine::ALL.len()).ok()?,
            listed: s.u16s(listed).ok()?,
        };
        Some(Mesh {
            topology,
            mean: mean.as_chunks().0,
            identity_scale,
            animation_scale,
            moved,
            modes: modes.as_chunks().0,
            pulled_by: pulled_by.as_chunks().0,
            pulls: pulls.as_chunks().0,
            rings: rings.as_chunks().0,
        })
    }

    /// Whether every index is that of a vertex or a landmark, the landmarks come first, texture
    /// coordinates are in 0..1, and there is a run for each block that a mode moves.
    fn is_consistent(&self) -> bool {
        let MeshTopology {
            vertices,
            triangles,
            uvs,
            lengths,
            listed,
        } = self.topology;
        let is_vertex = |index: &u16| usize::from(*index) < vertices;
        let is_landmark = |index: &u8| usize::from(*index) < LANDMARKS;
        let total: usize = lengths.iter().map(|length| usize::from(*length)).sum();
        let landmarks = self.topology.line(MeshLine::Landmarks);
        let come_first = landmarks.iter().copied().eq(0..LANDMARKS as u16);
        let moved = self.moved.iter().map(|bits| bits.count_ones() as usize);
        let indices = [self.rings.as_flattened(), triangles.as_flattened(), listed];
        indices.iter().all(|list| list.iter().all(is_vertex))
            && self.pulled_by.as_flattened().iter().all(is_landmark)
            && uvs.as_flattened().iter().all(|uv| (0.0..=1.0).contains(uv))
            && total == listed.len()
            && moved.sum::<usize>() == self.modes.len()
            && come_first
    }

    /// Writes the vertices of a face with these animation weights, or only the first ones, in the
    /// frame of the pose \[mm\].
    pub(crate) fn place(
        &self,
        pose: &Pose,
        identity: &Identity,
        animation: &[f32],
        out: &mut [MeshVertex],
    ) {
        let identity = self.identity_scale.iter().zip(identity);
        // Each of the modes has a factor, also where there is no weight for it.
        let animation = animation.iter().copied().chain(core::iter::repeat(0.0));
        let mut factors = [0.0; MAX_IDENTITIES + ANIMATIONS];
        let modes = self.identity_scale.len() + ANIMATIONS;
        let scaled = (self.animation_scale.iter().zip(animation)).map(|(scale, w)| scale * w);
        let scaled = identity.map(|(scale, w)| scale * w).chain(scaled);
        factors.iter_mut().zip(scaled).for_each(|(f, v)| *f = v);
        let factors = factors.get(..modes).unwrap_or(&[]);
        let moved = self
            .moved
            .chunks_exact(bytes_of(self.identity_scale.len()).max(1));
        let mut runs = self.modes.iter();
        let blocks = self.mean.chunks(MESH_BLOCK).zip(moved);
        for (out, (mean, moved)) in out.chunks_mut(MESH_BLOCK).zip(blocks) {
            let mut numbers = [0.0; BLOCK_NUMBERS];
            for (number, mean) in numbers.iter_mut().zip(mean.as_flattened()) {
                *number = *mean;
            }
            let bits = (moved.iter()).flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1));
            // A bit without a mode has a run, too.
            let factors = factors.iter().copied().chain(core::iter::repeat(0.0));
            for (_, factor) in bits.zip(factors).filter(|(is_moved, _)| *is_moved) {
                let Some(run) = runs.next() else {
                    break;
                };
                // Most animation modes are at rest.
                if factor != 0.0 {
                    for (number, delta) in numbers.iter_mut().zip(run) {
                        *number += f32::from(*delta) * factor;
                    }
                }
            }
            for (vertex, point) in out.iter_mut().zip(numbers.as_chunks().0) {
                vertex.set_position(pose.apply(Vec3::from_array(*point)));
            }
        }
    }

    /// Moves the vertices by displacements of the landmarks \[mm\], smoothly in between.
    pub(crate) fn pull(&self, moves: &[Vec3; LANDMARKS], out: &mut [MeshVertex]) {
        let pulls = self.pulled_by.iter().zip(self.pulls);
        for (vertex, (landmarks, pulls)) in out.iter_mut().zip(pulls) {
            let mut position = vertex.position();
            for (landmark, pull) in landmarks.iter().zip(pulls) {
                let by = moves.get(usize::from(*landmark)).copied();
                let share = f32::from(*pull) / f32::from(WHOLE_PULL);
                position += by.unwrap_or_default() * share;
            }
            vertex.set_position(position);
        }
    }

    /// Writes how far the surface at each vertex (camera frame) faces the camera.
    pub(crate) fn face(&self, out: &mut [MeshVertex]) {
        for (i, ring) in self.rings.iter().enumerate() {
            let at = |index: usize| out.get(index).map(MeshVertex::position).unwrap_or_default();
            let [a, b, c, d] = ring.map(|index| at(usize::from(index)));
            let (normal, point) = ((c - a).cross(d - b), at(i));
            let lengths = normal.length_squared() * point.length_squared();
            let facing = -normal.dot(point) / libm::sqrtf(lengths).max(f32::MIN_POSITIVE);
            if let Some(vertex) = out.get_mut(i) {
                vertex.visibility = (0.5 + facing * VISIBLE_BY_FACING).clamp(0.0, 1.0);
            }
        }
    }
}

/// Of the cosine of the angle between a surface's normal and the line to the camera: at 12° of the
/// surface to that line it is seen for sure.
const VISIBLE_BY_FACING: f32 = 2.5;
