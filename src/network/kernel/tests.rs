//! Every kernel that this machine runs gives the integers of the scalar one: on random and on
//! extreme numbers, whole strips and their tails.

use super::scalar::Scalar;
use super::*;

/// Values, weights or outputs of a case.
type Bytes<T> = heapless::Vec<T, 8192>;
/// Something of each block of a case.
type Blocks<T> = heapless::Vec<T, 8>;

/// Rounds of each test; every third one has extreme numbers only. Miri is slow.
const ROUNDS: u32 = if cfg!(miri) { 9 } else { 600 };

/// Runs a test with each kernel that is not the scalar one.
macro_rules! each_kernel {
    ($name:ident, $kernel:ident => $test:expr) => {
        for $name in KernelName::ALL.into_iter().filter(|k| k.is_available()) {
            // SAFETY: it is available.
            match unsafe { choice::of_name($name) } {
                #[cfg(target_arch = "x86_64")]
                Chosen::Vnni($kernel) => $test,
                #[cfg(target_arch = "x86_64")]
                Chosen::Avx512($kernel) => $test,
                #[cfg(target_arch = "x86_64")]
                Chosen::Avx2($kernel) => $test,
                #[cfg(target_arch = "x86_64")]
                Chosen::Sse2($kernel) => $test,
                #[cfg(target_arch = "aarch64")]
                Chosen::Neon($kernel) => $test,
                #[cfg(target_arch = "aarch64")]
                Chosen::Dotprod($kernel) => $test,
                #[cfg(all(target_arch = "wasm32", simd_kernel))]
                Chosen::Simd128($kernel) => $test,
                #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
                Chosen::Relaxed($kernel) => $test,
                Chosen::Scalar(_) => {}
            }
        }
    };
}

/// Marsaglia's xorshift generator, 32 bits.
struct Numbers {
    state: u32,
    extreme: bool,
}

impl Numbers {
    fn new(round: u32) -> Self {
        Numbers {
            state: round.wrapping_mul(2_654_435_761) | 1,
            extreme: round % 3 == 2,
        }
    }

    fn next(&mut self) -> u32 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 17;
        self.state ^= self.state << 5;
        self.state
    }

    /// A number in `least..=most`, in extreme rounds one of both.
    fn within(&mut self, least: i32, most: i32) -> i32 {
        let span = most.abs_diff(least);
        match (self.extreme, self.next() & 1) {
            (true, 0) => least,
            (true, _) => most,
            (false, _) => least.wrapping_add_unsigned(self.state % span.saturating_add(1)),
        }
    }

    /// A size in `1..=most`, in extreme rounds too.
    fn size(&mut self, most: u32) -> usize {
        (self.next() >> 8) as usize % most as usize + 1
    }

    fn bytes(&mut self, count: usize) -> Bytes<u8> {
        (0..count).map(|_| self.within(0, 255) as u8).collect()
    }

    /// What a checked network may have (plan.rs).
    fn weights(&mut self, count: usize) -> Bytes<i8> {
        (0..count).map(|_| self.within(-127, 127) as i8).collect()
    }
}

/// What a checked model may hold (plan.rs).
struct Constants {
    bias: Blocks<[i32; BLOCK]>,
    multiplier: Blocks<[i32; BLOCK]>,
}

impl Constants {
    fn new(n: &mut Numbers, blocks: usize) -> Self {
        let mut numbers = |limit: i32| {
            let block = |_| core::array::from_fn(|_| n.within(-limit, limit));
            (0..blocks).map(block).collect()
        };
        Constants {
            bias: numbers((1 << 28) - 1),
            multiplier: numbers((1 << 15) - 1),
        }
    }

    fn scale(&self, n: &mut Numbers) -> Scale<'_> {
        Scale {
            bias: &self.bias,
            multiplier: &self.multiplier,
            pre_shift: n.within(0, 24) as u32,
            post_shift: n.within(1, 30) as u32,
            zero_point: 128 * n.within(0, 1),
            lateral: n.next() & 64 == 0,
        }
    }
}

/// Sizes and numbers of a strip.
struct Case {
    values: Bytes<u8>,
    rows: usize,
    columns: usize,
    filled: usize,
    stride: usize,
    channels: usize,
    weights: Bytes<i8>,
    zero_point: u8,
    out: Bytes<u8>,
}

impl Case {
    fn new(n: &mut Numbers, blocks: usize) -> Self {
        let (rows, stride) = (n.size(5), 8 * n.size(3));
        let columns = 8 * n.size(if rows == 1 { 12 } else { 4 });
        let (pixels, channels) = (n.size(30), (blocks + n.size(3) - 1) * BLOCK);
        let filled = columns - n.size(8) + 1;
        let mut weights = n.weights(blocks * rows * columns * BLOCK);
        let of_rows = weights.chunks_mut(columns * BLOCK);
        for pair in of_rows.flat_map(|row| row.chunks_mut(2 * BLOCK).skip(filled.div_ceil(2))) {
            pair.fill(0);
        }
        Case {
            values: n.bytes(rows * ((pixels - 1) * stride + columns)),
            rows,
            columns,
            filled,
            stride,
            channels,
            weights,
            zero_point: n.within(0, 255) as u8,
            out: n.bytes((pixels - 1) * channels + blocks * BLOCK),
        }
    }

    /// The outputs of a kernel.
    fn run<K: Kernel>(&self, kernel: K, scale: &Scale<'_>) -> Bytes<u8> {
        let row = self.values.len() / self.rows;
        let count = self.values.len() * K::WIDTH;
        let mut staged: Bytes<u8> = core::iter::repeat_n(0, count).collect();
        kernel.stage(&self.values, self.zero_point, &mut staged);
        let rows: Blocks<usize> = (0..self.rows).map(|r| r * row * K::WIDTH).collect();
        let mut bias: Blocks<[i32; BLOCK]> = scale.bias.iter().copied().collect();
        kernel.correct(&self.weights, self.zero_point, &mut bias);
        let mut out = self.out.clone();
        let parts = StripParts {
            values: &staged,
            rows: &rows,
            step: self.stride * K::WIDTH,
            columns: self.columns,
            filled: self.filled,
            weights: &self.weights,
            scale: Scale {
                bias: &bias,
                ..*scale
            },
            out: &mut out,
            channels: self.channels,
        };
        let strip = Strip::new(parts, K::WIDTH, K::GROUP);
        kernel.conv2d(strip.expect("a strip whose parts fit"));
        out
    }
}

#[test]
fn convolutions_agree_with_the_scalar_kernel() {
    for round in 0..ROUNDS {
        let n = &mut Numbers::new(round);
        let blocks = n.size(6);
        let constants = Constants::new(n, blocks);
        let (case, scale) = (Case::new(n, blocks), constants.scale(n));
        let expected = case.run(Scalar, &scale);
        each_kernel!(name, kernel => {
            assert_eq!(case.run(kernel, &scale), expected, "{name:?}, round {round}");
        });
    }
}

#[test]
fn a_convolution_is_the_sum_of_products() {
    let n = &mut Numbers::new(0);
    let case = Case::new(n, 1);
    let scale = Scale {
        bias: &[[0; BLOCK]],
        multiplier: &[[1 << 10; BLOCK]],
        pre_shift: 4,
        post_shift: 16,
        zero_point: 128,
        lateral: false,
    };
    let out = case.run(Scalar, &scale);
    let row = case.values.len() / case.rows;
    for (pixel, out) in out.chunks(case.channels).enumerate() {
        for (channel, out) in out.iter().enumerate().take(BLOCK) {
            let mut sum = 0;
            for (r, k) in (0..case.rows).flat_map(|r| (0..case.columns).map(move |k| (r, k))) {
                let value = case.values[r * row + pixel * case.stride + k];
                let column = r * case.columns + k;
                let weight = case.weights[column / 2 * 16 + 2 * channel + column % 2];
                sum += (i32::from(value) - i32::from(case.zero_point)) * i32::from(weight);
            }
            let expected = (((sum >> 4) * 1024 + (1 << 15)) >> 16) + 128;
            assert_eq!(i32::from(*out), expected.clamp(0, 255));
        }
    }
}

#[test]
fn depthwise_convolutions_agree_with_the_scalar_kernel() {
    for round in 0..ROUNDS {
        let n = &mut Numbers::new(round);
        let (blocks, side, stride) = (n.size(5), n.size(9), n.size(2));
        let channels = blocks * BLOCK;
        let map = n.bytes(side * side * channels);
        let raw = n.weights(9 * channels);
        let mut paired: Blocks<TapWeights> = (0..blocks).map(|_| [[0; _]; _]).collect();
        super::super::layer::pair_taps(&raw, channels, &mut paired);
        let weights = DepthwiseWeights {
            raw: &raw,
            paired: &paired,
        };
        let constants = Constants::new(n, blocks);
        let scale = Scale {
            zero_point: 0,
            lateral: false,
            ..constants.scale(n)
        };
        let before = n.bytes(side.div_ceil(stride) * side.div_ceil(stride) * channels);
        let Some(input) = DepthwiseInput::new(&map, side, channels, stride) else {
            panic!("a whole map");
        };
        let mut expected = before.clone();
        Scalar.depthwise3x3(input, &weights, &scale, &mut expected);
        each_kernel!(name, kernel => {
            let mut out = before.clone();
            kernel.depthwise3x3(input, &weights, &scale, &mut out);
            assert_eq!(out, expected, "{name:?}, round {round}");
        });
    }
}

#[test]
fn sums_of_maps_agree_with_the_scalar_kernel() {
    for round in 0..ROUNDS {
        let n = &mut Numbers::new(round);
        let count = n.size(80);
        let (own, other) = (n.bytes(count), n.bytes(count));
        let limit = (1 << 15) - 1;
        let sum = Sum {
            factors: [0; 2].map(|_| n.within(-limit, limit) as i16),
            pre_shift: n.within(0, 24) as u32,
            post_shift: n.within(1, 30) as u32,
        };
        let mut expected = own.clone();
        Scalar.add(&sum, &other, &mut expected);
        each_kernel!(name, kernel => {
            let mut out = own.clone();
            kernel.add(&sum, &other, &mut out);
            assert_eq!(out, expected, "{name:?}, round {round}");
        });
    }
}

#[test]
fn dot_products_are_sums_of_products() {
    for round in 0..ROUNDS {
        let n = &mut Numbers::new(round);
        let count = n.size(80);
        // Those of heads may be −128.
        let weight = |_| n.within(-128, 127) as i8;
        let weights: Bytes<i8> = (0..3 * count).map(weight).collect();
        let features = n.bytes(count);
        let sum = |weights: &[i8]| {
            let pairs = features.iter().zip(weights);
            pairs
                .map(|(f, w)| i32::from(*f) * i32::from(*w))
                .sum::<i32>()
        };
        // A fourth row is not there.
        let expected: [i32; 4] = core::array::from_fn(|row| match row {
            3 => 0,
            _ => sum(&weights[row * count..(row + 1) * count]),
        });
        let check = |kernel: KernelName, dot: i32, dots: [i32; 4]| {
            assert_eq!(
                (dot, dots),
                (expected[0], expected),
                "{kernel:?}, round {round}"
            );
        };
        let mut dots = [0; 4];
        Scalar.dots(&features, &weights, &mut dots);
        check(
            KernelName::Scalar,
            Scalar.dot(&features, &weights[..count]),
            dots,
        );
        each_kernel!(name, kernel => {
            let mut dots = [0; 4];
            kernel.dots(&features, &weights, &mut dots);
            check(name, kernel.dot(&features, &weights[..count]), dots);
        });
    }
}

#[test]
fn a_kernel_that_is_not_available_is_not_selected() {
    let missing = KernelName::ALL.into_iter().find(|k| !k.is_available());
    let before = chosen_kernel();
    assert!(missing.is_none_or(|kernel| !select_kernel(kernel)));
    assert_eq!(chosen_kernel(), before);
}
