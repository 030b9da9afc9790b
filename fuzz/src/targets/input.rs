//! Reads a fuzzer's bytes as numbers; beyond the end, all are 0.

/// The bytes that are not read yet.
pub struct Input<'a>(&'a [u8]);

impl<'a> Input<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Input(bytes)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The remaining bytes.
    pub fn rest(self) -> &'a [u8] {
        self.0
    }

    pub fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let taken = N.min(self.0.len());
        let (head, rest) = self.0.split_at(taken);
        self.0 = rest;
        let mut bytes = [0; N];
        bytes[..taken].copy_from_slice(head);
        bytes
    }

    pub fn u8(&mut self) -> u8 {
        self.bytes::<1>()[0]
    }

    pub fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.bytes())
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    pub fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.bytes())
    }

    pub fn f32(&mut self) -> f32 {
        f32::from_bits(self.u32())
    }
}

/// The next byte of a linear congruential generator (constants of Numerical Recipes).
pub fn scramble(seed: &mut u32) -> u8 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*seed >> 24) as u8
}
