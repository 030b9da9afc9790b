//! What a camera, a frame's edge or a thing in between makes of a tile.

use super::tile::Tile;
use posewise::detect::TILE;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Repeats the pixels of a border outwards, as at a frame's edges.
pub fn frame_edges(tile: &mut Tile, rng: &mut ChaCha8Rng) {
    let mut low = [0usize; 2];
    let mut high = [TILE - 1; 2];
    for k in 0..2 {
        match rng.random_range(0..4) {
            0 => low[k] = rng.random_range(0..60),
            1 => high[k] = TILE - 1 - rng.random_range(0..60),
            2 => {
                low[k] = rng.random_range(0..45);
                high[k] = TILE - 1 - rng.random_range(0..45);
            }
            _ => {}
        }
    }
    let source = tile.luma.clone();
    for (k, v) in tile.luma.iter_mut().enumerate() {
        let x = (k % TILE).clamp(low[0], high[0]);
        let y = (k / TILE).clamp(low[1], high[1]);
        *v = source[y * TILE + x];
    }
    tile.cut(low, high);
}

/// Something flat over a part of the last face.
pub fn cover(tile: &mut Tile, rng: &mut ChaCha8Rng) {
    let Some(face) = tile.faces.last() else {
        return;
    };
    let half = [0, 1].map(|_| face.size * rng.random_range(0.08f32..0.3));
    let at = [face.x, face.y].map(|v| v + face.size * rng.random_range(-0.5f32..0.5));
    let level = rng.random_range(10.0f32..240.0);
    let range = |k: usize| {
        let low = (at[k] - half[k]).clamp(0.0, TILE as f32) as usize;
        low..(at[k] + half[k]).clamp(0.0, TILE as f32) as usize
    };
    for y in range(1) {
        for v in &mut tile.luma[y * TILE..][range(0)] {
            *v = (level + 0.1 * (*v as f32 - 128.0)).clamp(0.0, 255.0) as u8;
        }
    }
}

/// Blur, light and noise. Every fifth tile is dim or hazy, every tenth full of noise.
pub fn camera(luma: &mut [u8], rng: &mut ChaCha8Rng) {
    match rng.random_range(0..100) {
        0..24 => smear(luma, rng),
        // Out of focus: nearly a Gaussian, of 1.1 to 2.3 px in two dimensions.
        24..38 => {
            let taps = rng.random_range(3..=5);
            for step in [1, TILE, 1, TILE] {
                mean_along(luma, step, taps);
            }
        }
        _ => {}
    }
    let dim = rng.random_bool(0.2);
    let gain = match dim {
        true => rng.random_range(0.1f32.ln()..0.4f32.ln()).exp(),
        false => rng.random_range(0.5f32..1.35),
    };
    let middle = match dim && rng.random_bool(0.5) {
        true => 128.0 * gain,
        false => rng.random_range(70.0f32..180.0),
    };
    let slope = match rng.random_bool(0.3) {
        true => [0, 1].map(|_| rng.random_range(-0.4f32..0.4) / TILE as f32),
        false => [0.0; 2],
    };
    let sigma = match rng.random_range(0..10) {
        0..4 => 0.0,
        4..9 => rng.random_range(0.0f32..5.0) * gain.max(0.4),
        _ => rng.random_range(5.0f32..18.0) * gain.max(0.3),
    };
    let mut state = rng.random::<u64>() | 1;
    let centre = TILE as f32 / 2.0;
    for (k, v) in luma.iter_mut().enumerate() {
        let (x, y) = ((k % TILE) as f32 - centre, (k / TILE) as f32 - centre);
        let mut value = (*v as f32 - 128.0) * gain + middle;
        value *= 1.0 + slope[0] * x + slope[1] * y;
        if sigma > 0.0 {
            value += sigma * normal(&mut state);
        }
        *v = value.clamp(0.0, 255.0) as u8;
    }
}

/// Roughly normal, unit variance: a sum of four bytes of a xorshift generator.
fn normal(state: &mut u64) -> f32 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    let bytes = (*state as u32).to_le_bytes();
    let sum: f32 = bytes.iter().map(|b| *b as f32).sum();
    // Four uniform bytes: mean 510, standard deviation 147.8.
    (sum - 510.0) / 147.8
}

/// Mean over a short line, as of motion, or over a square.
fn smear(luma: &mut [u8], rng: &mut ChaCha8Rng) {
    let taps = rng.random_range(2..=5);
    let steps: &[usize] = match rng.random_range(0..5) {
        0 => &[1],
        1 => &[TILE],
        2 => &[TILE + 1],
        3 => &[TILE - 1],
        _ => &[1, TILE],
    };
    steps.iter().for_each(|step| mean_along(luma, *step, taps));
}

/// Replaces each pixel by the mean of `taps` pixels, a step apart, around it.
fn mean_along(luma: &mut [u8], step: usize, taps: usize) {
    let source = luma.to_vec();
    let first = (taps - 1) / 2 * step;
    for (i, pixel) in luma.iter_mut().enumerate() {
        let at = |k: usize| (i + k * step).saturating_sub(first).min(source.len() - 1);
        let sum: usize = (0..taps).map(|k| source[at(k)] as usize).sum();
        *pixel = ((sum + taps / 2) / taps) as u8;
    }
}
