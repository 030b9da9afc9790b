//! The stages that run networks, with each kernel of this machine: `cargo bench --bench kernels`.

mod clip;

use clip::clip;
use divan::Bencher;
use posewise::align::{Networks, Shape, Workspace};
use posewise::network::{KernelName, select_kernel};
use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};

fn main() {
    divan::main();
}

fn available() -> impl Iterator<Item = KernelName> {
    KernelName::ALL.into_iter().filter(|k| k.is_available())
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
            model
                .align()
                .iterate(frame, &mut shape, Networks::All, &mut work)
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
            model
                .align()
                .refine(frame, &mut shape, Networks::All, &mut work)
        });
    });
}

/// The classifiers on the features of 68 landmarks.
#[divan::bench(args = available())]
fn verifier(bencher: Bencher<'_, '_>, kernel: KernelName) {
    select_kernel(kernel);
    with_face(|model, frame, shape| {
        let mut work = Box::new(Workspace::new());
        model
            .align()
            .iterate(frame, &mut shape.clone(), Networks::All, &mut work);
        bencher.bench_local(|| model.verifier().evaluate(work.features(), work.view()));
    });
}
