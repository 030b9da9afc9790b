//! What `svm`, `cascade` and `hybrid` learn beforehand: from rendered faces, from a file of
//! renders, or from photographs with labels. It is kept in files and read from there the next time.

use super::settings::{Method, TrainingOptions};
use crate::features::cascade::{Cascade, Training};
use crate::features::local::Kind;
use crate::features::regression::Links;
use crate::store::sum;
use crate::templates::svm::{Bank, views};
use anyhow::{Context, Result, ensure};
use posewise::align::AlignModel;
use posewise_metrics::BoxJitter;
use posewise_train::align::{Boxes, StartShapes, mean_shape};
use posewise_train::faces::{self, Face};
use posewise_train::head::Head;
use posewise_train::render::mesh::Mesh;
use posewise_train::render::{People, Persons, Renderer, SampleSpec, cache};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Raised when what is learned from the same comes out otherwise.
const VERSION: u32 = 1;
/// Seed of the renders: no clip shows the same people.
const SEED: u64 = 0x7468_6573_6973;
/// Procedural people in the renders.
const PEOPLE: usize = 128;
/// Starts on each photograph that the cascade learns from; renders have half as many.
const STARTS: usize = 4;
/// Turns of the shapes that the cascade's boxes hold, normalised: 1 is a profile.
const TURNS: [f32; 3] = [0.0, 0.4, 0.8];
/// Predictors of a landmark in the last two stages (R).
const LINKS: usize = 8;

/// What was learned, each with the checksum of its file.
pub struct Trained {
    bank: Option<(Bank, String)>,
    cascade: Option<(Cascade, String)>,
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
        let lesson = Lesson { options, facekit };
        let needs = |kinds: [Method; 2]| methods.iter().any(|m| kinds.contains(m));
        let needs_bank = needs([Method::Svm, Method::Hybrid]);
        let needs_cascade = needs([Method::Cascade, Method::Hybrid]);
        let (bank_path, cascade_path) = (lesson.path("svm"), lesson.path("cascade"));
        let mut trained = Trained {
            bank: lesson.read(&bank_path, needs_bank)?,
            cascade: lesson.read(&cascade_path, needs_cascade)?,
        };
        let learn_bank = needs_bank && trained.bank.is_none();
        let learn_cascade = needs_cascade && trained.cascade.is_none();
        if learn_bank || learn_cascade {
            let faces = lesson.faces()?;
            if learn_bank {
                lesson.write(&bank_path, Bank::train(model, &faces))?;
                trained.bank = lesson.read(&bank_path, true)?;
            }
            if learn_cascade {
                lesson.write(&cascade_path, cascade(&faces))?;
                trained.cascade = lesson.read(&cascade_path, true)?;
            }
        }
        let is_whole = |(bank, _): &(Bank, String)| bank.is_whole(views(model));
        ensure!(
            trained.bank.as_ref().is_none_or(is_whole),
            "{}: templates of another model",
            bank_path.display()
        );
        Ok(trained)
    }

    /// The SVM templates.
    pub fn bank(&self) -> Result<&Bank> {
        let bank = self.bank.as_ref().context("no templates were learned")?;
        Ok(&bank.0)
    }

    /// The cascade.
    pub fn cascade(&self) -> Result<&Cascade> {
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

/// Linear regressions on RBM features, the last two stages on the best predictors.
fn cascade(faces: &[Face]) -> Cascade {
    let boxes = Boxes {
        jitter: BoxJitter::DETECTOR,
        count: STARTS,
    };
    let starts = StartShapes::fit(faces, &mean_shape(faces), &TURNS);
    let training = Training::new(faces, &starts, &boxes, SEED);
    Cascade::train(training, Kind::Rbm, Links::Best(LINKS))
}

struct Lesson<'a> {
    options: &'a TrainingOptions,
    facekit: &'a Path,
}

impl Lesson<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.options.trained.join(format!("{name}.json"))
    }

    /// From the file, if it is wanted, is there and was learned from the same.
    fn read<T: DeserializeOwned>(&self, path: &Path, wanted: bool) -> Result<Option<(T, String)>> {
        if !wanted || !path.exists() {
            return Ok(None);
        }
        let shown = || path.display().to_string();
        let bytes = std::fs::read(path).with_context(shown)?;
        let stored: Stored<T> = serde_json::from_slice(&bytes).with_context(shown)?;
        let is_same = stored.from == self.source();
        Ok(is_same.then(|| (stored.learned, sum(&bytes))))
    }

    /// Under its name only when it is whole.
    fn write<T: Serialize>(&self, path: &Path, learned: T) -> Result<()> {
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
            training_faces,
            ..
        } = self.options;
        format!(
            "version {VERSION}, renders {renders:?}, photographs {photographs:?}, \
             {training_faces} faces"
        )
    }

    fn faces(&self) -> Result<Vec<Face>> {
        let folder = &self.options.trained;
        eprintln!("learning what is kept in {}", folder.display());
        std::fs::create_dir_all(folder)?;
        let count = self.options.training_faces;
        let mut all = match &self.options.renders {
            Some(path) => faces::rendered(path, count)?,
            None => {
                let path = folder.join(format!("faces.{}", std::process::id()));
                cache::write(&path, &self.renderer()?, SEED, count as u64, &spec())?;
                let faces = faces::rendered(&path, count)?;
                std::fs::remove_file(&path)?;
                faces
            }
        };
        if let Some(folder) = &self.options.photographs {
            let labels = folder.join("train.csv");
            all.extend(faces::photographs(&labels, &folder.join("train"))?);
        }
        Ok(all)
    }

    fn renderer(&self) -> Result<Renderer> {
        let head = Head::load(self.facekit)?;
        let mesh = Mesh::new(&head)?;
        let people = People::new(&mesh, PEOPLE, SEED, false);
        let offsets_mm = head.conventional_offsets_mm();
        Ok(Renderer::new(mesh, people, Vec::new(), &offsets_mm))
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
        ..SampleSpec::default()
    }
}
