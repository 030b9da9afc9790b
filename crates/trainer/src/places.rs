//! Places of a network's maps in the memory that they share.

use anyhow::{Result, ensure};
use posewise::network::ARENA;

/// A map and the nodes that use it; every node makes one map.
pub struct Use {
    /// Size \[bytes\].
    pub bytes: usize,
    /// Number of the last node that reads the map, at least that of the node that makes it.
    pub last: usize,
    /// Number of an earlier map that this one overwrites in place, which no later node reads.
    pub replaces: Option<usize>,
}

/// First byte of every map: two share bytes only when one of them is read for the last time before
/// the other is made. Large maps are placed first, each at the lowest place that is free (greedy by
/// size, Pisarchyk and Lee, Efficient Memory Management for Deep Neural Net Inference, 2020).
///
/// # Errors
/// When the maps need more memory than there is.
pub fn places(maps: &[Use]) -> Result<Vec<usize>> {
    // A map that is overwritten in place and its successor are one block.
    let mut block_of = vec![];
    let mut blocks: Vec<Block> = vec![];
    for (first, map) in maps.iter().enumerate() {
        let block = match map.replaces {
            Some(earlier) => block_of[earlier],
            None => {
                blocks.push(Block::new(first, map.bytes));
                blocks.len() - 1
            }
        };
        blocks[block].last = blocks[block].last.max(map.last);
        block_of.push(block);
    }
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    order.sort_by_key(|k| (usize::MAX - blocks[*k].bytes, *k));
    for (placed, &k) in order.iter().enumerate() {
        let others = order[..placed].iter().map(|other| &blocks[*other]);
        let at = blocks[k].lowest(others);
        let end = at + blocks[k].bytes;
        ensure!(end <= ARENA, "the maps need {end} bytes of {ARENA}");
        blocks[k].at = at;
    }
    Ok(block_of.iter().map(|k| blocks[*k].at).collect())
}

struct Block {
    bytes: usize,
    /// Nodes between which it is in use, both included.
    first: usize,
    last: usize,
    at: usize,
}

impl Block {
    fn new(first: usize, bytes: usize) -> Block {
        Block {
            bytes,
            first,
            last: first,
            at: 0,
        }
    }

    /// The lowest place beside the others that are in use at the same time.
    fn lowest<'a>(&self, others: impl Iterator<Item = &'a Block>) -> usize {
        let mut taken: Vec<_> = others
            .filter(|b| b.first <= self.last && self.first <= b.last)
            .map(|b| (b.at, b.at + b.bytes))
            .collect();
        taken.sort_unstable();
        let mut at = 0;
        for (start, end) in taken {
            if at + self.bytes <= start {
                break;
            }
            at = at.max(end);
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(bytes: usize, last: usize) -> Use {
        Use {
            bytes,
            last,
            replaces: None,
        }
    }

    #[test]
    fn maps_in_use_at_one_time_are_apart() {
        // A small input, three large maps in use together, and a small one beside the last.
        let maps = [
            kept(10, 1),
            kept(100, 3),
            kept(100, 3),
            kept(100, 4),
            kept(20, 4),
        ];
        assert_eq!(places(&maps).unwrap(), [100, 0, 100, 200, 0]);
    }

    #[test]
    fn a_sum_takes_the_place_of_its_input() {
        let sum = Use {
            bytes: 50,
            last: 3,
            replaces: Some(1),
        };
        let maps = [kept(50, 2), kept(50, 2), sum, kept(30, 4)];
        assert_eq!(places(&maps).unwrap(), [0, 50, 50, 0]);
    }

    #[test]
    fn maps_that_do_not_fit_are_an_error() {
        assert!(places(&[kept(ARENA, 1), kept(1, 1)]).is_err());
        assert!(places(&[kept(ARENA, 0), kept(1, 1)]).is_ok());
    }
}
