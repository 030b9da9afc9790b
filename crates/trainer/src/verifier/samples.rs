//! What the verifier is trained on: where the finished cascade ends, with its features.
//!
//! Positives and negatives come from running the cascade: from jittered boxes on the training faces
//! (some of these fits fail), and, in pictures without a face, from random boxes and from false
//! positives of the detector. Some fits get further iterations, as a tracked face does. One picture
//! in [`POOR`] is shown as by a poor camera.

use super::linear::{Example, FOLDS};
use crate::align::cover::{covered, cut_off};
use crate::align::evaluate::{mean_error, start_of};
use crate::align::{Jitter, each, jittered_box, normal, start_from_box};
use crate::faces::{Face, Picture};
use crate::render::effects::Camera;
use posewise::align::{AlignModel, Shape, Workspace};
use posewise::detect::{
    Detection, DetectorModel, Scan, ScanBudget, ScanOutcome, Sizes, TileMemory,
};
use posewise::image::Frame;
use posewise::shape::LANDMARKS;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Largest error of a correct landmark, and largest mean error of a well-fitted face, relative to
/// the inter-ocular distance \[%\].
const CORRECT_PERCENT: f32 = 10.0;
/// Fits to start on faces in all, at most [`MAX_PER_FACE`] on each.
const FITS_ON_FACES: usize = 48_000;
const MAX_PER_FACE: usize = 6;
/// One fit in this number starts from a box [`FAR`] times as far off.
const FAR_STARTS: usize = 3;
const FAR: f32 = 3.5;
/// One face in this number has something before it, and one is cut off by the picture's edge.
const OCCLUDED: usize = 3;
const CUT_OFF: usize = 12;
/// Largest turn (−1 … 1) of a photographed face whose landmarks are known to be visible:
/// photographs do not label what turning hides.
const FRONTAL_TURN: f32 = 0.3;
/// Fits on random boxes, as a share of those on faces: one in this number.
const RANDOM_BOXES: usize = 4;
/// Weight of all false positives of the detector relative to that of the well-fitted faces, however
/// many there are. At full weight they outweigh half-covered faces, which then are lost.
const FALSE_POSITIVES: f32 = 2.0 / 3.0;
/// One picture in this number is shown as by a poor camera.
const POOR: usize = 2;
/// One orientation in this number of a picture without a face is searched for false positives.
const ORIENTATIONS: usize = 4;
/// Most false positives taken from a picture in one orientation: poor ones have hundreds.
const MAX_FALSE_POSITIVES: usize = 40;
/// Width of a face that the poor camera's defects are scaled to in pictures without one \[px\].
const EMPTY_FACE_PX: f32 = 100.0;
/// One fit in this number gets [`SETTLING_ITERATIONS`] further iterations, and every false positive
/// is taken before and after: the verifier mostly sees what has been tracked for a while.
const SETTLING: usize = 3;
const SETTLING_ITERATIONS: usize = 8;
/// Smallest face that false positives are looked for at \[px\].
const MIN_FACE_PX: i32 = 30;

/// One fit of the cascade.
pub struct Sample {
    /// Of all landmarks, where the last iteration read them.
    pub features: Vec<i8>,
    /// Per landmark: within [`CORRECT_PERCENT`], where it has a label. Empty without a face.
    pub correct: Vec<Option<bool>>,
    /// Per landmark. Empty where it is not known.
    pub visible: Vec<bool>,
    /// A face, well fitted.
    pub face: bool,
    pub weight: f32,
    /// All fits of a person, or of a picture without a face, are in one fold.
    pub fold: u32,
    pub view: usize,
}

impl Sample {
    /// The sample as an example of a class.
    pub fn example<'s>(&self, features: &'s [i8], positive: bool) -> Example<'s> {
        Example {
            features,
            positive,
            weight: self.weight,
            fold: self.fold,
        }
    }

    /// The workspace's last fit, on a picture without a face.
    fn without_face(work: &Workspace, picture: usize) -> Sample {
        Sample {
            features: work.features().to_vec(),
            correct: Vec::new(),
            visible: Vec::new(),
            face: false,
            weight: 1.0,
            fold: picture as u32 % FOLDS,
            view: work.view(),
        }
    }
}

/// Runs the cascade on faces, on random boxes and on the detector's false positives.
pub fn collect(
    model: &AlignModel<'_>,
    detector: &DetectorModel<'_>,
    faces: &[Face],
    empty: &[Picture],
    seed: u64,
) -> Vec<Sample> {
    let mut samples = on_faces(model, faces, seed);
    let boxes = samples.len() / RANDOM_BOXES;
    samples.extend(on_random_boxes(model, empty, seed ^ 1, boxes));
    let positives = samples.iter().filter(|s| s.face).count();
    let mut others = on_candidates(model, detector, empty, seed ^ 2);
    println!("verifier: {} false positives of the detector", others.len());
    let weight = FALSE_POSITIVES * positives as f32 / others.len().max(1) as f32;
    for sample in &mut others {
        sample.weight = weight;
    }
    samples.extend(others);
    let rest = samples.len() - positives;
    println!("verifier: {positives} well-fitted faces, {rest} others");
    samples
}

/// Runs the cascade on the faces, from boxes as good as a detector's and far worse ones.
fn on_faces(model: &AlignModel<'_>, faces: &[Face], seed: u64) -> Vec<Sample> {
    let per_face = (FITS_ON_FACES / faces.len().max(1)).clamp(1, MAX_PER_FACE);
    let samples = each(faces, seed, |index, face, rng, work| {
        let fit = |k| on_face(model, faces, face, index + k, k, rng, work);
        // Real profiles are rare.
        let fits = if is_half(face) {
            MAX_PER_FACE
        } else {
            per_face
        };
        (0..fits).filter_map(fit).collect::<Vec<_>>()
    });
    samples.into_iter().flatten().collect()
}

/// The `k`-th fit on a face, `count` in all so far: every [`FAR_STARTS`]-th starts far off.
fn on_face(
    model: &AlignModel<'_>,
    faces: &[Face],
    bare: &Face,
    count: usize,
    k: usize,
    rng: &mut ChaCha8Rng,
    work: &mut Workspace,
) -> Option<Sample> {
    // Views of both sides learn from every face.
    let mirrored = rng.random_bool(0.5).then(|| bare.mirrored());
    let bare = mirrored.as_ref().unwrap_or(bare);
    let occluded = (rng.random_range(0..OCCLUDED) == 0).then(|| {
        let other = &faces[rng.random_range(0..faces.len())];
        covered(bare, other, rng)
    });
    let face = occluded.as_ref().unwrap_or(bare);
    let cut = (rng.random_range(0..CUT_OFF) == 0).then(|| cut_off(face, rng));
    let face = cut.as_ref().unwrap_or(face);
    let mut shape = jittered_start(model, face, count % FAR_STARTS == FAR_STARTS - 1, rng);
    let poor = sometimes_poor(&face.picture, face.width(), rng);
    let frame = poor.as_ref().unwrap_or(&face.picture).frame();
    let fitted = model.run(&frame, model.iterations() + k % 2, &mut shape, work)
        && (rng.random_range(0..SETTLING) != 0 || settle(model, &frame, &mut shape, work));
    if !fitted {
        return None;
    }
    let unit = face.frontal_inter_ocular();
    let correct = |k: usize| {
        let (a, b) = (face.landmarks[k], shape[k]);
        (a[0] - b[0]).hypot(a[1] - b[1]) <= CORRECT_PERCENT / 100.0 * unit
    };
    // Hidden landmarks are estimates: hardly a profile would be well fitted if they counted.
    let visible = (0..LANDMARKS).filter(|k| bare.visible[*k] && bare.known[*k]);
    let well_fitted = mean_error(face, &shape, visible, unit) < CORRECT_PERCENT;
    let known = face.yaw_deg.is_some() || face.turn().abs() < FRONTAL_TURN;
    Some(Sample {
        features: work.features().to_vec(),
        correct: (0..LANDMARKS)
            .map(|k| face.known[k].then(|| correct(k)))
            .collect(),
        visible: match known && well_fitted {
            true => face.visible.to_vec(),
            false => vec![],
        },
        face: well_fitted,
        weight: 1.0,
        fold: face.person.wrapping_mul(0x9E37_79B9) >> 16 & (FOLDS - 1),
        view: work.view(),
    })
}

/// Whether a half of the face is labelled; the fitted head then says what is hidden.
fn is_half(face: &Face) -> bool {
    face.known.contains(&false)
}

/// A start shape for a face, from a box as far off as a detector's or farther.
fn jittered_start(model: &AlignModel<'_>, face: &Face, far: bool, rng: &mut ChaCha8Rng) -> Shape {
    let j = if far { FAR } else { 1.0 };
    let jitter = Jitter {
        shift: 0.05 * j,
        log_size: 0.08 * j,
        roll: 0.14 * j,
    };
    let (at, size, roll) = jittered_box(&model.views(), &face.landmarks, &jitter, rng);
    let turn = face.turn() + 0.25 * normal(rng);
    start_from_box(&start_of(model, turn), at, size, roll)
}

/// Runs the cascade on random boxes in pictures without a face.
fn on_random_boxes(
    model: &AlignModel<'_>,
    empty: &[Picture],
    seed: u64,
    count: usize,
) -> Vec<Sample> {
    if empty.is_empty() {
        return Vec::new();
    }
    let samples = each(&vec![(); count], seed, |index, (), rng, work| {
        let which = index % empty.len();
        let picture = &empty[which];
        let [w, h] = picture.size.map(|s| s as f32);
        let size = rng.random_range(40.0..0.9 * w.min(h));
        let at = [rng.random_range(0.0..w), rng.random_range(0.0..h)];
        let start = start_of(model, rng.random_range(-1.0..1.0));
        let mut shape = start_from_box(&start, at, size, 0.3 * normal(rng));
        let iterations = model.iterations() + index % 2;
        let poor = sometimes_poor(picture, size, rng);
        let frame = poor.as_ref().unwrap_or(picture).frame();
        let fitted = model.run(&frame, iterations, &mut shape, work)
            && (!(index / empty.len()).is_multiple_of(SETTLING)
                || settle(model, &frame, &mut shape, work));
        fitted.then(|| Sample::without_face(work, which))
    });
    samples.into_iter().flatten().collect()
}

/// Runs the cascade where the detector finds a face though there is none.
fn on_candidates(
    model: &AlignModel<'_>,
    detector: &DetectorModel<'_>,
    empty: &[Picture],
    seed: u64,
) -> Vec<Sample> {
    let samples = each(empty, seed, |index, picture, rng, work| {
        let mut samples = Vec::new();
        let orientations = picture.orientations();
        let some = orientations.iter().skip(index % ORIENTATIONS);
        for picture in some.step_by(ORIENTATIONS) {
            let poor = sometimes_poor(picture, EMPTY_FACE_PX, rng);
            let frame = poor.as_ref().unwrap_or(picture).frame();
            let found = candidates(detector, &frame, work);
            let every = found.len().div_ceil(MAX_FALSE_POSITIVES).max(1);
            for found in found.iter().step_by(every) {
                let start = start_of(model, found.yaw);
                let at = [found.x, found.y];
                let mut shape = start_from_box(&start, at, found.size, found.roll);
                if model.run(&frame, model.iterations(), &mut shape, work) {
                    samples.push(Sample::without_face(work, index));
                    if settle(model, &frame, &mut shape, work) {
                        samples.push(Sample::without_face(work, index));
                    }
                }
            }
        }
        samples
    });
    samples.into_iter().flatten().collect()
}

/// All that the detector reports in a picture.
pub fn candidates(
    detector: &DetectorModel<'_>,
    frame: &Frame<'_>,
    work: &mut Workspace,
) -> Vec<Detection> {
    let (mut scan, mut all) = (Scan::new(), vec![]);
    let (crop, maps) = work.network_memory();
    let memory = &mut TileMemory { crop, maps };
    let (sizes, budget) = (Sizes::from(MIN_FACE_PX), ScanBudget::of_tiles(u32::MAX));
    loop {
        match scan.advance(detector, frame, sizes, budget, memory) {
            ScanOutcome::Candidate(found) => all.push(found),
            ScanOutcome::BudgetSpent => continue,
            ScanOutcome::Finished => return all,
        }
    }
}

/// Further iterations, as tracking runs on the frames that follow.
fn settle(
    model: &AlignModel<'_>,
    frame: &Frame<'_>,
    shape: &mut Shape,
    work: &mut Workspace,
) -> bool {
    (0..SETTLING_ITERATIONS).all(|_| model.run(frame, 1, shape, work))
}

/// A picture as a poor camera shows it; its defects are scaled to a face of this width.
fn poor(picture: &Picture, face_px: f32, rng: &mut ChaCha8Rng) -> Picture {
    let camera = Camera::poor(rng, face_px);
    picture.through(&camera, rng)
}

/// The same, one time in [`POOR`].
fn sometimes_poor(picture: &Picture, face_px: f32, rng: &mut ChaCha8Rng) -> Option<Picture> {
    (rng.random_range(0..POOR) == 0).then(|| poor(picture, face_px, rng))
}
