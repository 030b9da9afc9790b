//! Options of a network's training.

use super::network::Sizes;
use posewise_metrics::BoxJitter;
use serde::Serialize;

/// Displacement of the points of landmarks.
const SHAKE: f32 = 0.5;

fn is_usual_shake(shake: &f32) -> bool {
    *shake == SHAKE
}

/// How far crops lie from where the true landmarks would put them.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Start {
    /// Errors as after a detection.
    pub detected: BoxJitter,
    /// Errors as from the frame before, or in a second pass.
    pub tracked: BoxJitter,
    /// Share of the first kind.
    pub detected_share: f32,
    /// Share of these that are farther off (`STRAY` of `samples.rs`): detections of blurred faces
    /// and of those that are hard to see.
    #[serde(skip_serializing_if = "is_none")]
    pub stray_share: f32,
    /// Share of the samples whose crop lies where the network itself puts it; that share of these
    /// after one more prediction.
    #[serde(skip_serializing_if = "is_none")]
    pub again: f32,
}

impl Default for Start {
    fn default() -> Self {
        Start {
            detected: BoxJitter {
                shift: 0.08,
                log_size: 0.13,
                roll: 0.20,
            },
            tracked: BoxJitter {
                shift: 0.03,
                log_size: 0.04,
                roll: 0.05,
            },
            detected_share: 0.4,
            stray_share: 0.15,
            again: 0.5,
        }
    }
}

/// Whether a disturbance is not used.
pub fn is_none(share: &f32) -> bool {
    *share == 0.0
}

/// Disturbances of a crop.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Augment {
    /// Deviation of the logarithm of contrast.
    pub contrast: f32,
    /// Deviation of brightness.
    pub brightness: f32,
    /// Deviation of how far middle greys are brightened or darkened.
    #[serde(skip_serializing_if = "is_none")]
    pub tone: f32,
    /// Share of crops that are lit in another way.
    #[serde(skip_serializing_if = "is_none")]
    pub light: f32,
    /// Largest deviation of noise.
    pub noise: f32,
    /// Largest change of brightness across the crop.
    pub slope: f32,
    /// Share of blurred crops.
    pub blur: f32,
    /// Share of crops at half resolution.
    pub coarse: f32,
    /// Share of crops of little contrast.
    #[serde(skip_serializing_if = "is_none")]
    pub faint: f32,
    /// Share of crops with a patch painted over.
    pub patch: f32,
    /// Share of crops that moved while they were exposed, and how far at most \[px\].
    pub motion_blur: f32,
    pub motion_blur_px: f32,
}

impl Default for Augment {
    fn default() -> Self {
        Augment {
            contrast: 0.3,
            brightness: 15.0,
            tone: 0.3,
            light: 0.4,
            noise: 12.0,
            slope: 40.0,
            blur: 0.2,
            coarse: 0.15,
            faint: 0.0,
            patch: 0.2,
            motion_blur: 0.0,
            motion_blur_px: 0.0,
        }
    }
}

/// How the network is trained.
#[derive(Clone, Debug, Serialize)]
pub struct Options {
    /// Seed of all randomness.
    pub seed: u64,
    /// Turns of the start shapes, rising from 0.
    pub turns: Vec<f32>,
    /// Iterations after a detection.
    pub iterations: usize,
    /// How large the network is.
    pub sizes: Sizes,
    /// Where crops are cut.
    pub start: Start,
    /// How they are disturbed.
    pub augment: Augment,
    /// Batches.
    pub steps: usize,
    /// Samples of a batch.
    pub batch: usize,
    /// Share of renders among them.
    pub rendered: f32,
    /// Share of faces with something before them.
    pub occluded: f32,
    /// Share of faces that the picture's edge cuts off in part.
    pub cut_off: f32,
    /// Share of crops that are bent.
    #[serde(skip_serializing_if = "is_none")]
    pub bent: f32,
    /// Share of photographs whose eyes are shut by drawing.
    #[serde(skip_serializing_if = "is_none")]
    pub shut: f32,
    /// How much more often a photograph of a face in profile is drawn than one from the front.
    pub turned: f32,
    /// How much more often a render of a face from the front is drawn than one in profile.
    pub front: f32,
    /// Largest rate; it rises over `warm_up` steps, then falls as a cosine.
    pub rate: f32,
    /// Steps until then.
    pub warm_up: usize,
    /// Weight decay.
    pub decay: f32,
    /// Share of the numbers that it started from in those that it ends with. The mean of a network
    /// and of what it became generalises better than either (Wortsman et al. 2022, Robust
    /// fine-tuning of zero-shot models, section 4).
    #[serde(skip_serializing_if = "is_none")]
    pub share_of_start: f32,
    /// How far the points at which later heads start are displaced while training \[px\].
    #[serde(skip_serializing_if = "is_usual_shake")]
    pub shake: f32,
    /// Weights of the aperture between the lids and between the lips, and the share of the steps
    /// after which they count.
    pub aperture: Aperture,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            seed: 1,
            turns: vec![0.0, 0.4, 0.8],
            iterations: 2,
            sizes: Sizes::default(),
            start: Start::default(),
            augment: Augment::default(),
            steps: 40_000,
            batch: 64,
            rendered: 0.4,
            occluded: 0.25,
            cut_off: 0.08,
            bent: 0.6,
            shut: 0.15,
            turned: 3.0,
            front: 0.0,
            rate: 2e-3,
            warm_up: 300,
            decay: 0.02,
            share_of_start: 0.0,
            shake: SHAKE,
            aperture: Aperture {
                lids: 6.0,
                lips: 2.0,
                from: 0.5,
            },
        }
    }
}

impl Options {
    /// As these, for the global stage's ensemble member: other random numbers, turned heads more
    /// often.
    pub fn ensemble_member(self) -> Options {
        Options {
            seed: self.seed ^ 0x2ed,
            turned: 2.0 * self.turned,
            ..self
        }
    }
}

/// What a gap's error weighs beside a landmark's.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Aperture {
    pub lids: f32,
    pub lips: f32,
    pub from: f32,
}

/// Upper and lower lids, upper and lower inner lips.
pub(super) const LIDS: [[usize; 2]; 4] = [[37, 41], [38, 40], [43, 47], [44, 46]];
const LIPS: [[usize; 2]; 3] = [[61, 67], [62, 66], [63, 65]];

impl Aperture {
    /// Pairs of landmarks, and what their gap weighs.
    pub fn pairs(&self) -> impl Iterator<Item = ([usize; 2], f32)> {
        let lids = LIDS.map(|pair| (pair, self.lids));
        lids.into_iter().chain(LIPS.map(|pair| (pair, self.lips)))
    }
}
