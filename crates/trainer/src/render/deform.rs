//! Smooth deformations of a head beyond what the morphable model spans, so that networks do not
//! learn its few hundred heads by heart: size along each axis, nose, chin, back of the head, and
//! waves over the whole. All are symmetric: an asymmetric one could not be told from a turn.

use super::mesh::Mesh;
use super::noise::normal;
use glam::Vec3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Deviations of the logarithm of the size across, down and along the depth.
const LOG_SIZE: Vec3 = Vec3::new(0.035, 0.035, 0.06);
/// Deviation of a bump's push \[mm\].
const BUMP_MM: f32 = 3.5;
/// Waves, the deviation of each one's displacement \[mm\], and the range of their lengths \[mm\].
const WAVES: usize = 5;
const WAVE_MM: f32 = 0.9;
const WAVE_LENGTHS_MM: (f32, f32) = (70.0, 200.0);
/// Behind this depth in the head a vertex belongs to the back of the head \[mm\].
const BACK_MM: f32 = 60.0;

/// Pushes the vertices near a point.
struct Bump {
    at: Vec3,
    radius_mm: f32,
    push: Vec3,
}

struct Wave {
    /// \[rad/mm\]
    number: Vec3,
    phase: f32,
    push: Vec3,
}

/// One random deformation.
pub struct Deformation {
    size: Vec3,
    bumps: Vec<Bump>,
    waves: Vec<Wave>,
    /// Of the back of the head, along the depth.
    back: f32,
}

impl Deformation {
    /// A random one of this strength: 1 is what procedural people get.
    pub fn random(rng: &mut ChaCha8Rng, mesh: &Mesh, strength: f32) -> Deformation {
        let at = |landmark: usize| mesh.mean[mesh.landmarks[landmark] as usize];
        let vector = |rng: &mut ChaCha8Rng| Vec3::from_array([0; 3].map(|_| normal(rng)));
        let log_size = strength * LOG_SIZE * vector(rng);
        // Tip of the nose, bridge, chin, angles of the jaw, brows, cheekbones.
        let bumps = [
            (30, 24.0),
            (28, 22.0),
            (8, 34.0),
            (4, 34.0),
            (19, 26.0),
            (1, 36.0),
        ];
        let bumps = bumps.map(|(landmark, radius_mm)| Bump {
            at: at(landmark),
            radius_mm,
            push: strength * BUMP_MM * vector(rng),
        });
        let waves = (0..WAVES).map(|_| {
            let length = rng.random_range(WAVE_LENGTHS_MM.0..WAVE_LENGTHS_MM.1);
            Wave {
                number: std::f32::consts::TAU / length * vector(rng).normalize_or(Vec3::Y),
                phase: rng.random_range(0.0..std::f32::consts::TAU),
                push: strength * WAVE_MM * vector(rng),
            }
        });
        Deformation {
            size: Vec3::from_array(log_size.to_array().map(f32::exp)),
            waves: waves.collect(),
            bumps: bumps.into(),
            back: strength * 0.08 * normal(rng),
        }
    }

    /// Moves a vertex (head axes).
    pub fn apply(&self, v: Vec3) -> Vec3 {
        let mirrored = Vec3::new(-v.x, v.y, v.z);
        let (own, other) = (self.push(v), self.push(mirrored));
        let other = Vec3::new(-other.x, other.y, other.z);
        let mut moved = (v + 0.5 * (own + other)) * self.size;
        moved.z += self.back * (v.z - BACK_MM).max(0.0);
        moved
    }

    fn push(&self, v: Vec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for wave in &self.waves {
            sum += wave.push * (wave.number.dot(v) + wave.phase).sin();
        }
        for bump in &self.bumps {
            // Twice: the mean of both sides halves what lies on one.
            let square = (v - bump.at).length_squared() / bump.radius_mm.powi(2);
            let middle = if bump.at.x.abs() < 5.0 { 1.0 } else { 2.0 };
            sum += middle * bump.push * (-square).exp();
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn both_sides_move_alike() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let deformation = Deformation {
            size: Vec3::new(1.1, 0.9, 1.0),
            bumps: vec![Bump {
                at: Vec3::new(20.0, 0.0, 0.0),
                radius_mm: 25.0,
                push: Vec3::new(2.0, 1.0, -3.0),
            }],
            waves: vec![Wave {
                number: Vec3::new(0.03, 0.02, -0.01),
                phase: 1.0,
                push: Vec3::new(1.0, -1.0, 0.5),
            }],
            back: 0.05,
        };
        for _ in 0..20 {
            let v = Vec3::from_array([0; 3].map(|_| 80.0 * normal(&mut rng)));
            let a = deformation.apply(v);
            let b = deformation.apply(Vec3::new(-v.x, v.y, v.z));
            assert!((a - Vec3::new(-b.x, b.y, b.z)).length() < 1e-3);
        }
    }
}
