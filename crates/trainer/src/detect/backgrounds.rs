//! Pictures without people: photographs and synthetic ones.

use std::collections::HashSet;
use std::path::Path;

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::options::rng_for;
use crate::picture::Picture;
use crate::render::{background, dead_leaves};

/// The usable photographs, in the order of their names, without every fifth.
///
/// # Errors
/// When a file cannot be read.
pub fn load(data: &Path) -> Result<Vec<Picture>> {
    usable(data, |i| i % 5 != 4)
}

/// Every fifth, not used in training: false positives can be measured on them.
///
/// # Errors
/// When a file cannot be read.
pub fn held_out(data: &Path) -> Result<Vec<Picture>> {
    usable(data, |i| i % 5 == 4)
}

fn usable(data: &Path, wanted: impl Fn(usize) -> bool + Sync) -> Result<Vec<Picture>> {
    let folder = data.join("backgrounds");
    let listed = std::fs::read_to_string(folder.join("with-people.txt"))
        .context("backgrounds/with-people.txt")?;
    let people: HashSet<&str> = listed.lines().map(str::trim).collect();
    let mut paths = Picture::list(&folder)?;
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        !people.contains(name.as_ref())
    });
    paths
        .par_iter()
        .enumerate()
        .filter(|(i, _)| wanted(*i))
        .map(|(_, path)| Picture::read(path))
        .collect()
}

/// Synthetic backgrounds, for a model that is trained without photographs.
pub fn made_up(seed: u64, count: u64) -> Vec<Picture> {
    const SIZE: [u32; 2] = [480, 320];
    (0..count)
        .into_par_iter()
        .map(|index| {
            let mut rng = rng_for(seed, 0x4D41_4445, index);
            let [width, height] = SIZE;
            // Few plain rooms and skies: hardly any of their windows pass the first trees.
            let make = match index % 6 {
                0 => background::procedural,
                _ => dead_leaves::scene,
            };
            let light = make(&mut rng, width as usize, height as usize);
            let level = |l: f32| (255.0 * l.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8;
            Picture {
                size: SIZE,
                luma: light.into_iter().map(level).collect(),
            }
        })
        .collect()
}
