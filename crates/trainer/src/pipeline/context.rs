//! What several stages need: options, store, data sets with their hashes, and the training faces,
//! which are loaded when a stage first asks for them.

use super::args::Args;
use super::renders;
use super::sections;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::align;
use crate::detect::backgrounds;
use crate::faces::{self, Face};
use crate::picture::Picture;
use anyhow::Result;
use posewise::align::AlignModel;
use posewise_format::Tag;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::path::PathBuf;

/// Procedural backgrounds of a model that is trained without photographs.
const MADE_UP_BACKGROUNDS: u64 = 600;

/// Options, store and training faces of one run.
pub struct Context<'a> {
    pub args: &'a Args,
    pub store: &'a Store,
    /// Outputs of the stages that render.
    pub plain: Output,
    pub near: Output,
    pub hard: Option<Output>,
    loaded: OnceCell<Vec<Face>>,
    loaded_near: OnceCell<Vec<Face>>,
}

impl<'a> Context<'a> {
    /// With these renders.
    pub fn new(
        args: &'a Args,
        store: &'a Store,
        [plain, near]: [Output; 2],
        hard: Option<Output>,
    ) -> Context<'a> {
        Context {
            args,
            store,
            plain,
            near,
            hard,
            loaded: OnceCell::new(),
            loaded_near: OnceCell::new(),
        }
    }

    /// A data set of `--data`.
    pub fn data(&self, name: &str) -> PathBuf {
        self.args.data.join(name)
    }

    /// The stage with data sets as inputs; of a clean model without.
    pub fn with_photographs(&self, mut stage: Stage, names: &[&str]) -> Result<Stage> {
        if !self.args.clean {
            for name in names {
                stage = stage.input(name, self.store.data(&self.data(name))?);
            }
        }
        Ok(stage)
    }

    /// The stage with the training faces of [`Context::faces`] as input.
    pub fn with_faces(&self, stage: Stage) -> Result<Stage> {
        let stage = stage.input("renders", self.plain.hash(renders::FILE)?);
        self.with_photographs(stage, &["faces68/train.csv", "faces68/train"])
    }

    /// The stage with the training faces of [`Context::pseudo_labelled`] as input.
    pub fn with_pseudo_labelled(&self, stage: Stage) -> Result<Stage> {
        self.with_photographs(self.with_faces(stage)?, &["faces-unlabelled"])
    }

    /// The stage with the close-up renders as input.
    pub fn with_near(&self, stage: Stage) -> Result<Stage> {
        Ok(stage.input("renders-near", self.near.hash(renders::FILE)?))
    }

    /// Photographs with their mirror images, and renders; of a clean model renders only.
    pub fn faces(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded.get() {
            return Ok(faces);
        }
        let mut faces = vec![];
        if !self.args.clean {
            faces = self.photographs()?;
            let mirrors: Vec<Face> = faces.par_iter().map(Face::mirrored).collect();
            faces.extend(mirrors);
        }
        faces.extend(self.rendered()?);
        Ok(self.loaded.get_or_init(|| faces))
    }

    /// Close-up renders.
    pub fn near(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded_near.get() {
            return Ok(faces);
        }
        let path = self.near.path(renders::FILE);
        let faces = faces::rendered(&path, self.args.near_renders as usize)?;
        Ok(self.loaded_near.get_or_init(|| faces))
    }

    /// Hard renders, if there are some.
    pub fn hard(&self) -> Result<Vec<Face>> {
        match &self.hard {
            Some(renders) => faces::rendered(
                &renders.path(renders::FILE),
                self.args.hard_renders as usize,
            ),
            None => Ok(Vec::new()),
        }
    }

    /// Pictures without a face.
    pub fn backgrounds(&self) -> Result<Vec<Picture>> {
        match self.args.clean {
            true => Ok(backgrounds::made_up(self.args.seed, MADE_UP_BACKGROUNDS)),
            false => backgrounds::load(&self.args.data),
        }
    }

    /// Photographs with labels half way between the annotator's and those of a trained global
    /// stage, photographs without labels with its own, and renders as they are. Of a clean model
    /// renders only.
    pub fn pseudo_labelled(&self, global: &[(&Output, Tag)]) -> Result<Vec<Face>> {
        if self.args.clean {
            return Ok(self.faces()?.to_vec());
        }
        let label = |teacher: &AlignModel<'_>| {
            let mut faces = align::pseudo_labels::blended(teacher, &self.photographs()?);
            let unlabelled = self.data("faces-unlabelled");
            let (found, dropped) = align::pseudo_labels::found(teacher, &unlabelled)?;
            println!(
                "{} faces without labels taken, {dropped} dropped",
                found.len()
            );
            faces.extend(found);
            Ok(faces)
        };
        let mut faces = sections::with_model(global, label)?;
        faces.extend(self.rendered()?);
        Ok(faces)
    }

    fn photographs(&self) -> Result<Vec<Face>> {
        faces::photographs(&self.data("faces68/train.csv"), &self.data("faces68/train"))
    }

    fn rendered(&self) -> Result<Vec<Face>> {
        faces::rendered(&self.plain.path(renders::FILE), self.args.renders as usize)
    }
}
