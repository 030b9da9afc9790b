//! New views of the person in the first frame: its pixels on the mesh, from other poses.

use super::person::Person;
use super::picture::Picture;
use super::state::State;
use glam::Vec3;
use posewise::shape::Project;
use posewise_train::render::raster::{Cull, EMPTY, Projected, Target, weights};

/// A landmark is seen if nothing is nearer than it by more than this \[mm\].
const SLACK_MM: f32 = 8.0;

/// The first frame on the mesh.
pub struct Texture<'a> {
    person: &'a Person<'a>,
    frame: &'a Picture,
    /// Vertices with the first frame's units \[mm, head frame\].
    vertices: Vec<Vec3>,
    /// The first frame's state.
    state: State,
    background: f32,
}

/// A view, and where something was drawn.
pub struct View {
    /// The picture.
    pub picture: Picture,
    target: Target,
}

impl<'a> Texture<'a> {
    /// Puts a frame on the mesh of the person, which it shows in this state.
    pub fn new(person: &'a Person<'a>, frame: &'a Picture, state: &State) -> Texture<'a> {
        let sum: f32 = frame.pixels.iter().sum();
        Texture {
            person,
            frame,
            vertices: person.vertices(&state.units),
            state: *state,
            background: sum / frame.pixels.len() as f32,
        }
    }

    /// The person in another pose, with the first frame's units.
    pub fn render(&self, pose: &State) -> View {
        let camera = &self.person.camera;
        let (width, height) = (self.frame.width, self.frame.height);
        let triangles = &self.person.model.mesh.triangles;
        let (projected, target) = drawn(self.person, &self.vertices, pose, [width, height]);
        let mut picture = Picture {
            width,
            height,
            pixels: vec![self.background; width * height],
        };
        for (at, pixel) in picture.pixels.iter_mut().enumerate() {
            if target.id[at] == EMPTY {
                continue;
            }
            let corners = triangles[target.id[at] as usize].map(|v| v as usize);
            let (x, y) = ((at % width) as f32, (at / width) as f32);
            let w = weights(corners.map(|v| projected[v]), x, y);
            let point: Vec3 = (0..3).map(|k| self.vertices[corners[k]] * w[k]).sum();
            let first = self.state.rotation * point + self.state.translation;
            *pixel = self.frame.at(camera.project(first));
        }
        View { picture, target }
    }
}

/// Draws the person's triangles, by number.
fn drawn(
    person: &Person<'_>,
    vertices: &[Vec3],
    pose: &State,
    [width, height]: [usize; 2],
) -> (Vec<Projected>, Target) {
    let project = |v: &Vec3| {
        let at = pose.rotation * *v + pose.translation;
        let [x, y] = person.camera.project(at);
        let inv_z = if at.z > 1.0 { 1.0 / at.z } else { 0.0 };
        Projected { x, y, inv_z }
    };
    let projected: Vec<Projected> = vertices.iter().map(project).collect();
    let mut target = Target::new(width, height);
    target.draw(&projected, &person.model.mesh.triangles, 0, Cull::Back);
    (projected, target)
}

/// The points of the person's surface \[mm, head frame\] that pixels of a frame show; `None` beside
/// the head.
pub fn surface(
    person: &Person<'_>,
    state: &State,
    size: [usize; 2],
    pixels: &[[f32; 2]],
) -> Vec<Option<Vec3>> {
    let vertices = person.vertices(&state.units);
    let (projected, target) = drawn(person, &vertices, state, size);
    let point = |[x, y]: &[f32; 2]| {
        let at = (*y as usize).min(size[1] - 1) * size[0] + (*x as usize).min(size[0] - 1);
        let id = target.id[at];
        (id != EMPTY).then(|| {
            let corners = person.model.mesh.triangles[id as usize].map(|v| v as usize);
            let w = weights(corners.map(|v| projected[v]), *x, *y);
            (0..3).map(|k| vertices[corners[k]] * w[k]).sum::<Vec3>()
        })
    };
    pixels.iter().map(point).collect()
}

impl View {
    /// Whether a landmark of the person in this pose is in the view and not covered.
    pub fn shows(&self, person: &Person<'_>, pose: &State, landmark: usize) -> bool {
        let point = person.landmark(pose, landmark);
        let [x, y] = person.camera.project(point);
        let nearest = self.target.nearest_around(x, y);
        // The surface that is drawn there may be SLACK_MM nearer than the point. With its inverse
        // depth w = 1 / z:  point.z ≤ z + SLACK_MM  ⇔  1 / point.z ≥ w / (1 + SLACK_MM · w).
        nearest.is_some_and(|w| 1.0 / point.z + 1e-9 >= w / (1.0 + SLACK_MM * w))
    }
}
