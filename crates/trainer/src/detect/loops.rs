//! Inner loops of the tile network, which the compiler vectorises.
//!
//! All are inlined into functions that `pulp` compiles for the processor's vectors. Blocks of
//! outputs have sizes whose sums fit the registers of AVX2.

use super::layer::{FIRST_KERNEL, Layer};

/// Channels that a depthwise convolution computes together; all maps have a multiple of them.
const LANES: usize = 8;

/// out += x·w; x is `[n][inputs]`, w `[inputs][outputs]`, outputs a multiple of 8.
#[inline(always)]
pub fn gemm(x: &[f32], inputs: usize, w: &[f32], outputs: usize, out: &mut [f32]) {
    let mut first = 0;
    while first < outputs {
        let left = outputs - first;
        first += if left.is_multiple_of(24) {
            gemm_block::<24, 4>(x, inputs, w, outputs, first, out)
        } else if left.is_multiple_of(16) {
            gemm_block::<16, 6>(x, inputs, w, outputs, first, out)
        } else {
            gemm_block::<8, 8>(x, inputs, w, outputs, first, out)
        };
    }
}

/// `B` outputs of `Q` rows at a time; returns `B`.
#[inline(always)]
fn gemm_block<const B: usize, const Q: usize>(
    x: &[f32],
    inputs: usize,
    w: &[f32],
    outputs: usize,
    first: usize,
    out: &mut [f32],
) -> usize {
    let mut rows_x = x.chunks_exact(Q * inputs);
    let mut rows_out = out.chunks_exact_mut(Q * outputs);
    for (x, out) in rows_x.by_ref().zip(rows_out.by_ref()) {
        let mut sums = [[0.0f32; B]; Q];
        for i in 0..inputs {
            let w: &[f32; B] = w[i * outputs + first..].first_chunk().expect("weights");
            for q in 0..Q {
                let v = x[q * inputs + i];
                for k in 0..B {
                    sums[q][k] = v.mul_add(w[k], sums[q][k]);
                }
            }
        }
        for (sums, out) in sums.iter().zip(out.chunks_exact_mut(outputs)) {
            let out = &mut out[first..][..B];
            out.iter_mut().zip(sums).for_each(|(o, s)| *o += s);
        }
    }
    let rest = rows_x.remainder().chunks_exact(inputs);
    let rest_out = rows_out.into_remainder().chunks_exact_mut(outputs);
    for (x, out) in rest.zip(rest_out) {
        for (i, v) in x.iter().enumerate() {
            let w = &w[i * outputs + first..][..B];
            let out = &mut out[first..][..B];
            out.iter_mut()
                .zip(w)
                .for_each(|(o, w)| *o = v.mul_add(*w, *o));
        }
    }
    B
}

/// `by_weights` += xᵀ·by; x is `[n][inputs]`, by `[n][outputs]`, outputs a multiple of 8.
#[inline(always)]
pub fn outer(x: &[f32], inputs: usize, by: &[f32], outputs: usize, by_weights: &mut [f32]) {
    let mut first = 0;
    while first < outputs {
        let left = outputs - first;
        first += if left.is_multiple_of(24) {
            outer_block::<24, 4>(x, inputs, by, outputs, first, by_weights)
        } else if left.is_multiple_of(16) {
            outer_block::<16, 6>(x, inputs, by, outputs, first, by_weights)
        } else {
            outer_block::<8, 8>(x, inputs, by, outputs, first, by_weights)
        };
    }
}

/// `B` outputs of `Q` inputs at a time; returns `B`.
#[inline(always)]
fn outer_block<const B: usize, const Q: usize>(
    x: &[f32],
    inputs: usize,
    by: &[f32],
    outputs: usize,
    first: usize,
    by_weights: &mut [f32],
) -> usize {
    let mut i = 0;
    while i < inputs {
        i += if i + Q <= inputs {
            outer_rows::<B, Q>(x, inputs, by, outputs, [i, first], by_weights)
        } else {
            outer_rows::<B, 1>(x, inputs, by, outputs, [i, first], by_weights)
        };
    }
    B
}

/// Weights of `Q` inputs, from one on, to `B` outputs, from one on; returns `Q`.
#[inline(always)]
fn outer_rows<const B: usize, const Q: usize>(
    x: &[f32],
    inputs: usize,
    by: &[f32],
    outputs: usize,
    [i, first]: [usize; 2],
    by_weights: &mut [f32],
) -> usize {
    let mut sums = [[0.0f32; B]; Q];
    for (x, by) in x.chunks_exact(inputs).zip(by.chunks_exact(outputs)) {
        let by: &[f32; B] = by[first..].first_chunk().expect("gradients");
        let x: &[f32; Q] = x[i..].first_chunk().expect("inputs");
        for q in 0..Q {
            for k in 0..B {
                sums[q][k] = x[q].mul_add(by[k], sums[q][k]);
            }
        }
    }
    for (q, sums) in sums.iter().enumerate() {
        let to = &mut by_weights[(i + q) * outputs + first..][..B];
        to.iter_mut().zip(sums).for_each(|(t, s)| *t += s);
    }
    Q
}

/// Windows of the first layer, one row per output pixel.
#[inline(always)]
pub fn columns(input: &[f32], l: &Layer, out: &mut Vec<f32>) {
    const STRIDE: usize = 2;
    let (kernel, reach) = (FIRST_KERNEL, FIRST_KERNEL / 2);
    let n = kernel * kernel;
    out.clear();
    out.resize(l.side * l.side * n, 0.0);
    for (at, row) in out.chunks_exact_mut(n).enumerate() {
        let (x, y) = (at % l.side, at / l.side);
        let left = (x * STRIDE).saturating_sub(reach);
        let right = (x * STRIDE + kernel - reach).min(l.side_in);
        let skipped = left + reach - x * STRIDE;
        for ky in 0..kernel {
            let sy = (y * STRIDE + ky).wrapping_sub(reach);
            if sy < l.side_in {
                let from = &input[sy * l.side_in + left..sy * l.side_in + right];
                row[ky * kernel + skipped..][..from.len()].copy_from_slice(from);
            }
        }
    }
}

/// Input pixel of a tap of the 3×3 kernel along one axis, if it lies in the map.
#[inline(always)]
fn tap(at: usize, stride: usize, k: usize, side: usize) -> Option<usize> {
    let from = (at * stride + k).wrapping_sub(1);
    (from < side).then_some(from)
}

/// Adds the 3×3 convolution of each channel.
#[inline(always)]
pub fn depthwise(input: &[f32], l: &Layer, stride: usize, weights: &[f32], out: &mut [f32]) {
    let c = l.channels;
    for block in (0..c).step_by(LANES) {
        let taps: [[f32; LANES]; 9] =
            std::array::from_fn(|t| *weights[t * c + block..].first_chunk().expect("a tap"));
        for (at, pixel) in out.chunks_exact_mut(c).enumerate() {
            let (x, y) = (at % l.side, at / l.side);
            let to: &mut [f32; LANES] = pixel[block..].first_chunk_mut().expect("lanes");
            let mut sum = *to;
            for ky in 0..3 {
                let Some(sy) = tap(y, stride, ky, l.side_in) else {
                    continue;
                };
                for kx in 0..3 {
                    let Some(sx) = tap(x, stride, kx, l.side_in) else {
                        continue;
                    };
                    let from = &input[(sy * l.side_in + sx) * c + block..];
                    let v: &[f32; LANES] = from.first_chunk().expect("lanes");
                    let w = &taps[ky * 3 + kx];
                    for k in 0..LANES {
                        sum[k] = v[k].mul_add(w[k], sum[k]);
                    }
                }
            }
            *to = sum;
        }
    }
}

/// Adds the gradients of [`depthwise`] by weights and input.
#[inline(always)]
pub fn depthwise_back(
    input: &[f32],
    l: &Layer,
    stride: usize,
    weights: &[f32],
    by_out: &[f32],
    by_weights: &mut [f32],
    by_in: &mut [f32],
) {
    let c = l.channels;
    for block in (0..c).step_by(LANES) {
        for (y, by_row) in by_out.chunks_exact(l.side * c).enumerate() {
            for t in 0..9 {
                let Some(sy) = tap(y, stride, t / 3, l.side_in) else {
                    continue;
                };
                let place = t * c + block;
                let w: &[f32; LANES] = weights[place..].first_chunk().expect("a tap");
                let mut sum = [0.0f32; LANES];
                for (x, by) in by_row.chunks_exact(c).enumerate() {
                    let Some(sx) = tap(x, stride, t % 3, l.side_in) else {
                        continue;
                    };
                    let by: &[f32; LANES] = by[block..].first_chunk().expect("lanes");
                    let from = (sy * l.side_in + sx) * c + block;
                    let v: &[f32; LANES] = input[from..].first_chunk().expect("lanes");
                    let d: &mut [f32; LANES] = by_in[from..].first_chunk_mut().expect("lanes");
                    for k in 0..LANES {
                        sum[k] = by[k].mul_add(v[k], sum[k]);
                        d[k] = by[k].mul_add(w[k], d[k]);
                    }
                }
                let to = by_weights[place..][..LANES].iter_mut();
                to.zip(sum).for_each(|(t, s)| *t += s);
            }
        }
    }
}
