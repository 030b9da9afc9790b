//! Layers of the tile network and what its outputs are.

/// Cells along each side of the last map, and tile px per cell.
pub const CELLS: usize = 16;
pub const STRIDE: f32 = 8.0;
/// Score, dx, dy, log size, roll, yaw, and two that are not used: kernels compute eight together.
pub const OUTPUTS: usize = 8;

/// What a layer computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// 5×5 convolution of the tile with a stride of 2, then ReLU.
    First,
    /// 3×3 convolution of each channel, then ReLU.
    Depthwise { stride: usize },
    /// 1×1 convolution, then ReLU.
    Pointwise,
    /// Adds the map two layers before.
    Add,
    /// 1×1 convolution.
    Head,
}

/// Side of the first layer's kernel \[px\].
pub const FIRST_KERNEL: usize = 5;
/// How many layers before the map is that [`Op::Add`] adds.
pub const ADDEND_BACK: usize = 2;

/// A layer and the place of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    pub op: Op,
    pub side_in: usize,
    pub inputs: usize,
    pub side: usize,
    pub channels: usize,
    /// Weights `[inputs of an output][channels]`, then biases, start here.
    pub at: usize,
    pub weights: usize,
}

impl Layer {
    /// Number of biases.
    pub fn biases(&self) -> usize {
        if self.weights == 0 { 0 } else { self.channels }
    }

    /// Whether a ReLU follows.
    pub fn has_relu(&self) -> bool {
        !matches!(self.op, Op::Add | Op::Head)
    }

    /// Its weights and biases.
    pub fn parameters<'p>(&self, all: &'p [f32]) -> (&'p [f32], &'p [f32]) {
        all[self.at..][..self.weights + self.biases()].split_at(self.weights)
    }

    /// The same, to be written.
    pub fn parameters_mut<'p>(&self, all: &'p mut [f32]) -> (&'p mut [f32], &'p mut [f32]) {
        all[self.at..][..self.weights + self.biases()].split_at_mut(self.weights)
    }
}
