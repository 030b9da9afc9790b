//! `posewise-train marks`: measures where people mark landmarks against where a model puts them,
//! for a table of [`marks_mm`].

use super::fits;
use super::store::Store;
use crate::align::{self, Boxes, Jitter};
use crate::faces;
use crate::fit::PhotoFit;
use crate::head::{Labels, marks_mm};
use crate::photographs::MANUAL;
use anyhow::{Context as _, Result};
use nalgebra::{Matrix3, RowVector3, Vector3};
use posewise::align::{AlignModel, EnsembleMember, Refiners, Shape};
use posewise::shape::{LANDMARKS, MIRROR};
use posewise_format::{AlignedBytes, Blob};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Options of `posewise-train marks`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The model.
    #[arg(long, default_value = "models/posewise.posewise")]
    pub model: PathBuf,
    /// The shared data.
    #[arg(long, default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder for the outputs of stages.
    #[arg(long, default_value = "cache")]
    pub cache: PathBuf,
}

/// Mean error above which a photograph does not count \[% of the inter-ocular distance\].
const LOST: f32 = 12.0;
/// Errors below count as squares, above by their size \[mm\].
const SMALL_MM: f32 = 1.5;
/// Weight of no offset, along the axes of the head; photographs tell little of the depth.
const PRIOR: [f32; 3] = [1.0, 1.0, 30.0];
/// Rounds of least squares with new weights.
const ROUNDS: usize = 5;

/// A coordinate of a landmark in a picture: the head's axes as it sees them, and how far the label
/// is from what was found \[mm\].
type Seen = (RowVector3<f32>, f32);

/// Prints, of each landmark of the image's left half, the offset that is left over and the one that
/// the table would have with it \[mm, head frame\].
pub fn run(args: &Args) -> Result<()> {
    let store = Store::open(&args.cache)?;
    let fits = fits::read(&fits::make(&store, &args.data, &[MANUAL])?)?;
    let fits: BTreeMap<&str, &PhotoFit> = fits.fits.iter().map(|f| (&*f.image, f)).collect();
    let bytes = std::fs::read(&args.model).with_context(|| args.model.display().to_string())?;
    let bytes = AlignedBytes::new(&bytes);
    let blob = Blob::open(&bytes)?;
    let member = EnsembleMember::open(&blob)?;
    let model = AlignModel::open(&blob, member, Refiners::open(&blob)?)?;
    let labels = MANUAL.labels(&args.data)?;
    let faces = faces::of_set(&MANUAL, &args.data)?;
    let boxes = Boxes {
        jitter: Jitter::DETECTOR,
        count: 1,
    };
    let found = align::evaluate(&model, &faces, &boxes, 1);
    let mut seen = vec![vec![]; LANDMARKS];
    for (label, (shape, error, _)) in labels.iter().zip(&found) {
        match fits.get(&*label.image) {
            Some(fit) if *error < LOST => add(&mut seen, fit, &label.points, shape),
            _ => {}
        }
    }
    println!("landmark: left over, with the table of the face mesh [mm]");
    for (i, mark) in marks_mm(Labels::FaceMesh)
        .iter()
        .enumerate()
        .filter(|(i, _)| *i <= MIRROR[*i])
    {
        let [x, y, z] = offset(&seen[i]).into();
        let [a, b, c] = [mark.x + x, mark.y + y, mark.z + z];
        println!("{i:2}: {x:5.1} {y:5.1} {z:5.1}   {a:5.1} {b:5.1} {c:5.1}");
    }
    Ok(())
}

/// Adds what a photograph says of all landmarks, and of those on the other side, whose offsets are
/// mirrored.
fn add(seen: &mut [Vec<Seen>], fit: &PhotoFit, labels: &Shape, found: &Shape) {
    let mm = fit.translation_mm[2] / fit.focal_px;
    for (i, (label, at)) in labels.iter().zip(found).enumerate() {
        for k in 0..2 {
            let axes = RowVector3::from(fit.rotation[k]);
            let distance = (label[k] - at[k]) * mm;
            seen[i].push((axes, distance));
            let mirrored = RowVector3::new(-axes.x, axes.y, axes.z);
            seen[MIRROR[i]].push((mirrored, distance));
        }
    }
}

/// The offset that explains what is seen best.
fn offset(seen: &[Seen]) -> Vector3<f32> {
    let mut offset = Vector3::zeros();
    for _ in 0..ROUNDS {
        let mut normal = Matrix3::from_diagonal(&PRIOR.into());
        let mut sum = Vector3::zeros();
        for (axes, distance) in seen {
            let left = (axes * offset)[0] - distance;
            let weighted = axes.transpose() / left.abs().max(SMALL_MM);
            normal += weighted * axes;
            sum += weighted * *distance;
        }
        offset = normal.cholesky().map_or(offset, |c| c.solve(&sum));
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_is_found_beside_wrong_labels() {
        let truth = Vector3::new(1.0, -2.0, 0.5);
        let mut seen: Vec<Seen> = (0..400)
            .map(|k| {
                let angle = k as f32 * 0.1;
                let axes = RowVector3::new(angle.cos(), (0.7 * angle).sin(), angle.sin());
                (axes, (axes * truth)[0])
            })
            .collect();
        seen.iter_mut().step_by(20).for_each(|s| s.1 += 30.0);
        let found = offset(&seen);
        assert!((found - truth).norm() < 0.5, "{found}");
    }
}
