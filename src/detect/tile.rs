//! Tiles: squares of the frame at one reduction that the network looks at, and what it finds there.

use super::candidates::{Candidates, Hits};
use super::model::{TILE, ZERO};
use super::{Detection, DetectorModel};
use crate::image::Crop;
use crate::math::Similarity;
use crate::network::Activations;

/// The working memory of a tile: its pixels and the network's maps. Nothing in it is kept from one
/// tile to the next.
pub struct TileMemory<'a> {
    /// The tile's pixels.
    pub crop: &'a mut Crop,
    /// The network's maps.
    pub maps: &'a mut Activations,
}

/// Largest magnitude of the logarithm of a size's ratio to the middle one.
const LOG_SIZE_MAX: f32 = 1.5;

/// The transform from a tile to the frame, of a tile that `reduce` has made with this corner
/// \[frame px\] and scale.
pub(super) fn upright_tile(corner: [i32; 2], scale: f32) -> Similarity {
    // A tile's pixel shows the middle of its square.
    let [tx, ty] = corner.map(|v| v as f32 + 0.5 * scale - 0.5);
    Similarity {
        a: scale,
        b: 0.0,
        tx,
        ty,
    }
}

/// Runs the network on the tile in `memory` and adds the faces that are wanted. `to_frame`: tile px
/// to frame px. `visit` is called with each cell's place \[frame px\] and score.
#[inline(never)]
pub(super) fn evaluate(
    model: &DetectorModel<'_>,
    to_frame: &Similarity,
    is_wanted: impl Fn(&Detection) -> bool,
    mut visit: impl FnMut([f32; 2], u8),
    memory: &mut TileMemory<'_>,
    candidates: &mut Candidates,
) {
    let Some((network, output)) = model.network() else {
        return;
    };
    memory.crop.standardise();
    network.run(memory.crop, memory.maps);
    let mut hits = Hits::EMPTY;
    let side = output.side().max(1);
    let stride = TILE.div_ceil(side) as f32;
    let (scale, angle) = (to_frame.scale(), to_frame.angle());
    let cells = memory
        .maps
        .values(&output)
        .chunks_exact(output.channels().max(1));
    for (k, values) in cells.enumerate() {
        let Some(values) = values.first_chunk() else {
            continue;
        };
        let [score, right, down, log_size, roll, yaw] = *values;
        let at = [(k % side) as f32 * stride, (k / side) as f32 * stride];
        visit(to_frame.apply(at), score);
        if score < model.threshold {
            continue;
        }
        let output = |value: u8, output: usize| {
            let unit = model.units.get(output).copied().unwrap_or(0.0);
            (i32::from(value) - i32::from(ZERO)) as f32 * unit
        };
        let [x, y] = to_frame.apply([at[0] + output(right, 1), at[1] + output(down, 2)]);
        let log_size = output(log_size, 3).clamp(-LOG_SIZE_MAX, LOG_SIZE_MAX);
        let threshold = output(model.threshold, 0);
        let face = Detection {
            x,
            y,
            size: scale * model.middle_size * libm::expf(log_size),
            roll: angle + output(roll, 4),
            yaw: output(yaw, 5).clamp(-1.0, 1.0),
            score: output(score, 0) - threshold,
        };
        if is_wanted(&face) {
            hits.add(&face);
        }
    }
    while let Some(face) = hits.take() {
        candidates.insert(face);
    }
}
