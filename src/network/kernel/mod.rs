//! Inner loops of the network: nearly all time of a step is spent here.
//!
//! [`scalar::Scalar`] defines what each loop computes. Every other kernel is one file that computes
//! the same integers with one instruction set, an implementation of [`Kernel`]; `choice.rs` lists
//! them and chooses one. `tests.rs` compares each with the scalar one.

// SIMD kernels are one of the places where `unsafe` is allowed.
#![allow(unsafe_code)]

#[cfg(target_arch = "aarch64")]
mod aarch64;
#[cfg(target_arch = "x86_64")]
mod avx;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod avx_depthwise;
#[cfg(target_arch = "x86_64")]
mod avx_dot_products;
mod choice;
mod depthwise_input;
#[cfg(target_arch = "aarch64")]
mod dotprod;
#[cfg(target_arch = "aarch64")]
mod neon;
mod operands;
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
mod relaxed;
#[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
mod scalar;
#[cfg(simd_kernel)]
mod shared;
#[cfg(all(target_arch = "wasm32", simd_kernel))]
mod simd128;
#[cfg(target_arch = "x86_64")]
mod sse2;
mod tail;
#[cfg(test)]
mod tests;
#[cfg(simd_kernel)]
mod unrolled;
#[cfg(target_arch = "x86_64")]
mod vnni;

pub use choice::set_dotprod;
pub(super) use choice::{Chosen, chosen, dispatch};
#[cfg(any(test, feature = "unstable-internals"))]
pub use choice::{KernelName, chosen_kernel, select_kernel};
pub(super) use depthwise_input::DepthwiseInput;
#[cfg(target_arch = "x86_64")]
use depthwise_input::Line;
#[cfg(simd_kernel)]
use operands::Tile;
pub(super) use operands::{
    BLOCK, DepthwiseWeights, MAX_ROWS, STAGING, Scale, Staging, Strip, StripParts, Sum, TapWeights,
};
#[cfg(all(simd_kernel, not(target_arch = "x86_64")))]
use shared::conv2d_by_block;
#[cfg(simd_kernel)]
use shared::forwarded;
#[cfg(simd_kernel)]
use unrolled::unrolled;

/// The loops of one instruction set. A value of the type shows that the machine has it.
pub(super) trait Kernel: Copy {
    /// Bytes of a staged value.
    const WIDTH: usize;
    /// The columns of a window's row are padded to a multiple of this, an even number.
    const GROUP: usize;
    /// Output pixels computed together, so that weights are read once for all of them.
    const TILE: usize;
    /// Whether [`Self::depthwise3x3`] reads the weights in pairs of taps.
    const PAIRED: bool = true;

    /// Whether staged values are the input's bytes, so that [`Self::conv2d`] takes it as it is.
    const DIRECT: bool = false;

    /// Stages input values for [`Self::conv2d`]: [`Self::WIDTH`] bytes for each, which stand for
    /// the value minus `zero_point`.
    #[inline(always)]
    fn stage(self, values: &[u8], zero_point: u8, staged: &mut [u8]) {
        if !Self::DIRECT {
            tail::widen(values, zero_point, staged);
        } else if let Some(staged) = staged.get_mut(..values.len()) {
            staged.copy_from_slice(values);
        }
    }

    /// The byte that fills what stands for values outside of the map.
    fn padding(self, zero_point: u8) -> u8 {
        if Self::DIRECT { zero_point } else { 0 }
    }

    /// Adds to each block's bias what its staged values lack.
    fn correct(self, _weights: &[i8], _zero_point: u8, _bias: &mut [[i32; BLOCK]]) {}

    /// Full convolution of a strip: `Σₖ values[k]·weights[k]`, requantised.
    fn conv2d(self, strip: Strip<'_>);

    /// Depthwise 3×3 convolution. Weights and scale are of all channels, and the scale is plain.
    fn depthwise3x3(
        self,
        input: DepthwiseInput<'_>,
        weights: &DepthwiseWeights<'_>,
        scale: &Scale<'_>,
        out: &mut [u8],
    );

    /// Weighted sum of two maps, in place of the first.
    fn add(self, sum: &Sum, other: &[u8], out: &mut [u8]);

    /// `Σ feature·weight`.
    fn dot(self, features: &[u8], weights: &[i8]) -> i32;

    /// [`Self::dot`] with each row of the weights.
    #[inline(always)]
    fn dots(self, features: &[u8], rows: &[i8], sums: &mut [i32]) {
        let rows = rows.chunks_exact(features.len().max(1));
        for (sum, weights) in sums.iter_mut().zip(rows) {
            *sum = self.dot(features, weights);
        }
    }
}

/// `Σ feature·weight` with each row of the weights.
pub(crate) fn dots(features: &[u8], rows: &[i8], sums: &mut [i32]) {
    dispatch!(kernel => kernel.dots(features, rows, sums))
}
