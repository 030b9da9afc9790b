//! Time of the parts of a step: each module's work on one frame of the clip, by itself.

use std::hint::black_box;
use std::time::Instant;

use anyhow::{Context, Result, anyhow};
use image::GrayImage;
use posewise::align::{Networks, Shape, Workspace};
use posewise::detect::{Scan, ScanBudget, Sizes, TILE_UNITS, TileMemory};
use posewise::image::Frame;
use posewise::mesh::{MAX_VERTICES, MeshSpace, MeshVertex};
use posewise::shape::{FitOptions, Identity, Intrinsics, MAX_IDENTITIES, Observed, fit};
use posewise::track::{Config, Model, State, Tracker};
use posewise_cli::picture::Picture;

/// Repetitions of each part.
const ROUNDS: usize = 300;

/// One part of a step.
pub struct Stage {
    pub name: &'static str,
    /// Median time \[ns\].
    pub ns: u64,
    /// Multiply-adds of its networks; 0 without any.
    pub multiply_adds: usize,
    /// Whether each tracking step does it; the scan is of searching steps, the mesh of calls.
    pub of_tracking: bool,
}

/// Times every part on the first frame of the clip in which the face is tracked.
pub fn time(model: &Model<'_>, frames: &[GrayImage]) -> Result<Vec<Stage>> {
    let (picture, tracker) = tracked(model, frames)?;
    let shape: Shape = tracker.result().landmarks.map(|l| [l.x, l.y]);
    let frame = picture.frame()?;
    let align = model.align();
    let mut work = Box::new(Workspace::new());
    let stage = |name, ns, multiply_adds| Stage {
        name,
        ns,
        multiply_adds,
        of_tracking: true,
    };
    let global = median(|| {
        let mut shape = shape;
        black_box(align.iterate(&frame, &mut shape, Networks::All, &mut work));
    });
    let verifier = median(|| {
        black_box(model.verifier().evaluate(work.features(), work.view()));
    });
    let refiners = median(|| {
        let mut shape = shape;
        black_box(align.refine(&frame, &mut shape, Networks::All, &mut work));
    });
    let tile = time_tile(model, &frame, &mut work);
    let fit = time_fit(model, &frame, &shape)?;
    let mut vertices = [MeshVertex::default(); MAX_VERTICES];
    let mesh = median(|| {
        let _ = black_box(tracker.mesh(model, MeshSpace::Picture, &mut vertices));
    });
    let apart = |name, ns, multiply_adds| Stage {
        of_tracking: false,
        ..stage(name, ns, multiply_adds)
    };
    Ok(vec![
        stage("global stage", global, align.iteration_multiply_adds()),
        stage("verifier", verifier, 0),
        stage("refiners", refiners, align.refiner_multiply_adds()),
        stage("3D fit", fit, 0),
        apart("tile", tile, model.detector().multiply_adds()),
        apart("mesh", mesh, 0),
    ])
}

fn tracked(model: &Model<'_>, frames: &[GrayImage]) -> Result<(Picture, Box<Tracker>)> {
    let mut tracker = Box::new(Tracker::new(&Config::default()).map_err(|e| anyhow!("{e}"))?);
    for (i, image) in frames.iter().enumerate() {
        let picture = Picture::from_grey(image.clone());
        let frame = picture.frame()?;
        let result = tracker
            .step(model, &frame, i as i64)
            .map_err(|e| anyhow!("{e}"))?;
        if result.state == State::Tracking {
            return Ok((picture, tracker));
        }
    }
    Err(anyhow!(
        "no face is tracked in the clip, so no stage can be timed"
    ))
}

fn time_fit(model: &Model<'_>, frame: &Frame<'_>, shape: &Shape) -> Result<u64> {
    let camera = Intrinsics::of_frame(frame.width(), frame.height());
    let observed = Observed {
        points: shape,
        weights: &[1.0; 68],
    };
    let identity: Identity = [0.0; MAX_IDENTITIES];
    let options = FitOptions::default();
    let first = fit(model.face(), &camera, &observed, None, &identity, &options);
    let start = first.context("no pose explains the landmarks")?.state;
    Ok(median(|| {
        black_box(fit(
            model.face(),
            &camera,
            &observed,
            Some(&start),
            &identity,
            &options,
        ));
    }))
}

/// One tile after the other; the few calls that report a candidate do no work.
fn time_tile(model: &Model<'_>, frame: &Frame<'_>, work: &mut Workspace) -> u64 {
    let sizes = Sizes::from(Config::default().min_face_px as i32);
    let mut scan = Scan::new();
    let (crop, maps) = work.network_memory();
    let memory = &mut TileMemory { crop, maps };
    let budget = ScanBudget::of_tiles(TILE_UNITS);
    median(|| {
        black_box(scan.advance(model.detector(), frame, sizes, budget, memory));
    })
}

fn median(mut part: impl FnMut()) -> u64 {
    let mut ns: Vec<u64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            part();
            start.elapsed().as_nanos() as u64
        })
        .collect();
    ns.sort_unstable();
    ns.get(ROUNDS / 2).copied().unwrap_or(0)
}
