//! Occludes faces with patches of other pictures, and cuts them off at the picture's edge.

use super::starts::normal;
use crate::faces::{Face, Picture};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
use std::sync::Arc;

/// Least and largest half axis of a patch, in widths of the face's box.
const HALF_AXIS: (f32, f32) = (0.1, 0.42);
/// Share of patches that are bands across the eyes or the mouth, as sunglasses, hands and scarves
/// are, and the range of their half length and half height, in widths of the face's box.
const BANDS: f64 = 0.3;
const BAND_LENGTH: (f32, f32) = (0.35, 0.65);
const BAND_HEIGHT: (f32, f32) = (0.09, 0.24);
/// What a band lies on.
const EYES: Range<usize> = 36..48;
const MOUTH: Range<usize> = 48..68;
/// Largest part of a face that the picture's edge cuts off, of its landmarks' extent.
const CUT_OFF: f32 = 0.35;
/// Smallest side of a picture that is left \[px\].
const LEFT_PX: usize = 16;

/// Where a patch lies.
struct Place {
    centre: [f32; 2],
    /// Half axes \[px\].
    half: [f32; 2],
    /// Direction of the first \[rad\].
    angle: f32,
}

impl Place {
    fn random(face: &Face, rng: &mut ChaCha8Rng) -> Place {
        let width = face.width();
        if !rng.random_bool(BANDS) {
            return Place {
                centre: face.landmarks[rng.random_range(17..68)],
                half: [0, 0].map(|_| width * rng.random_range(HALF_AXIS.0..HALF_AXIS.1)),
                angle: rng.random_range(0.0..std::f32::consts::PI),
            };
        }
        let on = if rng.random_bool(0.65) { EYES } else { MOUTH };
        let n = on.len() as f32;
        let mean = |k: usize| on.clone().map(|i| face.landmarks[i][k]).sum::<f32>() / n;
        let [right, left] = [face.landmarks[36], face.landmarks[45]];
        Place {
            centre: [0, 1].map(|k| mean(k) + 0.05 * width * normal(rng)),
            half: [
                width * rng.random_range(BAND_LENGTH.0..BAND_LENGTH.1),
                width * rng.random_range(BAND_HEIGHT.0..BAND_HEIGHT.1),
            ],
            angle: (left[1] - right[1]).atan2(left[0] - right[0]) + 0.15 * normal(rng),
        }
    }
}

/// A face occluded by a patch of another's picture; the landmarks under it are marked hidden.
pub fn covered(face: &Face, other: &Face, rng: &mut ChaCha8Rng) -> Face {
    let place = Place::random(face, rng);
    let ([cx, cy], half) = (place.centre, place.half);
    let (sin, cos) = place.angle.sin_cos();
    // A superellipse: from an ellipse to a box with round corners.
    let power = rng.random_range(2.0..8.0f32);
    let inside = |x: f32, y: f32| {
        let (dx, dy) = (x - cx, y - cy);
        let along = ((cos * dx + sin * dy) / half[0]).abs();
        let across = ((cos * dy - sin * dx) / half[1]).abs();
        along.powf(power) + across.powf(power) < 1.0
    };
    let [w, h] = face.picture.size.map(|s| s as usize);
    let mut luma = face.picture.luma.clone();
    let [ow, oh] = other.picture.size.map(|s| s as f32);
    let from = [rng.random_range(0.0..ow), rng.random_range(0.0..oh)];
    let zoom = (0.5 * normal(rng)).exp() * other.scale() / face.scale();
    let own = luma
        [(cy.clamp(0.0, h as f32 - 1.0) as usize) * w + cx.clamp(0.0, w as f32 - 1.0) as usize]
        as f32;
    // As bright as the face, like a hand, or of any brightness.
    let level = match rng.random_bool(0.5) {
        true => own + 25.0 * normal(rng),
        false => rng.random_range(0.0..255.0),
    };
    let gain = rng.random_range(0.0..1.0f32);
    let reach = half[0].max(half[1]) * 1.5;
    let rows = |c: f32, n: usize| {
        let low = (c - reach).clamp(0.0, n as f32) as usize;
        low..(c + reach).clamp(0.0, n as f32) as usize
    };
    for y in rows(cy, h) {
        for x in rows(cx, w) {
            if !inside(x as f32, y as f32) {
                continue;
            }
            let at = |v: f32, c: f32, from: f32, n: f32| {
                (from + (v - c) * zoom).rem_euclid(n).min(n - 1.0) as usize
            };
            let (u, v) = (at(x as f32, cx, from[0], ow), at(y as f32, cy, from[1], oh));
            let texture = other.picture.luma[v * ow as usize + u] as f32 - 110.0;
            luma[y * w + x] = (level + gain * texture).clamp(0.0, 255.0) as u8;
        }
    }
    let mut covered = Face {
        picture: Arc::new(Picture {
            size: face.picture.size,
            luma,
        }),
        ..face.clone()
    };
    for (seen, [x, y]) in covered.visible.iter_mut().zip(face.landmarks) {
        *seen &= !inside(x, y);
    }
    covered
}

/// A face whose picture ends within it, on one side; the landmarks beyond are marked hidden.
pub fn cut_off(face: &Face, rng: &mut ChaCha8Rng) -> Face {
    let axis = rng.random_range(0..2);
    let far = rng.random_bool(0.5);
    let share = rng.random_range(0.0..CUT_OFF);
    let (low, high) = face
        .landmarks
        .iter()
        .fold((f32::MAX, f32::MIN), |(l, h), p| {
            (l.min(p[axis]), h.max(p[axis]))
        });
    let [w, h] = face.picture.size.map(|s| s as usize);
    let side = [w, h][axis];
    let part = share * (high - low);
    // First and last pixel that are left.
    let edge = if far { high - part } else { low + part };
    let edge = (edge.max(0.0) as usize).min(side);
    let kept = if far { 0..edge } else { edge..side };
    if kept.len() < LEFT_PX {
        return face.clone();
    }
    let (xs, ys) = if axis == 0 {
        (kept.clone(), 0..h)
    } else {
        (0..w, kept.clone())
    };
    let rows = ys
        .clone()
        .flat_map(|y| &face.picture.luma[y * w + xs.start..y * w + xs.end]);
    let picture = Picture {
        size: [xs.len() as u32, ys.len() as u32],
        luma: rows.copied().collect(),
    };
    let inside = |p: [f32; 2]| kept.contains(&(p[axis].max(0.0).round() as usize));
    let visible = std::array::from_fn(|i| face.visible[i] && inside(face.landmarks[i]));
    let landmarks = face
        .landmarks
        .map(|p| [p[0] - xs.start as f32, p[1] - ys.start as f32]);
    Face {
        picture: Arc::new(picture),
        landmarks,
        visible,
        ..face.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise::shape::LANDMARKS;
    use rand::SeedableRng;

    #[test]
    fn a_cut_face_keeps_its_place_in_the_picture() {
        let size = [120u32, 100];
        let luma: Vec<u8> = (0..size[0] * size[1]).map(|k| (k % 120) as u8).collect();
        let landmarks = std::array::from_fn(|i| [20.0 + i as f32, 10.0 + i as f32]);
        let face = Face::new(Picture { size, luma }, landmarks);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..50 {
            let cut = cut_off(&face, &mut rng);
            let [w, h] = cut.picture.size.map(|s| s as f32);
            assert_eq!(cut.picture.luma.len(), (w * h) as usize);
            // The pictured column is each pixel's value.
            for ((p, before), visible) in cut.landmarks.iter().zip(face.landmarks).zip(cut.visible)
            {
                let inside = p[0] >= -0.5 && p[1] >= -0.5 && p[0] < w - 0.5 && p[1] < h - 0.5;
                assert_eq!(visible, inside);
                if inside {
                    let at = p[1] as usize * w as usize + p[0] as usize;
                    assert_eq!(cut.picture.luma[at], before[0] as u8);
                }
            }
            assert!(cut.visible.iter().filter(|v| **v).count() > LANDMARKS / 2);
        }
    }
}
