//! A small, bounded search around a place where a face is expected.

use super::cluster::{Clusters, Hit, turns};
use super::refine::window_of;
use super::{Detection, DetectorModel, judge, refine};
use crate::image::Frame;

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
pub fn search_near(
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
    let mut left = budget as i64;
    for roll in ROLLS {
        for scale in SIZES {
            let place = Detection {
                size: around.size * scale,
                roll: around.roll + turns(roll),
                ..*around
            };
            let step = place.size * model.step_q8 as f32 / 256.0;
            for place in grid(&place, step) {
                if left <= 0 {
                    break;
                }
                let (score, trees) = judge(model, frame, &window_of(model, &place));
                left -= 1 + (trees / 16) as i64;
                if let Some(score) = score {
                    clusters.add(hit(&place, roll, score));
                }
            }
        }
    }
    let mut best = clusters.tell(model.confirm, 1, true)?;
    // Clusters hold rolls relative to the expected one, so that ±180° needs no care.
    best.roll += around.roll;
    Some(refine(model, frame, &best))
}

fn grid(centre: &Detection, step: f32) -> impl Iterator<Item = Detection> {
    let centre = *centre;
    (-REACH..=REACH).flat_map(move |row| {
        (-REACH..=REACH).map(move |column| Detection {
            x: centre.x + step * column as f32,
            y: centre.y + step * row as f32,
            ..centre
        })
    })
}

fn hit(place: &Detection, roll: i32, score: i32) -> Hit {
    let q4 = |v: f32| libm::roundf(v * 16.0) as i32;
    Hit {
        x: q4(place.x),
        y: q4(place.y),
        size: q4(place.size),
        roll,
        score,
        pass: 0,
    }
}
