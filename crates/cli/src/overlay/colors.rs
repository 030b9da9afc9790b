//! Colours of the overlay.

use image::Rgb;

/// Edges of the mesh.
pub const MESH: Rgb<u8> = Rgb([120, 160, 200]);
/// The box of a tracked face.
pub const BOX: Rgb<u8> = Rgb([240, 220, 60]);
/// The box of a coasted face.
pub const BOX_COASTING: Rgb<u8> = Rgb([240, 140, 40]);
/// The head's axes: to the person's left, down, out of the face.
pub const AXES: [Rgb<u8>; 3] = [Rgb([255, 60, 60]), Rgb([60, 220, 60]), Rgb([80, 120, 255])];

/// Red for no confidence through yellow to green.
pub fn confidence_color(confidence: f32) -> Rgb<u8> {
    let c = confidence.clamp(0.0, 1.0);
    let ramp = |v: f32| (255.0 * v.min(1.0)) as u8;
    Rgb([ramp(2.0 - 2.0 * c), ramp(2.0 * c), 0])
}
