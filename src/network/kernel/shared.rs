//! What several kernels have in common, as macros: a generic function could not have the target
//! features of the one that calls it.

/// The methods of [`Kernel`](super::Kernel) that call the functions of their names, which need the
/// target features that a value of the kernel's type shows.
macro_rules! forwarded {
    () => {
        fn conv2d(self, strip: $crate::network::kernel::Strip<'_>) {
            // SAFETY: `self` exists only where the machine has the features; so for all below.
            unsafe { conv2d(strip) }
        }

        fn depthwise3x3(
            self,
            input: $crate::network::kernel::DepthwiseInput<'_>,
            weights: &$crate::network::kernel::DepthwiseWeights<'_>,
            scale: &$crate::network::kernel::Scale<'_>,
            out: &mut [u8],
        ) {
            // SAFETY: as above.
            unsafe { depthwise3x3(input, weights, scale, out) }
        }

        fn add(self, sum: &$crate::network::kernel::Sum, other: &[u8], out: &mut [u8]) {
            // SAFETY: as above.
            unsafe { add(sum, other, out) }
        }

        fn dot(self, features: &[u8], weights: &[i8]) -> i32 {
            // SAFETY: as above.
            unsafe { dot(features, weights) }
        }
    };
}

/// `conv2d` with tiles of `TILE` pixels and one block, by the module's `sums` and `Requantization`.
#[cfg(not(target_arch = "x86_64"))]
macro_rules! conv2d_by_block {
    ($features:literal) => {
        #[target_feature(enable = $features)]
        fn conv2d(mut strip: Strip<'_>) {
            let (pixels, channels) = (strip.pixels(), strip.channels());
            let scale = *strip.scale();
            let requantization = Requantization::new(&scale);
            for block in 0..strip.blocks() {
                let requantization = requantization.of_block(&scale, block);
                let mut out = strip.out().as_mut_ptr().wrapping_add(block * BLOCK);
                let mut first = 0;
                while first < pixels {
                    let tile = strip.tile(first, TILE);
                    // SAFETY: the strip has this block, and the outputs of all its blocks at all
                    // pixels.
                    unsafe {
                        let sums = sums(&strip, tile, block);
                        if scale.is_plain() && tile.present == TILE {
                            unrolled!(p < TILE => {
                                requantization.store::<true>(sums[p], out);
                                out = out.wrapping_add(channels);
                            });
                        } else {
                            unrolled!(p < TILE => {
                                if p < tile.present {
                                    requantization.store::<false>(sums[p], out);
                                    out = out.wrapping_add(channels);
                                }
                            });
                        }
                    }
                    first += tile.present;
                }
            }
        }
    };
}

#[cfg(not(target_arch = "x86_64"))]
pub(super) use conv2d_by_block;
pub(super) use forwarded;
