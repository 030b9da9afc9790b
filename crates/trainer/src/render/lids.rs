//! Lids that shut. The morphable head's blink moves every head's lids by the same distance, which
//! shuts the mean head's: wide eyes stay open, narrow lids cross, and where an eyeball stands out
//! it is seen through the lid.

use super::mesh::{Material, Mesh};
use glam::Vec3;

/// The shapes that shut the image left's and the image right's eye.
const BLINKS: [&str; 2] = ["eyeBlinkRight", "eyeBlinkLeft"];
/// Landmarks of upper and lower lids of these eyes.
const PAIRS: [[[usize; 2]; 2]; 2] = [[[37, 41], [38, 40]], [[43, 47], [44, 46]]];
/// Distance of these landmarks on lids that touch \[mm\]: they lie on the edges' outer side. A full
/// blink leaves 1.0 mm of the mean head's 8.1 mm, with which a slit is seen in some heads.
const TOUCHING_MM: f32 = 0.5;
/// Range of the weight of the shape for a full blink.
const WEIGHTS: (f32, f32) = (0.3, 2.5);
/// Lids are so far outside of the eyeball \[mm\], so that it does not show between their vertices.
const OUTSIDE_MM: f32 = 0.4;

/// How one head's eyes shut.
#[derive(Clone, Debug)]
pub struct Lids {
    /// Weights of the shapes that shut each eye.
    full: [f32; 2],
    /// Vertices of the skin that these shapes move.
    skin: [Vec<u32>; 2],
}

impl Lids {
    /// Those of a head whose vertices (head axes) are given for weights of the mesh's shapes.
    pub fn new(mesh: &Mesh, vertices: impl Fn(&[(usize, f32)]) -> Vec<Vec3>) -> Lids {
        let shapes = BLINKS.map(|name| mesh.shape(name));
        let blink: Vec<_> = shapes.iter().flatten().map(|shape| (*shape, 1.0)).collect();
        let (rest, shut) = (vertices(&[]), vertices(&blink));
        let full = PAIRS.map(|pairs| {
            let gap = |head: &[Vec3]| {
                let at = |landmark: usize| head[mesh.landmarks[landmark] as usize].y;
                let gaps = pairs.map(|[upper, lower]| at(lower) - at(upper));
                gaps.iter().sum::<f32>() / gaps.len() as f32
            };
            let (open, closed) = (gap(&rest), gap(&shut));
            let weight = (open - TOUCHING_MM) / (open - closed).max(1e-3);
            weight.clamp(WEIGHTS.0, WEIGHTS.1)
        });
        let mut is_skin = vec![false; mesh.mean.len()];
        for triangle in &mesh.triangles[mesh.run(Material::Skin)] {
            triangle.iter().for_each(|v| is_skin[*v as usize] = true);
        }
        let skin = shapes.map(|shape| {
            let moved = shape
                .into_iter()
                .flat_map(|shape| mesh.shapes[shape].moved());
            moved.filter(|v| is_skin[*v as usize]).collect()
        });
        Lids { full, skin }
    }

    /// Changes the weights of an expression so that a blink of 1 shuts the eyes.
    pub fn shut(&self, mesh: &Mesh, weights: &mut [(usize, f32)]) {
        for (name, full) in BLINKS.iter().zip(self.full) {
            let shape = mesh.shape(name);
            let of = weights.iter_mut().filter(|(at, _)| Some(*at) == shape);
            of.for_each(|(_, weight)| *weight *= full);
        }
    }

    /// Moves skin that is inside of an eyeball out of it.
    pub fn cover_eyeballs(&self, mesh: &Mesh, head: &mut [Vec3]) {
        let eyes = mesh.eyes.iter().zip(&self.skin);
        for (eye, skin) in eyes.filter(|(eye, _)| !eye.is_empty()) {
            let points = eye.iter().map(|v| head[*v as usize]);
            let (low, high) = points.fold((Vec3::MAX, Vec3::MIN), |(low, high), p| {
                (low.min(p), high.max(p))
            });
            let centre = (low + high) / 2.0;
            // That of the cornea, which stands out.
            let far = eye.iter().map(|v| head[*v as usize].distance(centre));
            let radius = far.fold(0.0, f32::max) + OUTSIDE_MM;
            for v in skin {
                let out = head[*v as usize] - centre;
                let length = out.length();
                if length < radius && length > 0.0 {
                    head[*v as usize] = centre + out * (radius / length);
                }
            }
        }
    }
}
