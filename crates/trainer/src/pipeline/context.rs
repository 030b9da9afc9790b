//! What several stages need: options, store, data sets with their hashes, and the training faces,
//! which are loaded when a stage first asks for them.

use super::args::Args;
use super::hash::Hash;
use super::stage::Stage;
use super::store::{Output, Store};
use super::{fits, renders, sections};
use crate::completion;
use crate::detect::backgrounds;
use crate::faces::{self, Face};
use crate::head::Head;
use crate::photographs::{Framing, Set};
use crate::picture::Picture;
use crate::render::Kind;
use crate::sources::Sources;
use anyhow::{Context as _, Result};
use posewise_format::{AlignedBytes, Blob, Section, SectionWriter, Tag};
use std::cell::OnceCell;
use std::path::PathBuf;

/// Procedural backgrounds of a model that is trained without photographs.
const MADE_UP_BACKGROUNDS: u64 = 600;

/// Share of the usual rate at which a network that is trained already goes on.
const CONTINUED_RATE: f32 = 0.6;

/// Options, store and training faces of one run.
pub struct Context<'a> {
    pub args: &'a Args,
    pub store: &'a Store,
    /// What it trains on.
    pub sources: Sources,
    /// The finished model whose networks go on, and its content hash.
    pub finished: Option<(AlignedBytes, Hash)>,
    fits: Option<&'a Output>,
    whole: Vec<Set>,
    plain: OnceCell<Output>,
    near: OnceCell<Output>,
    eyes: OnceCell<Output>,
    loaded: OnceCell<Vec<Face>>,
    loaded_near: OnceCell<Vec<Face>>,
}

impl<'a> Context<'a> {
    /// Of these options. `fits` are those of the sets that show whole heads, if there are some.
    pub fn new(args: &'a Args, store: &'a Store, fits: Option<&'a Output>) -> Result<Context<'a>> {
        let sources = args.sources()?;
        let finished = match &args.from {
            Some(path) => {
                let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
                Some((AlignedBytes::new(&bytes), store.data(path)?))
            }
            None => None,
        };
        Ok(Context {
            args,
            store,
            finished,
            fits,
            whole: sources.whole(),
            sources,
            plain: OnceCell::new(),
            near: OnceCell::new(),
            eyes: OnceCell::new(),
            loaded: OnceCell::new(),
            loaded_near: OnceCell::new(),
        })
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
        let output = {
            let photographed = self.fits.map(|fits| (fits, &self.whole[..]));
            renders::make(
                self.store,
                &self.args.render(kind, &self.sources),
                photographed,
            )?
        };
        Ok(cell.get_or_init(|| output))
    }

    /// A data set of `--data`.
    pub fn data(&self, name: &str) -> PathBuf {
        self.args.data.join(name)
    }

    /// The stage with pictures without people as input.
    pub fn with_backgrounds(&self, stage: Stage) -> Result<Stage> {
        let name = "backgrounds";
        Ok(match self.sources.has_backgrounds() {
            true => stage.input(name, self.store.data(&self.data(name))?),
            false => stage,
        })
    }

    /// The stage with the finished model as input, if there is one.
    pub fn with_finished(&self, stage: Stage) -> Stage {
        match &self.finished {
            Some((_, hash)) => stage.input("from", hash.clone()),
            None => stage,
        }
    }

    /// The largest rate of a network's training, which usually has this one.
    pub fn rate(&self, usual: f32) -> f32 {
        match self.finished {
            Some(_) => CONTINUED_RATE * usual,
            None => usual,
        }
    }

    /// A section of the finished model.
    pub fn section(&self, tag: Tag) -> Result<Option<Section<'_>>> {
        let Some((bytes, _)) = &self.finished else {
            return Ok(None);
        };
        Ok(Some(Blob::open(bytes)?.section(&tag)?))
    }

    /// A section of the finished model as it is, if it has one.
    pub fn kept(&self, tag: Tag) -> Result<Option<SectionWriter>> {
        let Some((bytes, _)) = &self.finished else {
            return Ok(None);
        };
        let all = Blob::open(bytes)?;
        let found = all.sections().find(|(of, _)| *of == tag);
        Ok(found.map(|(_, bytes)| SectionWriter::of_bytes(tag, bytes.to_vec())))
    }

    /// A section of the finished model as it is, as the output of a stage, if no batches are to be
    /// trained and it has one.
    pub fn kept_stage(&self, name: &'static str, steps: usize, tag: Tag) -> Result<Option<Output>> {
        let (0, Some(section)) = (steps, self.kept(tag)?) else {
            return Ok(None);
        };
        let stage = self.with_finished(Stage::new(name, 1));
        let output = self.store.make(&stage, &[sections::FILE], |folder| {
            sections::write(folder, &section)
        });
        output.map(Some)
    }

    /// The stage with the training faces of [`Context::faces`] as input.
    pub fn with_faces(&self, stage: Stage) -> Result<Stage> {
        let mut stage = self.with_renders(stage)?;
        for set in self.sources.sets() {
            for name in [set.table, set.images] {
                stage = stage.input(name, self.store.data(&self.data(name))?);
            }
        }
        match self.fits {
            Some(fits) => Ok(stage.input("fits", fits.hash(fits::FILE)?)),
            None => Ok(stage),
        }
    }

    /// The stage with the rendered faces as input.
    pub fn with_renders(&self, stage: Stage) -> Result<Stage> {
        let renders = self.renders(Kind::Plain)?;
        Ok(stage.input("renders", renders.hash(renders::FILE)?))
    }

    /// The stage with the close-up renders as input.
    pub fn with_near(&self, stage: Stage) -> Result<Stage> {
        let near = self.renders(Kind::Near)?;
        Ok(stage.input("renders-near", near.hash(renders::FILE)?))
    }

    /// Photographs and renders.
    pub fn faces(&self) -> Result<&[Face]> {
        if let Some(faces) = self.loaded.get() {
            return Ok(faces);
        }
        let mut faces = vec![];
        for set in self.sources.sets() {
            faces.extend(self.photographed(&set)?);
        }
        faces.extend(self.plain()?);
        Ok(self.loaded.get_or_init(|| faces))
    }

    /// The photographs of a set; where a half is labelled, completed.
    pub fn photographed(&self, set: &Set) -> Result<Vec<Face>> {
        if set.framing == Framing::Whole {
            let mut faces = faces::of_set(set, &self.args.data)?;
            if let Some(fits) = self.fits {
                let labels = set.labels(&self.args.data)?;
                completion::place(&fits::read(fits)?, &mut faces, &labels);
            }
            return Ok(faces);
        }
        if set.framing == Framing::Tight {
            return faces::of_set(set, &self.args.data);
        }
        let fits = self
            .fits
            .context("half faces are completed with fits of whole ones")?;
        let head = Head::load(&self.data("facekit.npz"))?;
        completion::faces(&head, &fits::read(fits)?, &self.args.data, set)
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
        match self.sources.has_backgrounds() {
            false => Ok(backgrounds::made_up(self.args.seed, MADE_UP_BACKGROUNDS)),
            true => backgrounds::load(&self.args.data),
        }
    }
}
