//! What several stages need: options, store, data sets with their hashes, and the training faces,
//! which are loaded when a stage first asks for them.

use super::args::Args;
use super::renders;
use super::stage::Stage;
use super::store::{Output, Store};
use crate::detect::backgrounds;
use crate::faces::{self, Face};
use crate::photographs::{self, Set};
use crate::picture::Picture;
use crate::render::Kind;
use anyhow::Result;
use std::cell::OnceCell;
use std::path::PathBuf;

/// Procedural backgrounds of a model that is trained without photographs.
const MADE_UP_BACKGROUNDS: u64 = 600;

/// Options, store and training faces of one run.
pub struct Context<'a> {
    pub args: &'a Args,
    pub store: &'a Store,
    fits: Option<&'a Output>,
    plain: OnceCell<Output>,
    near: OnceCell<Output>,
    eyes: OnceCell<Output>,
    loaded: OnceCell<Vec<Face>>,
    loaded_near: OnceCell<Vec<Face>>,
}

impl<'a> Context<'a> {
    /// Of these options. A model of photographs has `fits`.
    pub fn new(args: &'a Args, store: &'a Store, fits: Option<&'a Output>) -> Context<'a> {
        Context {
            args,
            store,
            fits,
            plain: OnceCell::new(),
            near: OnceCell::new(),
            eyes: OnceCell::new(),
            loaded: OnceCell::new(),
            loaded_near: OnceCell::new(),
        }
    }

    /// The output of a stage that renders, which is made when it is first asked for.
    pub fn renders(&self, kind: Kind) -> Result<&Output> {
        let cell = match kind {
            Kind::Plain => &self.plain,
            Kind::Near => &self.near,
            Kind::Eyes => &self.eyes,
        };
        if let Some(output) = cell.get() {
            return Ok(output);
        }
        let output = renders::make(self.store, &self.args.render(kind), self.fits)?;
        Ok(cell.get_or_init(|| output))
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
        self.with_sets(self.with_renders(stage)?, &photographs::TRAINING)
    }

    /// The stage with the rendered faces as input.
    pub fn with_renders(&self, stage: Stage) -> Result<Stage> {
        let renders = self.renders(Kind::Plain)?;
        Ok(stage.input("renders", renders.hash(renders::FILE)?))
    }

    /// The stage with sets of photographs as inputs; of a clean model without.
    pub fn with_sets(&self, stage: Stage, sets: &[Set]) -> Result<Stage> {
        let names: Vec<_> = sets.iter().flat_map(|s| [s.table, s.images]).collect();
        self.with_photographs(stage, &names)
    }

    /// The stage with the close-up renders as input.
    pub fn with_near(&self, stage: Stage) -> Result<Stage> {
        let near = self.renders(Kind::Near)?;
        Ok(stage.input("renders-near", near.hash(renders::FILE)?))
    }

    /// Photographs and renders; of a clean model renders only.
    pub fn faces(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded.get() {
            return Ok(faces);
        }
        let mut faces = vec![];
        if !self.args.clean {
            faces = photographs::load(&self.args.data, &photographs::TRAINING)?;
        }
        faces.extend(self.plain()?);
        Ok(self.loaded.get_or_init(|| faces))
    }

    /// Rendered faces alone; not kept.
    pub fn plain(&self) -> Result<Vec<Face>> {
        let path = self.renders(Kind::Plain)?.path(renders::FILE);
        faces::rendered(&path, self.args.renders as usize)
    }

    /// Close-up renders.
    pub fn near(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded_near.get() {
            return Ok(faces);
        }
        let path = self.renders(Kind::Near)?.path(renders::FILE);
        let faces = faces::rendered(&path, self.args.near_renders as usize)?;
        Ok(self.loaded_near.get_or_init(|| faces))
    }

    /// Pictures without a face.
    pub fn backgrounds(&self) -> Result<Vec<Picture>> {
        match self.args.clean {
            true => Ok(backgrounds::made_up(self.args.seed, MADE_UP_BACKGROUNDS)),
            false => backgrounds::load(&self.args.data),
        }
    }
}
