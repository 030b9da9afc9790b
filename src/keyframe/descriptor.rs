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

/// The pattern at one roll, for images of one width.
pub struct SteeredPattern {
    /// Index offsets of each pair in the image's memory.
    index_offsets: [[i32; 2]; PAIRS],
    offsets: [[i8; 4]; PAIRS],
    /// Largest offset along either axis \[px\].
    reach: i32,
}

impl SteeredPattern {
    /// Rotated clockwise by `roll` \[rad\]; a `roll` that is not finite is taken as 0.
    #[inline(never)]
    pub fn new(roll: f32, image: &ReducedImage<'_>) -> SteeredPattern {
        let roll = if roll.is_finite() { roll } else { 0.0 };
        let q14 = |v: f32| libm::roundf(v * 16_384.0) as i32;
        let (cos, sin) = (q14(libm::cosf(roll)), q14(libm::sinf(roll)));
        let rotate = |x: i8, y: i8| {
            let (x, y) = (x as i32, y as i32);
            let round = |v: i32| (v + 8192) >> 14;
            (round(x * cos - y * sin), round(x * sin + y * cos))
        };
        let mut steered = SteeredPattern {
            index_offsets: [[0; 2]; PAIRS],
            offsets: [[0; 4]; PAIRS],
            reach: 0,
        };
        let width = image.width() as i32;
        let out = steered.index_offsets.iter_mut().zip(&mut steered.offsets);
        for ((index_offsets, offsets), [x1, y1, x2, y2]) in out.zip(&PATTERN) {
            let ((ax, ay), (bx, by)) = (rotate(*x1, *y1), rotate(*x2, *y2));
            *index_offsets = [ay * width + ax, by * width + bx];
            *offsets = [ax as i8, ay as i8, bx as i8, by as i8];
            let farthest = ax.abs().max(ay.abs()).max(bx.abs()).max(by.abs());
            steered.reach = steered.reach.max(farthest);
        }
        steered
    }

    /// Describes the neighbourhood of the pixel (x, y).
    pub fn describe(&self, image: &ReducedImage<'_>, x: u16, y: u16) -> Descriptor {
        let (x, y) = (x as i32, y as i32);
        let (width, height) = (image.width() as i32, image.height() as i32);
        let reach = self.reach;
        let inside = x >= reach && y >= reach && x + reach < width && y + reach < height;
        let mut words = [0u32; 8];
        if inside {
            let centre = y * width + x;
            for (word, pairs) in words.iter_mut().zip(self.index_offsets.chunks_exact(32)) {
                for [a, b] in pairs {
                    let darker = image.at(centre + a) < image.at(centre + b);
                    *word = *word << 1 | darker as u32;
                }
            }
        } else {
            for (word, pairs) in words.iter_mut().zip(self.offsets.chunks_exact(32)) {
                for [ax, ay, bx, by] in pairs {
                    let at = |dx: i8, dy: i8| image.luma(x + dx as i32, y + dy as i32);
                    *word = *word << 1 | (at(*ax, *ay) < at(*bx, *by)) as u32;
                }
            }
        }
        words
    }
}

/// Hamming distance; `None` when more than `head_max` of the first 64 bits differ.
#[inline]
pub fn hamming_distance(a: &Descriptor, b: &Descriptor, head_max: u32) -> Option<u32> {
    // Two words at once: without an instruction for it, counting takes as long for 64 bits.
    let pairs = a.as_chunks::<2>().0.iter().zip(b.as_chunks::<2>().0);
    let mut counts =
        pairs.map(|([a, c], [b, d])| (u64::from(a ^ b) | u64::from(c ^ d) << 32).count_ones());
    let head = counts.next().unwrap_or(0);
    (head <= head_max).then(|| head + counts.sum::<u32>())
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
            SteeredPattern::new(roll, image).describe(image, x, centre)
        };
        let distance = |a, b| hamming_distance(&a, &b, BITS).expect("at most all");
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
        assert_eq!(hamming_distance(&[0; 8], &[u32::MAX; 8], 63), None);
    }
}
