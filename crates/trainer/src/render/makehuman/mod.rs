//! MakeHuman's heads as a second family beside the morphable head: people of any age, with skins,
//! hair, brows, lashes, eyes and teeth of their own.
//!
//! They are turned and scaled so that a mean adult agrees with the morphable head's mean: the same
//! angles mean the same pose in both, and what is worn fits both.

mod body;
mod kin;
mod proxy;
mod skins;

use super::contour::Landmarker;
use super::draw::Prop;
use super::mesh::Mesh;
use super::person::Person;
use super::skin::{Features, Looks, Painted, paint_over, push};
use super::texture::{TexelMap, Texture};
use crate::head::MakeHuman;
use crate::picture::Picture;
use anyhow::Result;
use glam::{Mat3, Vec3};
pub use kin::Groups;
use kin::Kin;
use proxy::Proxy;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use skins::Skin;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Numbers of these people count down from here.
const FIRST_ID: u32 = u32::MAX / 2;

/// One of them.
pub struct Member {
    /// Skin, iris and clothes.
    pub person: Person,
    kin: Kin,
    /// Places in the lists of meshes, and albedo.
    hair: Option<(usize, f32)>,
    brows: Option<(usize, f32)>,
    lashes: Option<usize>,
    /// Seed of all that is worn.
    dense: f32,
}

impl Member {
    /// Groups that they belong to.
    pub fn groups(&self) -> Groups {
        self.kin.groups(self.person.skin)
    }
}

/// The heads and everything that belongs to them.
pub struct Family {
    data: MakeHuman,
    /// The mean adult.
    pub mesh: Mesh,
    /// Finds the 68 points.
    pub landmarker: Landmarker,
    /// From MakeHuman's axes to the morphable head's, with the factor of the size.
    turn: Mat3,
    map: TexelMap,
    features: Features,
    skins: Vec<Skin>,
    hair: Vec<Proxy>,
    brows: Vec<Proxy>,
    lashes: Vec<Proxy>,
    seed: u64,
    near: bool,
    members: Vec<OnceLock<Arc<Member>>>,
}

impl Family {
    /// Reads the folder, for `people` people of a seed. `morphable` says what an angle of 0 is, and
    /// `moved_mm` how far photographs' labels sit from where the convention has them.
    pub fn load(
        folder: &Path,
        morphable: &Mesh,
        moved_mm: &[Vec3],
        people: usize,
        seed: u64,
        near: bool,
    ) -> Result<Family> {
        let mut data = MakeHuman::load(folder)?;
        let turn = body::alignment(&data, morphable);
        data.turn(turn);
        let mesh = body::mesh(&data, folder)?;
        let map = TexelMap::new(&mesh);
        let proxies = |name: &str| -> Result<Vec<Proxy>> {
            let paths = Picture::list(&folder.join(name))?;
            let proxies = paths.iter().map(|path| Proxy::load(path, &mesh));
            proxies.collect()
        };
        let offsets = body::offsets_mm(&mesh, moved_mm);
        Ok(Family {
            landmarker: Landmarker::new(&mesh, &offsets).levelled(&mesh),
            features: Features::new(&mesh, &map),
            skins: skins::load(&folder.join("skins"), &data, &mesh, &map)?,
            hair: proxies("hair")?,
            brows: proxies("brows")?,
            lashes: proxies("lashes")?,
            data,
            mesh,
            turn,
            map,
            seed,
            near,
            members: (0..people.max(1)).map(|_| OnceLock::new()).collect(),
        })
    }

    /// A random member.
    pub fn pick(&self, rng: &mut ChaCha8Rng) -> Arc<Member> {
        self.member(rng.random_range(0..self.members.len()))
    }

    /// A member by number.
    pub fn member(&self, number: usize) -> Arc<Member> {
        let make = || Arc::new(self.make(number));
        self.members[number].get_or_init(make).clone()
    }

    fn make(&self, number: usize) -> Member {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream((1 << 40) + number as u64);
        let rng = &mut rng;
        let kin = Kin::random(rng, &self.data);
        let skin = &self.skins[skins::choose(rng, &self.skins, &kin)];
        let mut looks = Looks::random(rng);
        looks.skin = skin.tone(rng);
        if self.near {
            looks.come_near(rng);
        }
        self.suit(rng, &mut looks, &kin);
        let hair = self.choose_hair(rng, &kin, &mut looks);
        let painted_brows = rng.random_bool(0.25);
        let brows = (!painted_brows && rng.random_bool(0.97)).then(|| {
            looks.brow.0 = 1.0;
            let tone = looks.hair.min(0.6 * looks.skin) * rng.random_range(0.5..1.1);
            (rng.random_range(0..self.brows.len()), tone)
        });
        let lashes = rng.random_bool(0.85).then(|| {
            looks.lashes *= 0.4;
            rng.random_range(0..self.lashes.len())
        });
        let bare = skin.over(&looks);
        let albedo = paint_over(&self.mesh, &self.map, &self.features, &looks, bare);
        let push_mm = match hair {
            Some(_) => Vec::new(),
            None => push(&self.mesh, &looks),
        };
        Member {
            person: Person {
                id: FIRST_ID - number as u32,
                painted: Painted {
                    texture: Texture::new(&self.map, &albedo),
                    push_mm,
                },
                identity: Vec::new(),
                iris: looks.iris,
                skin: looks.skin,
                hair: (hair.is_none() && looks.hair_mm > 0.0).then_some(looks.hair),
                cloth: looks.cloth,
            },
            kin,
            hair,
            brows,
            lashes,
            dense: rng.random_range(0.6..1.2),
        }
    }

    /// Makes random looks those of an age and a sex.
    fn suit(&self, rng: &mut ChaCha8Rng, looks: &mut Looks, kin: &Kin) {
        if kin.is_child() || !kin.male {
            looks.beard = 0.0;
        }
        if looks.skin < 0.17 {
            looks.hair = looks.hair.min(0.06);
        }
        if kin.is_old() && rng.random_bool(0.7) {
            looks.hair = rng.random_range(0.2..0.6);
        }
        // The skin has lips of its own, made up or not.
        let made_up = !kin.male && !kin.is_child() && rng.random_bool(0.3);
        looks.lips = match made_up {
            true => rng.random_range(0.4..0.9),
            false => rng.random_range(0.9..1.05),
        };
        looks.blotches *= 0.6;
        looks.iris = rng.random_range(0.02..0.2);
    }

    /// A mesh of hair and its tone, or hair that is painted and stands off, or none.
    fn choose_hair(
        &self,
        rng: &mut ChaCha8Rng,
        kin: &Kin,
        looks: &mut Looks,
    ) -> Option<(usize, f32)> {
        let bald = kin.male && !kin.is_child() && rng.random_bool(0.18);
        if bald {
            looks.hair_mm = 0.0;
            return None;
        }
        if rng.random_bool(0.3) {
            looks.hair_mm = looks.hair_mm.max(3.0);
            return None;
        }
        let short = |name: &str| name.starts_with("short") || name.starts_with("afro");
        let share = if kin.male { 0.92 } else { 0.2 };
        let want_short = rng.random_bool(share);
        let fits: Vec<usize> = (0..self.hair.len())
            .filter(|at| short(&self.hair[*at].name) == want_short)
            .collect();
        // Below it the scalp is as dark as the hair.
        looks.hairline_mm = rng.random_range(76.0..90.0);
        looks.hair_mm = 1.0;
        Some((fits[rng.random_range(0..fits.len())], looks.hair))
    }

    /// A neutral head of a member; the same member has other details in every sample.
    pub fn neutral(&self, rng: &mut ChaCha8Rng, member: &Member, strength: f32) -> Vec<Vec3> {
        let details = kin::details(rng, &self.data, strength);
        let kin = &member.kin;
        let mut head = self.data.mixed(&kin.macros, &kin.bodies, &details);
        head.resize(self.mesh.mean.len(), Vec3::ZERO);
        self.mesh.settle(&mut head);
        head
    }

    /// A mesh of hair on a head (head axes).
    pub fn hair(&self, member: &Member, head: &[Vec3]) -> Option<Prop> {
        let gloss = 0.12;
        let (at, tone) = member.hair?;
        Some(self.hair[at].prop(head, self.turn, tone, 1.0, gloss))
    }

    /// Brows and lashes on a head (head axes).
    pub fn strands(&self, member: &Member, head: &[Vec3]) -> Vec<Prop> {
        let brows = member.brows.map(|(at, tone)| {
            let mut prop = self.brows[at].prop(head, self.turn, tone, member.dense, 0.0);
            prop.lies_on_skin(1.2);
            prop
        });
        let lashes = member.lashes.map(|at| {
            let mut prop = self.lashes[at].prop(head, self.turn, 0.02, 1.0, 0.0);
            prop.lies_on_skin(0.6);
            prop
        });
        brows.into_iter().chain(lashes).collect()
    }

    /// How tall a head is between eyes and chin, against the mean adult's.
    pub fn size(&self, head: &[Vec3]) -> f32 {
        let chin = self.mesh.landmarks[8] as usize;
        head[chin].y / self.mesh.mean[chin].y
    }
}

impl Prop {
    fn lies_on_skin(&mut self, nearer_mm: f32) {
        if let Some(strands) = &mut self.strands {
            strands.nearer_mm = nearer_mm;
        }
    }
}
