//! Moves landmarks to where the templates respond.

use super::descriptor::{Patches, Placement};
use super::svm::{Bank, REACH};

/// Variance of the mean shift's kernel \[px²\].
const KERNEL: f32 = 4.0;

/// A way to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// Each landmark to the highest response near it.
    Peak,
    /// Each by the mean shift of its response map.
    MeanShift,
}

impl Correction {
    /// Where one landmark's response map pulls it \[crop px\], and how much it is to be believed.
    pub fn shift(
        self,
        bank: &Bank,
        placement: &Placement,
        k: usize,
        patches: &Patches,
        p: [f32; 2],
    ) -> ([f32; 2], f32) {
        let offsets = (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| (x, y)));
        let map: Vec<([f32; 2], f32)> = offsets
            .map(|(x, y)| {
                // Patches are cut at whole px.
                let [x, y] = [p[0].floor() + 0.5 + x as f32, p[1].floor() + 0.5 + y as f32];
                let at = [x, y];
                let off = [at[0] - p[0], at[1] - p[1]];
                (off, bank.response(placement.view, k, patches, at))
            })
            .collect();
        let peak = map.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((best, height)) = peak.copied().filter(|(_, height)| *height > 0.0) else {
            return ([0.0; 2], 0.0);
        };
        if self == Correction::Peak {
            return (best, height);
        }
        let mut sum = [0.0f32; 3];
        for (off, response) in &map {
            let square = off[0] * off[0] + off[1] * off[1];
            let weight = response * (-0.5 * square / KERNEL).exp();
            sum = [
                sum[0] + weight * off[0],
                sum[1] + weight * off[1],
                sum[2] + weight,
            ];
        }
        let total = sum[2].max(1e-9);
        ([sum[0] / total, sum[1] / total], height)
    }
}
