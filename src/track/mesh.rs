//! The dense mesh of the tracked face: of the 3D face as it was last fitted, drawn towards the
//! landmarks that were seen. And the person's head at rest, for files and avatars that animate it.

use super::Model;
use super::output::{State, TrackResult};
use super::policy::MESH_SURE;
use crate::shape::{
    ANIMATIONS, Contour, FaceModel, FaceState, Intrinsics, LANDMARKS, Mesh, MeshVertex, NEAREST_MM,
    Pose, Project, Shape,
};
use core::fmt;
use glam::{Mat3, Vec3};

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

/// A shape of the person's own head, which weights blend: the neutral one plus, for each animation
/// weight, that weight times what the shape of the weight differs by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MeshShape {
    /// No animation.
    Neutral,
    /// The weight of this index of [`ANIMATION_NAMES`](crate::ANIMATION_NAMES) is 1, all others are
    /// 0.
    Animation(usize),
}

/// Why there is no mesh. Nothing was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// The model has no mesh.
    NoMesh,
    /// No face is tracked; of a shape, none was since the tracker began.
    NoFace,
    /// There is no animation weight of this index.
    Shape,
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
            MeshError::Shape => f.write_str("there is no such animation weight"),
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

/// Writes the vertices of a shape of the head of the last fit, head frame; returns their number.
pub(super) fn write_shape(
    model: &Model<'_>,
    face: &FaceState,
    shape: MeshShape,
    out: &mut [MeshVertex],
) -> Result<usize, MeshError> {
    let mut animation = [0.0; ANIMATIONS];
    if let MeshShape::Animation(index) = shape {
        *animation.get_mut(index).ok_or(MeshError::Shape)? = 1.0;
    }
    let mesh = open_shape(model, face)?;
    let vertices = mesh.topology.vertices;
    let too_small = MeshError::Capacity { vertices };
    let out = out.get_mut(..vertices).ok_or(too_small)?;
    let upright = Pose {
        rotation: Mat3::IDENTITY,
        translation_mm: Vec3::ZERO,
    };
    mesh.place(&upright, &face.identity, &animation, out);
    for vertex in out {
        vertex.visibility = 1.0;
    }
    Ok(vertices)
}

/// The mesh of a model, if a face was fitted.
pub(super) fn open_shape<'m>(model: &Model<'m>, face: &FaceState) -> Result<Mesh<'m>, MeshError> {
    let mesh = model.mesh.mesh().ok_or(MeshError::NoMesh)?;
    match face.is_fitted() {
        true => Ok(mesh),
        false => Err(MeshError::NoFace),
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
    mesh.place(&face.pose, &face.identity, &face.animation, out);
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
