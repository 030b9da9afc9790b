//! The photographs that models train on and are measured on: tables of labels with their pictures.
//!
//! All labels are in the convention of the 300-W challenge (Sagonas et al., 2013). Those of
//! [`MANUAL`], [`MANUAL_MORE`] and [`PROFILES`] were made by people, the others by networks that
//! were mapped to the convention, with a spread.

use crate::labels::{self, Label};
use anyhow::Result;
use std::path::Path;

/// A set of labelled photographs below the data folder.
#[derive(Clone, Copy, Debug)]
pub struct Set {
    /// Its table of labels.
    pub table: &'static str,
    /// The folder that the table's file names are in.
    pub images: &'static str,
    /// How often a picture is drawn, against one of another set.
    pub share: f32,
    /// Pictures whose names begin so, and how often they are drawn, against another of the set.
    pub fewer: Option<(&'static str, f32)>,
    /// What its pictures show around the face.
    pub framing: Framing,
    /// Spread of the annotators at which a label counts half \[outer-eye distances\].
    pub half_weight_spread: f32,
    /// Whether people set the landmarks.
    pub by_people: bool,
    /// Which part of a file name tells the person.
    pub person: fn(&str) -> &str,
}

/// What a photograph shows around its face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// The head with its surroundings: the detector and the rendered skins need that.
    Whole,
    /// The head, with little around it.
    Tight,
    /// As [`Framing::Tight`]; only one half of the face is labelled.
    Half,
}

/// About the median spread of three networks. Chosen.
const NETWORKS_SPREAD: f32 = 0.02;

/// HELEN and AFW: 999 pictures with landmarks that people set.
pub const MANUAL: Set = Set {
    table: "faces300w/train.csv",
    images: "faces300w/train",
    share: 8.0,
    fewer: None,
    framing: Framing::Whole,
    half_weight_spread: NETWORKS_SPREAD,
    by_people: true,
    person: before_number,
};

/// The train set of LFPW: 805 pictures with landmarks that people set.
pub const MANUAL_MORE: Set = Set {
    table: "faces300w/lfpw.csv",
    images: "faces300w/lfpw",
    person: whole_name,
    ..MANUAL
};

/// Video frames of 245 people: 2,979 pictures, of which the same person's are much alike.
pub const VIDEO: Set = Set {
    table: "faces68/train-teacher.csv",
    images: "faces68/train",
    share: 2.0,
    by_people: false,
    ..MANUAL
};

/// Tight crops of some 11,000 people: 17,060 pictures.
pub const CROPS: Set = Set {
    table: "faces-many/labels.csv",
    images: "faces-many",
    share: 1.0,
    framing: Framing::Tight,
    by_people: false,
    ..MANUAL
};

/// Celebrities (CFP): 824 profiles and 412 frontal faces of 204 people, of which people marked one
/// half.
pub const PROFILES: Set = Set {
    table: "profiles/train.csv",
    images: "profiles/train",
    share: 6.0,
    framing: Framing::Half,
    person: between_underscores,
    ..MANUAL
};

/// Portraits in the public domain: 3,490 pictures of some 3,000 people. Their spread is how far
/// another network is from the one that labelled them: a bound that is three times as wide.
pub const PORTRAITS: Set = Set {
    table: "free/portraits.csv",
    images: "free/portraits",
    share: 3.0,
    // Drawings, plates and prints are among the old ones, and their labels err more.
    fewer: Some(("old_", 0.5)),
    half_weight_spread: 0.06,
    by_people: false,
    person: after_prefix,
    ..MANUAL
};

/// Pictures with manual landmarks that no training sees.
pub const DEV: Set = Set {
    table: "faces300w/dev.csv",
    images: "faces300w/dev",
    share: 1.0,
    ..MANUAL
};

impl Set {
    /// The labels; file names are relative to the data folder.
    pub fn labels(&self, data: &Path) -> Result<Vec<Label>> {
        let mut labels = labels::read(&data.join(self.table))?;
        for label in &mut labels {
            label.image = format!("{}/{}", self.images, label.image);
        }
        Ok(labels)
    }

    /// The person in a picture, as a name that is unlike that of any other set.
    pub fn person_in(&self, image: &str) -> String {
        format!("{}/{}", self.images, (self.person)(file_name(image)))
    }

    /// How often a picture is drawn.
    pub fn share_of(&self, image: &str) -> f32 {
        let fewer = (self.fewer).filter(|(prefix, _)| file_name(image).starts_with(prefix));
        self.share * fewer.map_or(1.0, |(_, share)| share)
    }
}

fn file_name(image: &str) -> &str {
    image.rsplit_once('/').map_or(image, |(_, name)| name)
}

/// Without its last number (`a_Jane_Roe_03.jpg`) and the leading letter.
fn before_number(name: &str) -> &str {
    let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
    match stem.split_once('_') {
        Some((prefix, rest)) if prefix.len() == 1 => rest,
        _ => stem,
    }
}

/// Each picture shows another person.
fn whole_name(name: &str) -> &str {
    name
}

/// `profile_017_02.jpg`: person 017.
fn between_underscores(name: &str) -> &str {
    name.split('_').nth(1).unwrap_or(name)
}

/// `new_A000022.jpg`: person A000022.
fn after_prefix(name: &str) -> &str {
    name.split_once('_').map_or(name, |(_, rest)| rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_people() {
        let person =
            |set: &Set, image: &str| set.person_in(image).rsplit_once('/').unwrap().1.to_owned();
        assert_eq!(person(&VIDEO, "a_Jane_Roe_03.jpg"), "Jane_Roe");
        assert_eq!(
            person(&CROPS, "faces-many/mux/Jane_Roe_0001.jpg"),
            "Jane_Roe"
        );
        assert_eq!(
            person(&PROFILES, "profiles/train/frontal_017_02.jpg"),
            "017"
        );
        assert_eq!(
            person(&PORTRAITS, "free/portraits/new_A000022.jpg"),
            "A000022.jpg"
        );
        let lfpw = ["1", "2"].map(|k| person(&MANUAL_MORE, &format!("lfpw_image_{k}.jpg")));
        assert_ne!(lfpw[0], lfpw[1]);
    }
}
