//! The z-buffered rasteriser: projected triangles in, a visibility buffer (nearest triangle and
//! its depth at every sample) out. Shading is deferred, so each sample is shaded once.

use glam::Vec3;

/// A vertex on the sample grid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Projected {
    /// Sample column; sample centres are at whole numbers.
    pub x: f32,
    /// Sample row.
    pub y: f32,
    /// 1/z \[1/mm\]; 0 marks a vertex behind the near plane, whose triangles are not drawn.
    pub inv_z: f32,
}

/// Nothing was drawn here.
pub const EMPTY: u32 = u32::MAX;

/// The visibility buffer.
pub struct Target {
    /// Samples per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// 1/z of the nearest surface, 0 where there is none.
    pub inv_z: Vec<f32>,
    /// `base + triangle` of the nearest surface, or [`EMPTY`].
    pub id: Vec<u32>,
}

/// Which faces are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    /// Only triangles that turn their outside to the camera.
    Back,
    /// All: sheets without an inside.
    None,
}

impl Target {
    /// An empty buffer.
    pub fn new(width: usize, height: usize) -> Self {
        Target {
            width,
            height,
            inv_z: vec![0.0; width * height],
            id: vec![EMPTY; width * height],
        }
    }

    /// Draws triangles; their ids are `base + position in the list`.
    pub fn draw(&mut self, vertices: &[Projected], triangles: &[[u32; 3]], base: u32, cull: Cull) {
        self.draw_where(vertices, triangles, base, cull, |_, _, _| true);
    }

    /// Draws triangles where they are said to be, by their number, the sample's place and the
    /// weights of the corners.
    pub fn draw_where(
        &mut self,
        vertices: &[Projected],
        triangles: &[[u32; 3]],
        base: u32,
        cull: Cull,
        is_there: impl Fn(usize, [u32; 2], [f32; 3]) -> bool,
    ) {
        for (n, t) in triangles.iter().enumerate() {
            let corner = t.map(|i| vertices[i as usize]);
            if corner.iter().any(|c| c.inv_z <= 0.0) {
                continue;
            }
            self.triangle(corner, base + n as u32, cull, |at, w| is_there(n, at, w));
        }
    }

    fn triangle(
        &mut self,
        mut c: [Projected; 3],
        id: u32,
        cull: Cull,
        is_there: impl Fn([u32; 2], [f32; 3]) -> bool,
    ) {
        let (min_x, max_x) = bounds(c.map(|p| p.x), self.width);
        let (min_y, max_y) = bounds(c.map(|p| p.y), self.height);
        if min_x > max_x || min_y > max_y {
            return;
        }
        // Outward normals point to −z where the surface faces the camera: with y down that is a
        // negative area.
        let mut area = cross(c[0], c[1], c[2]);
        let turned = area >= 0.0;
        if turned {
            if cull == Cull::Back || area == 0.0 {
                return;
            }
            c.swap(1, 2);
            area = -area;
        }
        let scale = 1.0 / area;
        for y in min_y..=max_y {
            for x in min_x..=max_x {
                let p = Projected {
                    x: x as f32,
                    y: y as f32,
                    inv_z: 0.0,
                };
                let w0 = cross(c[1], c[2], p) * scale;
                let w1 = cross(c[2], c[0], p) * scale;
                let w2 = 1.0 - w0 - w1;
                // A small tolerance closes the seams between neighbours.
                if w0 < -1e-5 || w1 < -1e-5 || w2 < -1e-5 {
                    continue;
                }
                let inv_z = w0 * c[0].inv_z + w1 * c[1].inv_z + w2 * c[2].inv_z;
                let at = y as usize * self.width + x as usize;
                let w = if turned { [w0, w2, w1] } else { [w0, w1, w2] };
                if inv_z > self.inv_z[at] && is_there([x as u32, y as u32], w) {
                    self.inv_z[at] = inv_z;
                    self.id[at] = id;
                }
            }
        }
    }

    /// Largest 1/z in the 3×3 neighbourhood of a point, `None` outside the buffer.
    pub fn nearest_around(&self, x: f32, y: f32) -> Option<f32> {
        let (cx, cy) = (x.round() as i32, y.round() as i32);
        if cx < 0 || cy < 0 || cx >= self.width as i32 || cy >= self.height as i32 {
            return None;
        }
        let mut least = f32::INFINITY;
        for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
            let (px, py) = (cx + dx, cy + dy);
            if px < 0 || py < 0 || px >= self.width as i32 || py >= self.height as i32 {
                continue;
            }
            least = least.min(self.inv_z[py as usize * self.width + px as usize]);
        }
        Some(least)
    }
}

/// Perspective-correct weights of the three corners at a sample.
pub fn weights(c: [Projected; 3], x: f32, y: f32) -> Vec3 {
    let p = Projected { x, y, inv_z: 0.0 };
    let area = cross(c[0], c[1], c[2]);
    let w0 = cross(c[1], c[2], p) / area;
    let w1 = cross(c[2], c[0], p) / area;
    let w = Vec3::new(
        w0 * c[0].inv_z,
        w1 * c[1].inv_z,
        (1.0 - w0 - w1) * c[2].inv_z,
    );
    let w = w / (w.x + w.y + w.z);
    // The tolerance at the edges must not extrapolate.
    w.clamp(Vec3::ZERO, Vec3::ONE)
}

/// Twice the signed area of a, b, c.
fn cross(a: Projected, b: Projected, c: Projected) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The whole numbers covered by three values within `0..len`.
fn bounds(v: [f32; 3], len: usize) -> (i32, i32) {
    let low = v[0].min(v[1]).min(v[2]).ceil().max(0.0);
    let high = v[0].max(v[1]).max(v[2]).floor().min(len as f32 - 1.0);
    (low as i32, high as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f32) -> [Projected; 4] {
        [(2., 2.), (12., 2.), (12., 12.), (2., 12.)].map(|(x, y)| Projected {
            x,
            y,
            inv_z: 1.0 / z,
        })
    }
    /// Negative area with y down: facing the camera.
    const FACING: [[u32; 3]; 2] = [[0, 2, 1], [0, 3, 2]];

    #[test]
    fn nearer_surface_wins_in_either_order() {
        for flip in [false, true] {
            let mut target = Target::new(16, 16);
            let mut layers = [(square(100.), 0), (square(50.), 10)];
            if flip {
                layers.reverse();
            }
            for (vertices, base) in &layers {
                target.draw(vertices, &FACING, *base, Cull::Back);
            }
            let at = |x: usize, y: usize| target.id[y * 16 + x];
            assert!((10..12).contains(&at(7, 7)));
            assert_eq!(at(0, 0), EMPTY);
            assert_eq!(at(14, 7), EMPTY);
        }
    }

    #[test]
    fn back_faces_are_culled() {
        let mut target = Target::new(16, 16);
        target.draw(&square(50.), &[[0, 1, 2]], 0, Cull::Back);
        assert!(target.id.iter().all(|&i| i == EMPTY));
        target.draw(&square(50.), &[[0, 1, 2]], 0, Cull::None);
        assert!(target.id.contains(&0));
    }

    #[test]
    fn weights_follow_perspective() {
        let mut c = [square(100.)[0], square(100.)[1], square(100.)[3]];
        c[1].inv_z = 1.0 / 300.0;
        // Halfway on the screen between z = 100 and z = 300 is a quarter of the way along.
        let w = weights(c, 7.0, 2.0);
        assert!((w.y - 0.25).abs() < 1e-4, "{w}");
    }
}
