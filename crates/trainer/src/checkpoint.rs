//! Checkpoints of training runs: how many batches were seen, then arrays of one length.

use anyhow::{Context, Result};
use std::path::Path;

/// Reads one; `None` when there is none or its arrays have another length.
pub fn read<const N: usize>(path: &Path, length: usize) -> Option<(usize, [Vec<f32>; N])> {
    let bytes = std::fs::read(path).ok()?;
    let (step, rest) = bytes.split_first_chunk::<8>()?;
    let floats = rest.as_chunks::<4>().0.iter();
    let floats: Vec<f32> = floats.map(|b| f32::from_le_bytes(*b)).collect();
    let parts: Vec<Vec<f32>> = floats.chunks(length).map(<[f32]>::to_vec).collect();
    let is_whole = floats.len() == N * length;
    let step = u64::from_le_bytes(*step) as usize;
    Some((step, parts.try_into().ok().filter(|_| is_whole)?))
}

/// Writes one, under its name only when it is whole.
pub fn write(path: &Path, step: usize, arrays: &[&[f32]]) -> Result<()> {
    let mut bytes = (step as u64).to_le_bytes().to_vec();
    let all = arrays.iter().copied().flatten();
    all.for_each(|v| bytes.extend(v.to_le_bytes()));
    let fresh = path.with_extension("part");
    std::fs::write(&fresh, bytes).with_context(|| format!("writing {}", fresh.display()))?;
    std::fs::rename(&fresh, path).with_context(|| format!("writing {}", path.display()))
}
