//! What `svm`, `cascade` and `hybrid` learn beforehand: from rendered faces or a file of renders,
//! and from photographs with labels. It is kept in files and read from there the next time.

use super::cascade_training;
use super::face_model::FaceModel;
use super::head_cascade::HeadCascade;
use super::settings::{Method, TrainingOptions};
use crate::features::local::Kind;
use crate::store::sum;
use crate::sweeps::{self, Material, U3ptArgs};
use crate::templates::svm::{Bank, views};
use anyhow::{Context, Result, ensure};
use glam::Vec3;
use posewise::align::AlignModel;
use posewise::shape::LANDMARKS;
use posewise_train::faces::{self, Face};
use posewise_train::head::Head;
use posewise_train::photographs::{MANUAL, MANUAL_MORE, Set, VIDEO};
use posewise_train::render::mesh::Mesh;
use posewise_train::render::{
    Behind, Family, MAKEHUMAN, MAKEHUMAN_FOLDER, People, Persons, Renderer, SampleSpec, cache,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Raised when what is learned from the same comes out otherwise.
const BANK_VERSION: u32 = 1;
const CASCADE_VERSION: u32 = 3;
/// Seed of the renders: no clip shows the same people.
const SEED: u64 = 0x7468_6573_6973;
/// Procedural people in the renders that templates learn from, and, of each head family, in those
/// that the cascade learns from; fewer in tests, as to make a person takes as long as many faces.
const PEOPLE: usize = if cfg!(test) { 16 } else { 128 };
const MANY_PEOPLE: usize = 2 * PEOPLE;
/// Photographs that the cascade learns from, where they are beside the morphable head: manual
/// landmarks, and teachers'.
const PHOTOGRAPHED: [Set; 3] = [MANUAL, MANUAL_MORE, VIDEO];
/// Renders for a photograph of each of these sets.
const PHOTOGRAPHED_SHARE: usize = 6;
/// Rendered faces for each subject that the cascade tracks between its rounds, frames of each of
/// the subject's videos and their width \[px\]. Chosen.
const TRACKED_SHARE: usize = 1000;
const TRACKED_FRAMES: usize = 75;
const TRACKED_WIDTH: usize = if cfg!(test) { 320 } else { 640 };

/// What was learned, each with the checksum of its file.
pub struct Trained {
    bank: Option<(Bank, String)>,
    cascade: Option<(HeadCascade, String)>,
}

/// A file of what was learned.
#[derive(Serialize, Deserialize)]
struct Stored<T> {
    /// What it was learned from.
    from: String,
    learned: T,
}

impl Trained {
    /// What these methods need.
    pub fn new(
        options: &TrainingOptions,
        facekit: &Path,
        model: &AlignModel<'_>,
        methods: &[Method],
    ) -> Result<Trained> {
        let needs = |kinds: [Method; 2]| methods.iter().any(|m| kinds.contains(m));
        let needs_bank = needs([Method::Svm, Method::Hybrid]);
        let needs_cascade = needs([Method::Cascade, Method::Hybrid]);
        let lesson = |name, version, count| Lesson {
            options,
            facekit,
            name,
            version,
            count,
        };
        let bank = lesson("svm", BANK_VERSION, options.training_faces);
        let learn_bank = || Ok(Bank::train(model, &bank.plain_faces()?));
        let cascade = lesson("cascade", CASCADE_VERSION, options.cascade_faces);
        let learn_cascade = || {
            let head = FaceModel::morphable(facekit)?;
            let faces = cascade.many_faces()?;
            let folder = options
                .trained
                .join(format!("clips.{}", std::process::id()));
            let clips = cascade.clips(&folder)?;
            let kind = Kind::PooledRbm;
            let learned = cascade_training::train(&head, &faces, &clips, kind, SEED)?;
            std::fs::remove_dir_all(&folder)?;
            Ok(learned)
        };
        let trained = Trained {
            bank: needs_bank.then(|| bank.learned(learn_bank)).transpose()?,
            cascade: needs_cascade
                .then(|| cascade.learned(learn_cascade))
                .transpose()?,
        };
        let is_whole = |(bank, _): &(Bank, String)| bank.is_whole(views(model));
        ensure!(
            trained.bank.as_ref().is_none_or(is_whole),
            "{}: templates of another model",
            bank.path().display()
        );
        Ok(trained)
    }

    /// The SVM templates.
    pub fn bank(&self) -> Result<&Bank> {
        let bank = self.bank.as_ref().context("no templates were learned")?;
        Ok(&bank.0)
    }

    /// The cascade.
    pub fn cascade(&self) -> Result<&HeadCascade> {
        let cascade = self.cascade.as_ref().context("no cascade was learned")?;
        Ok(&cascade.0)
    }

    /// Checksums of what a method uses.
    pub fn sums(&self, method: Method) -> Vec<&str> {
        let bank = self.bank.as_ref().map(|b| b.1.as_str());
        let cascade = self.cascade.as_ref().map(|c| c.1.as_str());
        let used = match method {
            Method::Svm => [bank, None],
            Method::Cascade => [cascade, None],
            Method::Hybrid => [bank, cascade],
            _ => [None, None],
        };
        used.into_iter().flatten().collect()
    }
}

/// One thing that is learned.
struct Lesson<'a> {
    options: &'a TrainingOptions,
    facekit: &'a Path,
    name: &'a str,
    version: u32,
    /// Renders.
    count: usize,
}

impl Lesson<'_> {
    fn path(&self) -> PathBuf {
        self.options.trained.join(format!("{}.json", self.name))
    }

    /// What the file has, with its checksum; it is learned where it is not there.
    fn learned<T: Serialize + DeserializeOwned>(
        &self,
        learn: impl FnOnce() -> Result<T>,
    ) -> Result<(T, String)> {
        if let Some(found) = self.read()? {
            return Ok(found);
        }
        let folder = &self.options.trained;
        eprintln!("learning what is kept in {}", folder.display());
        std::fs::create_dir_all(folder)?;
        self.write(learn()?)?;
        self.read()?.context("what was just learned")
    }

    /// From the file, if it is there and was learned from the same.
    fn read<T: DeserializeOwned>(&self) -> Result<Option<(T, String)>> {
        let path = self.path();
        if !path.exists() {
            return Ok(None);
        }
        let shown = || path.display().to_string();
        let bytes = std::fs::read(&path).with_context(shown)?;
        let stored: Stored<T> = serde_json::from_slice(&bytes).with_context(shown)?;
        let is_same = stored.from == self.source();
        Ok(is_same.then(|| (stored.learned, sum(&bytes))))
    }

    /// Under its name only when it is whole.
    fn write<T: Serialize>(&self, learned: T) -> Result<()> {
        let path = self.path();
        let from = self.source();
        let bytes = serde_json::to_vec(&Stored { from, learned })?;
        let part = path.with_added_extension(std::process::id().to_string());
        std::fs::write(&part, bytes).with_context(|| part.display().to_string())?;
        Ok(std::fs::rename(&part, path)?)
    }

    /// Names what is learned from.
    fn source(&self) -> String {
        let TrainingOptions {
            renders,
            photographs,
            ..
        } = self.options;
        format!(
            "version {}, renders {renders:?}, photographs {photographs:?}, {} faces",
            self.version, self.count
        )
    }

    /// Renders of the morphable head, and the photographs that are asked for.
    fn plain_faces(&self) -> Result<Vec<Face>> {
        let renderer = || self.renderer(PEOPLE);
        let mut all = self.renders(renderer, &spec())?;
        all.extend(self.photographs()?);
        Ok(all)
    }

    /// Renders of both head families and photographs, as many of these at most.
    fn many_faces(&self) -> Result<Vec<Face>> {
        let data = self.facekit.parent().unwrap_or(Path::new(""));
        let makehuman = data.join(MAKEHUMAN_FOLDER);
        let mut spec = hard_spec();
        if !makehuman.exists() {
            spec.makehuman = 0.0;
        }
        let renderer = || {
            let renderer = self.renderer(MANY_PEOPLE)?;
            if spec.makehuman == 0.0 {
                return Ok(renderer);
            }
            let mesh = &renderer.mesh;
            let family = Family::load(
                &makehuman,
                mesh,
                &[Vec3::ZERO; LANDMARKS],
                MANY_PEOPLE,
                SEED,
                false,
            );
            Ok(renderer.with_makehuman(family?))
        };
        let mut all = self.renders(renderer, &spec)?;
        for set in PHOTOGRAPHED {
            if data.join(set.table).exists() {
                let mut labels = set.labels(data)?;
                labels.truncate(self.count / PHOTOGRAPHED_SHARE);
                all.extend(faces::labelled(&labels, data, &set)?);
            }
        }
        all.extend(self.photographs()?);
        Ok(all)
    }

    /// Renders the clips that the cascade tracks between its rounds.
    fn clips(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        sweeps::render_u3pt(&U3ptArgs {
            material: Material {
                facekit: self.facekit.into(),
                backgrounds: None,
                seed: SEED,
            },
            out: folder.into(),
            only: Vec::new(),
            subjects: self.count.div_ceil(TRACKED_SHARE),
            frames: TRACKED_FRAMES,
            width: TRACKED_WIDTH,
        })
    }

    /// Faces of the file of renders that is given, or rendered now.
    fn renders(
        &self,
        renderer: impl FnOnce() -> Result<Renderer>,
        spec: &SampleSpec,
    ) -> Result<Vec<Face>> {
        if let Some(path) = &self.options.renders {
            return faces::rendered(path, self.count);
        }
        let name = format!("faces.{}", std::process::id());
        let path = self.options.trained.join(name);
        cache::write(&path, &renderer()?, SEED, self.count as u64, spec)?;
        let faces = faces::rendered(&path, self.count)?;
        std::fs::remove_file(&path)?;
        Ok(faces)
    }

    /// Those that are asked for.
    fn photographs(&self) -> Result<Vec<Face>> {
        let Some(folder) = &self.options.photographs else {
            return Ok(Vec::new());
        };
        faces::photographs(&folder.join("train.csv"), &folder.join("train"))
    }

    /// Of people with the morphable head.
    fn renderer(&self, people: usize) -> Result<Renderer> {
        let head = Head::load(self.facekit)?;
        let mesh = Mesh::new(&head)?;
        let people = People::new(&mesh, people, SEED, false);
        let offsets_mm = head.conventional_offsets_mm();
        Ok(Renderer::new(mesh, people, Behind::default(), &offsets_mm))
    }
}

/// Faces of the size and the sharpness of clips.
fn spec() -> SampleSpec {
    SampleSpec {
        face_px: (60.0, 160.0),
        defects: 0.5,
        occluders: 0.05,
        masks: 0.0,
        odd_eyes: 0.0,
        persons: Persons::Procedural,
        photo_backgrounds: 0.0,
        ..SampleSpec::default()
    }
}

/// The same, covered more often, of both head families.
fn hard_spec() -> SampleSpec {
    SampleSpec {
        occluders: 0.3,
        masks: 0.06,
        makehuman: MAKEHUMAN,
        ..spec()
    }
}
