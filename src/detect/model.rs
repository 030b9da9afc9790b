//! Section `DTCT`: the scan's steps, the ensembles and the regression forest.
//!
//! ```text
//! u32 scale ratio [1/256]    u32 step [1/256 of the face's size]   u32 window side / size [1/256]
//! u32 margin [1/256 of size] u32 confirmation strength
//! u32 R, i16[R] rolls [1/65536 revolution]
//! u32 E, then per ensemble: u32 mirrored, u32 depth, u32 T,
//!     u16[T·(2^depth − 1)·2] nodes: pixels of the window's 40×40 grid,
//!     u8[T·(2^depth − 1)] margins, i16[T·2^depth] leaves, i32[T] thresholds
//! u32 iterations, u32 depth, u32 T, u16[…] nodes, u8[…] margins,
//!     i16[T·2^depth·5] leaves  (the regression forest)
//! ```

use super::forest::Forest;
use posewise_format::{ModelError, Section, Tag};

/// The section's tag.
pub const TAG: Tag = *b"DTCT";
/// Most rolls that are scanned.
pub const ROLLS_MAX: usize = 12;
/// Most ensembles.
pub const ENSEMBLES_MAX: usize = 3;
/// Outputs of a leaf of the regression forest \[1/4096\]: shift right and shift down (along the
/// window's own axes, as a share of its size), natural logarithm of the size's ratio, change of
/// roll \[rad\], and yaw as in [`Detection::yaw`](super::Detection::yaw).
pub const REFINE_OUTPUTS: usize = 5;

const TREES_MAX: usize = 4096;
/// Largest magnitude of a window's sum, and so of a threshold: that many leaves of an `i16` each.
const SUM_MAX: u32 = TREES_MAX as u32 * i16::MIN.unsigned_abs() as u32;
const ITERATIONS_MAX: usize = 8;

/// A soft cascade of boosted trees (Bourdev and Brandt, "Robust object detection via soft cascade",
/// 2005): a window is rejected at the first tree where its sum falls below the tree's threshold.
#[derive(Clone, Copy, Debug)]
pub struct Ensemble<'m> {
    /// Whether windows are also evaluated mirrored: then the ensemble is trained on one side view
    /// only.
    pub mirrored: bool,
    pub(super) forest: Forest<'m>,
    /// Value per tree and leaf.
    pub(super) leaves: &'m [i16],
    /// Per tree: the window is rejected when the sum so far lies below.
    pub(super) thresholds: &'m [i32],
}

/// The regression forest that moves a window onto the face.
#[derive(Clone, Copy, Debug)]
pub struct BoxRefiner<'m> {
    pub(super) iterations: usize,
    pub(super) forest: Forest<'m>,
    /// Value per tree, leaf and output.
    pub(super) leaves: &'m [i16],
}

/// The detector's parameters, viewed in place.
#[derive(Clone, Debug)]
pub struct DetectorModel<'m> {
    /// Ratio of each size to the one before it \[1/256\], 128..=250.
    pub(super) ratio_q8: i32,
    /// Step from window to window \[1/256 of size\], 4..=256.
    pub(super) step_q8: i32,
    /// Ratio of the side of the window that the trees read to the size \[1/256\], 128..=1024.
    pub(super) side_q8: i32,
    /// Smallest distance of centres from the frame's edge \[1/256 of size\], 0..=256.
    pub(super) margin_q8: i32,
    /// Summed score from which merged hits are a candidate, > 0.
    pub(super) confirm: i32,
    /// Rolls scanned at each size, in order, −16384..=16384 \[1/65536 revolution\].
    pub(super) rolls: &'m [i16],
    /// In the order of evaluation.
    pub(super) ensembles: heapless::Vec<Ensemble<'m>, ENSEMBLES_MAX>,
    pub(super) refiner: BoxRefiner<'m>,
}

impl<'m> DetectorModel<'m> {
    /// Reads and checks the section; nothing is copied.
    ///
    /// # Errors
    /// [`ModelError::Section`] names the first precondition of the scan that does not hold.
    pub fn open(mut section: Section<'m>) -> Result<Self, ModelError> {
        let s = &mut section;
        let ratio_q8 = s.count(128, 250, "the scale ratio is out of range")? as i32;
        let step_q8 = s.count(4, 256, "the step is out of range")? as i32;
        let side_q8 = s.count(128, 1024, "the window's side is out of range")? as i32;
        let margin_q8 = s.count(0, 256, "the margin is out of range")? as i32;
        let confirm = s.count(1, 1 << 24, "the confirmation strength is out of range")? as i32;
        let rolls = s.count(1, ROLLS_MAX, "too many rolls")?;
        let rolls = s.i16s(rolls)?;
        s.require(
            rolls.iter().all(|r| (-16_384..=16_384).contains(r)),
            "a roll is out of range",
        )?;
        let count = s.count(1, ENSEMBLES_MAX, "too many ensembles")?;
        let mut ensembles = heapless::Vec::new();
        for _ in 0..count {
            let ensemble = Ensemble::open(s)?;
            // `count` is at most the capacity, so there is space.
            let _ = ensembles.push(ensemble);
        }
        let refiner = BoxRefiner::open(s)?;
        Ok(DetectorModel {
            ratio_q8,
            step_q8,
            side_q8,
            margin_q8,
            confirm,
            rolls,
            ensembles,
            refiner,
        })
    }
}

impl<'m> Ensemble<'m> {
    fn open(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let mirrored = s.count(0, 1, "a flag is neither 0 nor 1")? == 1;
        let forest = Forest::open(s, 1, TREES_MAX)?;
        let leaves = s.i16s(forest.trees() * forest.leaves())?;
        let thresholds = s.i32s(forest.trees())?;
        s.require(
            thresholds.iter().all(|t| t.unsigned_abs() <= SUM_MAX),
            "a threshold is out of range",
        )?;
        Ok(Ensemble {
            mirrored,
            forest,
            leaves,
            thresholds,
        })
    }

    /// Number of trees.
    pub fn trees(&self) -> usize {
        self.forest.trees()
    }
}

impl<'m> BoxRefiner<'m> {
    fn open(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let iterations = s.count(0, ITERATIONS_MAX, "too many iterations")?;
        let forest = Forest::open(s, 0, TREES_MAX)?;
        let leaves = s.i16s(forest.trees() * forest.leaves() * REFINE_OUTPUTS)?;
        Ok(BoxRefiner {
            iterations,
            forest,
            leaves,
        })
    }
}
