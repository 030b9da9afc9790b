//! What the 3D head that was fitted to a photograph tells of its face.
//!
//! Of a face of which one half is labelled, it says where the other landmarks are. What is made up
//! so has no loss; it places the crop.

use crate::face_section::{face_section, open};
use crate::faces::{self, Face};
use crate::fit::{FitSettings, Fits, PhotoFit, camera};
use crate::head::Head;
use crate::labels::Label;
use crate::photographs::Set;
use anyhow::Result;
use posewise::align::crop_to_camera;
use posewise::shape::{
    self, FaceFit, FaceModel, FitOptions, IdentityEstimator, LANDMARKS, MAX_IDENTITIES, Observed,
};
use posewise_format::{AlignedBytes, Blob, blob};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// Fits whose known landmarks are farther off on average explain no face \[face sizes, see
/// [`Face::scale`]\].
const LARGEST_ERROR: f32 = 0.13;
/// Rounds of fit and identity.
const ROUNDS: usize = 3;
/// Weight of landmarks that the head hides at the initial pose. None of the known ones is.
const HIDDEN_WEIGHT: f32 = 1.0;

/// Tells whole faces of these labels how the heads that were fitted to them are turned, and how
/// large they are.
pub fn place(fits: &Fits, faces: &mut [Face], labels: &[Label]) {
    let fits: BTreeMap<&str, &PhotoFit> = fits.fits.iter().map(|f| (&*f.image, f)).collect();
    for (face, label) in faces.iter_mut().zip(labels) {
        let Some(fit) = fits.get(&*label.image) else {
            continue;
        };
        let to_camera = crop_to_camera(&face.landmarks, 0.0, &fit.intrinsics());
        face.rotation = Some(to_camera.transpose() * fit.pose().rotation);
        face.px_per_mm = Some(fit.focal_px / fit.translation_mm[2]);
    }
}

/// The faces of a set of half faces; those that no head explains are left out.
pub fn faces(head: &Head, fits: &Fits, data: &Path, set: &Set) -> Result<Vec<Face>> {
    let bytes = AlignedBytes::new(&blob(&[face_section(head, Some(&fits.offsets_mm))?]));
    let blob = Blob::open(&bytes)?;
    let face = open(&blob)?;
    let labelled = faces::of_set(set, data)?;
    let count = labelled.len();
    let completed: Vec<Face> = labelled
        .into_par_iter()
        .filter_map(|labelled| complete(&face, &fits.settings, labelled))
        .collect();
    println!(
        "{}: {} of {count} faces completed",
        set.table,
        completed.len()
    );
    Ok(completed)
}

fn complete(model: &FaceModel<'_>, settings: &FitSettings, mut face: Face) -> Option<Face> {
    let [w, h] = face.picture.size;
    let focal = settings.focal_per_side * w.max(h) as f32;
    let fit = fit(model, focal, &face)?;
    for (i, point) in face.landmarks.iter_mut().enumerate() {
        if !face.known[i] {
            *point = fit.image_px[i];
        }
    }
    let known = (0..LANDMARKS).filter(|i| face.known[*i]);
    let distance = |i: usize| {
        let (a, b) = (face.landmarks[i], fit.image_px[i]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let error = known.clone().map(distance).sum::<f32>() / known.count() as f32;
    face.yaw_deg = Some(fit.state.pose.facing_angles().yaw_deg);
    face.px_per_mm = Some(px_per_mm(&fit, focal));
    face.visible = std::array::from_fn(|i| face.known[i] || fit.visible[i]);
    (error <= LARGEST_ERROR * face.scale()).then_some(face)
}

/// Pixels per millimetre at the head's distance.
fn px_per_mm(fit: &FaceFit, focal: f32) -> f32 {
    focal / fit.state.pose.translation_mm.z
}

/// Pose, identity and expression that explain the known landmarks.
fn fit(model: &FaceModel<'_>, focal: f32, face: &Face) -> Option<FaceFit> {
    let camera = camera(face.picture.size, focal);
    let weights = face.known.map(|known| if known { 1.0 } else { 0.0 });
    let observed = Observed {
        points: &face.landmarks,
        weights: &weights,
    };
    let options = FitOptions {
        iterations: 15,
        hidden_weight: HIDDEN_WEIGHT,
        ..FitOptions::default()
    };
    let mut identity = [0.0; MAX_IDENTITIES];
    let mut fit = shape::fit(model, &camera, &observed, None, &identity, &options)?;
    for _ in 1..ROUNDS {
        let mut estimator = IdentityEstimator::with_memory(f32::MAX);
        estimator.add(model, &camera, &observed, &fit, 1.0);
        identity = estimator.estimate();
        let start = Some(&fit.state);
        fit = shape::fit(model, &camera, &observed, start, &identity, &options)?;
    }
    Some(fit)
}
