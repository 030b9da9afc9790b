//! Section `DTCT`: the scan's grid, the ensembles and the refining forest.
//!
//! ```text
//! u32 scale ratio [1/256]    u32 step [1/256 of the face's size]   u32 window side / size [1/256]
//! u32 margin [1/256 of size] u32 confirming strength
//! u32 R, i16[R] rolls [1/65536 turn]
//! u32 E, then per ensemble: u32 mirrored, u32 depth, u32 T,
//!     u16[T·(2^depth − 1)·2] nodes: pixels of the window's 40×40 grid,
//!     u8[T·(2^depth − 1)] margins, i16[T·2^depth] leaves, i32[T] thresholds
//! u32 rounds, u32 depth, u32 T, u16[…] nodes, u8[…] margins,
//!     i16[T·2^depth·5] leaves  (the refining forest)
//! ```

use super::forest::Forest;
use crate::model::{ModelError, Section, Tag};

/// The section's tag.
pub const TAG: Tag = *b"DTCT";
/// Most rolls that are scanned.
pub const ROLLS_MAX: usize = 12;
/// Most ensembles.
pub const ENSEMBLES_MAX: usize = 3;
/// Numbers that a leaf of the refining forest holds: shift right, shift down (in the window's own
/// axes, fractions of size), log of the size's ratio, roll \[rad\], all in 1/4096, and turn in
/// 1/4096.
pub const REFINE_OUTPUTS: usize = 5;

const TREES_MAX: usize = 4096;
const ROUNDS_MAX: usize = 8;

/// One soft cascade of boosted trees.
#[derive(Clone, Copy, Debug)]
pub struct Ensemble<'m> {
    /// Whether windows are also tested mirrored: then the ensemble knows one side view only.
    pub mirrored: bool,
    pub(super) forest: Forest<'m>,
    /// Per tree and leaf.
    pub(super) leaves: &'m [i16],
    /// Per tree: the window is no face when the sum so far lies below.
    pub(super) thresholds: &'m [i32],
}

/// The regression forest that moves a window onto the face.
#[derive(Clone, Copy, Debug)]
pub struct BoxRefiner<'m> {
    pub(super) rounds: usize,
    pub(super) forest: Forest<'m>,
    /// Per tree, leaf and output.
    pub(super) leaves: &'m [i16],
}

/// The detector's numbers, viewed in place.
#[derive(Clone, Copy, Debug)]
pub struct DetectorModel<'m> {
    /// Size of one pass over that of the pass before it \[1/256\], 128..=250.
    pub(super) ratio_q8: i32,
    /// From window to window \[1/256 of size\], 4..=256.
    pub(super) step_q8: i32,
    /// Side of the window that the trees look at over the size \[1/256\], 128..=1024.
    pub(super) side_q8: i32,
    /// How near centres come to the frame's edge \[1/256 of size\], 0..=256.
    pub(super) margin_q8: i32,
    /// Summed score from which merged hits are a face, > 0.
    pub(super) confirm: i32,
    /// Rolls scanned at each size, in order, −16384..=16384 \[1/65536 turn\].
    pub(super) rolls: &'m [i16],
    pub(super) ensembles: [Option<Ensemble<'m>>; ENSEMBLES_MAX],
    pub(super) refiner: BoxRefiner<'m>,
}

impl<'m> DetectorModel<'m> {
    /// Reads and checks the section; nothing is copied.
    ///
    /// # Errors
    /// [`ModelError::Section`] for whatever the scan relies on and does not hold.
    pub fn open(mut section: Section<'m>) -> Result<Self, ModelError> {
        let s = &mut section;
        let ratio_q8 = s.count(128, 250, "the scale ratio is out of range")? as i32;
        let step_q8 = s.count(4, 256, "the step is out of range")? as i32;
        let side_q8 = s.count(128, 1024, "the window's side is out of range")? as i32;
        let margin_q8 = s.count(0, 256, "the margin is out of range")? as i32;
        let confirm = s.count(1, 1 << 24, "the confirming strength is out of range")? as i32;
        let rolls = s.count(1, ROLLS_MAX, "too many rolls")?;
        let rolls = s.i16s(rolls)?;
        s.require(
            rolls.iter().all(|r| (-16_384..=16_384).contains(r)),
            "a roll is out of range",
        )?;
        let count = s.count(1, ENSEMBLES_MAX, "too many ensembles")?;
        let mut ensembles = [None; ENSEMBLES_MAX];
        for slot in ensembles.iter_mut().take(count) {
            *slot = Some(Ensemble::open(s)?);
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

    /// The ensembles, in the order in which they are asked.
    pub fn ensembles(&self) -> impl Iterator<Item = &Ensemble<'m>> {
        self.ensembles.iter().flatten()
    }

    /// The same detector with another strength (at least 1) from which merged hits are a face.
    pub fn confirming(self, strength: i32) -> Self {
        DetectorModel {
            confirm: strength.max(1),
            ..self
        }
    }

    /// Side of the window that the trees look at, as a multiple of a face's size \[1/256\].
    pub fn side_q8(&self) -> i32 {
        self.side_q8
    }
}

impl<'m> Ensemble<'m> {
    fn open(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let mirrored = s.count(0, 1, "a flag is neither 0 nor 1")? == 1;
        let forest = Forest::open(s, 1, TREES_MAX)?;
        let leaves = s.i16s(forest.trees() * forest.leaves())?;
        // Sums of TREES_MAX i16 stay far inside i32, so any threshold is sound.
        let thresholds = s.i32s(forest.trees())?;
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
        let rounds = s.count(0, ROUNDS_MAX, "too many rounds")?;
        let forest = Forest::open(s, 0, TREES_MAX)?;
        let leaves = s.i16s(forest.trees() * forest.leaves() * REFINE_OUTPUTS)?;
        Ok(BoxRefiner {
            rounds,
            forest,
            leaves,
        })
    }
}
