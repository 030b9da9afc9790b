//! Draws results into a picture: mesh, landmarks, axes and box, as far as they are wanted, with a
//! line of text and a legend.

use clap::ValueEnum;
use glam::{Mat3, Quat, Vec3};
use image::{Rgb, RgbImage};
use imageproc::drawing::{draw_antialiased_line_segment_mut, draw_filled_circle_mut};
use imageproc::pixelops::interpolate;
use posewise::{Intrinsics, State, TrackResult};

use super::colors::{AXES, BOX, BOX_COASTING, MESH, confidence_color};
use super::legend::legend;
use super::mesh::{Triangles, triangulate_face, twice_area};
use crate::cli::Style;
use crate::faces::Face;
use crate::text;

const WHITE: Rgb<u8> = Rgb([255, 255, 255]);
/// Length of the drawn axes \[mm\].
const AXIS_MM: f32 = 60.0;

/// Draws results; keeps the mesh's triangles from the first face on.
pub struct Painter {
    styles: Vec<Style>,
    triangles: Triangles,
}

impl Painter {
    /// Draws these parts.
    pub fn new(styles: &[Style]) -> Self {
        Painter {
            styles: styles.to_vec(),
            triangles: Triangles::new(),
        }
    }

    /// Draws all parts.
    pub fn all() -> Self {
        Painter::new(Style::value_variants())
    }

    fn shows(&self, style: Style) -> bool {
        self.styles.contains(&style)
    }

    /// Draws the faces of a frame into its upright picture. `camera` is what the tracker assumed.
    pub fn paint(&mut self, image: &mut RgbImage, frame: u64, faces: &[Face], camera: &Intrinsics) {
        let seen = |face: &&Face| face.result.state != State::Searching;
        for Face { result, .. } in faces.iter().filter(seen) {
            if self.shows(Style::Mesh) {
                self.mesh(image, result, camera);
            }
            if self.shows(Style::Box) {
                draw_box(image, result);
            }
            if self.shows(Style::Points) {
                draw_landmarks(image, result);
            }
            if self.shows(Style::Axes) {
                draw_axes(image, result, camera);
            }
        }
        legend(image, &self.styles);
        match faces {
            [] => label(image, 0, &format!("{frame} {}", State::Searching.name())),
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
            let solid = triangle.map(|i| projected.get(i).copied().flatten());
            let [Some(a), Some(b), Some(c)] = solid else {
                continue;
            };
            // Triangles of the 3D face that face away would clutter the far side.
            if twice_area([a, b, c]) <= 0.0 {
                continue;
            }
            // The corners are the landmarks, not the points of the 3D face: along the jaw of a
            // turned head these are other places of the face.
            let [a, b, c] = triangle.map(|i| {
                let landmark = result.landmarks.get(i).copied().unwrap_or_default();
                [landmark.x, landmark.y]
            });
            for (from, to) in [(a, b), (b, c), (c, a)] {
                line(image, from, to, MESH);
            }
        }
    }
}

/// Points that are nearer are not drawn; projections of such are no longer right.
const NEAREST_MM: f32 = 20.0;

/// Where a point of the camera frame appears; `None` behind the camera or far out.
fn project(camera: &Intrinsics, p: Vec3) -> Option<[f32; 2]> {
    let at = camera.image_of(p.to_array());
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
        State::Coasting => BOX_COASTING,
        _ => BOX,
    };
    let [x, y, w, h] = result.face_box;
    let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    for i in 0..4 {
        line(image, corners[i], corners[(i + 1) % 4], color);
    }
}

/// Coloured by confidence; hidden landmarks smaller.
fn draw_landmarks(image: &mut RgbImage, result: &TrackResult) {
    let size = result.face_box[2].max(result.face_box[3]);
    let radius = ((size / 110.0).round() as i32).clamp(1, 6);
    for l in result.landmarks {
        if !drawable([l.x, l.y]) {
            continue;
        }
        let color = confidence_color(l.confidence);
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
        (rotation.x_axis, AXES[0]),
        (rotation.y_axis, AXES[1]),
        (-rotation.z_axis, AXES[2]),
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
    let mut words = result.state.name().to_string();
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
    text::darken(image, text::width(words) as u32 + 4, top..top + strip);
    text::write(image, [2, top + 2], words, WHITE);
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
        let mut painter = Painter::all();
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
        Painter::all().paint(&mut image, 2, &one(wild), &camera);
        Painter::all().paint(&mut RgbImage::new(1, 1), 2, &one(wild), &camera);
        Painter::all().paint(&mut RgbImage::new(1, 1), 2, &[], &camera);
    }

    /// On a turned head the jaw's landmarks are elsewhere than the points of the 3D face.
    #[test]
    fn the_mesh_goes_through_the_landmarks() {
        let camera = Intrinsics::of_frame(320, 240);
        let mut face = fake_face(&camera);
        for landmark in &mut face.landmarks[..17] {
            landmark.x += 40.0;
        }
        let mut image = RgbImage::new(320, 240);
        Painter::new(&[Style::Mesh]).paint(&mut image, 1, &one(face), &camera);
        for landmark in &face.landmarks[..17] {
            let at = [landmark.x, landmark.y].map(|v| v.round() as u32);
            let around = (0..9).map(|k| image.get_pixel(at[0] + k % 3 - 1, at[1] + k / 3 - 1));
            assert!(around.into_iter().any(|p| p.0 != [0; 3]), "{landmark:?}");
        }
    }

    #[test]
    fn only_the_styles_that_are_wanted_are_drawn() {
        let camera = Intrinsics::of_frame(320, 240);
        let face = one(fake_face(&camera));
        let shows = |style: Style, color: Rgb<u8>| {
            let mut image = RgbImage::new(320, 240);
            Painter::new(&[style]).paint(&mut image, 1, &face, &camera);
            // Above the legend.
            let seen = image.enumerate_pixels().filter(|(_, y, _)| *y < 200);
            seen.into_iter().any(|(_, _, p)| *p == color)
        };
        let colors = [confidence_color(1.0), MESH, AXES[0], BOX];
        for (i, style) in Style::value_variants().iter().enumerate() {
            for (j, color) in colors.iter().enumerate() {
                assert_eq!(shows(*style, *color), i == j, "{style:?} {color:?}");
            }
        }
    }
}
