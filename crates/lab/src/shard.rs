//! A share of the units of work that independent processes, or the tasks of a job array, divide
//! among themselves without talking to each other.

use anyhow::{Context, Result, ensure};
use std::str::FromStr;

/// `index/count`, the index from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Shard = Shard { index: 1, count: 1 };

    /// Whether the unit with this number, from 0, is in it.
    pub fn has(self, unit: usize) -> bool {
        unit % self.count == self.index - 1
    }
}

impl FromStr for Shard {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Shard> {
        let (index, count) = text.split_once('/').context("not of the form i/n")?;
        let (index, count) = (index.parse()?, count.parse()?);
        ensure!((1..=count).contains(&index), "i must be from 1 to n");
        Ok(Shard { index, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_is_in_one_shard() {
        let shards = ["1/3", "2/3", "3/3"].map(|text| text.parse::<Shard>().unwrap());
        for unit in 0..10 {
            assert_eq!(shards.iter().filter(|s| s.has(unit)).count(), 1);
            assert!(Shard::WHOLE.has(unit));
        }
        for bad in ["", "1", "0/3", "4/3", "1/0", "-1/2", "a/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
