//! Occludes faces with patches of other pictures.

use super::starts::normal;
use crate::faces::{Face, Picture};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Least and largest half axis of a patch, in widths of the face's box.
const HALF_AXIS: (f32, f32) = (0.1, 0.42);

/// A face occluded by a patch of another's picture; the landmarks under it are marked hidden.
pub fn covered(face: &Face, other: &Face, rng: &mut ChaCha8Rng) -> Face {
    let width = face.width();
    let [cx, cy] = face.landmarks[rng.random_range(17..68)];
    let half = [0, 0].map(|_| width * rng.random_range(HALF_AXIS.0..HALF_AXIS.1));
    let (sin, cos) = rng.random_range(0.0..std::f32::consts::PI).sin_cos();
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
