//! Pictures to make tiles of: faces with their boxes, and pictures without people.

use super::faces::Face;
use crate::picture::Picture;
use posewise::detect::Detection;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// What a picture shows around its face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A photograph with its surroundings, in which other people may be seen.
    Photograph,
    /// A photograph cropped tightly.
    Crop,
    /// The same, mostly of a face in profile, of which one half was labelled.
    HalfLabelled,
    /// A render: one face before a picture without people.
    Render,
}

/// A face with its picture at decreasing resolutions, each half of the one before.
pub struct Source {
    pub kind: Kind,
    pub truth: Detection,
    pub levels: Vec<Picture>,
}

/// A group of faces and how often one of them is drawn.
struct Group {
    share: f64,
    /// Numbers of faces.
    faces: Vec<usize>,
}

/// Everything that tiles are made of.
pub struct Pictures {
    faces: Vec<Source>,
    groups: Vec<Group>,
    backgrounds: Vec<Vec<Picture>>,
}

/// Shares of photographs, crops, half labelled faces, and renders by |yaw|, which is divided at
/// [`YAWS`]. Profiles are drawn often because most photographs hardly show them.
const SHARES: [f64; 6] = [26.0, 16.0, 14.0, 14.0, 10.0, 20.0];
/// \[90°\].
const YAWS: [f32; 2] = [0.5, 0.722];
/// Most levels of a picture, and the smallest side of one that is halved \[px\].
const LEVELS: usize = 5;
const HALVED_PX: u32 = 40;

/// A picture at decreasing resolutions.
fn levels(picture: Picture) -> Vec<Picture> {
    let mut all = vec![picture];
    while all.len() < LEVELS && all[all.len() - 1].size.iter().all(|s| *s >= HALVED_PX) {
        all.push(all[all.len() - 1].halved());
    }
    all
}

impl Pictures {
    /// Of these faces and pictures without people. Where there are no photographs, renders from the
    /// front are drawn in their place.
    pub fn new(faces: Vec<(Kind, Face)>, backgrounds: Vec<Picture>) -> Pictures {
        let faces: Vec<Source> = faces
            .into_par_iter()
            .map(|(kind, face)| Source {
                kind,
                truth: face.truth,
                levels: levels(face.picture),
            })
            .collect();
        let mut groups = SHARES.map(|share| Group {
            share,
            faces: vec![],
        });
        for (k, face) in faces.iter().enumerate() {
            let beyond = YAWS.iter().filter(|y| face.truth.yaw.abs() > **y).count();
            let group = match face.kind {
                Kind::Photograph => 0,
                Kind::Crop => 1,
                Kind::HalfLabelled => 2,
                Kind::Render => 3 + beyond,
            };
            groups[group].faces.push(k);
        }
        // In place of frontal photographs renders from the front, of profiles those in profile.
        for (photographs, renders) in [(0, 3), (1, 3), (2, 5)] {
            if groups[photographs].faces.is_empty() {
                groups[renders].share += SHARES[photographs];
            }
        }
        let mut groups = Vec::from(groups);
        groups.retain(|group| !group.faces.is_empty());
        Pictures {
            faces,
            groups,
            backgrounds: backgrounds.into_par_iter().map(levels).collect(),
        }
    }

    /// Number of faces and of pictures without people.
    pub fn count(&self) -> [usize; 2] {
        [self.faces.len(), self.backgrounds.len()]
    }

    /// A random face.
    pub fn face(&self, rng: &mut ChaCha8Rng) -> &Source {
        let all: f64 = self.groups.iter().map(|g| g.share).sum();
        let mut at = rng.random_range(0.0..all);
        let chosen = self.groups.iter().find(|group| {
            at -= group.share;
            at < 0.0
        });
        let group = chosen.unwrap_or(&self.groups[0]);
        &self.faces[group.faces[rng.random_range(0..group.faces.len())]]
    }

    /// A random picture without people.
    pub fn background(&self, rng: &mut ChaCha8Rng) -> &[Picture] {
        &self.backgrounds[rng.random_range(0..self.backgrounds.len())]
    }

    /// All of them.
    pub fn backgrounds(&self) -> impl Iterator<Item = &Picture> {
        self.backgrounds.iter().filter_map(|levels| levels.first())
    }
}
