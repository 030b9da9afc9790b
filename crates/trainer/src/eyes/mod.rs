//! Trains the network of single eyes (section `EYES`) on rendered eyes, on those of photographed
//! faces, which are also shut by drawing, and, where there are some, on photographs of single eyes.

mod calibration;
mod cover;
mod crop;
mod glint;
mod lashes;
mod lens;
mod photographed;
mod samples;
mod single;
pub mod tracked;

pub use calibration::{Figures, figures, look_single};
pub use photographed::PhotographedEye;
pub use single::{SingleEye, WIDTH, is_held_out, read as read_single};

use crate::align::{Augment, Options, Sizes, Source, Trained, parameters, train, write_regressor};
use crate::render::eye_cache::Eye;
use anyhow::{Context, Result};
use posewise::align::{EYE_OUTPUTS, EYES_TAG, GLOBAL, SHAPE_INDEXED};
use posewise_format::{Section, SectionWriter};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use samples::Eyes;
use serde::Serialize;
use std::path::Path;

/// Samples that show how large the maps' values grow.
const EXAMPLES: usize = 2048;

/// The second round has one in this number of the first round's batches.
const SECOND: usize = 4;

/// How the network is trained.
#[derive(Clone, Debug, Serialize)]
pub struct EyeOptions {
    /// Those of the network.
    pub network: Options,
    /// Share of photographed faces' eyes among the samples, if there are any.
    pub photographed_share: f32,
    /// Share of photographs of single eyes among the samples of the second round.
    pub single_share: f32,
    /// By how much of the nose's direction the gaze's label is reduced. With 0.8, about how far
    /// behind the corners of the eye its centre is in radii of the eyeball, it is no better.
    pub by_nose: f32,
}

impl EyeOptions {
    /// Those of this seed and number of batches.
    pub fn new(seed: u64, steps: usize) -> EyeOptions {
        EyeOptions {
            network: Options {
                seed,
                steps,
                sizes: Sizes {
                    side: 40,
                    // 44 mm across.
                    zoom: 40.0 / 44.0,
                    channels: [8, 24, 32, 64],
                    fine: 16,
                    depth: [1, 2],
                    rank: 2 * EYE_OUTPUTS,
                    points: EYE_OUTPUTS,
                    reads: vec![GLOBAL, GLOBAL | SHAPE_INDEXED],
                },
                augment: Augment {
                    light: 0.0,
                    patch: 0.05,
                    motion_blur: 0.1,
                    motion_blur_px: 5.0,
                    faint: 0.2,
                    ..Augment::default()
                },
                shake: 0.0,
                bent: 0.0,
                shut: 0.0,
                ..Options::default()
            },
            photographed_share: 0.3,
            single_share: 0.25,
            by_nose: 0.0,
        }
    }
}

fn source<'a>(
    rendered: &'a [Eye],
    photographed: &'a [PhotographedEye],
    single: &'a [SingleEye],
    options: &'a EyeOptions,
) -> Eyes<'a> {
    Eyes {
        rendered,
        photographed,
        photographed_share: options.photographed_share,
        single,
        single_share: options.single_share,
        sizes: &options.network.sizes,
        augment: &options.network.augment,
        by_nose: options.by_nose,
    }
}

/// The first round: trains the network on rendered eyes and on those of photographed faces, and
/// leaves it in the checkpoint. It goes on from there if it is begun, else from the mean of the
/// networks `before`, if there are some: networks that went on from one lie near enough to each
/// other for that, and their mean is better at what each was trained on than the others are
/// (Wortsman et al., *Model soups*, 2022).
pub fn train_first(
    rendered: &[Eye],
    photographed: &[PhotographedEye],
    options: &EyeOptions,
    checkpoint: &Path,
    before: &[Vec<f32>],
) -> Result<()> {
    let network = &options.network;
    let source = source(rendered, photographed, &[], options);
    train(&source, network, checkpoint, mean_of(before)).map(drop)
}

/// The parameters of the network of a section.
pub fn of_section(mut section: Section<'_>, options: &EyeOptions) -> Result<Vec<f32>> {
    calibration::Numbers::skip(&mut section)?;
    parameters(&mut section, &options.network.sizes, options.network.seed)
}

/// Those of a network that a first round left.
pub fn of_checkpoint(checkpoint: &Path, options: &EyeOptions) -> Result<Vec<f32>> {
    let trained = Trained::read(checkpoint, &options.network.sizes);
    let trained = trained.with_context(|| format!("no network in {}", checkpoint.display()))?;
    Ok(trained.parameters)
}

/// The mean of networks; `None` of none.
fn mean_of(networks: &[Vec<f32>]) -> Option<Vec<f32>> {
    let mut mean = networks.first()?.clone();
    for (k, value) in mean.iter_mut().enumerate() {
        *value = networks.iter().map(|n| n[k]).sum::<f32>() / networks.len() as f32;
    }
    Some(mean)
}

/// The section, of the network of the first round. With photographs there is a second round, which
/// goes on from its checkpoint. Probabilities are calibrated on eyes of people that are not among
/// those that it is trained on.
pub fn section(
    first: &Path,
    rendered: &[Eye],
    calibration: &[Eye],
    photographed: &[PhotographedEye],
    single: &[SingleEye],
    options: &EyeOptions,
    checkpoint: &Path,
) -> Result<SectionWriter> {
    let network = &options.network;
    let source = source(rendered, photographed, single, options);
    let mut trained = Trained::read(first, &network.sizes).context("no network of eyes")?;
    if !single.is_empty() {
        println!("second round, with single eyes");
        let second = Options {
            seed: network.seed ^ 0xe7e,
            rate: 0.5 * network.rate,
            steps: network.steps / SECOND,
            ..network.clone()
        };
        trained = train(&source, &second, checkpoint, Some(trained.parameters))?;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(network.seed ^ 2);
    let samples = source.samples(EXAMPLES, &mut rng);
    let write = |numbers: &calibration::Numbers| {
        let mut out = SectionWriter::new(EYES_TAG);
        numbers.write(&mut out);
        write_regressor(&trained, &samples, &mut out)?;
        Ok(out)
    };
    let first = write(&calibration::Numbers::first(options.by_nose))?;
    write(&calibration::calibrate(
        &first,
        calibration,
        options.by_nose,
    )?)
}
