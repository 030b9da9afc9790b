//! Steered BRIEF: 256 comparisons of two pixels around a keypoint (Calonder et al., "BRIEF: Binary
//! Robust Independent Elementary Features", 2010), rotated with the face.

use super::reduced_image::ReducedImage;

/// One bit per comparison.
pub type Descriptor = [u32; 8];

/// Bits of a descriptor.
pub const BITS: u32 = 256;
const PAIRS: usize = BITS as usize;
/// Largest offset of a compared pixel along each axis \[px\].
const OFFSET_MAX: i32 = 12;

/// Pairs of offsets from the keypoint: x and y of the first pixel, x and y of the second \[px\].
/// Each coordinate is the clamped sum of four uniform numbers, which approximates a normal
/// distribution.
const PATTERN: [[i8; 4]; PAIRS] = {
    let mut pattern = [[0; 4]; PAIRS];
    let mut state = 0x2545_F491u32;
    let mut i = 0;
    while i < 4 * PAIRS {
        let mut sum = 0;
        let mut k = 0;
        while k < 4 {
            // xorshift32
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            sum += (state >> 16) as i32 % (2 * OFFSET_MAX / 3 + 1) - OFFSET_MAX / 3;
            k += 1;
        }
        let offset = if sum > OFFSET_MAX {
            OFFSET_MAX
        } else if sum < -OFFSET_MAX {
            -OFFSET_MAX
        } else {
            sum
        };
        pattern[i / 4][i % 4] = offset as i8;
        i += 1;
    }
    pattern
};

/// Largest offset of a compared pixel in a turned pattern: that of a corner, rounded \[px\].
const REACH: usize = 17;
/// Side of what a descriptor sees \[px\].
const SIDE: usize = 2 * REACH + 1;
/// Bytes for its pixels; a power of two, so that an index needs no check but a mask.
const PATCH: usize = 2048;
const _: () = assert!(SIDE * SIDE <= PATCH);

/// The pattern at one roll.
pub struct SteeredPattern {
    /// Indices of each pair in the pixels around a keypoint, row by row.
    pairs: [[u16; 2]; PAIRS],
}

impl SteeredPattern {
    /// Rotated clockwise by `roll` \[rad\]; a `roll` that is not finite is taken as 0.
    #[inline(never)]
    pub fn new(roll: f32) -> SteeredPattern {
        let roll = if roll.is_finite() { roll } else { 0.0 };
        let q14 = |v: f32| libm::roundf(v * 16_384.0) as i32;
        let (cos, sin) = (q14(libm::cosf(roll)), q14(libm::sinf(roll)));
        let index = |x: i8, y: i8| {
            let (x, y) = (x as i32, y as i32);
            let round = |v: i32| ((v + 8192) >> 14) + REACH as i32;
            (round(x * sin + y * cos) * SIDE as i32 + round(x * cos - y * sin)) as u16
        };
        SteeredPattern {
            pairs: PATTERN.map(|[x1, y1, x2, y2]| [index(x1, y1), index(x2, y2)]),
        }
    }

    /// Describes the neighbourhood of the pixel (x, y).
    pub fn describe(&self, image: &ReducedImage<'_>, x: u16, y: u16) -> Descriptor {
        let mut patch = [0u8; PATCH];
        let (left, top) = (x as i32 - REACH as i32, y as i32 - REACH as i32);
        for (v, row) in patch.chunks_exact_mut(SIDE).take(SIDE).enumerate() {
            image.copy_row(left, top + v as i32, row);
        }
        // All indices are below.
        let at = |index: u16| patch[usize::from(index) % PATCH];
        let mut words = [0u32; 8];
        for (word, pairs) in words.iter_mut().zip(self.pairs.as_chunks::<32>().0) {
            for [a, b] in pairs {
                *word = *word << 1 | u32::from(at(*a) < at(*b));
            }
        }
        words
    }
}

/// The first 64 bits and the others.
pub fn split([a, b, tail @ ..]: &Descriptor) -> (u64, [u32; 6]) {
    (u64::from(*a) | u64::from(*b) << 32, *tail)
}

/// A bit for each of these heads, set where it differs from `head` in at most `most` bits. All are
/// compared, in vectors, which takes less than to look at some.
#[inline]
pub fn near<const N: usize>(heads: &[u64; N], head: u64, most: u32) -> u32 {
    let distances = heads.map(|other| (other ^ head).count_ones() as u8);
    let least = distances.iter().fold(u8::MAX, |least, d| least.min(*d));
    if u32::from(least) > most {
        return 0;
    }
    let bits = distances.iter().rev();
    bits.fold(0, |bits, d| bits << 1 | u32::from(u32::from(*d) <= most))
}

/// Bits in which descriptors differ.
#[inline]
pub fn hamming_distance((head, tail): (u64, &[u32; 6]), other: (u64, &[u32; 6])) -> u32 {
    let pairs = tail
        .as_chunks::<2>()
        .0
        .iter()
        .zip(other.1.as_chunks::<2>().0);
    // Two words at once: without an instruction for it, counting takes as long for 64 bits.
    let counts =
        pairs.map(|([a, c], [b, d])| (u64::from(a ^ b) | u64::from(c ^ d) << 32).count_ones());
    (head ^ other.0).count_ones() + counts.sum::<u32>()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{SIDE, texture};
    use super::*;

    #[test]
    fn noise_and_steered_rotation_change_few_bits() {
        let centre = (SIDE / 2) as u16;
        let upright = texture(0.0, 1.0, 0);
        let upright = ReducedImage::new(&upright, SIDE);
        let of = |image: &ReducedImage<'_>, roll, x| {
            SteeredPattern::new(roll).describe(image, x, centre)
        };
        let distance = |a: Descriptor, b: Descriptor| {
            let ((a, after_a), (b, after_b)) = (split(&a), split(&b));
            hamming_distance((a, &after_a), (b, &after_b))
        };
        let before = of(&upright, 0.0, centre);
        for roll in [0.0f32, 0.4, -1.0, 2.0] {
            let rotated = texture(roll, 1.0, 6);
            let rotated = ReducedImage::new(&rotated, SIDE);
            let same = distance(before, of(&rotated, roll, centre));
            assert!(same < 48, "{same} bits at a roll of {roll}");
            let elsewhere = distance(before, of(&rotated, roll, centre + 30));
            assert!(elsewhere > 80, "{elsewhere} bits of another place");
        }
        // At the edge outside pixels repeat the nearest ones.
        assert_ne!(of(&upright, 0.7, 0), [0; 8]);
        assert_eq!(distance([0; 8], [u32::MAX; 8]), BITS);
    }

    #[test]
    fn near_heads_by_hand() {
        assert_eq!(near(&[0, 0b111, u64::MAX, 0b11], 0, 2), 0b1001);
        assert_eq!(near(&[u64::MAX; 4], 0, 63), 0);
    }
}
