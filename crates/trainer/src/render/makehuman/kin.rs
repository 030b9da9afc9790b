//! Random people: ethnicity, sex, age, build and details of the shape.

use crate::head::MakeHuman;
use crate::render::noise::normal;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

const PEOPLES: [&str; 3] = ["african", "asian", "caucasian"];
const SEXES: [&str; 2] = ["female", "male"];
const AGES: [&str; 4] = ["baby", "child", "young", "old"];

/// Deviation of a detail, in shares of its sensible range.
const DETAIL: f32 = 0.42;
/// The same of what makes both sides differ.
const ASYMMETRY: f32 = 0.2;

/// Groups that someone belongs to.
#[derive(Clone, Copy, Debug)]
pub struct Groups {
    /// What most of the shape is: african, asian or caucasian.
    pub people: &'static str,
    /// Female or male, by what prevails.
    pub sex: &'static str,
    /// Child, adult or old.
    pub age: &'static str,
    /// Albedo of the skin, 0..1.
    pub skin: f32,
}

/// What someone is a mixture of.
pub struct Kin {
    /// Places in the list of whole heads, and weights that sum to 1.
    pub macros: Vec<(usize, f32)>,
    /// Places in the list of builds, and weights.
    pub bodies: Vec<(usize, f32)>,
    /// Mostly male.
    pub male: bool,
    /// 0 a baby, 1 a child, 2 a young adult, 3 an old one.
    pub age: f32,
    /// Share of African, Asian and Caucasian shapes.
    pub peoples: [f32; 3],
}

impl Kin {
    /// A random mixture.
    pub fn random(rng: &mut ChaCha8Rng, data: &MakeHuman) -> Kin {
        let age = match rng.random_range(0..100) {
            0..2 => rng.random_range(0.3..1.0),
            2..14 => rng.random_range(1.0..2.0),
            14..70 => rng.random_range(2.0..2.65),
            _ => rng.random_range(2.5..3.0f32),
        };
        let main = rng.random_range(0..3);
        let mut peoples = [0.0f32; 3];
        peoples
            .iter_mut()
            .for_each(|p| *p = 0.3 * rng.random::<f32>().powi(2));
        peoples[main] += rng.random_range(0.6..1.0);
        let sum: f32 = peoples.iter().sum();
        let male = rng.random_bool(0.5);
        let other = 0.4 * rng.random::<f32>().powi(2);
        let sexes = if male {
            [other, 1.0 - other]
        } else {
            [1.0 - other, other]
        };
        let from = (age as usize).min(2);
        let ages = [
            (from, 1.0 - (age - from as f32)),
            (from + 1, age - from as f32),
        ];
        let place = |list: &[(String, _)], name: &str| list.iter().position(|(n, _)| n == name);
        let mut kin = Kin {
            macros: Vec::new(),
            bodies: Vec::new(),
            male,
            age,
            peoples: peoples.map(|p| p / sum),
        };
        let [weight, muscle] = [0.45, 0.4].map(|d| (d * normal(rng)).clamp(-1.0, 1.0));
        for (sex, w) in SEXES.iter().zip(sexes) {
            for (age, v) in ages {
                let age = AGES[age];
                for (people, u) in PEOPLES.iter().zip(kin.peoples) {
                    let at = place(&data.macros, &format!("{people}-{sex}-{age}"));
                    kin.macros.extend(at.map(|at| (at, u * v * w)));
                }
                for (value, name) in [(weight, "weight"), (muscle, "muscle")] {
                    let end = if value < 0.0 { "min" } else { "max" };
                    let name = format!("{sex}-{age}-{end}{name}");
                    let at = data.bodies.iter().position(|(n, _)| *n == name);
                    kin.bodies.extend(at.map(|at| (at, v * w * value.abs())));
                }
            }
        }
        kin.macros.retain(|(_, w)| *w > 0.0);
        kin
    }

    /// Groups of someone with this skin.
    pub fn groups(&self, skin: f32) -> Groups {
        let most = (0..PEOPLES.len()).max_by(|a, b| self.peoples[*a].total_cmp(&self.peoples[*b]));
        Groups {
            people: PEOPLES[most.unwrap_or(0)],
            sex: SEXES[usize::from(self.male)],
            age: match self {
                _ if self.is_child() => "child",
                _ if self.is_old() => "old",
                _ => "adult",
            },
            skin,
        }
    }

    /// Below about fourteen years.
    pub fn is_child(&self) -> bool {
        self.age < 1.6
    }

    /// Above about sixty years.
    pub fn is_old(&self) -> bool {
        self.age > 2.62
    }
}

/// Random values of all details; those of both sides are nearly the same.
pub fn details(rng: &mut ChaCha8Rng, data: &MakeHuman, strength: f32) -> Vec<f32> {
    let mut values: Vec<f32> = Vec::with_capacity(data.details.len());
    for detail in &data.details {
        let [low, high] = detail.range;
        let apart = detail.name.starts_with("asym");
        let deviation = strength * if apart { ASYMMETRY } else { DETAIL };
        let value = if low < 0.0 {
            deviation * normal(rng) * high
        } else if rng.random_bool(0.25) {
            strength * rng.random_range(0.0..0.7) * high
        } else {
            0.0
        };
        let other = detail.name.replacen("/l-", "/r-", 1);
        let right = (other != detail.name)
            .then(|| data.details.iter().position(|d| d.name == other))
            .flatten()
            .and_then(|at| values.get(at));
        let value = match right {
            Some(right) => right + 0.2 * value,
            None => value,
        };
        values.push(value.clamp(low, high));
    }
    values
}
