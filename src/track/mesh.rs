//! The dense mesh of the tracked face: of the 3D face as it was last fitted, drawn towards the
//! landmarks that were seen.

use super::Model;
use super::output::{State, TrackResult};
use super::policy::MESH_SURE;
use crate::shape::{
    Contour, FaceModel, FaceState, Intrinsics, LANDMARKS, Mesh, MeshVertex, NEAREST_MM, Project,
    Shape,
};
use core::fmt;
use glam::Vec3;

/// Where the vertices of a mesh are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MeshSpace {
    /// The head frame \[mm\].
    Head,
    /// The camera frame \[mm\].
    Camera,
    /// The picture, as its lens shows it: x and y \[px of the upright frame\]; z is the distance
    /// along the camera's axis \[mm\].
    Picture,
}

/// Why there is no mesh. Nothing was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// The model has no mesh.
    NoMesh,
    /// No face is tracked.
    NoFace,
    /// There is room for fewer vertices than the mesh has.
    Capacity {
        /// Vertices of the mesh.
        vertices: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshError::NoMesh => f.write_str("the model has no mesh"),
            MeshError::NoFace => f.write_str("no face is tracked"),
            MeshError::Capacity { vertices } => {
                write!(
                    f,
                    "the mesh has {vertices} vertices, more than there is room for"
                )
            }
        }
    }
}

impl core::error::Error for MeshError {}

/// The mesh of a model, if there is a face.
pub(super) fn open<'m>(model: &Model<'m>, result: &TrackResult) -> Result<Mesh<'m>, MeshError> {
    let mesh = model.mesh.mesh().ok_or(MeshError::NoMesh)?;
    match result.state {
        State::Searching => Err(MeshError::NoFace),
        State::Tracking | State::Coasting => Ok(mesh),
    }
}

/// Writes the vertices of a face that was fitted by this camera; returns their number.
pub(super) fn write(
    model: &Model<'_>,
    result: &TrackResult,
    face: &FaceState,
    camera: &Intrinsics,
    space: MeshSpace,
    out: &mut [MeshVertex],
) -> Result<usize, MeshError> {
    let mesh = open(model, result)?;
    let vertices = mesh.topology.vertices;
    let too_small = MeshError::Capacity { vertices };
    let out = out.get_mut(..vertices).ok_or(too_small)?;
    mesh.place(face, out);
    let moves = moves(&model.face, result, face, camera, out);
    mesh.pull(&moves, out);
    mesh.face(out);
    let to_head = face.pose.rotation.transpose();
    for vertex in out {
        let point = vertex.position();
        match space {
            MeshSpace::Camera => {}
            MeshSpace::Head => vertex.set_position(to_head * (point - face.pose.translation_mm)),
            MeshSpace::Picture => [vertex.x, vertex.y] = camera.image_of(point.to_array()),
        }
    }
    Ok(vertices)
}

/// From the vertex of each landmark, which come first, to where the landmark is, across the
/// camera's axis \[mm\]: as far as it was seen, from where the 3D face has it. Of the jaw the
/// landmarks follow the visible contour: its vertices move as that does.
#[inline(never)]
fn moves(
    face: &FaceModel<'_>,
    result: &TrackResult,
    state: &FaceState,
    camera: &Intrinsics,
    vertices: &[MeshVertex],
) -> [Vec3; LANDMARKS] {
    let seen = camera.undistorted(&result.landmarks.each_ref().map(|l| [l.x, l.y]));
    let (contour, shape) = contour(face, state);
    let mut moves = [Vec3::ZERO; LANDMARKS];
    let landmarks = (result.landmarks.iter().zip(&result.points_mm)).zip(&seen);
    for (i, (out, ((landmark, point), [x, y]))) in moves.iter_mut().zip(landmarks).enumerate() {
        let vertex = vertices
            .get(i)
            .map(MeshVertex::position)
            .unwrap_or_default();
        let [from_x, from_y] = camera.project(vertex);
        let [fitted_x, fitted_y] = camera.project(Vec3::from_array(*point));
        // Where the fit has what is seen.
        let [expected_x, expected_y] = match contour.get(i) {
            Some(on) => camera.project(state.pose.apply(shape.at(usize::from(*on)))),
            None => [fitted_x, fitted_y],
        };
        let share = (landmark.confidence * landmark.visibility / MESH_SURE).min(1.0);
        let right = fitted_x - from_x + share * (x - expected_x);
        let down = fitted_y - from_y + share * (y - expected_y);
        let depth = vertex.z.max(NEAREST_MM);
        *out = Vec3::new(right * depth / camera.fx, down * depth / camera.fy, 0.0);
    }
    moves
}

/// The visible contour of the face as fitted, and its points, head frame.
#[inline(never)]
fn contour(face: &FaceModel<'_>, state: &FaceState) -> (Contour, Shape) {
    let mut shape = face.neutral(&state.identity);
    face.animate(&mut shape, &state.animation);
    (shape.contour(face, &state.pose), shape)
}
