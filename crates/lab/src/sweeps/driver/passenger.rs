//! The person on the seat beside the driver.

use super::super::clip::{Set, Studio};
use super::super::plan::{Kind, Sweep};
use super::plan::Clip;
use super::script::{Script, What};
use anyhow::Result;
use glam::Vec3;
use rand::Rng;

/// Changes the stream of a clip's seed.
const OTHER: u64 = 0x7_0000;
/// How far the seats are apart \[mm\], and how much farther back the passenger sits.
const APART_MM: std::ops::Range<f32> = 430.0..560.0;
const BACK_MM: std::ops::Range<f32> = -40.0..200.0;
/// The tip of the nose among the landmarks.
const NOSE: usize = 30;

/// Someone with a script of their own, who sits still.
pub struct Passenger<'a> {
    set: Set<'a>,
    script: Script,
    behind: Vec<f32>,
}

impl<'a> Passenger<'a> {
    /// Beside a driver, who moves to the other side of the picture.
    pub fn beside(
        driver: &mut Set<'a>,
        studio: &'a Studio,
        clip: &Clip,
        sweep: &'a Sweep,
    ) -> Result<Passenger<'a>> {
        let mut set = Set::cast(studio, sweep)?;
        let side = if set.rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let apart = set.rng.random_range(APART_MM);
        driver.at.x = -side * 0.45 * apart;
        let back = set.rng.random_range(BACK_MM);
        set.at = driver.at + Vec3::new(side * apart, set.rng.random_range(-40.0..40.0), back);
        set.view = driver.view;
        set.lights = driver.lights.clone();
        let own = Clip {
            sweep: sweep.clone(),
            ..clip.clone()
        };
        let mut script = Script::new(&mut set.rng, &own);
        script.acts.retain(|act| act.what != What::Duck);
        Ok(Passenger {
            behind: driver.behind.clone(),
            set,
            script,
        })
    }

    /// Draws the passenger into what is behind the driver; returns the tip of the nose \[px\].
    pub fn draw_behind(&mut self, driver: &mut Set<'_>, t: f32) -> [f32; 2] {
        let moment = self.script.at(t);
        let figure = self.set.figure(&moment);
        self.set.behind.clone_from(&self.behind);
        driver.behind = self.set.drawn(&figure, &moment).light;
        self.set.landmarks(&figure).points[NOSE].to_array()
    }
}

/// The plan of the passenger of a clip.
pub fn sweep(clip: &Clip) -> Sweep {
    let (seed, stream) = clip.sweep.seed;
    Sweep {
        seed: (seed, stream + OTHER),
        kind: Kind::Driver(None),
        ..clip.sweep.clone()
    }
}
