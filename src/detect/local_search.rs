//! A small, bounded search around a place where a face is expected.

use super::candidates::Candidates;
use super::model::TILE;
use super::tile::{TileMemory, evaluate, upright_tile};
use super::{Detection, DetectorModel};
use crate::image::{Frame, reduce, warp};
use crate::math::Similarity;

/// Expected sizes that are searched for \[frame px\]: others cannot be faces of a frame.
const SIZE_PX: core::ops::RangeInclusive<f32> = 8.0..=16_384.0;
/// Places that are searched: farther from a frame there is none \[frame px\].
const FARTHEST_PX: f32 = 65_536.0;
/// Farthest from the expected place that a face is found \[of the expected size\].
const REACH: f32 = 0.6;
/// Roll up to which the tile is upright, as those of the scan \[rad\]: a fifth of the pixels are
/// read then. Chosen: the detector finds faces that are rolled so far.
const UPRIGHT: f32 = 0.35;

/// The face near `expected`, if there is one. Of `expected` the place, size and roll are read.
///
/// The work is that of one tile: it is centred on the place, it shows faces of the expected size at
/// the middle of its range, and where the head is rolled far it is turned by the roll.
#[inline(never)]
pub fn local_search(
    model: &DetectorModel<'_>,
    frame: &Frame<'_>,
    expected: &Detection,
    memory: &mut TileMemory<'_>,
) -> Option<Detection> {
    let is_near = |v: f32| v.abs() <= FARTHEST_PX;
    let finite = is_near(expected.x) && is_near(expected.y) && expected.roll.is_finite();
    if !finite || !SIZE_PX.contains(&expected.size) {
        return None;
    }
    let scale = expected.size / model.middle_size;
    let to_frame = match is_upright(expected) {
        true => reduced(frame, expected, scale, memory),
        false => turned(frame, expected, scale, memory),
    };
    let mut candidates = Candidates::EMPTY;
    let reach = REACH * expected.size;
    let wanted = |face: &Detection| libm::hypotf(face.x - expected.x, face.y - expected.y) <= reach;
    evaluate(model, &to_frame, wanted, |_, _| (), memory, &mut candidates);
    candidates.report()
}

/// Whether the tile around an expected face is upright, which takes less work.
pub fn is_upright(expected: &Detection) -> bool {
    expected.roll.abs() <= UPRIGHT
}

/// Fills the tile with what is around the place, upright; returns the transform from the tile to
/// the frame.
fn reduced(
    frame: &Frame<'_>,
    expected: &Detection,
    scale: f32,
    memory: &mut TileMemory<'_>,
) -> Similarity {
    let scale_q8 = (libm::roundf(scale * 256.0) as i32).max(1);
    let scale = scale_q8 as f32 / 256.0;
    let half = scale * TILE as f32 / 2.0;
    let corner = [expected.x, expected.y].map(|v| libm::roundf(v - half) as i32);
    reduce(frame, corner, scale_q8, TILE, memory.crop);
    upright_tile(corner, scale)
}

/// The same, turned by the roll.
fn turned(
    frame: &Frame<'_>,
    expected: &Detection,
    scale: f32,
    memory: &mut TileMemory<'_>,
) -> Similarity {
    let (sin, cos) = (libm::sinf(expected.roll), libm::cosf(expected.roll));
    let centre = (TILE as f32 - 1.0) / 2.0;
    let linear = Similarity {
        a: scale * cos,
        b: scale * sin,
        tx: 0.0,
        ty: 0.0,
    };
    let [x, y] = linear.apply_vector([centre, centre]);
    let to_frame = Similarity {
        tx: expected.x - x,
        ty: expected.y - y,
        ..linear
    };
    warp(frame, &to_frame, TILE, memory.crop);
    to_frame
}
