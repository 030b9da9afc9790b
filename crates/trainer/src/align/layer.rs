//! Convolutional layers in `f32`, forwards and backwards, one sample at a time.
//!
//! Maps are `[height][width][channels]`. Convolutions are matrix products over unrolled windows;
//! borders are padded with zeros so that a stride of 1 keeps the size and a stride of 2 halves it.
//! `by_output`, `by_weights` and `by_input` are the loss's gradients by these; layers add to the
//! latter two.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Height, width, channels.
pub type Dims = [usize; 3];

/// Working memory of one thread.
#[derive(Default)]
pub struct Scratch {
    columns: Vec<f32>,
}

/// A full convolution: every output channel reads all input channels. Weights are
/// `[kernel²·inputs][outputs]`.
pub struct Conv {
    /// Size of its input.
    pub from: Dims,
    /// Size of its output.
    pub to: Dims,
    /// Width of its square kernel (1, 3 or 5).
    pub kernel: usize,
    /// Distance between output pixels.
    pub stride: usize,
}

impl Conv {
    /// A kernel of one pixel needs no unrolled windows.
    fn is_pointwise(&self) -> bool {
        self.kernel == 1 && self.stride == 1
    }

    /// Output pixels, and weights per output channel.
    fn size(&self) -> (usize, usize) {
        let columns = self.kernel * self.kernel * self.from[2];
        (self.to[0] * self.to[1], columns)
    }

    /// Computes the output.
    pub fn forward(
        &self,
        input: &[f32],
        weights: &[f32],
        biases: &[f32],
        out: &mut [f32],
        scratch: &mut Scratch,
    ) {
        let (rows, columns) = self.size();
        let channels = self.to[2];
        out.chunks_exact_mut(channels)
            .for_each(|o| o.copy_from_slice(biases));
        if self.is_pointwise() {
            product(out, [rows, channels], input, weights, columns);
        } else {
            unroll(input, self, &mut scratch.columns);
            product(out, [rows, channels], &scratch.columns, weights, columns);
        }
    }

    /// Adds the gradients by the weights and, unless it is `None`, by the input.
    pub fn backward(
        &self,
        input: &[f32],
        weights: &[f32],
        by_output: &[f32],
        by_weights: &mut [f32],
        by_input: Option<&mut [f32]>,
        scratch: &mut Scratch,
    ) {
        let (rows, columns) = self.size();
        let channels = self.to[2];
        let (of_weights, of_input) = ([columns, channels], [rows, columns]);
        if self.is_pointwise() {
            product_of_transpose(by_weights, of_weights, input, by_output, rows);
            if let Some(by_input) = by_input {
                product_by_transpose(by_input, of_input, by_output, weights, channels);
            }
        } else {
            let unrolled = &mut scratch.columns;
            unroll(input, self, unrolled);
            product_of_transpose(by_weights, of_weights, unrolled, by_output, rows);
            if let Some(by_input) = by_input {
                unrolled.fill(0.0);
                product_by_transpose(unrolled, of_input, by_output, weights, channels);
                roll(unrolled, self, by_input);
            }
        }
    }
}

/// A 3×3 convolution of each channel by itself. Weights are `[9][channels]`.
pub struct Depthwise {
    /// Size of its input.
    pub from: Dims,
    /// Size of its output.
    pub to: Dims,
    /// Distance between output pixels.
    pub stride: usize,
}

impl Depthwise {
    /// Computes the output.
    pub fn forward(&self, input: &[f32], weights: &[f32], biases: &[f32], out: &mut [f32]) {
        let channels = self.to[2];
        out.chunks_exact_mut(channels)
            .for_each(|o| o.copy_from_slice(biases));
        self.for_taps(|tap, source, target| {
            let w = &weights[tap * channels..][..channels];
            let x = &input[source..source + channels];
            let o = &mut out[target..target + channels];
            for k in 0..channels {
                o[k] += w[k] * x[k];
            }
        });
    }

    /// Adds the gradients by the weights and by the input.
    pub fn backward(
        &self,
        input: &[f32],
        weights: &[f32],
        by_output: &[f32],
        by_weights: &mut [f32],
        by_input: &mut [f32],
    ) {
        let channels = self.to[2];
        self.for_taps(|tap, source, target| {
            let w = &weights[tap * channels..][..channels];
            let g = &mut by_weights[tap * channels..][..channels];
            let s = &by_output[target..target + channels];
            let x = &input[source..source + channels];
            let d = &mut by_input[source..source + channels];
            for k in 0..channels {
                g[k] += s[k] * x[k];
                d[k] += s[k] * w[k];
            }
        });
    }

    /// Calls `each(tap, input index, output index)` for the 3×3 windows, borders left out.
    fn for_taps(&self, mut each: impl FnMut(usize, usize, usize)) {
        let (from, to, stride) = (self.from, self.to, self.stride);
        let channels = to[2];
        for y in 0..to[0] {
            for x in 0..to[1] {
                let target = (y * to[1] + x) * channels;
                for tap in 0..9 {
                    let (sy, sx) = (y * stride + tap / 3, x * stride + tap % 3);
                    if (1..=from[0]).contains(&sy) && (1..=from[1]).contains(&sx) {
                        each(tap, ((sy - 1) * from[1] + sx - 1) * channels, target);
                    }
                }
            }
        }
    }
}

/// fine += coarse, read at its nearest pixel; `coarse` has half the size of `fine`.
pub fn add_upsampled(fine: &mut [f32], fine_dims: Dims, coarse: &[f32], coarse_width: usize) {
    let channels = fine_dims[2];
    for (at, f) in fine.chunks_exact_mut(channels).enumerate() {
        let (y, x) = (at / fine_dims[1] / 2, at % fine_dims[1] / 2);
        add(f, &coarse[(y * coarse_width + x) * channels..][..channels]);
    }
}

/// The transpose of [`add_upsampled`]: coarse += the sum of the fine pixels that read it.
pub fn add_downsampled(coarse: &mut [f32], coarse_width: usize, fine: &[f32], fine_dims: Dims) {
    let channels = fine_dims[2];
    for (at, f) in fine.chunks_exact(channels).enumerate() {
        let (y, x) = (at / fine_dims[1] / 2, at % fine_dims[1] / 2);
        let start = (y * coarse_width + x) * channels;
        add(&mut coarse[start..start + channels], f);
    }
}

/// to += from.
pub fn add(to: &mut [f32], from: &[f32]) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
}

/// out += a·b; a is `rows × inner`.
fn product(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(&a[..size[0] * inner], size[0], inner);
    let b = MatRef::from_row_major_slice(b, inner, size[1]);
    add_product(out, size, a, b);
}

/// out += aᵀ·b; a is `inner × rows`.
fn product_of_transpose(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(&a[..size[0] * inner], inner, size[0]);
    let b = MatRef::from_row_major_slice(b, inner, size[1]);
    add_product(out, size, a.transpose(), b);
}

/// out += a·bᵀ; b is `columns × inner`.
fn product_by_transpose(out: &mut [f32], size: [usize; 2], a: &[f32], b: &[f32], inner: usize) {
    let a = MatRef::from_row_major_slice(a, size[0], inner);
    let b = MatRef::from_row_major_slice(b, size[1], inner);
    add_product(&mut out[..size[0] * size[1]], size, a, b.transpose());
}

fn add_product(out: &mut [f32], [rows, columns]: [usize; 2], a: MatRef<f32>, b: MatRef<f32>) {
    let out = MatMut::from_row_major_slice_mut(out, rows, columns);
    matmul(out, Accum::Add, a, b, 1.0, Par::Seq);
}

/// One row per output pixel: its window, row by row.
fn unroll(input: &[f32], conv: &Conv, columns: &mut Vec<f32>) {
    let (rows, width) = conv.size();
    columns.clear();
    columns.resize(rows * width, 0.0);
    for_windows(conv, |at, source, len| {
        columns[at..at + len].copy_from_slice(&input[source..source + len]);
    });
}

/// The transpose of [`unroll`]: adds windows back.
fn roll(columns: &[f32], conv: &Conv, out: &mut [f32]) {
    for_windows(conv, |at, source, len| {
        add(&mut out[source..source + len], &columns[at..at + len]);
    });
}

/// Calls `each(index in columns, index in map, length)` for every row of every window.
fn for_windows(conv: &Conv, mut each: impl FnMut(usize, usize, usize)) {
    let (from, to, kernel, stride) = (conv.from, conv.to, conv.kernel, conv.stride);
    let (reach, channels) = (kernel / 2, from[2]);
    for y in 0..to[0] {
        for x in 0..to[1] {
            let row = (y * to[1] + x) * kernel * kernel * channels;
            let left = (x * stride).saturating_sub(reach);
            let right = (x * stride + kernel - reach).min(from[1]);
            let skipped = left + reach - x * stride;
            for ky in 0..kernel {
                let sy = y * stride + ky;
                if sy < reach || sy - reach >= from[0] || left >= right {
                    continue;
                }
                let at = row + (ky * kernel + skipped) * channels;
                let source = ((sy - reach) * from[1] + left) * channels;
                each(at, source, (right - left) * channels);
            }
        }
    }
}
