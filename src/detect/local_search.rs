//! A small, bounded search around a place where a face is expected.

use super::cluster::{Clusters, Hit, turns};
use super::evaluate::{EMPTY, Windows};
use super::refine::window_of;
use super::window::Q4;
use super::{Detection, DetectorModel, refine};
use crate::image::{Frame, MAX_SIDE};

/// Places along each axis, in steps of the model's grid.
const REACH: i32 = 3;
/// Sizes, as multiples of the expected one.
const SIZES: [f32; 5] = [1.0, 0.86, 1.16, 0.74, 1.35];
/// Rolls beside the expected one \[1/65536 turn\]: 0, ±20°.
const ROLLS: [i32; 3] = [0, 3_641, -3_641];

/// The face near `around` (its place, size and roll; the rest is not read), if there is one.
///
/// Tests at most `budget` units of work as [`Scan::advance`](super::Scan::advance) counts them,
/// the expected size and roll first; the whole search is 7×7 places × 5 sizes × 3 rolls = 735
/// windows.
// By itself, so that its table is on the stack only while it runs.
#[inline(never)]
pub fn local_search(
    model: &DetectorModel<'_>,
    frame: &Frame<'_>,
    around: &Detection,
    budget: u32,
) -> Option<Detection> {
    let sane = around.x.is_finite() && around.y.is_finite() && around.roll.is_finite();
    if !sane || !(8.0..=16_384.0).contains(&around.size) {
        return None;
    }
    let mut clusters = Clusters::default();
    let mut table = EMPTY;
    let mut left = budget as i64;
    for roll in ROLLS {
        for scale in SIZES {
            let place = Detection {
                size: around.size * scale,
                roll: around.roll + turns(roll),
                ..*around
            };
            let step = place.size * model.step_q8 as f32 / 256.0;
            let windows = Windows::new(frame, window_of(model, &place), &mut table);
            for [x, y] in places(&place, step) {
                if left <= 0 {
                    break;
                }
                let (score, units) = windows.evaluate(model, x, y);
                left -= units;
                if let Some(score) = score {
                    clusters.add(Hit {
                        x: x * Q4,
                        y: y * Q4,
                        size: libm::roundf(place.size * Q4 as f32) as i32,
                        roll,
                        score,
                        pass: 0,
                    });
                }
            }
        }
    }
    let mut best = clusters.report(model.confirm, 1, true)?;
    // Clusters hold rolls relative to the expected one, so that ±180° needs no care.
    best.roll += around.roll;
    Some(refine(model, frame, &best))
}

/// The pixels in which windows are centred.
fn places(around: &Detection, step: f32) -> impl Iterator<Item = [i32; 2]> {
    // What is farther away is outside of any frame.
    let near = |v: f32| v.min(2.0 * MAX_SIDE as f32).max(-2.0 * MAX_SIDE as f32);
    let at = move |centre: f32, steps: i32| libm::roundf(near(centre + step * steps as f32)) as i32;
    let (x, y) = (around.x, around.y);
    (-REACH..=REACH)
        .flat_map(move |row| (-REACH..=REACH).map(move |column| [at(x, column), at(y, row)]))
}
