//! The cascade of trees, and how windows and patches pass it.

use posewise::detect::Window;
use posewise::image::Frame;
use serde::{Deserialize, Serialize};

use super::boost::{Node, Tree, brighter};

/// One unit of a leaf.
pub const UNIT: f32 = 1.0 / 4096.0;

/// Trees with their thresholds, in units of [`UNIT`].
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Cascade {
    pub depth: usize,
    pub trees: Vec<Tree>,
    pub thresholds: Vec<i32>,
}

/// The cascade as the core stores it.
pub struct Flat {
    pub nodes: Vec<Node>,
    pub leaves: Vec<i16>,
    thresholds: Vec<i32>,
    inner: usize,
}

impl Cascade {
    /// Flattened for speed.
    pub fn flat(&self) -> Flat {
        Flat {
            nodes: self.trees.iter().flat_map(|t| t.nodes.clone()).collect(),
            leaves: self
                .trees
                .iter()
                .flat_map(|t| t.leaves.iter().map(|l| quantised(l[0])))
                .collect(),
            thresholds: self.thresholds.clone(),
            inner: (1 << self.depth) - 1,
        }
    }
}

/// A leaf in units of [`UNIT`].
pub fn quantised(leaf: f32) -> i16 {
    (leaf / UNIT).round() as i16
}

impl Flat {
    fn walk(&self, mut second: impl FnMut(usize) -> bool, mut sum: impl FnMut(usize, i32) -> bool) {
        for tree in 0..self.thresholds.len() {
            let mut at = 0;
            while at < self.inner {
                at = 2 * at + 1 + usize::from(second(tree * self.inner + at));
            }
            let leaf = self.leaves[tree * (self.inner + 1) + at - self.inner];
            if !sum(tree, leaf as i32) {
                return;
            }
        }
    }

    fn passes_by(&self, second: impl FnMut(usize) -> bool) -> bool {
        let (mut total, mut passed) = (0, true);
        self.walk(second, |tree, leaf| {
            total += leaf;
            passed = total >= self.thresholds[tree];
            passed
        });
        passed
    }

    fn asks(&self, node: usize, frame: &Frame<'_>, window: &Window) -> bool {
        let [first, second, margin] = self.nodes[node];
        let first = window.read(frame, first);
        brighter(first, window.read(frame, second), margin)
    }

    /// Whether a window passes every threshold.
    pub fn passes(&self, frame: &Frame<'_>, window: &Window) -> bool {
        self.passes_by(|n| self.asks(n, frame, window))
    }

    /// Whether a patch passes every threshold.
    pub fn passes_patch(&self, patch: &[u8]) -> bool {
        self.passes_by(|n| {
            let [a, b, margin] = self.nodes[n];
            brighter(patch[a as usize], patch[b as usize], margin)
        })
    }

    /// The sums after each tree, thresholds aside.
    pub fn sums(&self, frame: &Frame<'_>, window: &Window) -> Vec<i32> {
        let (mut total, mut sums) = (0, Vec::with_capacity(self.thresholds.len()));
        self.walk(
            |n| self.asks(n, frame, window),
            |_, leaf| {
                total += leaf;
                sums.push(total);
                true
            },
        );
        sums
    }
}
