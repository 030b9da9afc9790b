//! Heads of the morphable model that no training sees: extreme coefficients, and smooth
//! deformations that the model does not have.

use crate::rigid::rotation_onto;
use glam::{Mat3, Vec3};
use posewise_train::render::expression::Expression;
use posewise_train::render::lids::Lids;
use posewise_train::render::mesh::{IDENTITIES, Mesh};
use posewise_train::render::noise::{fractal, noise, normal, smoothstep};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Coefficients that reach further than training's do, among the [`LEADING`] first ones.
const EXTREMES: std::ops::RangeInclusive<usize> = 3..=5;
const LEADING: usize = 12;
/// Depth of the skull's middle \[mm\].
const SKULL: Vec3 = Vec3::new(0.0, -20.0, 75.0);

/// A head's shape.
pub struct Body {
    identity: Vec<f32>,
    /// Displacement of each vertex \[mm\].
    moves: Vec<Vec3>,
    /// What takes off the rotation and the shift that the displacements have in common.
    turn: Mat3,
    shift: Vec3,
    /// Of a head whose eyes shut.
    lids: Option<Lids>,
}

impl Body {
    /// A random one.
    pub fn new(rng: &mut ChaCha8Rng, mesh: &Mesh) -> Body {
        let identity = identity(rng);
        let neutral = mesh.vertices(&identity, &[]);
        let field = Field::random(rng, mesh);
        let mut moves: Vec<Vec3> = mesh.mean.iter().map(|p| field.at(*p)).collect();
        // Eyeballs stay round.
        for eye in &mesh.eyes {
            let sum: Vec3 = eye.iter().map(|v| moves[*v as usize]).sum();
            let mean = sum / eye.len().max(1) as f32;
            eye.iter().for_each(|v| moves[*v as usize] = mean);
        }
        let at = |v: u32| neutral[v as usize];
        let landmarks = mesh.landmarks;
        let before: Vec<Vec3> = landmarks.iter().map(|v| at(*v)).collect();
        let moved = |v: u32| at(v) + moves[v as usize];
        let after: Vec<Vec3> = landmarks.iter().map(|v| moved(*v)).collect();
        let turn = rotation_onto(&after, &before);
        // The origin is midway between the eyeballs.
        let middle = |eye: &Vec<u32>| -> Vec3 {
            eye.iter().map(|v| turn * moved(*v)).sum::<Vec3>() / eye.len().max(1) as f32
        };
        let shift = -(middle(&mesh.eyes[0]) + middle(&mesh.eyes[1])) / 2.0;
        Body {
            identity,
            moves,
            turn,
            shift,
            lids: None,
        }
    }

    /// The same whose eyes a blink of 1 shuts.
    pub fn shutting(mut self, mesh: &Mesh) -> Body {
        self.lids = Some(Lids::new(mesh, |weights| self.weighted(mesh, weights)));
        self
    }

    /// Vertices \[mm, head axes\] with an expression.
    pub fn vertices(&self, mesh: &Mesh, face: &Expression) -> Vec<Vec3> {
        let mut weights = face.weights(mesh);
        let Some(lids) = &self.lids else {
            return self.weighted(mesh, &weights);
        };
        lids.shut(mesh, &mut weights);
        let mut head = self.weighted(mesh, &weights);
        lids.cover_eyeballs(mesh, &mut head);
        head
    }

    fn weighted(&self, mesh: &Mesh, weights: &[(usize, f32)]) -> Vec<Vec3> {
        let model = mesh.vertices(&self.identity, weights);
        let moved = model.iter().zip(&self.moves);
        moved
            .map(|(v, d)| self.turn * (*v + *d) + self.shift)
            .collect()
    }
}

/// Coefficients of which some are beyond two standard deviations; the others are scaled so that
/// the head as a whole is as unusual as a random one with deviations of 1 to 1.2.
fn identity(rng: &mut ChaCha8Rng) -> Vec<f32> {
    let mut all: Vec<f32> = (0..IDENTITIES).map(|_| normal(rng)).collect();
    let mut extreme = vec![false; IDENTITIES];
    for _ in 0..rng.random_range(EXTREMES) {
        let at = rng.random_range(0..LEADING);
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        all[at] = sign * rng.random_range(2.0..2.5f32);
        extreme[at] = true;
    }
    let squares = |which: bool| -> f32 {
        let chosen = all.iter().zip(&extreme).filter(|(_, e)| **e == which);
        chosen.map(|(w, _)| w * w).sum()
    };
    let wanted = IDENTITIES as f32 * rng.random_range(1.0..1.2f32).powi(2);
    let scale = ((wanted - squares(true)).max(4.0) / squares(false)).sqrt();
    for (w, _) in all.iter_mut().zip(&extreme).filter(|(_, e)| !**e) {
        *w = (*w * scale).clamp(-2.5, 2.5);
    }
    all
}

/// A smooth displacement of the mean head.
struct Field {
    seed: u32,
    /// Size \[mm\] and width \[mm\] of the random part.
    waves: (f32, f32),
    /// Stretch of the whole head along its axes.
    stretch: Vec3,
    /// Places, displacements and radii \[mm\]: nose, chin, brow, cheeks.
    bumps: Vec<(Vec3, Vec3, f32)>,
    skull: Vec3,
    neck: f32,
}

impl Field {
    fn random(rng: &mut ChaCha8Rng, mesh: &Mesh) -> Field {
        let mut signed = |size: f32| size * rng.random_range(-1.0..1.0f32);
        let at = |landmark: usize| mesh.mean[mesh.landmarks[landmark] as usize];
        let cheek = Vec3::new(0.0, signed(3.0), signed(4.0));
        let wide = signed(4.0);
        let bumps = vec![
            (at(30), Vec3::new(0.0, signed(4.0), signed(6.0)), 17.0),
            (at(27), Vec3::new(0.0, 0.0, signed(3.0)), 16.0),
            (at(8), Vec3::new(0.0, signed(6.0), signed(5.0)), 30.0),
            (at(41) + 20.0 * Vec3::Y, cheek - wide * Vec3::X, 26.0),
            (at(46) + 20.0 * Vec3::Y, cheek + wide * Vec3::X, 26.0),
        ];
        Field {
            stretch: Vec3::new(signed(0.04), signed(0.05), signed(0.07)),
            skull: Vec3::new(signed(0.08), signed(0.10), signed(0.12)),
            neck: signed(0.22),
            bumps,
            waves: (rng.random_range(1.5..4.0), rng.random_range(60.0..100.0)),
            seed: rng.random(),
        }
    }

    fn at(&self, p: Vec3) -> Vec3 {
        let (size, wide) = self.waves;
        let wave = |k: u32| size * noise(p / wide, self.seed.wrapping_add(k));
        let mut sum = Vec3::new(0.7 * wave(0), wave(1), wave(2)) + p * self.stretch;
        for (at, by, radius) in &self.bumps {
            sum += *by * (-(p - *at).length_squared() / (radius * radius)).exp();
        }
        let behind = smoothstep(25.0, 70.0, p.z) * smoothstep(60.0, 10.0, p.y);
        let above = smoothstep(-50.0, -90.0, p.y);
        sum += (p - SKULL) * self.skull * behind.max(above);
        // Below it the mesh spreads to the chest, which clothes cover.
        let neck = smoothstep(100.0, 140.0, p.y)
            * smoothstep(172.0, 150.0, p.y)
            * smoothstep(-10.0, 25.0, p.z);
        sum + Vec3::new(p.x, 0.0, p.z - 62.0) * self.neck * neck
    }
}

/// The frontmost depth of a head's surface over its frontal view.
pub struct Front {
    cells: Vec<f32>,
}

/// Of the cells of [`Front`] \[mm\], their first middle (x and y) and their number.
const CELL_MM: f32 = 6.0;
const FIRST_MM: (f32, f32) = (-126.0, -126.0);
const CELLS: (usize, usize) = (43, 56);
/// Where there is no head.
const BEHIND_MM: f32 = 70.0;

impl Front {
    /// Of vertices in head axes.
    pub fn new(vertices: &[Vec3]) -> Front {
        const NEAR_MM: f32 = 9.0;
        let mut cells = vec![BEHIND_MM; CELLS.0 * CELLS.1];
        for (n, cell) in cells.iter_mut().enumerate() {
            let x = FIRST_MM.0 + CELL_MM * (n % CELLS.0) as f32;
            let y = FIRST_MM.1 + CELL_MM * (n / CELLS.0) as f32;
            for v in vertices {
                if (v.x - x).hypot(v.y - y) < NEAR_MM {
                    *cell = cell.min(v.z);
                }
            }
        }
        Front { cells }
    }

    /// Depth at a place, smoothed.
    pub fn at(&self, x: f32, y: f32) -> f32 {
        let column = ((x - FIRST_MM.0) / CELL_MM).round() as i32;
        let row = ((y - FIRST_MM.1) / CELL_MM).round() as i32;
        let cell = |dx: i32, dy: i32| {
            let column = (column + dx).clamp(0, CELLS.0 as i32 - 1) as usize;
            let row = (row + dy).clamp(0, CELLS.1 as i32 - 1) as usize;
            self.cells[row * CELLS.0 + column]
        };
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let mean: f32 = around.map(|(dx, dy)| cell(dx, dy)).sum::<f32>() / 9.0;
        // Cloth spans hollows and lies on what stands out.
        mean.min(cell(0, 0))
    }
}

/// Irregular darkening of a surface, about −1..1.
pub fn grain(p: Vec3, seed: u32) -> f32 {
    fractal(p * 0.06, 3, seed)
}
