//! Trains section `DTCT` as a whole.

use super::faces::Face;
use super::options::Options;
use super::{calibrate, pack, refine, training};
use crate::picture::Picture;
use anyhow::Result;
use posewise_format::SectionWriter;
use std::path::Path;

/// Trains everything on these faces and backgrounds, keeping intermediate results in `cache`, from
/// which an interrupted run resumes. The cascade is trained on the first `of_trees` faces, the
/// forest that refines its hits on all.
///
/// # Errors
/// When the cache cannot be written.
pub fn train(
    faces: &[Face],
    of_trees: usize,
    backgrounds: &[Picture],
    cache: &Path,
    options: &Options,
) -> Result<SectionWriter> {
    std::fs::create_dir_all(cache)?;
    let positives = &faces[..of_trees.min(faces.len())];
    let cascade = training::train(positives, backgrounds, cache, options)?;
    let refiner = refine::train(faces, cache, options)?;
    let mut cascade = calibrate::thresholds(&cascade, positives, options.discard_quantile);
    cascade.trees.truncate(options.kept);
    cascade.thresholds.truncate(options.kept);
    Ok(pack::section(&cascade, &refiner, options.confirm))
}
