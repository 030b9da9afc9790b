//! Complete binary trees of pixel comparisons, stored breadth first.
//!
//! A node is two pixels of the window's [grid](super::grid) and a u8 margin. A walk goes to the
//! second child where the luma of the first pixel exceeds that of the second by more than the
//! margin. Without a margin noise decides the comparison in flat regions: the margin halves the
//! false positives of equally many trees.

use super::grid::{GRID, Pixel};
use posewise_format::{ModelError, Section};

/// Deepest trees that a model may have.
pub(super) const DEPTH_MAX: usize = 8;

/// Trees that are walked in parallel.
pub(super) const PARALLEL_TREES: usize = 4;

/// Trees of one depth; their owner keeps the values of the leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forest<'m> {
    depth: u32,
    trees: usize,
    nodes: &'m [[Pixel; 2]],
    margins: &'m [u8],
}

impl<'m> Forest<'m> {
    /// Reads depth, number of trees (`min..=max`), the nodes and their margins.
    pub fn open(section: &mut Section<'m>, min: usize, max: usize) -> Result<Self, ModelError> {
        let depth = section.count(1, DEPTH_MAX, "trees are too deep")? as u32;
        let trees = section.count(min, max, "the number of trees is out of range")?;
        let count = trees * ((1 << depth) - 1);
        let (nodes, _) = section.u16s(count * 2)?.as_chunks();
        let outside = |pixel: &Pixel| *pixel as usize >= GRID * GRID;
        section.require(
            !nodes.as_flattened().iter().any(outside),
            "a tree reads a pixel outside the grid",
        )?;
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

    /// The leaf, 0..`leaves()`, that a window with this luma reaches in each of [`PARALLEL_TREES`]
    /// trees from `tree` on. Values of trees beyond the last are undefined.
    ///
    /// Each step of a walk waits for the pixels that it compares; parallel walks overlap their
    /// waits.
    #[inline]
    pub fn walk(&self, tree: usize, luma: impl Fn(Pixel) -> u8) -> [usize; PARALLEL_TREES] {
        let inner = (1usize << self.depth) - 1;
        let mut at = [0; PARALLEL_TREES];
        for _ in 0..self.depth {
            for (k, at) in at.iter_mut().enumerate() {
                let node = (tree + k) * inner + *at;
                let [first, second] = self.nodes.get(node).copied().unwrap_or_default();
                let margin = self.margins.get(node).copied().unwrap_or(0);
                let brighter = luma(first) as u16 > luma(second) as u16 + margin as u16;
                *at = 2 * *at + 1 + usize::from(brighter);
            }
        }
        at.map(|at| at - inner)
    }
}
