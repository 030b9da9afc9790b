//! The photographs that models train on and are measured on: tables of labels with their pictures.
//!
//! All labels are in the convention of the 300-W challenge (Sagonas et al., 2013). Those of
//! [`MANUAL`] were made by people; those of the other sets are means of three public networks that
//! were mapped to the convention, with the spread of the three.

use crate::faces::{self, Face};
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
}

/// HELEN and AFW: 999 pictures with landmarks that people set.
pub const MANUAL: Set = Set {
    table: "faces300w/train.csv",
    images: "faces300w/train",
    share: 8.0,
};

/// Video frames of 245 people: 2,979 pictures, of which the same person's are much alike.
pub const VIDEO: Set = Set {
    table: "faces68/train-teacher.csv",
    images: "faces68/train",
    share: 2.0,
};

/// Tight crops of some 11,000 people: 17,060 pictures.
pub const CROPS: Set = Set {
    table: "faces-many/labels.csv",
    images: "faces-many",
    share: 1.0,
};

/// All sets to train on.
pub const TRAINING: [Set; 3] = [MANUAL, VIDEO, CROPS];

/// Sets whose pictures show the face with what is around it: the detector and the rendered skins
/// need that.
pub const UNCROPPED: [Set; 2] = [MANUAL, VIDEO];

/// Pictures with manual landmarks that no training sees.
pub const DEV: Set = Set {
    table: "faces300w/dev.csv",
    images: "faces300w/dev",
    share: 1.0,
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
}

/// The labels of several sets.
pub fn labels(data: &Path, sets: &[Set]) -> Result<Vec<Label>> {
    let all: Result<Vec<_>> = sets.iter().map(|set| set.labels(data)).collect();
    Ok(all?.concat())
}

/// The faces of several sets.
pub fn load(data: &Path, sets: &[Set]) -> Result<Vec<Face>> {
    let mut faces = Vec::new();
    for set in sets {
        faces.extend(faces::labelled(&set.labels(data)?, data, set.share)?);
    }
    Ok(faces)
}
