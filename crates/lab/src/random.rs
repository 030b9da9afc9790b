//! Numbers that look random and are the same in every run.
//!
//! No crate, because figures of `eval` and `bench` depend on the numbers: a generator or a
//! distribution of another crate, or of its next version, would change them.

/// SplitMix64.
pub struct Random(u64);

impl Random {
    /// The same seed gives the same numbers.
    pub fn of(seed: u64) -> Self {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// One of 0 … n − 1; 0 when there is none.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// One of −most … most.
    pub fn within(&mut self, most: i32) -> i32 {
        let most = most.max(0);
        self.below(2 * most as usize + 1) as i32 - most
    }

    /// Puts them in a random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_repeat_and_stay_in_range() {
        let draw = |seed: u64| -> Vec<i32> {
            let mut random = Random::of(seed);
            (0..200).map(|_| random.within(3)).collect()
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        assert!((-3..=3).all(|n| draw(0).contains(&n)));
        assert!(draw(0).iter().all(|n| n.abs() <= 3));
        let mut order: Vec<usize> = (0..50).collect();
        Random::of(5).shuffle(&mut order);
        assert_ne!(order, (0..50).collect::<Vec<_>>());
        order.sort_unstable();
        assert_eq!(order, (0..50).collect::<Vec<_>>());
    }
}
