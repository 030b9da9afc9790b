//! 256 comparisons of two pixels around a keypoint (BRIEF, Calonder et al. 2010), turned with the
//! face.

use super::picture::Picture;

/// One bit per comparison.
pub type Descriptor = [u32; 8];

/// Bits of a descriptor.
pub const BITS: u32 = 256;
const PAIRS: usize = BITS as usize;
/// Farthest compared pixel along each axis \[px\].
const FAR: i32 = 12;

/// Pairs of places, spread around the keypoint like a bell: each coordinate is the sum of four
/// uniform numbers.
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
            sum += (state >> 16) as i32 % (2 * FAR / 3 + 1) - FAR / 3;
            k += 1;
        }
        let far = if sum > FAR {
            FAR
        } else if sum < -FAR {
            -FAR
        } else {
            sum
        };
        pattern[i / 4][i % 4] = far as i8;
        i += 1;
    }
    pattern
};

/// The pattern for one roll and one picture.
pub struct Steered {
    /// Places of each pair, as distances in the picture's memory.
    offsets: [[i32; 2]; PAIRS],
    places: [[i8; 4]; PAIRS],
    /// Farthest place.
    reach: i32,
}

impl Steered {
    /// Turned clockwise by `roll` \[rad\].
    #[inline(never)]
    pub fn new(roll: f32, picture: &Picture<'_>) -> Steered {
        let roll = if roll.is_finite() { roll } else { 0.0 };
        let q14 = |v: f32| libm::roundf(v * 16_384.0) as i32;
        let (cos, sin) = (q14(libm::cosf(roll)), q14(libm::sinf(roll)));
        let turned = |x: i8, y: i8| {
            let (x, y) = (x as i32, y as i32);
            let at = |v: i32| (v + 8192) >> 14;
            (at(x * cos - y * sin), at(x * sin + y * cos))
        };
        let mut steered = Steered {
            offsets: [[0; 2]; PAIRS],
            places: [[0; 4]; PAIRS],
            reach: 0,
        };
        let width = picture.width() as i32;
        let out = steered.offsets.iter_mut().zip(&mut steered.places);
        for ((offsets, places), [x1, y1, x2, y2]) in out.zip(&PATTERN) {
            let ((ax, ay), (bx, by)) = (turned(*x1, *y1), turned(*x2, *y2));
            *offsets = [ay * width + ax, by * width + bx];
            *places = [ax as i8, ay as i8, bx as i8, by as i8];
            let farthest = ax.abs().max(ay.abs()).max(bx.abs()).max(by.abs());
            steered.reach = steered.reach.max(farthest);
        }
        steered
    }

    /// Describes the place (x, y).
    pub fn describe(&self, picture: &Picture<'_>, x: u16, y: u16) -> Descriptor {
        let (x, y) = (x as i32, y as i32);
        let (width, height) = (picture.width() as i32, picture.height() as i32);
        let reach = self.reach;
        let inside = x >= reach && y >= reach && x + reach < width && y + reach < height;
        let mut words = [0u32; 8];
        if inside {
            let centre = y * width + x;
            for (word, pairs) in words.iter_mut().zip(self.offsets.chunks_exact(32)) {
                for [a, b] in pairs {
                    let darker = picture.at(centre + a) < picture.at(centre + b);
                    *word = *word << 1 | darker as u32;
                }
            }
        } else {
            for (word, pairs) in words.iter_mut().zip(self.places.chunks_exact(32)) {
                for [ax, ay, bx, by] in pairs {
                    let at = |dx: i8, dy: i8| picture.luma(x + dx as i32, y + dy as i32);
                    *word = *word << 1 | (at(*ax, *ay) < at(*bx, *by)) as u32;
                }
            }
        }
        words
    }
}

/// Comparisons that differ; `None` when more than `first` of the first 64 do.
#[inline]
pub fn apart(a: &Descriptor, b: &Descriptor, first: u32) -> Option<u32> {
    let mut words = a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones());
    let head: u32 = words.by_ref().take(2).sum();
    (head <= first).then(|| head + words.sum::<u32>())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{SIDE, texture};
    use super::*;

    #[test]
    fn noise_and_steered_turns_change_few_bits() {
        let centre = (SIDE / 2) as u16;
        let upright = texture(0.0, 1.0, 0);
        let upright = Picture::new(&upright, SIDE);
        let of = |picture: &Picture<'_>, roll, x| {
            Steered::new(roll, picture).describe(picture, x, centre)
        };
        let apart = |a, b| super::apart(&a, &b, BITS).expect("at most all");
        let before = of(&upright, 0.0, centre);
        for roll in [0.0f32, 0.4, -1.0, 2.0] {
            let turned = texture(roll, 1.0, 6);
            let turned = Picture::new(&turned, SIDE);
            let same = apart(before, of(&turned, roll, centre));
            assert!(same < 48, "{same} bits at a roll of {roll}");
            let elsewhere = apart(before, of(&turned, roll, centre + 30));
            assert!(elsewhere > 80, "{elsewhere} bits of another place");
        }
        // At the very edge there is something to read, too.
        assert_ne!(of(&upright, 0.7, 0), [0; 8]);
        assert_eq!(super::apart(&[0; 8], &[u32::MAX; 8], 63), None);
    }
}
