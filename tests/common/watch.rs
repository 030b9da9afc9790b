//! A tracker that watches pictures into which the demo clip's face is pasted, once or more.

use super::{Clip, demo, grey, model, tracker};
use posewise::{Config, FaceHint, Model, State, TrackResult, Tracker};

pub const WIDTH: usize = 640;
pub const HEIGHT: usize = 360;
pub const FRAME_US: i64 = 40_000;
/// Middle and width of the clip's face in its first frames, about \[px\].
pub const FACE: ([f32; 2], f32) = ([160.0, 130.0], 90.0);

/// A face of the clip: how many times its size, where its middle goes.
#[derive(Clone, Copy)]
pub struct Pasted {
    pub scale: f32,
    pub at: [f32; 2],
}

/// A picture with such faces; later ones lie over earlier ones.
pub fn picture(clip: &Clip, frame: usize, faces: &[Pasted]) -> Vec<u8> {
    // Forwards and backwards, so that the face never jumps.
    let from = &clip.luma[(frame % 38).min(38 - frame % 38)];
    let ground = |i: usize| 90 + (((i % WIDTH) * 7 + (i / WIDTH) * 13) % 31) as u8;
    let mut luma: Vec<u8> = (0..WIDTH * HEIGHT).map(ground).collect();
    for face in faces {
        // Head and shoulders, not the clip's whole background.
        let half = 0.75 * FACE.1 * face.scale;
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let [dx, dy] = [x as f32 - face.at[0], y as f32 - face.at[1]];
                if dx.abs() > half || dy.abs() > half {
                    continue;
                }
                let u = (FACE.0[0] + dx / face.scale).round() as usize;
                let v = (FACE.0[1] + dy / face.scale).round() as usize;
                if u < clip.width && v < clip.height {
                    luma[y * WIDTH + x] = from[v * clip.width + u];
                }
            }
        }
    }
    luma
}

/// A picture as a camera shows it in a room so dim: every level is this share of what it was, and
/// the sensor's noise, up to half of this to either side, stays.
pub fn dimmed(luma: &mut [u8], share: f32, noise: f32, frame: usize) {
    for (i, level) in luma.iter_mut().enumerate() {
        let mixed = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ (frame as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let random = (mixed.wrapping_mul(0x94d0_49bb_1331_11eb) >> 40) as f32 / (1 << 24) as f32;
        *level = (share * *level as f32 + noise * (random - 0.5)).clamp(0.0, 255.0) as u8;
    }
}

pub struct Watch<'m> {
    pub clip: &'static Clip,
    /// 1 by day.
    pub light: f32,
    /// Range of the sensor's noise [grey levels]; as long as it is light there is none.
    pub noise: f32,
    pub model: &'m Model<'m>,
    pub tracker: Box<Tracker>,
    pub frame: usize,
}

impl Watch<'_> {
    /// One step on the next frame with these faces.
    pub fn see(&mut self, faces: &[Pasted]) -> TrackResult {
        let mut luma = picture(self.clip, self.frame, faces);
        if self.light < 1.0 {
            dimmed(&mut luma, self.light, self.noise, self.frame);
        }
        let frame = grey(WIDTH, HEIGHT, &luma);
        let time = self.frame as i64 * FRAME_US;
        self.frame += 1;
        *self
            .tracker
            .step(self.model, &frame, time)
            .expect("time goes on")
    }

    /// One step for a caller who expects this face, whose box is off by a share of its size.
    pub fn see_at(&mut self, faces: &[Pasted], expected: Pasted, off: f32) -> TrackResult {
        let luma = picture(self.clip, self.frame, faces);
        let frame = grey(WIDTH, HEIGHT, &luma);
        let time = self.frame as i64 * FRAME_US;
        self.frame += 1;
        let side = FACE.1 * expected.scale;
        let [x, y] = expected.at.map(|v| v + (off - 0.5) * side);
        let hint = FaceHint::new([x, y, side, side]);
        *self
            .tracker
            .step_at(self.model, &frame, time, &hint)
            .expect("time goes on")
    }

    /// Shows the same until a face is tracked; how many frames that took.
    pub fn until_tracked(&mut self, faces: &[Pasted], most: usize) -> (usize, TrackResult) {
        for n in 1..=most {
            let result = self.see(faces);
            if result.state == State::Tracking {
                return (n, result);
            }
        }
        panic!("not tracked in {most} frames");
    }
}

/// Runs a test on the clip.
pub fn watch(config: Config, test: impl FnOnce(&mut Watch<'_>)) {
    let model = model();
    test(&mut Watch {
        clip: demo(),
        light: 1.0,
        noise: 6.0,
        model: &model,
        tracker: tracker(&config),
        frame: 0,
    });
}

pub fn middle(result: &TrackResult) -> [f32; 2] {
    let [x, y, w, h] = result.face_box;
    [x + w / 2.0, y + h / 2.0]
}

pub fn is_at(result: &TrackResult, face: Pasted) -> bool {
    let [x, y] = middle(result);
    (x - face.at[0]).hypot(y - face.at[1]) < 0.3 * FACE.1 * face.scale
}

pub const SMALL: Pasted = Pasted {
    scale: 0.9,
    at: [130.0, 180.0],
};
pub const LARGE: Pasted = Pasted {
    scale: 1.7,
    at: [430.0, 180.0],
};

/// The whole frame is searched at once.
pub fn patient() -> Config {
    let mut config = Config::default();
    config.scan_budget = 1_000_000;
    config
}
