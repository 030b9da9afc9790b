//! Synthetic scenes in linear light: objects of all sizes that occlude each other, as in the
//! dead-leaves model of natural pictures (Lee, Mumford and Huang, "Occlusion models for natural
//! images", 2001), with shading, patterns and rows of equal objects.

use super::background::procedural;
use super::noise::{fractal, noise, smoothstep};
use glam::{Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::{PI, TAU};

/// A scene and its objects.
pub fn scene(rng: &mut ChaCha8Rng, width: usize, height: usize) -> Vec<f32> {
    let mut light = procedural(rng, width, height);
    let size = width.max(height) as f32;
    let style = Style::draw(rng);
    let count = rng.random_range(0.0f32..5.5).exp() as usize;
    for _ in 0..count {
        let thing = Thing::draw(rng, &style, size);
        let (columns, rows, pitch) = row_of(rng, &thing);
        let middle = Vec2::new(
            rng.random_range(0.0..width as f32),
            rng.random_range(0.0..height as f32),
        );
        for k in 0..columns * rows {
            let step = Vec2::new((k % columns) as f32, (k / columns) as f32);
            thing.paint(&mut light, width, middle + thing.lean.rotate(step * pitch));
        }
    }
    light
}

/// Repetitions of an object beside and below itself, and their distance \[px\].
fn row_of(rng: &mut ChaCha8Rng, thing: &Thing) -> (usize, usize, Vec2) {
    let mut times = || match rng.random_range(0..12) {
        0..9 => 1,
        9 => 2,
        _ => rng.random_range(3..9usize),
    };
    let (columns, rows) = (times(), times());
    let gap = Vec2::new(rng.random_range(1.02..2.2), rng.random_range(1.02..2.2));
    (columns, rows, 2.0 * thing.half * gap)
}

/// What the objects of a scene have in common.
struct Style {
    /// Radius of the smallest objects over the picture's size; frequency falls with the cube.
    least: f32,
    /// Tones of the objects, in linear light.
    tones: (f32, f32),
    /// Largest half width of an object over its radius.
    slim: f32,
    /// Share of upright objects.
    upright: f64,
    /// Half the width of an edge \[px\]: the defocus.
    soft: f32,
}

impl Style {
    fn draw(rng: &mut ChaCha8Rng) -> Style {
        let dark = rng.random_range(0.01f32..0.25);
        Style {
            least: rng.random_range(0.012f32.ln()..0.1f32.ln()).exp(),
            tones: (dark, dark + rng.random_range(0.05f32..0.75)),
            slim: rng.random_range(0.15..1.0),
            upright: rng.random_range(0.0..1.0),
            soft: if rng.random_bool(0.6) {
                0.7
            } else {
                rng.random_range(0.7..5.0)
            },
        }
    }

    fn tone(&self, rng: &mut ChaCha8Rng) -> f32 {
        let (low, high) = self.tones;
        // Even steps on a display.
        rng.random_range(low.sqrt()..high.sqrt()).powi(2)
    }
}

enum Outline {
    Ellipse,
    Box,
    /// Waves on a circle: share of the radius, how many, where they begin \[rad\].
    Wavy(f32, f32, f32),
}

enum Shade {
    Flat,
    Slope(Vec2),
    /// A ball or a cushion lit from a direction.
    Ball(Vec3),
    /// A pipe or a limb.
    Tube(Vec3),
}

enum Pattern {
    Plain,
    /// Lines of a period \[px\] along one axis, and their share of it.
    Stripes {
        period: f32,
        share: f32,
        across: bool,
    },
    /// Spots of a period \[px\] and a radius over it.
    Spots {
        period: f32,
        radius: f32,
    },
    /// Lines of words of a height \[px\].
    Writing {
        height: f32,
    },
    /// Stone, leaves, fur: waves per pixel, depth.
    Grain {
        scale: Vec2,
        depth: f32,
    },
}

struct Thing {
    /// Half width and half height \[px\].
    half: Vec2,
    /// Rotates its own axes to the picture's.
    lean: Vec2,
    outline: Outline,
    shade: Shade,
    pattern: Pattern,
    /// Of the object and of its pattern, in linear light.
    tones: [f32; 2],
    soft: f32,
    seed: u32,
}

impl Thing {
    fn draw(rng: &mut ChaCha8Rng, style: &Style, size: f32) -> Thing {
        // An object's area grows with the square of its radius, the number falls with the cube.
        let radius = size * (style.least / rng.random_range(0.02f32..1.0).sqrt()).min(0.45);
        let slim = rng.random_range(style.slim..=1.0);
        let half = radius
            * if rng.random_bool(0.5) {
                Vec2::new(slim, 1.0)
            } else {
                Vec2::new(1.0, slim)
            };
        let lean = if rng.random_bool(style.upright) {
            rng.random_range(-0.05f32..0.05)
        } else {
            rng.random_range(-PI..PI)
        };
        Thing {
            half,
            lean: Vec2::from_angle(lean),
            outline: match rng.random_range(0..10) {
                0..3 => Outline::Ellipse,
                3..6 => Outline::Box,
                _ => Outline::Wavy(
                    rng.random_range(0.05..0.5),
                    rng.random_range(2..9) as f32,
                    rng.random_range(0.0..TAU),
                ),
            },
            shade: shade(rng),
            pattern: pattern(rng, radius),
            tones: [style.tone(rng), style.tone(rng)],
            soft: style.soft,
            seed: rng.random(),
        }
    }

    /// Paints the object over the picture.
    fn paint(&self, light: &mut [f32], width: usize, middle: Vec2) {
        let height = light.len() / width;
        let reach = self.half.length() + self.soft;
        let from = |v: f32| (v - reach).max(0.0) as usize;
        let to = |v: f32, len: usize| ((v + reach).max(0.0) as usize + 1).min(len);
        let back = Vec2::new(self.lean.x, -self.lean.y);
        for y in from(middle.y)..to(middle.y, height) {
            for x in from(middle.x)..to(middle.x, width) {
                let p = back.rotate(Vec2::new(x as f32, y as f32) - middle);
                let cover = smoothstep(-self.soft, self.soft, self.depth(p));
                if cover > 0.0 {
                    let pixel = &mut light[y * width + x];
                    *pixel += (self.tone(p) - *pixel) * cover;
                }
            }
        }
    }

    /// About how far inside a point lies \[px\].
    fn depth(&self, p: Vec2) -> f32 {
        let q = p / self.half;
        let thin = self.half.min_element();
        match self.outline {
            Outline::Ellipse => (1.0 - q.length()) * thin,
            Outline::Box => (self.half - p.abs()).min_element(),
            Outline::Wavy(depth, count, from) => {
                let wave = (count * q.y.atan2(q.x) + from).sin();
                (1.0 + depth * (wave - 1.0) / 2.0 - q.length()) * thin
            }
        }
    }

    fn tone(&self, p: Vec2) -> f32 {
        let q = p / self.half;
        let lit = match self.shade {
            Shade::Flat => 1.0,
            Shade::Slope(slope) => 1.0 + slope.dot(q),
            Shade::Ball(from) => lit(q.extend((1.0 - q.length_squared()).max(0.0).sqrt()), from),
            Shade::Tube(from) => lit(Vec3::new(q.x, 0.0, (1.0 - q.x * q.x).max(0.0).sqrt()), from),
        };
        let [tone, other] = self.tones;
        (lit * (tone + (other - tone) * self.ink(p))).clamp(0.0, 1.0)
    }

    /// How much of the pattern's tone is at a point, 0 to 1.
    fn ink(&self, p: Vec2) -> f32 {
        match self.pattern {
            Pattern::Plain => 0.0,
            Pattern::Stripes {
                period,
                share,
                across,
            } => {
                let v = if across { p.x } else { p.y };
                let off = ((v / period).rem_euclid(1.0) - 0.5).abs() * period;
                smoothstep(-self.soft, self.soft, share * period / 2.0 - off)
            }
            Pattern::Spots { period, radius } => {
                let cell = (p / period - (p / period).floor() - 0.5) * period;
                smoothstep(-self.soft, self.soft, radius * period - cell.length())
            }
            Pattern::Writing { height } => {
                let line = (p.y / height).floor();
                let off = ((p.y / height).rem_euclid(1.0) - 0.5).abs();
                let letters = noise(Vec3::new(2.5 * p.x / height, 7.3 * line, 0.5), self.seed);
                let words = noise(Vec3::new(0.4 * p.x / height, 5.1 * line, 9.5), self.seed);
                smoothstep(-0.1, 0.2, letters)
                    * smoothstep(-0.45, -0.35, words)
                    * smoothstep(0.36, 0.26, off)
            }
            Pattern::Grain { scale, depth } => {
                let q = p * scale;
                (0.5 + depth * fractal(q.extend(0.0), 3, self.seed)).clamp(0.0, 1.0)
            }
        }
    }
}

/// Lambert's law, with some light from everywhere.
fn lit(normal: Vec3, from: Vec3) -> f32 {
    0.25 + 0.9 * normal.dot(from).max(0.0)
}

fn shade(rng: &mut ChaCha8Rng) -> Shade {
    let mut within = |v: f32| rng.random_range(-v..v);
    let from = Vec3::new(within(0.9), within(0.9), 0.6).normalize();
    let slope = Vec2::new(within(0.6), within(0.6));
    match rng.random_range(0..10) {
        0..3 => Shade::Flat,
        3..6 => Shade::Slope(slope),
        6..8 => Shade::Ball(from),
        _ => Shade::Tube(from),
    }
}

fn pattern(rng: &mut ChaCha8Rng, radius: f32) -> Pattern {
    let period = radius * rng.random_range(0.06f32.ln()..1.2f32.ln()).exp();
    match rng.random_range(0..20) {
        0..8 => Pattern::Plain,
        8..11 => Pattern::Stripes {
            period: period.max(2.5),
            share: rng.random_range(0.15..0.8),
            across: rng.random_bool(0.5),
        },
        11..13 => Pattern::Spots {
            period: period.max(4.0),
            radius: rng.random_range(0.12..0.48),
        },
        13..15 => Pattern::Writing {
            height: period.max(4.0),
        },
        _ => Pattern::Grain {
            scale: Vec2::new(rng.random_range(0.3..1.0), rng.random_range(0.3..1.0))
                / period.max(1.5),
            depth: rng.random_range(0.3..1.5),
        },
    }
}
