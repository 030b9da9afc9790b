//! Complete binary trees of pixel comparisons, stored breadth first.
//!
//! A node is four i8: the offsets x₁, y₁, x₂, y₂ from the window's centre in 1/256 of its side.
//! The walk goes to the second child where the luma at the first point exceeds that at the second.

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
}

impl<'m> Forest<'m> {
    /// Reads depth, number of trees (`min..=max`) and the nodes.
    pub fn open(section: &mut Section<'m>, min: usize, max: usize) -> Result<Self, ModelError> {
        let depth = section.count(1, DEPTH_MAX, "trees are too deep")? as u32;
        let trees = section.count(min, max, "the number of trees is out of range")?;
        let bytes = section.i8s(trees * ((1 << depth) - 1) * 4)?;
        let (nodes, _) = bytes.as_chunks();
        Ok(Forest {
            depth,
            trees,
            nodes,
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
            let brighter = window.read(frame, x1, y1) > window.read(frame, x2, y2);
            at = 2 * at + 1 + usize::from(brighter);
        }
        at - inner
    }
}
