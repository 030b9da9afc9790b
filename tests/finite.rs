//! Every number of a result is finite, whatever camera is accepted: random cameras, also at the
//! limits of what is accepted, with real faces and with what a tiny model takes for faces.

mod common;
#[path = "../fuzz/src/targets/mod.rs"]
#[allow(dead_code)] // only some of the targets' parts are used here
mod targets;

// The targets use `crate::ffi`.
use posewise::ffi;

use ffi::types::*;
use posewise::{
    Config, Distortion, Frame, FrameLayout, Intrinsics, Model, State, TrackResult, Tracker,
};
use targets::memory::Exact;
use targets::{outputs, tiny};

/// Random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In 0..1.
    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A positive number; mostly in the range of focal lengths, with logarithms evenly distributed.
    fn scale(&mut self, decades: f32) -> f32 {
        match self.next() % 32 {
            0..3 => 1.0,
            3..6 => 1e6,
            6 => f32::from_bits(1),
            7 => f32::MAX,
            8 => 10f32.powf(self.unit() * 20.0 - 10.0),
            _ => 10f32.powf(self.unit() * decades),
        }
    }

    /// A camera; most focal lengths are between 1 px and this power of ten.
    fn camera(&mut self, decades: f32) -> Intrinsics {
        let fx = self.scale(decades);
        let fy = match self.next() % 4 {
            0 => self.scale(decades),
            1 => fx * 10f32.powf(self.unit() * 2.0 - 1.0),
            _ => fx,
        };
        let mut centre = || match self.next() % 4 {
            0 => self.scale(6.0) / 10.0,
            1 => -self.scale(6.0) / 10.0,
            _ => self.unit() * 1000.0 - 250.0,
        };
        Intrinsics::new(fx, fy, centre(), centre())
    }

    /// A lens; most coefficients are small.
    fn lens(&mut self) -> Distortion {
        let mut k = |most: f32| match self.next() % 16 {
            0 => most,
            1 => -most,
            2 => (self.unit() * 2.0 - 1.0) * most,
            _ => self.unit() * 0.6 - 0.3,
        };
        let [k1, k2, k3, k4] = [k(10.0), k(10.0), k(1e4), k(10.0)];
        let [p1, p2] = [k(0.1), k(0.1)].map(|p| p.clamp(-0.1, 0.1));
        match self.next() % 2 {
            0 => Distortion::BrownConrady { k1, k2, p1, p2, k3 },
            _ => Distortion::KannalaBrandt { k1, k2, k3, k4 },
        }
    }
}

fn check(result: &TrackResult, camera: &Intrinsics) {
    // The text has all fields, those of later versions too.
    let text = format!("{result:?}");
    let finite = !text.contains("NaN") && !text.contains("inf");
    assert!(finite, "{camera:?}: {text}");
}

/// Tracks 20 frames of the demo clip's face again and again, with a new camera for each, and checks
/// every result. Frames that were tracked, and cameras that were refused.
fn track_demo(
    rounds: i64,
    mut random: Random,
    camera: impl Fn(&mut Random) -> Intrinsics,
) -> (usize, usize) {
    let clip = common::demo().expect("tests/data/demo.y4m.gz");
    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let mut tracker = Box::new(Tracker::new(&Config::default()).expect("defaults"));
    let layout = FrameLayout::grey(clip.width as u32, clip.height as u32);
    let (mut tracked, mut refused) = (0, 0);
    for round in 0..rounds {
        for (i, luma) in clip.luma.iter().skip(20).take(20).enumerate() {
            let camera = camera(&mut random);
            refused += usize::from(tracker.set_intrinsics(Some(camera)).is_err());
            let frame = Frame::new(&layout, luma).expect("a frame");
            let now = (round * 20 + i as i64 + 1) * 33_333;
            let result = tracker.step(&model, &frame, now).expect("in order");
            tracked += usize::from(result.state == State::Tracking);
            check(result, &camera);
            check(tracker.smoothed(), &camera);
        }
    }
    println!("{tracked} tracked, {refused} cameras refused");
    (tracked, refused)
}

#[test]
fn real_faces() {
    let (tracked, refused) = track_demo(60, Random(1), |random| random.camera(6.0));
    assert!(tracked > 900 && refused > 100);
}

#[test]
fn real_faces_through_any_lens() {
    let (tracked, refused) = track_demo(40, Random(3), |random| {
        // Cameras with a field of view from 5° to nearly 180°.
        let focal = 10f32.powf(random.unit() * 2.0 + 1.5);
        Intrinsics::new(focal, focal, 160.0, 120.0).with_distortion(random.lens())
    });
    assert!(tracked > 600 && refused > 50);
}

#[test]
fn anything_taken_for_a_face() {
    const WIDTH: usize = 56;
    const HEIGHT: usize = 48;
    let config = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        min_face_px: 24,
        ..Default::default()
    };
    let mut random = Random(2);
    let mut data = Exact::new(WIDTH * HEIGHT, 1, 0);
    let mut tracked = 0;
    for _ in 0..2000 {
        let camera = random.camera(3.0);
        let Intrinsics { fx, fy, cx, cy, .. } = camera;
        let config = posewise_config {
            intrinsics: posewise_intrinsics { fx, fy, cx, cy },
            ..config
        };
        let Ok(mut tracker) = outputs::Tracker::new(tiny::model(), Some(&config), 0xA5) else {
            continue;
        };
        let (kind, noise) = (random.next() % 4, random.next() % 8 + 1);
        for step in 1..=6 {
            for (i, luma) in data.get_mut().iter_mut().enumerate() {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let smooth = [x * 4 + y, (x ^ y) * 3, 90 + (x * x + y * y) % 32, 0][kind as usize];
                *luma = (smooth as u64 + random.next() % noise) as u8;
            }
            let frame = posewise_frame {
                struct_size: size_of::<posewise_frame>() as u32,
                format: POSEWISE_FMT_GREY,
                timestamp_us: 33_333 * step,
                width: WIDTH as u32,
                height: HEIGHT as u32,
                stride: WIDTH as u32,
                rotation_deg: 0,
                flags: 0,
                reserved: 0,
                data_len: WIDTH * HEIGHT,
                data: data.ptr(),
            };
            // SAFETY: a whole frame.
            let outputs = unsafe { tracker.step(&frame) };
            tracked += usize::from(outputs.expect("a valid frame").is_tracking());
        }
    }
    println!("{tracked} tracked");
    assert!(tracked > 100);
}
