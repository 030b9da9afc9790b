//! Composes random tiles: pictures pasted into others.

use super::disturb;
use super::paste::{Mask, Pose, fill, paste};
use super::pictures::{Kind, Pictures, Source};
use super::tile::{ROLL, SIZES, Tile};
use posewise::detect::{Detection, TILE};
use posewise::image::Crop;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// How far beyond a tile's edge faces are centred \[tile px\].
const BEYOND: f32 = 4.0;
const SIDE: f32 = TILE as f32;

struct Maker<'a> {
    pictures: &'a Pictures,
    rng: &'a mut ChaCha8Rng,
    tile: Tile,
    crop: Box<Crop>,
}

/// A random tile.
pub fn draw(pictures: &Pictures, rng: &mut ChaCha8Rng) -> Tile {
    let mut maker = Maker {
        pictures,
        rng,
        tile: Tile::new(),
        crop: Box::new(Crop::new()),
    };
    match maker.rng.random_range(0..100) {
        0..12 => maker.large(),
        12..30 => maker.alone(),
        _ => maker.background(),
    }
    // Many in one tile, because a tile costs as much with one.
    let wanted = match maker.rng.random_range(0..100) {
        0..20 => 0,
        20..40 => 1,
        _ => maker.rng.random_range(3..8),
    };
    (0..wanted).for_each(|_| maker.face());
    for _ in 0..maker.rng.random_range(0..5) {
        maker.distractor();
    }
    let Maker { mut tile, rng, .. } = maker;
    if rng.random_bool(0.2) {
        disturb::cover(&mut tile, rng);
    }
    if rng.random_bool(0.35) {
        disturb::frame_edges(&mut tile, rng);
    }
    disturb::camera(&mut tile.luma, rng);
    if rng.random_bool(0.5) {
        tile.mirror();
    }
    tile
}

fn log_uniform(rng: &mut ChaCha8Rng, low: f32, high: f32) -> f32 {
    rng.random_range(low.ln()..high.ln()).exp()
}

impl Maker<'_> {
    /// Fills the tile with a picture without people.
    fn background(&mut self) {
        let levels = self.pictures.background(self.rng);
        let scale = log_uniform(self.rng, 0.5, 3.4);
        let roll = match self.rng.random_range(0..4) {
            0 => self.rng.random_range(-3.1f32..3.1),
            _ => self.rng.random_range(-0.2f32..0.2),
        };
        let size = levels[0].size;
        let pose = Pose {
            scale,
            roll,
            from: size.map(|s| self.rng.random_range(0.1f32..0.9) * s as f32),
            to: [SIDE / 2.0; 2],
        };
        fill(&mut self.tile.luma, levels, &pose, &mut self.crop);
    }

    /// Fills the tile with a face's own picture.
    fn alone(&mut self) {
        let source = self.pictures.face(self.rng);
        let size = self.size();
        let to = [0, 1].map(|_| self.rng.random_range(-BEYOND..SIDE + BEYOND));
        let (pose, face) = self.pose(source, size, to);
        fill(&mut self.tile.luma, &source.levels, &pose, &mut self.crop);
        self.tile.label(&face, source.kind);
    }

    /// Fills the tile with a face that is too large for it.
    fn large(&mut self) {
        let source = self.pictures.face(self.rng);
        let size = log_uniform(self.rng, 72.0, 230.0);
        let to = [0, 1].map(|_| self.rng.random_range(0.0..SIDE));
        let (pose, _) = self.pose(source, size, to);
        fill(&mut self.tile.luma, &source.levels, &pose, &mut self.crop);
        if source.kind == Kind::Photograph {
            self.tile.ignore(to, 0.75 * size..f32::MAX);
        }
    }

    /// Pastes a face where none is.
    fn face(&mut self) {
        let source = self.pictures.face(self.rng);
        let size = self.size();
        let is_tight = matches!(source.kind, Kind::Crop | Kind::HalfLabelled);
        let is_whole = !is_tight && self.rng.random_bool(0.4);
        let reach = if is_whole { [1.0, 1.6] } else { [0.58, 1.0] };
        let half = [0, 1].map(|_| size * self.rng.random_range(reach[0]..reach[1]));
        let Some(to) = self.place(half[0].max(half[1])) else {
            return;
        };
        let (pose, face) = self.pose(source, size, to);
        let mut mask = self.mask(half, to, if is_whole { pose.roll } else { face.roll });
        if is_whole {
            mask.doublings = 3;
        }
        self.paste(source.levels.as_slice(), &pose, &mask);
        self.tile.label(&face, source.kind);
    }

    /// Pastes what is no face as faces are pasted: a piece of a picture without people, or of a
    /// face that is far larger or not in the middle.
    fn distractor(&mut self) {
        let to = [0, 1].map(|_| self.rng.random_range(0.0..SIDE));
        let size = log_uniform(self.rng, 15.0, 60.0);
        let roll = self.rng.random_range(-0.8f32..0.8);
        let half = [0, 1].map(|_| size * self.rng.random_range(0.5f32..1.0));
        if !self.is_free(to, half[0].max(half[1])) {
            return;
        }
        let mask = self.mask(half, to, roll);
        if self.rng.random_bool(0.6) {
            let levels = self.pictures.background(self.rng);
            let side = levels[0].size;
            let pose = Pose {
                scale: log_uniform(self.rng, 0.4, 4.0),
                roll,
                from: side.map(|s| self.rng.random_range(0.1f32..0.9) * s as f32),
                to,
            };
            return self.paste(levels, &pose, &mask);
        }
        let source = self.pictures.face(self.rng);
        let truth = source.truth;
        if self.rng.random_bool(0.5) {
            // A piece of a face as large as a face.
            let shift = [0, 1].map(|_| truth.size * self.rng.random_range(-0.45f32..0.45));
            let pose = Pose {
                scale: truth.size / size / self.rng.random_range(2.4f32..4.0),
                roll,
                from: [truth.x + shift[0], truth.y + shift[1]],
                to,
            };
            return self.paste(&source.levels, &pose, &mask);
        }
        // Half a face or less at the mask's edge, or hair, ear, neck.
        let angle = self.rng.random_range(-3.1f32..3.1);
        let far = truth.size * self.rng.random_range(0.55f32..0.8);
        let pose = Pose {
            scale: truth.size / size,
            roll,
            from: [truth.x + far * angle.cos(), truth.y + far * angle.sin()],
            to,
        };
        let mask = Mask {
            half: mask.half.map(|v| v.min(0.5 * size)),
            ..mask
        };
        self.paste(&source.levels, &pose, &mask);
        // What is left of the face does not count.
        self.tile.ignore(to, 0.3 * size..0.9 * size);
    }

    fn paste(&mut self, levels: &[crate::picture::Picture], pose: &Pose, mask: &Mask) {
        let tone = match self.rng.random_bool(0.6) {
            true => [
                self.rng.random_range(0.45f32..1.2),
                self.rng.random_range(-50.0f32..50.0),
            ],
            false => [1.0, 0.0],
        };
        let luma = &mut self.tile.luma;
        paste(luma, levels, pose, mask, tone, &mut self.crop);
    }

    fn size(&mut self) -> f32 {
        match self.rng.random_bool(0.86) {
            true => log_uniform(self.rng, SIZES[0], SIZES[1]),
            false => log_uniform(self.rng, 10.0, 80.0),
        }
    }

    /// A face at this place, rolled at random, and where its picture is then.
    fn pose(&mut self, source: &Source, size: f32, to: [f32; 2]) -> (Pose, Detection) {
        let truth = source.truth;
        let roll = match self.rng.random_bool(0.5) {
            true => self.rng.random_range(-ROLL..ROLL),
            false => {
                let small = self.rng.random_range(-0.15f32..0.15);
                (truth.roll + small).clamp(-1.2, 1.2)
            }
        };
        let pose = Pose {
            scale: truth.size / size,
            roll: roll - truth.roll,
            from: [truth.x, truth.y],
            to,
        };
        let face = Detection {
            x: to[0],
            y: to[1],
            size,
            roll,
            yaw: truth.yaw,
            score: 0.0,
        };
        (pose, face)
    }

    fn mask(&mut self, half: [f32; 2], centre: [f32; 2], angle: f32) -> Mask {
        Mask {
            centre,
            half,
            angle,
            doublings: [1, 1, 2, 2, 3][self.rng.random_range(0..5)],
            feather: match self.rng.random_range(0..4) {
                0 => 1.0,
                _ => self.rng.random_range(1.5f32..8.0),
            },
        }
    }

    /// Whether something may be pasted there without covering a face.
    fn is_free(&self, to: [f32; 2], radius: f32) -> bool {
        let far =
            |f: &Detection| (f.x - to[0]).abs().max((f.y - to[1]).abs()) > radius + 0.5 * f.size;
        self.tile.faces.iter().all(far)
    }

    /// A place that is free, if one is found.
    fn place(&mut self, radius: f32) -> Option<[f32; 2]> {
        (0..4).find_map(|_| {
            let to = [0, 1].map(|_| self.rng.random_range(-BEYOND..SIDE + BEYOND));
            self.is_free(to, radius).then_some(to)
        })
    }
}
