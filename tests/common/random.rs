//! Random numbers, cameras and lenses for tests, the same on every machine.

use posewise::{Distortion, Intrinsics};

/// Random numbers (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A positive number; mostly in the range of focal lengths, with logarithms evenly distributed.
    fn scale(&mut self, decades: f32) -> f32 {
        match self.next() % 32 {
            0..3 => 1.0,
            3..6 => 1e6,
            6 => f32::from_bits(1),
            7 => f32::MAX,
            8 => 10f32.powf(self.unit() * 20.0 - 10.0),
            _ => 10f32.powf(self.unit() * decades),
        }
    }

    /// A camera; most focal lengths are between 1 px and this power of ten.
    pub fn camera(&mut self, decades: f32) -> Intrinsics {
        let fx = self.scale(decades);
        let fy = match self.next() % 4 {
            0 => self.scale(decades),
            1 => fx * 10f32.powf(self.unit() * 2.0 - 1.0),
            _ => fx,
        };
        let mut centre = || match self.next() % 4 {
            0 => self.scale(6.0) / 10.0,
            1 => -self.scale(6.0) / 10.0,
            _ => self.unit() * 1000.0 - 250.0,
        };
        Intrinsics::new(fx, fy, centre(), centre())
    }

    /// A lens; most coefficients are small.
    pub fn lens(&mut self) -> Distortion {
        let mut k = |most: f32| match self.next() % 16 {
            0 => most,
            1 => -most,
            2 => (self.unit() * 2.0 - 1.0) * most,
            _ => self.unit() * 0.6 - 0.3,
        };
        let [k1, k2, k3, k4] = [k(10.0), k(10.0), k(1e4), k(10.0)];
        let [p1, p2] = [k(0.1), k(0.1)].map(|p| p.clamp(-0.1, 0.1));
        match self.next() % 2 {
            0 => Distortion::BrownConrady { k1, k2, p1, p2, k3 },
            _ => Distortion::KannalaBrandt { k1, k2, k3, k4 },
        }
    }

    /// An integer below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// Between two numbers.
    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * f64::from(self.unit())
    }

    /// True with this probability.
    pub fn is(&mut self, probability: f64) -> bool {
        f64::from(self.unit()) < probability
    }

    /// True once in a number of times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }
}
