//! A small, bounded search around a place where a face is expected.

use super::cluster::{Clusters, Hit, radians};
use super::evaluate::{EMPTY_TABLE, WindowGrid};
use super::refine::window_of;
use super::window::Q4;
use super::{Detection, DetectorModel, refine};
use crate::image::{Frame, MAX_SIDE};

/// Places to each side along each axis, in steps of the model's scan.
const REACH: i32 = 3;
/// Sizes, as multiples of the expected one.
const SIZES: [f32; 5] = [1.0, 0.86, 1.16, 0.74, 1.35];
/// Rolls relative to the expected one \[1/65536 revolution\]: 0, ±20°.
const ROLLS: [i32; 3] = [0, 3_641, -3_641];
/// Expected sizes that are searched for \[frame px\]: others cannot be faces of a frame.
const SIZE_PX: core::ops::RangeInclusive<f32> = 8.0..=16_384.0;

/// The face near `expected`, if there is one. Of `expected` the place, size and roll are read.
///
/// Evaluates at most `budget` units of work as [`Scan::advance`](super::Scan::advance) counts them,
/// the expected size and roll first. The whole search is 7×7 places × 5 sizes × 3 rolls = 735
/// windows.
// Not inlined: its table is on the stack only while it runs.
#[inline(never)]
pub fn local_search(
    model: &DetectorModel<'_>,
    frame: &Frame<'_>,
    expected: &Detection,
    budget: u32,
) -> Option<Detection> {
    let finite = expected.x.is_finite() && expected.y.is_finite() && expected.roll.is_finite();
    if !finite || !SIZE_PX.contains(&expected.size) {
        return None;
    }
    let mut clusters = Clusters::EMPTY;
    let mut table = EMPTY_TABLE;
    let mut units_left = budget as i64;
    for roll in ROLLS {
        for scale in SIZES {
            let place = Detection {
                size: expected.size * scale,
                roll: expected.roll + radians(roll),
                ..*expected
            };
            let step = place.size * model.step_q8 as f32 / 256.0;
            let windows = WindowGrid::new(frame, window_of(model, &place), &mut table);
            for [x, y] in centres(&place, step) {
                if units_left <= 0 {
                    break;
                }
                let (score, units) = windows.evaluate(model, x, y);
                units_left -= units;
                if let Some(score) = score {
                    clusters.add(Hit {
                        x: x * Q4,
                        y: y * Q4,
                        size: libm::roundf(place.size * Q4 as f32) as i32,
                        roll,
                        score,
                        level: 0,
                    });
                }
            }
        }
    }
    let mut best = clusters.report(model.confirm, 1, true)?;
    // Clusters hold rolls relative to the expected one, so that ±180° needs no care.
    best.roll += expected.roll;
    Some(refine(model, frame, &best))
}

/// The frame's pixels in which windows are centred.
fn centres(expected: &Detection, step: f32) -> impl Iterator<Item = [i32; 2]> {
    // What is clamped lies outside of any frame.
    let clamp = |v: f32| v.min(2.0 * MAX_SIDE as f32).max(-2.0 * MAX_SIDE as f32);
    let at = move |centre: f32, n: i32| libm::roundf(clamp(centre + step * n as f32)) as i32;
    let (x, y) = (expected.x, expected.y);
    (-REACH..=REACH)
        .flat_map(move |row| (-REACH..=REACH).map(move |column| [at(x, column), at(y, row)]))
}
