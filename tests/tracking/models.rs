//! Every model in `models/` tracks, and a spoilt one is rejected or harmless.

use crate::common::random::Random;
use crate::common::{demo, root, tracker};
use posewise::{Config, Model, ModelInfo, ModelTerms, State};
use posewise_format::{AlignedBytes, Blob, SectionWriter, blob};

/// Frames of the demo clip, at most `most`, in which a face is tracked.
fn tracked(model: &Model<'_>, most: usize) -> (usize, usize) {
    let mut tracker = tracker(&Config::default());
    let frames = demo().luma.len().min(most);
    let is_tracked = |n: &usize| {
        let result = tracker.step(model, &demo().frame(*n), demo().time_us(*n));
        result.expect("time goes forward").state == State::Tracking
    };
    ((0..frames).filter(is_tracked).count(), frames)
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
        let (tracked, frames) = tracked(&model, usize::MAX);
        let name = path.display();
        println!("{name}: {tracked} of {frames} frames tracked");
        assert!(tracked * 10 >= frames * 9, "{name}: {tracked} of {frames}");
    }
    assert!(models > 0);
}

#[test]
fn models_say_their_names_and_terms() {
    let research = [("posewise.posewise", false), ("research.posewise", true)];
    for (name, is_research) in research {
        let bytes = std::fs::read(root().join("models").join(name)).expect("a model");
        let bytes = AlignedBytes::new(&bytes);
        let info = ModelInfo::read(&bytes).expect("a valid model");
        assert_eq!(info.name, name);
        assert_eq!(info.terms == ModelTerms::Research, is_research, "{name}");
        assert!(info.sheet.contains("Trained on"));
        assert_eq!(info.checksum, posewise_format::crc32(&bytes[64..]));
    }
}

/// The crate's manifest tells the licence of the code and the terms of the model apart.
#[test]
fn the_manifest_has_the_terms_of_the_model() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
    let (_, metadata) = manifest
        .split_once("[package.metadata.model]")
        .expect("what it says of the model");
    let info = ModelInfo::read(posewise::DEFAULT_MODEL).expect("the built-in model");
    let says_free = metadata.contains("\nterms = \"free\"\n");
    assert_eq!(says_free, info.terms == ModelTerms::Free);
}

/// A model without one section, or with one of no bytes.
#[test]
fn the_wrong_section_is_named() {
    let valid = Blob::open(posewise::DEFAULT_MODEL).expect("the default model is valid");
    for (wrong, _) in valid.sections().filter(|(tag, _)| tag != b"INFO") {
        for is_there in [false, true] {
            let kept = valid
                .sections()
                .filter(|(tag, _)| is_there || *tag != wrong);
            let sections = kept.map(|(tag, content)| match tag == wrong {
                true => SectionWriter::of_bytes(tag, Vec::new()),
                false => SectionWriter::of_bytes(tag, content.to_vec()),
            });
            let bytes = AlignedBytes::new(&blob(&sections.collect::<Vec<_>>()));
            let info = ModelInfo::read(&bytes).expect("a whole file");
            assert_eq!(info.name, "posewise.posewise");
            match Model::load(&bytes) {
                // Optional sections may be missing.
                Ok(_) => assert!(!is_there),
                Err(error) => {
                    assert_eq!(error.section(), Some(wrong), "{error}");
                    assert!(!error.check().is_empty());
                }
            }
        }
    }
}

/// Changes what a checksum would have found: bytes of the sections, mostly of their heads, where
/// sizes and offsets stand.
#[test]
fn spoilt_sections_are_rejected_or_harmless() {
    let valid = Blob::open(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let sections: Vec<_> = valid.sections().collect();
    let (mut rejected, mut ran) = (0, 0);
    let mut random = Random(1);
    for round in 0..200 {
        let mut contents: Vec<_> = sections.iter().map(|(_, c)| c.to_vec()).collect();
        let spoilt = &mut contents[round % sections.len()];
        for _ in 0..1 + random.below(3) {
            let reach = match round % 3 {
                0 => spoilt.len(),
                _ => spoilt.len().min(4096),
            };
            spoilt[random.below(reach)] = random.below(256) as u8;
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
