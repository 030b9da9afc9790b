//! Where the eyes of a drawn head look, and how much of each iris is seen.

use super::contour::is_drawn;
use super::draw::{Drawn, IRIS_RAD, Scene, View, eye_centre};
use super::glare;
use super::mesh::Material;
use glam::{Vec2, Vec3};

/// The truth of one eye.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EyeTruth {
    /// Centre of the eyeball \[mm, camera axes\].
    pub centre: Vec3,
    /// Unit gaze, camera axes.
    pub gaze: Vec3,
    /// Where the middle of the iris is in the picture, seen or not \[px\].
    pub iris: Vec2,
    /// Share of the iris that is seen, 0..1.
    pub seen: f32,
    /// Opacity of the lens before the eye; 0 without glasses.
    pub lens: f32,
    /// Mean light that a lens mirrors before the iris, where lit white paper returns about 1.
    pub glare: f32,
    /// Share of the iris before which is something else than lids, 0..1.
    pub hidden: f32,
}

/// The truth of the image left's (0) or the image right's eye (1).
pub fn eye_truth(eye: usize, scene: &Scene<'_>, view: &View, drawn: &Drawn) -> EyeTruth {
    let centre = eye_centre(scene.mesh, scene.head, eye);
    let gaze = scene.head.rotation * scene.eyes.gaze[eye];
    let surface = Surface::new(eye, scene, centre, gaze);
    let (mut seen, mut all) = (0.0f32, 0.0f32);
    let points: Vec<Vec3> = disc(gaze).map(|d| centre + d * surface.radius).collect();
    let glare = glare::before(&points, scene.props, view);
    let hidden = points
        .iter()
        .filter(|p| !is_drawn(**p, view, &drawn.target))
        .count();
    for (direction, p) in disc(gaze).zip(points) {
        // Where the eyeball is seen from the side its iris covers less of the picture.
        let weight = -direction.dot(p.normalize());
        if weight > 0.0 {
            all += weight;
            seen += weight * f32::from(surface.is_seen(p, view, drawn));
        }
    }
    EyeTruth {
        centre,
        gaze,
        iris: view.project(centre + gaze * surface.radius * IRIS_RAD.cos()),
        seen: seen / all.max(1e-6),
        lens: (scene.props.iter().map(|prop| prop.opacity))
            .filter(|opacity| *opacity < 1.0)
            .fold(0.0, f32::max),
        glare: glare.iter().sum::<f32>() / glare.len() as f32,
        hidden: hidden as f32 / glare.len() as f32,
    }
}

/// The eyeball's surface where the iris is.
struct Surface {
    radius: f32,
    triangles: std::ops::Range<usize>,
}

impl Surface {
    fn new(eye: usize, scene: &Scene<'_>, centre: Vec3, gaze: Vec3) -> Surface {
        let vertices = scene.mesh.eyes[eye].iter();
        let out = vertices.map(|v| scene.head.vertices[*v as usize] - centre);
        let near = out.filter(|d| d.normalize_or_zero().dot(gaze) > IRIS_RAD.cos());
        let (sum, count) = near.fold((0.0, 0), |(sum, n), d| (sum + d.length(), n + 1));
        let material = [Material::EyeRight, Material::EyeLeft][eye];
        Surface {
            radius: sum / count.max(1) as f32,
            triangles: scene.mesh.run(material),
        }
    }

    /// Whether the eyeball is what was drawn there, and nothing opaque before it.
    fn is_seen(&self, p: Vec3, view: &View, drawn: &Drawn) -> bool {
        let at = view.to_samples(p);
        let (x, y) = (at.x.round(), at.y.round());
        let target = &drawn.target;
        let inside = x >= 0.0 && y >= 0.0 && x < target.width as f32;
        let index = y as usize * target.width + x as usize;
        let id = target.id.get(index).filter(|_| inside);
        id.is_some_and(|id| self.triangles.contains(&(*id as usize))) && is_drawn(p, view, target)
    }
}

/// Directions over the iris, each for the same solid angle.
fn disc(gaze: Vec3) -> impl Iterator<Item = Vec3> {
    const COUNT: usize = 48;
    let across = gaze.any_orthonormal_vector();
    let up = gaze.cross(across);
    (0..COUNT).map(move |i| {
        let radius = IRIS_RAD * ((i as f32 + 0.5) / COUNT as f32).sqrt();
        let (s, c) = (i as f32 * 2.399_963).sin_cos();
        gaze * radius.cos() + (across * c + up * s) * radius.sin()
    })
}
