//! Who can be rendered: procedural people, made when first needed, and photographed ones.

use super::mesh::Mesh;
use super::person::Person;
use super::photo::Photographer;
use super::skin::{Features, Looks, paint};
use super::texture::TexelMap;
use crate::fit::PhotoFit;
use crate::head::Head;
use anyhow::{Context, Result};
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use posewise::math::head_angles;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Which people a sample may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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
    /// Whether lids are painted in detail.
    near: bool,
    procedural: Vec<OnceLock<Arc<Person>>>,
    photographed: Vec<Arc<Person>>,
}

impl People {
    /// So many procedural people of a seed, and photographed ones.
    pub fn new(mesh: &Mesh, procedural: usize, seed: u64, near: bool) -> People {
        let map = TexelMap::new(mesh);
        People {
            features: Features::new(mesh, &map),
            map,
            seed,
            near,
            procedural: (0..procedural.max(1)).map(|_| OnceLock::new()).collect(),
            photographed: Vec::new(),
        }
    }

    /// Adds people from fitted photographs below `data`: of each person at most `per_person`
    /// pictures, those that show most of the face.
    pub fn add_photographs(
        &mut self,
        head: &Head,
        mesh: &Mesh,
        fits: &[PhotoFit],
        data: &Path,
        per_person: usize,
    ) -> Result<()> {
        let photographer = Photographer {
            head,
            mesh,
            map: &self.map,
            features: &self.features,
            near: self.near,
        };
        let chosen = choose(fits, per_person);
        let style = ProgressStyle::with_template("skins  {bar:40} {pos}/{len} eta {eta}")?;
        let bar = ProgressBar::new(chosen.len() as u64).with_style(style);
        let made: Vec<Option<Person>> = chosen
            .into_par_iter()
            .progress_with(bar)
            .map(|(id, fit)| {
                let path = data.join(&fit.image);
                let photo = image::open(&path).with_context(|| path.display().to_string())?;
                Ok(photographer.person(id, fit, &photo.to_luma8(), self.seed))
            })
            .collect::<Result<_>>()?;
        self.photographed
            .extend(made.into_iter().flatten().map(Arc::new));
        Ok(())
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
                let mut looks = Looks::random(&mut rng);
                if self.near {
                    looks.come_near(&mut rng);
                }
                Arc::new(self.make(mesh, u32::MAX - number as u32, &looks))
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
            hair: (looks.hair_mm > 0.0).then_some(looks.hair),
            cloth: looks.cloth,
        }
    }
}

/// Most people whose skins are taken from photographs; each costs about 0.2 s.
const MOST_PHOTOGRAPHED: usize = 500;

/// The best pictures of each person, with the person's number. Of more people than
/// [`MOST_PHOTOGRAPHED`], every n-th by name.
fn choose(fits: &[PhotoFit], per_person: usize) -> Vec<(u32, &PhotoFit)> {
    let mut by_name: BTreeMap<&str, Vec<&PhotoFit>> = BTreeMap::new();
    for fit in fits {
        by_name.entry(&fit.person).or_default().push(fit);
    }
    // Turned heads show less; a bad fit smears.
    let cost = |fit: &PhotoFit| {
        let turned = head_angles(&fit.pose().rotation).yaw_deg.abs() / 90.0;
        turned + 8.0 * fit.error
    };
    let mut chosen = Vec::new();
    let every = by_name.len().div_ceil(MOST_PHOTOGRAPHED).max(1);
    for (id, mut of) in (0..).zip(by_name.into_values().step_by(every)) {
        of.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        chosen.extend(of.into_iter().take(per_person).map(|fit| (id, fit)));
    }
    chosen
}
