//! Draws one result into a picture: mesh, landmarks, axes, box and a line of text.

use glam::{Mat3, Quat, Vec3};
use image::{Rgb, RgbImage};
use imageproc::drawing::{draw_antialiased_line_segment_mut, draw_filled_circle_mut};
use imageproc::pixelops::interpolate;
use posewise::shape::Intrinsics;
use posewise::track::{State, TrackResult};

use super::mesh::{Triangles, triangulate_face, twice_area};
use crate::csv::state_name;
use crate::faces::Face;
use crate::text;

const MESH: Rgb<u8> = Rgb([120, 160, 200]);
const BOX: Rgb<u8> = Rgb([240, 220, 60]);
const BOX_HOLDING: Rgb<u8> = Rgb([240, 140, 40]);
const WHITE: Rgb<u8> = Rgb([255, 255, 255]);
/// Length of the drawn axes \[mm\].
const AXIS_MM: f32 = 60.0;

/// Draws results; keeps the mesh's triangles from the first face on.
#[derive(Default)]
pub struct Painter {
    triangles: Triangles,
}

impl Painter {
    /// Draws the faces of a frame into its upright picture. `camera` is what the tracker assumed.
    pub fn paint(&mut self, image: &mut RgbImage, frame: u64, faces: &[Face], camera: &Intrinsics) {
        let seen = |face: &&Face| face.result.state != State::Searching;
        for Face { result, .. } in faces.iter().filter(seen) {
            self.mesh(image, result, camera);
            draw_box(image, result);
            draw_landmarks(image, result);
            draw_axes(image, result, camera);
        }
        match faces {
            [] => label(
                image,
                0,
                &format!("{frame} {}", state_name(State::Searching)),
            ),
            [Face { id: 0, result }] => label(image, 0, &format!("{frame} {}", summary(result))),
            _ => {
                for (line, Face { id, result }) in (0..).zip(faces) {
                    label(image, line, &format!("{frame} #{id} {}", summary(result)));
                }
            }
        }
    }

    fn mesh(&mut self, image: &mut RgbImage, result: &TrackResult, camera: &Intrinsics) {
        if self.triangles.is_empty() {
            self.triangles = triangulate_face(result);
        }
        let projected = result.points_mm.map(|p| project(camera, Vec3::from(p)));
        for triangle in &self.triangles {
            let corners = triangle.map(|i| projected.get(i).copied().flatten());
            let [Some(a), Some(b), Some(c)] = corners else {
                continue;
            };
            // Triangles that face away would clutter the far side.
            if twice_area([a, b, c]) > 0.0 {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    line(image, from, to, MESH);
                }
            }
        }
    }
}

/// Points that are nearer are not drawn; projections of such are no longer right.
const NEAREST_MM: f32 = 20.0;

/// Where a point of the camera frame appears; `None` behind the camera or far out.
fn project(camera: &Intrinsics, p: Vec3) -> Option<[f32; 2]> {
    let at = camera.image_of(p);
    (p.z > NEAREST_MM && drawable(at)).then_some(at)
}

/// Coordinates so far out that drawing there would only cost time are left out.
fn drawable(p: [f32; 2]) -> bool {
    p.iter().all(|v| v.is_finite() && v.abs() < 20_000.0)
}

fn line(image: &mut RgbImage, from: [f32; 2], to: [f32; 2], color: Rgb<u8>) {
    if drawable(from) && drawable(to) {
        let ends = [from, to].map(|p| (p[0].round() as i32, p[1].round() as i32));
        draw_antialiased_line_segment_mut(image, ends[0], ends[1], color, interpolate);
    }
}

fn draw_box(image: &mut RgbImage, result: &TrackResult) {
    let color = match result.state {
        State::Coasting => BOX_HOLDING,
        _ => BOX,
    };
    let [x, y, w, h] = result.face_box;
    let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    for i in 0..4 {
        line(image, corners[i], corners[(i + 1) % 4], color);
    }
}

/// Red for no confidence through yellow to green; hidden landmarks smaller.
fn draw_landmarks(image: &mut RgbImage, result: &TrackResult) {
    let size = result.face_box[2].max(result.face_box[3]);
    let radius = ((size / 110.0).round() as i32).clamp(1, 6);
    for l in result.landmarks {
        if !drawable([l.x, l.y]) {
            continue;
        }
        let c = l.confidence.clamp(0.0, 1.0);
        let ramp = |v: f32| (255.0 * v.min(1.0)) as u8;
        let color = Rgb([ramp(2.0 - 2.0 * c), ramp(2.0 * c), 0]);
        let radius = if l.visibility < 0.5 {
            (radius / 2).max(1)
        } else {
            radius
        };
        let centre = (l.x.round() as i32, l.y.round() as i32);
        draw_filled_circle_mut(image, centre, radius, color);
    }
}

/// The head's axes from its origin: red to the subject's left, green down, blue out of the face.
fn draw_axes(image: &mut RgbImage, result: &TrackResult, camera: &Intrinsics) {
    let rotation = Mat3::from_quat(Quat::from_array(result.rotation).normalize());
    let origin = Vec3::from(result.translation_mm);
    let Some(from) = project(camera, origin) else {
        return;
    };
    let axes = [
        (rotation.x_axis, Rgb([255, 60, 60])),
        (rotation.y_axis, Rgb([60, 220, 60])),
        (-rotation.z_axis, Rgb([80, 120, 255])),
    ];
    for (axis, color) in axes {
        if let Some(to) = project(camera, origin + AXIS_MM * axis) {
            for shift in [0.0, 1.0] {
                let moved = |p: [f32; 2]| [p[0] + shift, p[1]];
                line(image, moved(from), moved(to), color);
            }
        }
    }
}

/// State, angles, distance and confidence in a line.
fn summary(result: &TrackResult) -> String {
    let mut words = state_name(result.state).to_string();
    if result.state != State::Searching {
        words += &format!(
            " y{:+.0}° p{:+.0}° r{:+.0}° {:.0}mm {:.2}",
            result.yaw_deg,
            result.pitch_deg,
            result.roll_deg,
            result.translation_mm[2],
            result.confidence
        );
    }
    words
}

/// Writes a line from the top, on a dark strip that keeps it readable on any picture.
fn label(image: &mut RgbImage, line: u32, words: &str) {
    let strip = text::GLYPH as u32 + 4;
    let top = line * strip;
    let width = (text::width(words) as u32 + 4).min(image.width());
    for y in top..(top + strip).min(image.height()) {
        for x in 0..width {
            let pixel = image.get_pixel_mut(x, y);
            pixel.0 = pixel.0.map(|v| v / 3);
        }
    }
    text::each_pixel(words, |x, y| {
        if let Some(pixel) = image.get_pixel_mut_checked(x as u32 + 2, top + y as u32 + 2) {
            *pixel = WHITE;
        }
    });
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A made-up face: landmarks on a half cylinder, looking into the camera.
    pub fn fake_face(camera: &Intrinsics) -> TrackResult {
        let mut result = TrackResult::default();
        result.state = State::Tracking;
        result.confidence = 0.9;
        result.rotation = [0.0, 0.0, 0.0, 1.0];
        result.translation_mm = [0.0, 0.0, 600.0];
        result.face_box = [100.0, 80.0, 120.0, 120.0];
        for i in 0..68 {
            let angle = i as f32 * 2.4;
            let radius = 9.0 * (i as f32).sqrt();
            let p = Vec3::new(radius * angle.cos(), radius * angle.sin(), 560.0);
            result.points_mm[i] = p.to_array();
            let [x, y] = project(camera, p).unwrap();
            let landmark = &mut result.landmarks[i];
            (landmark.x, landmark.y) = (x, y);
            landmark.confidence = i as f32 / 67.0;
            landmark.visibility = 1.0;
        }
        result
    }

    fn one(result: TrackResult) -> [Face; 1] {
        [Face { id: 0, result }]
    }

    #[test]
    fn paints_a_face_and_survives_nonsense() {
        let camera = Intrinsics::of_frame(320, 240);
        let mut painter = Painter::default();
        let mut image = RgbImage::new(320, 240);
        painter.paint(&mut image, 1, &one(fake_face(&camera)), &camera);
        assert!(painter.triangles.len() > 60);
        let last = fake_face(&camera).landmarks[67];
        let pixel = image.get_pixel(last.x.round() as u32, last.y.round() as u32);
        assert_eq!(pixel.0, [0, 255, 0], "full confidence is green");

        let mut wild = fake_face(&camera);
        wild.landmarks[0].x = f32::NAN;
        wild.points_mm[1] = [f32::INFINITY, 0.0, 0.0];
        wild.translation_mm = [0.0, 0.0, -1.0];
        wild.face_box = [1e9, -1e9, f32::NAN, 5.0];
        wild.rotation = [0.0; 4];
        Painter::default().paint(&mut image, 2, &one(wild), &camera);
        Painter::default().paint(&mut RgbImage::new(1, 1), 2, &one(wild), &camera);
        Painter::default().paint(&mut RgbImage::new(1, 1), 2, &[], &camera);
    }
}
