//! Every method follows the demo clip, which is rendered.

use super::face_model::Kind;
use super::settings::{Method, Settings};
use super::trackers::Trackers;
use crate::truth;
use clap::Parser;
use flate2::read::GzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

#[derive(Parser)]
struct Options {
    #[command(flatten)]
    settings: Settings,
}

/// Frames of the clip that are followed, 2 s; the head nods and tilts there, and hardly turns.
const FIRST: usize = 68;
const FRAMES: usize = 40;
/// Most that a method may be off in the mean of the clip \[deg\]: a face that is lost is further.
const LOOSE_DEG: f64 = 15.0;

/// The demo clip's frames that are followed.
fn calm_part(path: &Path) -> Vec<u8> {
    let mut video = Vec::new();
    let packed = std::fs::File::open(path).unwrap();
    GzDecoder::new(packed).read_to_end(&mut video).unwrap();
    let head = video.iter().position(|b| *b == b'\n').unwrap() + 1;
    let frame = "FRAME\n".len() + 320 * 240;
    let wanted = &video[head + FIRST * frame..][..FRAMES * frame];
    [&video[..head], wanted].concat()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The morphable head; skips the test where there is none.
fn facekit() -> Option<PathBuf> {
    let facekit = root().join("../shared/data/facekit.npz");
    if !facekit.exists() {
        crate::skip::skipped("facekit.npz");
        return None;
    }
    Some(facekit)
}

/// Frames of the calm part that [`covered_part`] shows nothing in.
const COVERED: std::ops::Range<usize> = 15..25;

/// The calm part with some frames grey.
fn covered_part(path: &Path) -> Vec<u8> {
    let mut video = calm_part(path);
    let head = video.iter().position(|b| *b == b'\n').unwrap() + 1;
    let size = 320 * 240;
    let frame = "FRAME\n".len() + size;
    for k in COVERED {
        let end = head + (k + 1) * frame;
        video[end - size..end].fill(128);
    }
    video
}

/// What clips are followed with, which takes long to learn: with the morphable head, and, for
/// [`WITH_CANDIDE`], with Candide-3.
static TRACKERS: LazyLock<[Trackers; 2]> = LazyLock::new(|| {
    let facekit = facekit().expect("the tests look for it before");
    let folder = tempfile::tempdir().unwrap();
    let trained = folder.path().to_str().unwrap();
    let settings = Options::parse_from([
        "test",
        "--facekit",
        facekit.to_str().unwrap(),
        "--trained",
        trained,
        "--training-faces",
        "200",
        "--cascade-faces",
        "100",
        "--grid-step",
        "20",
        "--frames",
        &FRAMES.to_string(),
    ]);
    let candide = Settings {
        face_model: Kind::Candide,
        candide: facekit.with_file_name("candide3.wfm"),
        ..settings.settings.clone()
    };
    let morphable = Trackers::new(&settings.settings, &Method::ALL).unwrap();
    // What was learned is read the next time.
    let written = || std::fs::metadata(folder.path().join("svm.json")).unwrap();
    let kept = written().modified().unwrap();
    let candide = Trackers::new(&candide, &WITH_CANDIDE).unwrap();
    assert_eq!(kept, written().modified().unwrap());
    [morphable, candide]
});

const WITH_CANDIDE: [Method; 2] = [Method::Gaussian, Method::Svm];

#[test]
fn templates_wait_for_a_face_that_they_lost() {
    if facekit().is_none() {
        return;
    }
    let (root, folder) = (root(), tempfile::tempdir().unwrap());
    let clip = folder.path().join("clip.y4m");
    std::fs::write(&clip, covered_part(&root.join("tests/data/demo.y4m.gz"))).unwrap();
    let truth = truth::read(&root.join("tests/data/demo.csv")).unwrap();
    let focal = truth[0].focal.map(|f| f as f32);
    let frames = TRACKERS[0].follow(Method::Svm, &clip, focal).unwrap();
    let angles = |k: usize| frames[k].tracked.as_ref().unwrap().angles;
    let last_seen = angles(COVERED.start - 1);
    assert!(COVERED.into_iter().all(|k| angles(k) == last_seen));
    let pairs = angles(FRAMES - 1).into_iter();
    let pairs = pairs.zip(truth[FIRST + FRAMES - 1].angles);
    let off = pairs.map(|(a, b)| (a - b).abs()).sum::<f64>() / 3.0;
    assert!(off < LOOSE_DEG, "{off}");
}

#[test]
fn every_method_follows_a_short_clip() {
    if facekit().is_none() {
        return;
    }
    let (root, folder) = (root(), tempfile::tempdir().unwrap());
    let clip = folder.path().join("clip.y4m");
    std::fs::write(&clip, calm_part(&root.join("tests/data/demo.y4m.gz"))).unwrap();
    let mut truth = truth::read(&root.join("tests/data/demo.csv")).unwrap();
    let truth: Vec<_> = truth.drain(FIRST..FIRST + FRAMES).collect();
    let focal = truth[0].focal.map(|f| f as f32);
    let [morphable, candide] = &*TRACKERS;
    let all = Method::ALL.iter().map(|method| (method, morphable));
    for (method, trackers) in all.chain(WITH_CANDIDE.iter().map(|method| (method, candide))) {
        let frames = trackers.follow(*method, &clip, focal).unwrap();
        assert_eq!(frames.len(), truth.len(), "{}", method.name());
        let pairs = frames.iter().zip(&truth);
        let off = pairs.filter_map(|(frame, truth)| {
            let found = frame.tracked.as_ref()?.angles.into_iter();
            let terms = found.zip(truth.angles);
            Some(terms.map(|(a, b)| (a - b).abs()).sum::<f64>() / 3.0)
        });
        let off: Vec<f64> = off.collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        println!("{}: {mean:.2}° in {} frames", method.name(), off.len());
        assert!(off.len() + 5 > truth.len(), "{}", method.name());
        // The clip shows the morphable head, and Candide-3 is another one.
        let is_other = std::ptr::eq(trackers, candide);
        let most = if is_other { 2.0 * LOOSE_DEG } else { LOOSE_DEG };
        assert!(mean < most, "{}: {mean}", method.name());
    }
}
