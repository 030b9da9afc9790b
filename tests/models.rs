//! Every model in `models/` tracks, and a spoilt one is refused or harmless.

mod common;

use common::root;
use posewise::image::{Frame, FrameLayout};
use posewise::model::{HEADER_LEN, crc32};
use posewise::track::{Config, Model, State, Tracker};

/// Bytes at a multiple of 64.
struct Aligned {
    bytes: Vec<u8>,
    start: usize,
    len: usize,
}

impl Aligned {
    fn new(content: &[u8]) -> Aligned {
        let mut bytes = vec![0; content.len() + 64];
        let start = bytes.as_ptr().align_offset(64);
        bytes[start..start + content.len()].copy_from_slice(content);
        Aligned {
            bytes,
            start,
            len: content.len(),
        }
    }

    fn get(&self) -> &[u8] {
        &self.bytes[self.start..self.start + self.len]
    }
}

/// Frames of the demo clip, at most `most`, in which a face is tracked.
fn tracked(model: &Model<'_>, most: usize) -> Option<(usize, usize)> {
    let clip = common::demo()?;
    let mut tracker = Box::new(Tracker::new(&Config::default()).expect("defaults"));
    let layout = FrameLayout::grey(clip.width as u32, clip.height as u32);
    let (mut tracked, mut frames) = (0, 0);
    for luma in clip.luma.iter().take(most) {
        let frame = Frame::new(&layout, luma).expect("a frame");
        frames += 1;
        let result = tracker
            .step(model, &frame, frames as i64 * 33_333)
            .expect("time goes forward");
        tracked += usize::from(result.state == State::Tracking);
    }
    Some((tracked, frames))
}

#[test]
fn every_model_tracks_the_demo_clip() {
    let mut models = 0;
    for entry in std::fs::read_dir(root().join("models")).expect("models/") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "posewise") {
            continue;
        }
        models += 1;
        let bytes = Aligned::new(&std::fs::read(&path).expect("a model"));
        let model = Model::load(bytes.get()).expect("a valid model");
        if let Some((tracked, frames)) = tracked(&model, usize::MAX) {
            let name = path.display();
            println!("{name}: {tracked} of {frames} frames tracked");
            assert!(tracked * 10 >= frames * 9, "{name}: {tracked} of {frames}");
        }
    }
    assert!(models > 0);
}

/// Changes what a checksum would have told: bytes of the sections' heads, where sizes and places in
/// memory stand.
#[test]
fn spoilt_sections_are_refused_or_harmless() {
    let whole = posewise::DEFAULT_MODEL;
    let word = |bytes: &[u8], at: usize| {
        u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
    };
    let sections = word(whole, 20);
    let (mut refused, mut ran) = (0, 0);
    let mut seed = 1u32;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as usize % below
    };
    for round in 0..200 {
        let entry = HEADER_LEN + 16 * (round % sections);
        let (start, len) = (word(whole, entry + 4), word(whole, entry + 8));
        let mut bytes = whole.to_vec();
        for _ in 0..1 + random(3) {
            let reach = if round % 3 == 0 { len } else { len.min(4096) };
            bytes[start + random(reach)] = random(256) as u8;
        }
        let sum = crc32(&bytes[HEADER_LEN..]).to_le_bytes();
        bytes[16..20].copy_from_slice(&sum);
        let bytes = Aligned::new(&bytes);
        match Model::load(bytes.get()) {
            Err(_) => refused += 1,
            Ok(model) => {
                ran += 1;
                tracked(&model, 8);
            }
        }
    }
    println!("{refused} refused, {ran} ran");
    assert!(refused > 0 && ran > 0);
}
