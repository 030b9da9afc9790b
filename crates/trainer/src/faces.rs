//! Labelled faces in memory: photographs from a CSV, and renders turned into the same form.

use crate::head::{Labels, marks_px};
use crate::labels::{self, Label};
use crate::photographs::{MANUAL, Set};
pub use crate::picture::Picture;
use crate::render::{Sample, cache};
use anyhow::Result;
use glam::{Mat3, Vec3};
use posewise::align::{Shape, crop_to_camera};
use posewise::math::head_rotation;
use posewise::shape::{LANDMARKS, MIRROR};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Exchanges left and right of a rotation, applied on both sides.
const MIRRORED: Mat3 = Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0));

/// One face with its 68 landmarks.
#[derive(Clone)]
pub struct Face {
    /// Picture that shows it.
    pub picture: Arc<Picture>,
    /// iBUG 68 landmarks \[px\]; the jaw follows the visible contour.
    pub landmarks: Shape,
    /// Which person, for splits.
    pub person: u32,
    /// Yaw \[deg\] where it is known: of renders, and of half-labelled photographs.
    pub yaw_deg: Option<f32>,
    /// The head's rotation as a camera sees it that looks straight at the landmarks' middle, where
    /// it is known (renders, and photographs of whole heads by their fits).
    pub rotation: Option<Mat3>,
    /// Pixels per millimetre at the middle of the landmarks, where it is known, as `yaw_deg`.
    pub px_per_mm: Option<f32>,
    /// What an error against its label weighs.
    pub weight: f32,
    /// How often it is drawn, against another photograph or another render.
    pub share: f32,
    /// Landmarks that are seen, as far as it is known.
    pub visible: [bool; LANDMARKS],
    /// Landmarks that have a label; the others have an estimate, which no error is measured
    /// against.
    pub known: [bool; LANDMARKS],
    /// Whether it is the picture of a single eye.
    pub is_single_eye: bool,
    /// Whether it was drawn, not photographed.
    pub is_render: bool,
    /// Whether the labels of narrow eyes are right: people and networks leave shut eyes half open.
    pub has_exact_lids: bool,
}

/// About the distance between the outer eye corners of the mean head, 89.2 \[mm\].
const INTER_OCULAR_MM: f32 = 90.0;

impl Face {
    /// A photograph of which all landmarks are seen and labelled, of weight 1, of person 0.
    pub fn new(picture: Picture, landmarks: Shape) -> Face {
        Face {
            picture: Arc::new(picture),
            landmarks,
            person: 0,
            yaw_deg: None,
            rotation: None,
            px_per_mm: None,
            weight: 1.0,
            share: 1.0,
            visible: [true; LANDMARKS],
            known: [true; LANDMARKS],
            is_single_eye: false,
            is_render: false,
            has_exact_lids: false,
        }
    }

    /// The face in a mirror.
    pub fn mirrored(&self) -> Face {
        let last = self.picture.size[0] as f32 - 1.0;
        let mut landmarks = self.landmarks;
        for (to, from) in landmarks.iter_mut().zip(MIRROR) {
            let [x, y] = self.landmarks[from];
            *to = [last - x, y];
        }
        Face {
            picture: Arc::new(self.picture.mirrored()),
            landmarks,
            yaw_deg: self.yaw_deg.map(|yaw| -yaw),
            rotation: self.rotation.map(|r| MIRRORED * r * MIRRORED),
            visible: MIRROR.map(|from| self.visible[from]),
            known: MIRROR.map(|from| self.known[from]),
            ..self.clone()
        }
    }

    /// Width of the face, roughly, however it is turned \[px\].
    pub fn width(&self) -> f32 {
        self.scale() / 0.42
    }

    /// Distance between the outer eye corners \[px\].
    pub fn inter_ocular(&self) -> f32 {
        let [a, b] = [self.landmarks[36], self.landmarks[45]];
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// Distance between the outer eye corners if the face looked into the camera \[px\]; where
    /// the head's size is not known, [`Face::scale`].
    pub fn frontal_inter_ocular(&self) -> f32 {
        let known = self.px_per_mm.map(|scale| INTER_OCULAR_MM * scale);
        known.unwrap_or_else(|| self.scale())
    }

    /// Pixels per millimetre; where they are not known, those of a head of the usual size.
    pub fn usual_px_per_mm(&self) -> f32 {
        self.frontal_inter_ocular() / INTER_OCULAR_MM
    }

    /// Size that an error is measured against \[px\]: the inter-ocular distance of a face that
    /// looks into the camera, also where turning shortens it: never less than 0.42 of the root of
    /// the landmarks' box area.
    pub fn scale(&self) -> f32 {
        let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
        for [x, y] in self.landmarks {
            (low, high) = (
                [low[0].min(x), low[1].min(y)],
                [high[0].max(x), high[1].max(y)],
            );
        }
        let area = (high[0] - low[0]) * (high[1] - low[1]);
        self.inter_ocular().max(0.42 * area.sqrt())
    }

    /// The landmarks where people mark them ([`marks_px`]), if the head's place is known. The more
    /// the head is turned, the less they move, because the marks were measured on heads that turn
    /// to 50°.
    pub fn marked(&self, labels: Labels) -> Shape {
        let mut marked = self.landmarks;
        let (Some(rotation), Some(scale)) = (self.rotation, self.px_per_mm) else {
            return marked;
        };
        let facing = rotation.z_axis.z.max(0.0);
        for (point, moved) in marked
            .iter_mut()
            .zip(marks_px(labels, rotation, facing * scale))
        {
            *point = [point[0] + moved.x, point[1] + moved.y];
        }
        marked
    }

    /// −1 (turned to the image left) … 1 (right): from yaw where it is known, else from where the
    /// nose tip lies between the outer eye corners.
    pub fn turn(&self) -> f32 {
        if let Some(yaw) = self.yaw_deg {
            return yaw / 90.0;
        }
        let [right, left, tip] = [self.landmarks[36], self.landmarks[45], self.landmarks[30]];
        let along = [left[0] - right[0], left[1] - right[1]];
        let norm = along[0] * along[0] + along[1] * along[1];
        let at = ((tip[0] - right[0]) * along[0] + (tip[1] - right[1]) * along[1]) / norm;
        // The tip passes an eye corner at about 60°.
        ((2.0 * at - 1.0) * 60.0 / 90.0).clamp(-1.0, 1.0)
    }
}

/// How far an eye or a mouth is open: mean of the gaps over the distance of the ends.
pub fn ratio(p: &Shape, ends: [usize; 2], gaps: &[[usize; 2]]) -> f32 {
    let distance = |a: usize, b: usize| (p[a][0] - p[b][0]).hypot(p[a][1] - p[b][1]);
    let gap: f32 = gaps.iter().map(|[a, b]| distance(*a, *b)).sum();
    gap / gaps.len() as f32 / distance(ends[0], ends[1]).max(1.0)
}

/// Reads a table of labels and its pictures, which no set of this crate holds.
pub fn photographs(csv_path: &Path, images: &Path) -> Result<Vec<Face>> {
    let set = Set {
        share: 1.0,
        ..MANUAL
    };
    labelled(&labels::read(csv_path)?, images, &set)
}

/// The faces of a set below the data folder; those whose landmarks are labelled in part need
/// [`crate::completion`].
pub fn of_set(set: &Set, data: &Path) -> Result<Vec<Face>> {
    labelled(&set.labels(data)?, data, set)
}

/// Faces of the labels of a set, whose pictures are below the data folder.
pub fn labelled(labels: &[Label], data: &Path, set: &Set) -> Result<Vec<Face>> {
    labels
        .par_iter()
        .map(|label| {
            let picture = Picture::read(&data.join(&label.image))?;
            Ok(Face {
                person: number(&set.person_in(&label.image)),
                weight: label_weight(label.spread, set.half_weight_spread),
                share: set.share_of(&label.image),
                known: label.known,
                ..Face::new(picture, label.points)
            })
        })
        .collect()
}

/// 1 where one annotator set a label, less the less several agree.
fn label_weight(spread: Option<f32>, half_weight_spread: f32) -> f32 {
    let spread = spread.unwrap_or(0.0) / half_weight_spread;
    1.0 / (1.0 + spread * spread)
}

/// A number for a name (FNV-1a).
fn number(name: &str) -> u32 {
    let mix = |h: u32, b: u8| (h ^ u32::from(b)).wrapping_mul(0x0100_0193);
    name.bytes().fold(0x811c_9dc5, mix)
}

/// The first `count` samples of a file of renders; a face weighs as much as a photograph when all
/// of it is seen, and less the more of it is hidden.
pub fn rendered(path: &Path, count: usize) -> Result<Vec<Face>> {
    let samples = cache::read(path, count)?;
    Ok(samples
        .into_iter()
        .map(|sample| Face {
            rotation: Some(rotation_of(&sample)),
            px_per_mm: Some(px_per_mm(&sample)),
            weight: visible_weight(&sample.visible),
            person: sample.person,
            yaw_deg: Some(sample.angles.yaw_deg),
            visible: sample.visible,
            is_render: true,
            has_exact_lids: true,
            ..Face::new(
                Picture {
                    size: [sample.width as u32, sample.height as u32],
                    luma: sample.luma,
                },
                sample.landmarks.map(|p| p.to_array()),
            )
        })
        .collect())
}

/// The head's rotation relative to a camera that looks straight at the landmarks' middle.
fn rotation_of(sample: &Sample) -> Mat3 {
    let landmarks = sample.landmarks.map(|p| p.to_array());
    let to_camera = crop_to_camera(&landmarks, 0.0, &sample.camera);
    to_camera.transpose() * head_rotation(sample.angles)
}

/// Pixels per millimetre at the landmarks' mean distance.
fn px_per_mm(sample: &Sample) -> f32 {
    let depths = sample.points3d.iter().map(|p| p.z);
    sample.camera.fx * LANDMARKS as f32 / depths.sum::<f32>()
}

/// Weight of a render of which hardly anything is seen. Half of a profile's landmarks are hidden,
/// and its pose depends on them. Chosen.
const HIDDEN_WEIGHT: f32 = 0.3;

fn visible_weight(visible: &[bool; LANDMARKS]) -> f32 {
    let share = visible.iter().filter(|v| **v).count() as f32 / LANDMARKS as f32;
    HIDDEN_WEIGHT + (1.0 - HIDDEN_WEIGHT) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_weigh_less_where_annotators_differ() {
        assert_eq!(label_weight(None, 0.02), 1.0);
        assert_eq!(label_weight(Some(0.02), 0.02), 0.5);
    }

    #[test]
    fn mirror_is_its_own_inverse() {
        assert!((0..LANDMARKS).all(|i| MIRROR[MIRROR[i]] == i));
        assert_eq!(
            [36, 37, 41, 48, 51, 60, 67].map(|i| MIRROR[i]),
            [45, 44, 46, 54, 51, 64, 65]
        );
    }
}
