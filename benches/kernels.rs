//! The stages that run networks, with each kernel of this machine: `cargo bench --bench kernels`.

use divan::Bencher;
use posewise::align::{Shape, Workspace};
use posewise::network::{KernelName, select_kernel};
use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
use std::io::Read;

fn main() {
    divan::main();
}

fn available() -> impl Iterator<Item = KernelName> {
    KernelName::ALL.into_iter().filter(|k| k.is_available())
}

/// Width, height and luma of the demo clip's frames.
fn clip() -> (usize, usize, Vec<Vec<u8>>) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/demo.y4m.gz");
    let packed = std::fs::File::open(path).expect(path);
    let mut video = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(packed);
    reader.read_to_end(&mut video).expect("a whole clip");
    let (reader, mut frames) = (&mut &video[..], Vec::new());
    let mut decoder = y4m::decode(reader).expect("y4m");
    let (width, height) = (decoder.get_width(), decoder.get_height());
    while let Ok(frame) = decoder.read_frame() {
        frames.push(frame.get_y_plane().to_vec());
    }
    (width, height, frames)
}

/// Calls `bench` with the first frame in which the face is tracked, and its landmarks.
fn with_face(bench: impl FnOnce(&Model<'_>, &Frame<'_>, &Shape)) {
    let (width, height, frames) = clip();
    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let mut tracker = Box::new(Tracker::new(&Config::default()).expect("defaults"));
    let layout = FrameLayout::grey(width as u32, height as u32);
    for (n, luma) in frames.iter().enumerate() {
        let frame = Frame::new(&layout, luma).expect("a frame");
        let result = tracker.step(&model, &frame, n as i64).expect("in order");
        if result.state == State::Tracking {
            return bench(&model, &frame, &result.landmarks.map(|l| [l.x, l.y]));
        }
    }
    panic!("no face is tracked in the demo clip");
}

/// A crop and both networks.
#[divan::bench(args = available())]
fn global_stage(bencher: Bencher<'_, '_>, kernel: KernelName) {
    select_kernel(kernel);
    with_face(|model, frame, shape| {
        let mut work = Box::new(Workspace::new());
        bencher.bench_local(|| {
            let mut shape = *shape;
            model.align().iterate(frame, &mut shape, &mut work)
        });
    });
}

/// Six crops, of the eyes, the mouth and the lids.
#[divan::bench(args = available())]
fn refiners(bencher: Bencher<'_, '_>, kernel: KernelName) {
    select_kernel(kernel);
    with_face(|model, frame, shape| {
        let mut work = Box::new(Workspace::new());
        bencher.bench_local(|| {
            let mut shape = *shape;
            model.align().refine(frame, &mut shape, &mut work)
        });
    });
}

/// The classifiers on the features of 68 landmarks.
#[divan::bench(args = available())]
fn verifier(bencher: Bencher<'_, '_>, kernel: KernelName) {
    select_kernel(kernel);
    with_face(|model, frame, shape| {
        let mut work = Box::new(Workspace::new());
        model.align().iterate(frame, &mut shape.clone(), &mut work);
        bencher.bench_local(|| model.verifier().evaluate(work.features(), work.view()));
    });
}
