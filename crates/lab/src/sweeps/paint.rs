//! Albedo of Candide-3's surface: the features of a face drawn along its landmarks.

use super::body::grain;
use glam::{Vec2, Vec3};
use posewise_train::render::noise::{noise, smoothstep};
use posewise_train::render::skin::Looks;

/// Draws on the mean head.
pub struct Painter<'a> {
    looks: &'a Looks,
    /// Landmarks in the frontal view \[mm\].
    front: Vec<Vec2>,
}

impl<'a> Painter<'a> {
    /// For a head with these landmarks.
    pub fn new(looks: &'a Looks, landmarks: &[Vec3]) -> Painter<'a> {
        Painter {
            looks,
            front: landmarks.iter().map(|p| p.truncate()).collect(),
        }
    }

    /// Albedo of a point of the mean head.
    pub fn albedo(&self, p: Vec3) -> f32 {
        let looks = self.looks;
        let at = p.truncate();
        let blotches = 1.0 + looks.blotches * 0.2 * grain(0.6 * p, looks.seed);
        let mut value = looks.skin * blotches;
        let socket =
            (-(Vec2::new(at.x.abs(), at.y) - Vec2::new(30.0, 2.0)).length_squared() / 350.0).exp();
        value *= 1.0 - 0.2 * socket;
        for nostril in [32, 34] {
            let d = (at - self.front[nostril] + Vec2::new(0.0, 1.0)).length();
            value *= 1.0 - 0.8 * smoothstep(4.0, 1.5, d);
        }
        let lips = smoothstep(-0.7, 0.7, self.inside(at, 48..60));
        value *= 1.0 - (1.0 - looks.lips) * lips;
        let open = smoothstep(-0.4, 0.4, self.inside(at, 60..68));
        value += (0.02 - value) * open;
        for brow in [17..22, 22..27] {
            let line: Vec<usize> = brow.collect();
            let half = looks.brow.1 * (1.0 + 0.3 * noise(p * 0.8, looks.seed ^ 21));
            let dark = smoothstep(1.2 * half, 0.5 * half, self.distance(at, &line));
            value *= 1.0 - (1.0 - looks.brow.0) * dark;
        }
        for eye in [36..42, 42..48] {
            value = self.eye(value, at, eye);
        }
        let hair = smoothstep(-3.0, 3.0, looks.hair_depth(p, false));
        value + (looks.hair_albedo(p) - value) * hair
    }

    /// Sclera, iris, pupil and lashes over what is below.
    fn eye(&self, skin: f32, at: Vec2, eye: std::ops::Range<usize>) -> f32 {
        let middle = self.front[eye.clone()].iter().sum::<Vec2>() / 6.0;
        let out = (at - middle).length();
        let iris = self.looks.iris + (0.01 - self.looks.iris) * smoothstep(2.8, 2.0, out);
        let white = 0.28 + 0.35 * self.looks.skin;
        let ball = white + (iris - white) * smoothstep(6.2, 5.4, out);
        let inside = self.inside(at, eye.clone());
        let open = skin + (ball - skin) * smoothstep(-0.5, 0.5, inside);
        // The upper lid's margin: both corners and the two points between them.
        let upper: Vec<usize> = eye.take(4).collect();
        let lashes = smoothstep(1.6, 0.4, self.distance(at, &upper));
        open * (1.0 - 0.7 * self.looks.lashes * lashes)
    }

    /// Distance \[mm\] to the line through landmarks.
    fn distance(&self, at: Vec2, line: &[usize]) -> f32 {
        let to = |pair: &[usize]| segment(at, self.front[pair[0]], self.front[pair[1]]);
        line.windows(2).map(to).fold(f32::INFINITY, f32::min)
    }

    /// Signed distance \[mm\] inside the polygon of landmarks.
    fn inside(&self, at: Vec2, landmarks: std::ops::Range<usize>) -> f32 {
        let corners = &self.front[landmarks];
        let (mut odd, mut nearest) = (false, f32::INFINITY);
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let crosses = (a.y > at.y) != (b.y > at.y);
            if crosses && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                odd = !odd;
            }
            nearest = nearest.min(segment(at, a, b));
        }
        if odd { nearest } else { -nearest }
    }
}

fn segment(at: Vec2, a: Vec2, b: Vec2) -> f32 {
    let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
    (at - a.lerp(b, t)).length()
}
