//! Trains the refiners (section `RFIN`): their samples start at the global stage's own results on
//! the training faces, jittered because the stage errs more on faces that it was not trained on.

mod refiner;
mod samples;
pub(super) mod starts;

use super::finished;
use super::network::{Network, Sizes};
use super::open::with_model;
use super::options::{Aperture, Augment, Options};
use super::samples::{EXAMPLES, Sample};
use super::source::{Draw, Source};
use super::train::{Trained, train};
use crate::faces::Face;
use crate::single_eyes;
use anyhow::{Result, ensure};
use posewise::align::{AlignModel, Refiners};
use posewise_format::{Section, SectionWriter};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use refiner::{Refiner, all};
use samples::RefinerFaces;
use starts::{STARTS, Start, advance, starts};
use std::path::Path;

/// Longest motion blur of a crop, in canonical units.
const MOTION_BLUR: f32 = 9.0;

/// How and from where refiners are trained.
pub struct Training<'a> {
    /// Sections of the cascade's global stage.
    pub global: [&'a SectionWriter; 2],
    /// Faces to train on.
    pub faces: &'a [Face],
    /// Folder of pictures of single eyes ([`single_eyes`]); without it eyes and lids have a second
    /// round on the same faces.
    pub eyes: Option<&'a Path>,
    /// Section `RFIN` of a finished model, whose networks go on.
    pub before: Option<Section<'a>>,
    /// Those of [`options`].
    pub options: &'a Options,
    /// Folder of checkpoints.
    pub checkpoints: &'a Path,
}

impl Training<'_> {
    /// Trains section `RFIN`; resumes from checkpoints if there are some.
    pub fn run(&self) -> Result<SectionWriter> {
        let mut refiners = all().into_iter().peekable();
        let mut out = SectionWriter::new(Refiners::TAG);
        out.scalar(refiners.len() as u32);
        let mut finished = self.before.clone();
        if let Some(s) = &mut finished {
            ensure!(s.u32()? as usize == refiners.len(), "other refiners");
        }
        let [first, second] = self.global;
        let start = |model: &AlignModel<'_>| Ok(starts(model, self.faces));
        let mut starts = with_model(&self.global, start)?;
        while let Some(refiner) = refiners.next() {
            println!("refiner: {}", refiner.name);
            let mut single = SectionWriter::new(Refiners::TAG);
            single.scalar(1u32);
            let before = finished.as_mut().map(|s| self.finished(&refiner, s));
            let (trained, samples) = self.train(&refiner, &starts, &out, before.transpose()?)?;
            for out in [&mut single, &mut out] {
                refiner.write(&trained, &samples, out)?;
            }
            if refiners.peek().is_some() {
                // The next refiner starts at the results of this one.
                with_model(&[first, second, &single], |model| {
                    advance(model, self.faces, &mut starts);
                    Ok(())
                })?;
            }
        }
        Ok(out)
    }

    /// The next refiner of a finished section.
    fn finished(&self, refiner: &Refiner, s: &mut Section<'_>) -> Result<Trained> {
        let [points, _mirrored] = [s.u32()?, s.u32()?];
        let landmarks: Vec<usize> = s
            .u32s(points as usize)?
            .iter()
            .map(|k| *k as usize)
            .collect();
        ensure!(landmarks == refiner.landmarks, "another refiner");
        let sizes = self.options_for(refiner).sizes;
        Ok(Trained {
            parameters: finished::parameters(s, &sizes, self.options.seed)?,
            network: Network::new(&sizes),
        })
    }

    /// Trains a refiner, and returns samples as the first round draws them. Where it is `finished`
    /// already, there is no first round, and always a second one. `others` has the refiners before
    /// it.
    fn train(
        &self,
        refiner: &Refiner,
        starts: &[[Start; STARTS]],
        others: &SectionWriter,
        finished: Option<Trained>,
    ) -> Result<(Trained, Vec<Sample>)> {
        let goes_on = finished.is_some();
        let mut trained = match finished {
            Some(trained) => trained,
            None => self.round(refiner, self.faces, starts, None)?,
        };
        let samples = self.samples(refiner, starts)?;
        if let Some(eyes) = self.eyes.filter(|_| refiner.single_eyes) {
            // The single eyes are found by all refiners: this one is the last.
            let mut section = others.clone();
            refiner.write(&trained, &samples, &mut section)?;
            let find = |model: &AlignModel<'_>| {
                let found = single_eyes::for_training(model, eyes)?.into_iter();
                Ok(found.map(|eye| Start::of_single(model, eye)).unzip())
            };
            let [first, second] = self.global;
            let (singles, found): (Vec<_>, Vec<_>) = with_model(&[first, second, &section], find)?;
            let faces = [self.faces, &singles[..]].concat();
            let starts: Vec<_> = starts.iter().copied().chain(found).collect();
            println!("second round, with single eyes");
            trained = self.round(refiner, &faces, &starts, Some(trained))?;
        } else if goes_on || self.eyes.is_none() && refiner.mirrored {
            println!("second round");
            trained = self.round(refiner, self.faces, starts, Some(trained))?;
        }
        Ok((trained, samples))
    }

    /// How a refiner is trained, in the first round.
    fn options_for(&self, refiner: &Refiner) -> Options {
        Options {
            sizes: Sizes::of_refiner(refiner.landmarks.len(), refiner.side, refiner.zoom),
            rendered: refiner.rendered,
            shut: refiner.shut,
            augment: Augment {
                motion_blur: refiner.motion_blurred,
                motion_blur_px: MOTION_BLUR * refiner.zoom,
                ..self.options.augment
            },
            ..self.options.clone()
        }
    }

    /// One round of a refiner, the first or that `after` another one.
    fn round(
        &self,
        refiner: &Refiner,
        faces: &[Face],
        starts: &[[Start; STARTS]],
        after: Option<Trained>,
    ) -> Result<Trained> {
        let mut options = self.options_for(refiner);
        let mut name = refiner.name.to_string();
        if after.is_some() {
            options.seed ^= 0xe7e;
            options.rate *= 0.5;
            name += "-second";
        }
        let source = source(refiner, faces, starts, &options)?;
        let name = format!("{name}.checkpoint");
        let initial = after.map(|trained| trained.parameters);
        train(&source, &options, &self.checkpoints.join(name), initial)
    }

    /// Samples as the first round draws them.
    fn samples(&self, refiner: &Refiner, starts: &[[Start; STARTS]]) -> Result<Vec<Sample>> {
        let options = self.options_for(refiner);
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ 2);
        let source = source(refiner, self.faces, starts, &options)?;
        Ok(source.samples(EXAMPLES, &mut rng))
    }
}

fn source<'a>(
    refiner: &'a Refiner,
    faces: &'a [Face],
    starts: &'a [[Start; STARTS]],
    options: &'a Options,
) -> Result<RefinerFaces<'a>> {
    Ok(RefinerFaces {
        faces,
        starts,
        options,
        draw: Draw::new(faces, options, |face| refiner.draw_weight(face))?,
        refiner,
    })
}

/// How refiners are trained.
pub fn options(seed: u64, steps: usize) -> Options {
    Options {
        seed,
        steps,
        turned: 1.0,
        augment: Augment {
            coarse: 0.25,
            ..Augment::default()
        },
        aperture: Aperture {
            lids: 4.0,
            lips: 1.0,
            from: 0.0,
        },
        ..Options::default()
    }
}
