//! Fits the 3D head to labelled photographs: poses, identities, expressions; and from them where
//! the labels sit against the head's vertices.
//!
//! The tracker's own fit does the work, with identities estimated over all pictures of a person.
//! The photographs are crops of unknown cameras: the principal point is taken as the middle and
//! the focal length as [`FitSettings::focal_per_side`] times the longer side.

use crate::face_section::{face_section, head_identity, identity_directions, open, point_vertices};
use crate::head::Head;
use crate::labels::Label;
use crate::photographs::Set;
use anyhow::{Context, Result, ensure};
use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use posewise::shape::{self, FaceFit, FaceModel, FitOptions, Identity, IdentityEstimator};
use posewise::shape::{Intrinsics, LANDMARKS, MAX_IDENTITIES, MIRROR, Observed};
use posewise_format::{AlignedBytes, Blob, blob};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// How photographs are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitSettings {
    /// Focal length in units of the picture's longer side.
    pub focal_per_side: f32,
    /// One identity for all pictures of a person instead of one per picture.
    pub shared_identity: bool,
    /// Fits with a larger mean error are dropped \[inter-ocular distances\].
    pub max_error: f32,
    /// Rounds of fit, identity and label offsets.
    pub rounds: usize,
}

impl Default for FitSettings {
    fn default() -> Self {
        FitSettings {
            focal_per_side: 2.5,
            shared_identity: true,
            max_error: 0.06,
            rounds: 4,
        }
    }
}

/// The 3D head fitted to one photograph.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PhotoFit {
    /// File name, relative to the data folder.
    pub image: String,
    /// Name shared by all pictures of the person.
    pub person: String,
    /// Size of the picture \[px\].
    pub size: [u32; 2],
    /// Focal length that was assumed; the principal point is the middle \[px\].
    pub focal_px: f32,
    /// Head-to-camera rotation, rows.
    pub rotation: [[f32; 3]; 3],
    /// The head's origin in the camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Weights for [`Head::vertices`].
    pub identity: Vec<f32>,
    /// Weights for [`Head::vertices`], by `FITTED_NAMES`.
    pub animation: Vec<f32>,
    /// The labels \[px\].
    pub labels: Vec<[f32; 2]>,
    /// The fitted landmarks, jaw on the contour, label offsets included \[px\].
    pub fitted: Vec<[f32; 2]>,
    /// Head vertices that stand for the jaw landmarks on the visible contour.
    pub contour: Vec<u32>,
    /// Mean distance of fitted landmarks and labels \[inter-ocular distances\]: outer eye corners
    /// of the 3D face as if seen frontally, so that turned faces are not measured against less.
    pub error: f32,
}

/// All fits, and what they say about the labels.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Fits {
    /// The settings they were made with.
    pub settings: FitSettings,
    /// Good fits, in the table's order.
    pub fits: Vec<PhotoFit>,
    /// Pictures that no pose explained, or whose error is above the threshold.
    pub dropped: Vec<String>,
    /// Where labels sit against the head's landmark vertices, head frame \[mm\]; 0 for the jaw.
    pub offsets_mm: Vec<[f32; 3]>,
    /// Root mean square distance of each landmark's labels, per coordinate \[mm on the face\].
    pub noise_mm: Vec<f32>,
}

impl PhotoFit {
    /// The camera that was assumed.
    pub fn intrinsics(&self) -> Intrinsics {
        camera(self.size, self.focal_px)
    }

    /// The pose.
    pub fn pose(&self) -> shape::Pose {
        shape::Pose {
            rotation: glam::Mat3::from_cols_array_2d(&self.rotation).transpose(),
            translation_mm: self.translation_mm.into(),
        }
    }

    /// Vertices of the fitted head in the camera frame \[mm\].
    pub fn vertices(&self, head: &Head) -> Vec<[f32; 3]> {
        let animation = std::array::from_fn(|i| self.animation.get(i).copied().unwrap_or(0.0));
        let pose = self.pose();
        let mut vertices = head.vertices(&self.identity, &animation);
        vertices
            .iter_mut()
            .for_each(|v| *v = pose.apply((*v).into()).into());
        vertices
    }
}

/// The camera that is assumed of a photograph.
pub fn camera([width, height]: [u32; 2], focal_px: f32) -> Intrinsics {
    let centre = |side: u32| (side as f32 - 1.0) / 2.0;
    Intrinsics::new(focal_px, focal_px, centre(width), centre(height))
}

/// One picture while it is being fitted.
struct Photo {
    label: Label,
    person: String,
    size: [u32; 2],
    camera: Intrinsics,
    identity: Identity,
    fit: Option<FaceFit>,
}

impl Photo {
    fn open(label: Label, set: &Set, data: &Path, settings: &FitSettings) -> Result<Photo> {
        let path = data.join(&label.image);
        let (w, h) = image::image_dimensions(&path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        Ok(Photo {
            camera: camera([w, h], settings.focal_per_side * w.max(h) as f32),
            size: [w, h],
            person: set.person_in(&label.image),
            label,
            identity: [0.0; MAX_IDENTITIES],
            fit: None,
        })
    }

    fn observed<'a>(&'a self, weights: &'a [f32; LANDMARKS]) -> Observed<'a> {
        Observed {
            points: &self.label.points,
            weights,
        }
    }

    /// Pixels per millimetre on the face.
    fn scale(&self, fit: &FaceFit) -> f32 {
        self.camera.fx / fit.state.pose.translation_mm.z
    }

    fn error(&self, fit: &FaceFit) -> f32 {
        let distances = self.label.points.iter().zip(fit.image_px);
        let sum: f32 = distances
            .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
            .sum();
        let iod = (fit.points_mm[36] - fit.points_mm[45]).length() * self.scale(fit);
        sum / LANDMARKS as f32 / iod
    }
}

/// Fits all pictures of some sets, whose names are relative to the data folder. Deterministic.
pub fn fit_photographs(
    head: &Head,
    sets: &[Set],
    data: &Path,
    settings: &FitSettings,
) -> Result<Fits> {
    let mut photos = vec![];
    for set in sets {
        let opened = set
            .labels(data)?
            .into_par_iter()
            .map(|label| Photo::open(label, set, data, settings));
        photos.extend(opened.collect::<Result<Vec<_>>>()?);
    }
    ensure!(!photos.is_empty(), "no labels");
    let mut offsets = vec![[0.0f32; 3]; LANDMARKS];
    for round in 0..settings.rounds.max(1) {
        let bytes = blob(&[face_section(head, Some(&offsets))?]);
        let bytes = AlignedBytes::new(&bytes);
        let face = open(&Blob::open(&bytes)?)?;
        fit_all(&face, &mut photos, round, settings.rounds);
        if round + 1 < settings.rounds.max(1) {
            estimate_identities(&face, &mut photos, settings);
            add_offsets(&mut offsets, &photos);
        }
    }
    Ok(collect(head, photos, settings, offsets))
}

fn fit_all(face: &FaceModel<'_>, photos: &mut [Photo], round: usize, rounds: usize) {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    let bar = ProgressBar::new(photos.len() as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(format!("fitting photographs, round {}/{rounds}", round + 1));
    let options = FitOptions {
        iterations: 15,
        ..FitOptions::default()
    };
    photos.par_iter_mut().progress_with(bar).for_each(|photo| {
        let start = photo.fit.map(|fit| fit.state);
        let observed = photo.observed(&[1.0; LANDMARKS]);
        let identity = &photo.identity;
        photo.fit = shape::fit(
            face,
            &photo.camera,
            &observed,
            start.as_ref(),
            identity,
            &options,
        );
    });
}

/// Identities from all fits so far, shared by the pictures of a person if so set.
fn estimate_identities(face: &FaceModel<'_>, photos: &mut [Photo], settings: &FitSettings) {
    let mut people: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (i, photo) in photos.iter().enumerate() {
        let key = if settings.shared_identity {
            &photo.person
        } else {
            &photo.label.image
        };
        people.entry(key.to_owned()).or_default().push(i);
    }
    let groups: Vec<Vec<usize>> = people.into_values().collect();
    let identities: Vec<Identity> = groups
        .par_iter()
        .map(|group| {
            let mut estimator = IdentityEstimator::with_memory(f32::MAX);
            for photo in group.iter().map(|i| &photos[*i]) {
                // One picture's labels err alike in the next of the same video.
                let weight = 1.0 / (group.len() as f32).sqrt();
                if let Some(fit) = photo
                    .fit
                    .filter(|fit| photo.error(fit) < settings.max_error)
                {
                    let observed = photo.observed(&[1.0; LANDMARKS]);
                    estimator.add(face, &photo.camera, &observed, &fit, weight);
                }
            }
            estimator.estimate()
        })
        .collect();
    for (group, identity) in groups.iter().zip(identities) {
        group.iter().for_each(|i| photos[*i].identity = identity);
    }
}

/// Adds the mean residual of near-frontal pictures, made symmetric, to the inner landmarks.
fn add_offsets(offsets: &mut [[f32; 3]], photos: &[Photo]) {
    let mut sums = vec![[0.0f32; 2]; LANDMARKS];
    let mut count = 0.0;
    for (photo, fit) in photos.iter().filter_map(|p| p.fit.map(|fit| (p, fit))) {
        let angles = fit.state.pose.angles();
        if angles.yaw_deg.abs() > 15.0 || angles.pitch_deg.abs() > 20.0 {
            continue;
        }
        count += 1.0;
        let scale = photo.scale(&fit);
        let (sin, cos) = angles.roll_deg.to_radians().sin_cos();
        let residuals = photo.label.points.iter().zip(fit.image_px);
        for (sum, (label, fitted)) in sums.iter_mut().zip(residuals) {
            let (x, y) = (
                (label[0] - fitted[0]) / scale,
                (label[1] - fitted[1]) / scale,
            );
            sum[0] += cos * x + sin * y;
            sum[1] += cos * y - sin * x;
        }
    }
    for i in 17..LANDMARKS {
        let other = sums[MIRROR[i]];
        offsets[i][0] += (sums[i][0] - other[0]) / 2.0 / f32::max(count, 1.0);
        offsets[i][1] += (sums[i][1] + other[1]) / 2.0 / f32::max(count, 1.0);
    }
}

fn collect(
    head: &Head,
    photos: Vec<Photo>,
    settings: &FitSettings,
    offsets_mm: Vec<[f32; 3]>,
) -> Fits {
    let (vertices, directions) = (point_vertices(head), identity_directions(head));
    let mut noise = vec![0.0f32; LANDMARKS];
    let (mut fits, mut dropped) = (Vec::new(), Vec::new());
    for photo in photos {
        let fit = match photo
            .fit
            .filter(|fit| photo.error(fit) <= settings.max_error)
        {
            Some(fit) => fit,
            None => {
                dropped.push(photo.label.image);
                continue;
            }
        };
        let scale = photo.scale(&fit);
        for (sum, (a, b)) in noise
            .iter_mut()
            .zip(photo.label.points.iter().zip(fit.image_px))
        {
            *sum += ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)) / (2.0 * scale * scale);
        }
        fits.push(PhotoFit {
            size: photo.size,
            focal_px: photo.camera.fx,
            rotation: fit.state.pose.rotation.transpose().to_cols_array_2d(),
            translation_mm: fit.state.pose.translation_mm.into(),
            identity: head_identity(&directions, &fit.state.identity),
            animation: fit.state.animation.to_vec(),
            labels: photo.label.points.to_vec(),
            fitted: fit.image_px.to_vec(),
            contour: fit.contour.iter().map(|p| vertices[*p as usize]).collect(),
            error: photo.error(&fit),
            person: photo.person,
            image: photo.label.image,
        });
    }
    let count = fits.len().max(1) as f32;
    Fits {
        settings: *settings,
        fits,
        dropped,
        offsets_mm,
        noise_mm: noise.iter().map(|s| (s / count).sqrt()).collect(),
    }
}
