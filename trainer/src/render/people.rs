//! Who can be rendered: procedural people, made when first needed, and photographed ones.

use super::mesh::Mesh;
use super::skin::{Features, Looks, Painted, paint};
use super::texture::TexelMap;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::{Arc, OnceLock};

/// A textured person.
pub struct Person {
    /// Procedural people count down from `u32::MAX`.
    pub id: u32,
    /// Skin and hair.
    pub painted: Painted,
    /// Identity weights; empty where any head fits.
    pub identity: Vec<f32>,
    /// Iris albedo.
    pub iris: f32,
    /// Skin albedo.
    pub skin: f32,
    /// Albedo of the clothes.
    pub cloth: f32,
}

/// Which people a sample may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Persons {
    /// Any.
    All,
    /// Procedural ones only.
    Procedural,
    /// Photographed ones only (procedural if there are none).
    Photographed,
}

/// All the people.
pub struct People {
    map: TexelMap,
    features: Features,
    seed: u64,
    procedural: Vec<OnceLock<Arc<Person>>>,
    photographed: Vec<Arc<Person>>,
}

impl People {
    /// So many procedural people of a seed, and photographed ones.
    pub fn new(mesh: &Mesh, procedural: usize, photographed: Vec<Person>, seed: u64) -> People {
        let map = TexelMap::new(mesh);
        People {
            features: Features::new(mesh, &map),
            map,
            seed,
            procedural: (0..procedural.max(1)).map(|_| OnceLock::new()).collect(),
            photographed: photographed.into_iter().map(Arc::new).collect(),
        }
    }

    /// A random person.
    pub fn pick(&self, rng: &mut ChaCha8Rng, mesh: &Mesh, persons: Persons) -> Arc<Person> {
        let photographed = match persons {
            Persons::All => rng.random_bool(0.6),
            Persons::Procedural => false,
            Persons::Photographed => true,
        };
        if photographed && !self.photographed.is_empty() {
            return self.photographed[rng.random_range(0..self.photographed.len())].clone();
        }
        self.procedural(mesh, rng.random_range(0..self.procedural.len()))
    }

    /// A procedural person by number.
    pub fn procedural(&self, mesh: &Mesh, number: usize) -> Arc<Person> {
        self.procedural[number]
            .get_or_init(|| {
                let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
                rng.set_stream(number as u64);
                Arc::new(self.make(mesh, u32::MAX - number as u32, &Looks::random(&mut rng)))
            })
            .clone()
    }

    /// A procedural person of given looks.
    pub fn make(&self, mesh: &Mesh, id: u32, looks: &Looks) -> Person {
        Person {
            id,
            painted: paint(mesh, &self.map, &self.features, looks),
            identity: Vec::new(),
            iris: looks.iris,
            skin: looks.skin,
            cloth: looks.cloth,
        }
    }
}
