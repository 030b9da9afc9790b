//! Complete binary trees of pixel comparisons, stored breadth first.
//!
//! A node is four i8, the offsets x₁, y₁, x₂, y₂ from the window's centre in 1/256 of its side, and
//! a u8 margin. The walk goes to the second child where the luma at the first point exceeds that at
//! the second by more than the margin: without one, noise decides where a picture is flat (halves
//! the false alarms of equally many trees).

use super::Window;
use crate::image::Frame;
use crate::model::{ModelError, Section};

/// Deepest trees that a model may have.
pub(super) const DEPTH_MAX: usize = 8;

/// Trees of one depth; leaves are kept by the owner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forest<'m> {
    depth: u32,
    trees: usize,
    nodes: &'m [[i8; 4]],
    margins: &'m [u8],
}

impl<'m> Forest<'m> {
    /// Reads depth, number of trees (`min..=max`), the nodes and their margins.
    pub fn open(section: &mut Section<'m>, min: usize, max: usize) -> Result<Self, ModelError> {
        let depth = section.count(1, DEPTH_MAX, "trees are too deep")? as u32;
        let trees = section.count(min, max, "the number of trees is out of range")?;
        let count = trees * ((1 << depth) - 1);
        let (nodes, _) = section.i8s(count * 4)?.as_chunks();
        let margins = section.u8s(count)?;
        Ok(Forest {
            depth,
            trees,
            nodes,
            margins,
        })
    }

    /// Number of trees.
    pub fn trees(&self) -> usize {
        self.trees
    }

    /// Leaves per tree.
    pub fn leaves(&self) -> usize {
        1 << self.depth
    }

    /// The leaf, 0..`leaves()`, that the window reaches in a tree (`< trees()`).
    #[inline]
    pub fn leaf(&self, tree: usize, frame: &Frame<'_>, window: &Window) -> usize {
        let inner = (1usize << self.depth) - 1;
        let base = tree * inner;
        let mut at = 0;
        for _ in 0..self.depth {
            // `open` checked the length, so the fallback is never taken.
            let [x1, y1, x2, y2] = self.nodes.get(base + at).copied().unwrap_or_default();
            let margin = self.margins.get(base + at).copied().unwrap_or(0);
            let first = window.read(frame, x1, y1) as u16;
            let brighter = first > window.read(frame, x2, y2) as u16 + margin as u16;
            at = 2 * at + 1 + usize::from(brighter);
        }
        at - inner
    }
}
