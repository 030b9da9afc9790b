//! What lenses mirror before an eye.

use super::draw::{Prop, SUPER, View};
use super::raster::{Cull, EMPTY, Target, weights};
use glam::Vec3;

/// Mirrored light that hides what is behind a lens, where lit white paper returns about 1 and skin
/// about 0.3.
pub const GLARE: f32 = 0.25;

/// Light that lenses mirror before points (camera axes), as the camera sees them.
pub fn before(points: &[Vec3], props: &[Prop], view: &View) -> Vec<f32> {
    let mut light = vec![0.0; points.len()];
    for prop in props {
        if prop.mirror.is_none() {
            continue;
        }
        let mut target = Target::new(view.width * SUPER, view.height * SUPER);
        let seen: Vec<_> = prop.vertices.iter().map(|v| view.to_samples(*v)).collect();
        target.draw(&seen, &prop.triangles, 0, Cull::None);
        for (point, light) in points.iter().zip(&mut light) {
            let at = view.to_samples(*point);
            let (x, y) = (at.x.round(), at.y.round());
            let inside = x >= 0.0 && y >= 0.0 && x < target.width as f32;
            let index = y as usize * target.width + x as usize;
            let id = target.id.get(index).filter(|id| inside && **id != EMPTY);
            if let Some(id) = id.filter(|_| target.inv_z[index] >= at.inv_z) {
                let t = prop.triangles[*id as usize].map(|i| i as usize);
                let w = weights(t.map(|i| seen[i]), x, y).to_array();
                *light += prop.mirrored(t, w);
            }
        }
    }
    light
}
