//! Trains the refiners (section `RFIN`): their samples start at the global stage's own results on
//! the training faces, jittered because the stage errs more on faces that it was not trained on.

mod refiner;
mod samples;
pub(super) mod starts;

use super::network::Sizes;
use super::open::with_model;
use super::options::{Aperture, Options};
use super::samples::{Augment, EXAMPLES, Sample};
use super::source::{Draw, Source};
use super::train::{Trained, train};
use crate::faces::Face;
use crate::single_eyes;
use anyhow::Result;
use posewise::align::{AlignModel, Refiners};
use posewise_format::SectionWriter;
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
        let [first, second] = self.global;
        let start = |model: &AlignModel<'_>| Ok(starts(model, self.faces));
        let mut starts = with_model(&self.global, start)?;
        while let Some(refiner) = refiners.next() {
            println!("refiner: {}", refiner.name);
            let mut single = SectionWriter::new(Refiners::TAG);
            single.scalar(1u32);
            let (trained, samples) = self.train(&refiner, &starts, &out)?;
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

    /// Both rounds of a refiner, or its only one, and samples as the first round draws them;
    /// `before` has the refiners before it.
    fn train(
        &self,
        refiner: &Refiner,
        starts: &[[Start; STARTS]],
        before: &SectionWriter,
    ) -> Result<(Trained, Vec<Sample>)> {
        let (mut trained, samples) = self.round(refiner, self.faces, starts, None)?;
        if let Some(eyes) = self.eyes.filter(|_| refiner.single_eyes) {
            // The single eyes are found by all refiners: this one is the last.
            let mut section = before.clone();
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
            trained = self.round(refiner, &faces, &starts, Some(trained))?.0;
        } else if self.eyes.is_none() && refiner.mirrored {
            println!("second round");
            trained = self.round(refiner, self.faces, starts, Some(trained))?.0;
        }
        Ok((trained, samples))
    }

    /// One round of a refiner, the first or that `after` another one, and samples as it draws them.
    fn round(
        &self,
        refiner: &Refiner,
        faces: &[Face],
        starts: &[[Start; STARTS]],
        after: Option<Trained>,
    ) -> Result<(Trained, Vec<Sample>)> {
        let mut options = Options {
            sizes: Sizes::of_refiner(refiner.landmarks.len(), refiner.side, refiner.zoom),
            rendered: refiner.rendered,
            augment: Augment {
                motion_blur: refiner.motion_blurred,
                motion_blur_px: MOTION_BLUR * refiner.zoom,
                ..self.options.augment
            },
            ..self.options.clone()
        };
        let mut name = refiner.name.to_string();
        if after.is_some() {
            options.seed ^= 0xe7e;
            options.rate *= 0.5;
            name += "-second";
        }
        let source = RefinerFaces {
            faces,
            starts,
            options: &options,
            draw: Draw::new(faces, &options, |face| refiner.draw_weight(face))?,
            refiner,
        };
        let name = format!("{name}.checkpoint");
        let initial = after.map(|trained| trained.parameters);
        let trained = train(&source, &options, &self.checkpoints.join(name), initial)?;
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ 2);
        Ok((trained, source.samples(EXAMPLES, &mut rng)))
    }
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
