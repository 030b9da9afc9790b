//! Every model in `models/` tracks, and a spoilt one is rejected or harmless.

mod common;

use common::root;
use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

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
        let bytes = AlignedBytes::new(&std::fs::read(&path).expect("a model"));
        let model = Model::load(&bytes).expect("a valid model");
        if let Some((tracked, frames)) = tracked(&model, usize::MAX) {
            let name = path.display();
            println!("{name}: {tracked} of {frames} frames tracked");
            assert!(tracked * 10 >= frames * 9, "{name}: {tracked} of {frames}");
        }
    }
    assert!(models > 0);
}

/// Changes what a checksum would have found: bytes of the sections, mostly of their heads, where
/// sizes and offsets stand.
#[test]
fn spoilt_sections_are_rejected_or_harmless() {
    let valid = Blob::open(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let sections: Vec<_> = valid.sections().collect();
    let (mut rejected, mut ran) = (0, 0);
    let mut seed = 1u32;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as usize % below
    };
    for round in 0..200 {
        let mut contents: Vec<_> = sections.iter().map(|(_, c)| c.to_vec()).collect();
        let spoilt = &mut contents[round % sections.len()];
        for _ in 0..1 + random(3) {
            let reach = match round % 3 {
                0 => spoilt.len(),
                _ => spoilt.len().min(4096),
            };
            spoilt[random(reach)] = random(256) as u8;
        }
        let tags = sections.iter().map(|(tag, _)| *tag);
        let sections = tags
            .zip(contents)
            .map(|(t, c)| SectionWriter::of_bytes(t, c));
        let bytes = AlignedBytes::new(&blob(&sections.collect::<Vec<_>>()));
        match Model::load(&bytes) {
            Err(_) => rejected += 1,
            Ok(model) => {
                ran += 1;
                tracked(&model, 8);
            }
        }
    }
    println!("{rejected} rejected, {ran} ran");
    assert!(rejected > 0 && ran > 0);
}
