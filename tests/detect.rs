//! The scan finds a synthetic pattern with a small hand-written model.

use posewise::detect::{
    Detection, DetectorModel, GRID, Scan, ScanOutcome, Sizes, TAG, local_search,
};
use posewise::{Frame, FrameLayout, Roi, Rotation};
use posewise_format::{AlignedBytes, Blob, ModelError, SectionWriter, blob};

fn with_model<T>(
    section: Vec<u8>,
    run: impl FnOnce(Result<DetectorModel<'_>, ModelError>) -> T,
) -> T {
    let bytes = AlignedBytes::new(&blob(&[SectionWriter::of_bytes(TAG, section)]));
    let blob = Blob::open(&bytes).expect("a well-formed blob");
    run(blob.section(&TAG).and_then(DetectorModel::open))
}

/// The pattern: dark upper half with a bright left spot, in a bright-below square.
/// Each tree of depth 1 compares two of its pixels.
const COMPARISONS: [[usize; 4]; 6] = [
    // Column and row of two pixels of the grid: the first is brighter.
    [9, 29, 9, 4],
    [31, 29, 31, 4],
    [20, 29, 20, 4],
    [9, 14, 31, 14],
    [9, 14, 20, 14],
    [9, 29, 31, 14],
];

fn section(mirrored: bool, rolls: &[i16]) -> Vec<u8> {
    let mut w = SectionWriter::new(TAG);
    // Scale ratio, step, window's side, margin, confirmation strength.
    for value in [213u32, 31, 256, 64, 3] {
        w.scalar(value);
    }
    w.scalar(rolls.len() as u32).array(rolls);
    let n = COMPARISONS.len();
    // One ensemble: mirrored or not, depth, trees.
    w.scalar(1u32).scalar(mirrored as u32);
    w.scalar(1u32).scalar(n as u32);
    let pixels = COMPARISONS.as_flattened().as_chunks().0.iter();
    let pixels = pixels.map(|[column, row]| (row * GRID + column) as u16);
    w.array(&pixels.collect::<Vec<_>>());
    w.array(&[10u8; COMPARISONS.len()]);
    w.array([[-100i16, 100]; COMPARISONS.len()].as_flattened());
    w.array(&[1i32, 2, 3, 4, 5, 6].map(|tree| 100 * tree));
    // No refinement.
    w.scalar(0u32).scalar(1u32).scalar(0u32);
    w.array::<u8>(&[]).array::<u8>(&[]).array::<u8>(&[]);
    w.bytes().to_vec()
}

const SIDE: i32 = 160;

/// A uniform image with the pattern at (x, y), rotated clockwise by `roll` \[rad\].
fn image(x: f32, y: f32, size: f32, roll: f32) -> Vec<u8> {
    let (sin, cos) = roll.sin_cos();
    let pixel = |i: i32| {
        let (dx, dy) = ((i % SIDE) as f32 - x, (i / SIDE) as f32 - y);
        let (u, v) = ((cos * dx + sin * dy) / size, (cos * dy - sin * dx) / size);
        match (u, v) {
            _ if u.abs() > 0.5 || v.abs() > 0.5 => 90,
            _ if v > 0.0 => 200,
            _ if (u + 0.27).abs() < 0.13 && (v + 0.16).abs() < 0.13 => 150,
            _ => 30,
        }
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn layout() -> FrameLayout {
    FrameLayout::grey(SIDE as u32, SIDE as u32)
}

fn first_candidate(model: &DetectorModel<'_>, frame: &Frame<'_>, budget: u32) -> Option<Detection> {
    let mut scan = Scan::new();
    for _ in 0..1_000_000 {
        match scan.advance(model, frame, Sizes::from(24), budget) {
            ScanOutcome::BudgetSpent => {}
            ScanOutcome::Candidate(found) => return Some(found),
            ScanOutcome::Finished => return None,
        }
    }
    panic!("a scan ends");
}

/// All candidates that a scan reports if each is rejected.
fn all_candidates(model: &DetectorModel<'_>, frame: &Frame<'_>) -> Vec<Detection> {
    let mut scan = Scan::new();
    let mut candidates = Vec::new();
    while let ScanOutcome::Candidate(found) = scan.advance(model, frame, Sizes::from(24), u32::MAX)
    {
        candidates.push(found);
        assert!(candidates.len() < 100, "each candidate is reported once");
    }
    candidates
}

fn assert_close(found: Option<Detection>, x: f32, y: f32, size: f32) {
    let d = found.expect("the pattern is found");
    let off = ((d.x - x).powi(2) + (d.y - y).powi(2)).sqrt();
    assert!(off < 0.2 * size, "{d:?}");
    assert!((0.7..1.4).contains(&(d.size / size)), "{d:?}");
    assert!(d.score >= 0.0, "{d:?}");
}

/// Calls of 500 units until the pattern is reported or the scan ends.
fn calls_in(model: &DetectorModel<'_>, frame: &Frame<'_>, roi: Roi) -> (u32, Option<Detection>) {
    let (mut scan, mut calls) = (Scan::new(), 0);
    loop {
        calls += 1;
        match scan.advance_in(model, frame, roi, Sizes::from(24), 500) {
            ScanOutcome::BudgetSpent => {}
            ScanOutcome::Candidate(found) => return (calls, Some(found)),
            ScanOutcome::Finished => return (calls, None),
        }
    }
}

#[test]
fn only_the_region_is_scanned() {
    let pixels = image(120.0, 60.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(false, &[0]), |model| {
        let model = model.expect("a valid model");
        let around = Roi::new(112, 52, 16, 16);
        let (calls, found) = calls_in(&model, &frame, around);
        assert_close(found, 120.0, 60.0, 48.0);
        assert!(calls <= calls_in(&model, &frame, Roi::whole(&frame)).0);
        // One pixel, at a corner too, is a region.
        for roi in [Roi::new(20, 130, 30, 20), Roi::new(159, 159, 1, 1)] {
            let (calls, found) = calls_in(&model, &frame, roi);
            assert!(found.is_none() && calls <= 3, "{calls} {found:?}");
        }
        // Beyond the frame there is nothing, and no overflow.
        calls_in(&model, &frame, Roi::new(u32::MAX, 9, u32::MAX, 1));
    });
}

#[test]
fn finds_the_pattern_with_any_budget() {
    let pixels = image(90.0, 70.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let blank = vec![90; pixels.len()];
    let blank = Frame::new(&layout(), &blank).unwrap();
    with_model(section(false, &[0]), |model| {
        let model = model.expect("a valid model");
        let whole = first_candidate(&model, &frame, u32::MAX);
        assert_close(whole, 90.0, 70.0, 48.0);
        for budget in [0, 1, 7, 100, 1013] {
            assert_close(first_candidate(&model, &frame, budget), 90.0, 70.0, 48.0);
        }
        // A budget that covers the whole frame gives the same candidate as an unlimited one.
        assert_eq!(first_candidate(&model, &frame, 1_000_000), whole);
        assert_eq!(first_candidate(&model, &blank, 100), None);
    });
}

#[test]
fn rolls_mirrored_ensembles_and_frame_layouts() {
    let rotated = image(80.0, 84.0, 60.0, 1.0);
    let frame = Frame::new(&layout(), &rotated).unwrap();
    let upright = section(false, &[0]);
    let rolls = section(false, &[0, 10430, -10430]);
    let missed = with_model(upright.clone(), |model| {
        first_candidate(&model.unwrap(), &frame, u32::MAX)
    });
    with_model(rolls, |model| {
        // Upright candidates come first.
        let all = all_candidates(&model.unwrap(), &frame);
        let found = all.into_iter().find(|d| d.roll.abs() > 0.5);
        assert!(found.map(|d| d.score) > missed.map(|d| d.score));
        assert_close(found, 80.0, 84.0, 60.0);
        assert!((found.unwrap().roll - 1.0).abs() < 0.15);
    });
    let pixels = image(90.0, 70.0, 48.0, 0.0);
    let plain = Frame::new(&layout(), &pixels).unwrap();
    let mut mirror = layout();
    mirror.mirrored = true;
    let mirror = Frame::new(&mirror, &pixels).unwrap();
    with_model(upright.clone(), |model| {
        assert_eq!(first_candidate(&model.unwrap(), &mirror, 1000), None);
    });
    with_model(section(true, &[0]), |model| {
        let model = model.unwrap();
        let a = first_candidate(&model, &plain, 1000).expect("found");
        let b = first_candidate(&model, &mirror, 1000).expect("found mirrored");
        // Windows are centred on pixels: their mirror images lie up to one off.
        assert!((a.x + b.x - (SIDE - 1) as f32).abs() <= 1.0, "{a:?} {b:?}");
        assert!((a.y - b.y).abs() <= 0.125, "{a:?} {b:?}");
        assert!((a.size / b.size - 1.0).abs() < 0.005, "{a:?} {b:?}");
        // One hit of some twenty more or less.
        assert!((a.score / b.score - 1.0).abs() < 0.05, "{a:?} {b:?}");
    });
    let mut half = layout();
    half.rotation = Rotation::Half;
    let reversed: Vec<u8> = pixels.iter().rev().copied().collect();
    let half = Frame::new(&half, &reversed).unwrap();
    with_model(upright.clone(), |model| {
        let model = model.unwrap();
        assert_eq!(
            first_candidate(&model, &half, 50),
            first_candidate(&model, &plain, 50)
        );
    });
}

#[test]
fn a_moving_pattern_is_reported_where_it_is() {
    with_model(section(false, &[0]), |model| {
        let model = model.unwrap();
        let mut scan = Scan::new();
        for call in 0..40 {
            let x = 30.0 + 100.0 * (call % 10) as f32 / 9.0;
            let pixels = image(x, 70.0, 48.0, 0.0);
            let frame = Frame::new(&layout(), &pixels).unwrap();
            match scan.advance(&model, &frame, Sizes::from(24), 400) {
                ScanOutcome::BudgetSpent => {}
                ScanOutcome::Candidate(found) => return assert_close(Some(found), x, 70.0, 48.0),
                ScanOutcome::Finished => panic!("missed"),
            }
        }
        panic!("a scan ends");
    });
}

#[test]
fn local_search_stays_near_the_expected_place() {
    let pixels = image(90.0, 70.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(false, &[0]), |model| {
        let model = model.unwrap();
        let around = |x, y, size| Detection {
            x,
            y,
            size,
            ..Detection::default()
        };
        assert_close(
            local_search(&model, &frame, &around(96.0, 64.0, 52.0), 3000),
            90.0,
            70.0,
            48.0,
        );
        assert_eq!(
            local_search(&model, &frame, &around(30.0, 130.0, 52.0), 3000),
            None
        );
        assert_eq!(
            local_search(&model, &frame, &around(96.0, 64.0, 52.0), 0),
            None
        );
        for bad in [f32::NAN, f32::INFINITY, -1.0, 0.0, 1e30] {
            assert_eq!(
                local_search(&model, &frame, &around(bad, bad, bad), 3000),
                None
            );
            local_search(&model, &frame, &around(bad, 70.0, 48.0), 3000);
        }
    });
}

#[test]
fn broken_sections_are_rejected_or_harmless() {
    let pixels = image(90.0, 70.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let good = section(true, &[0, 5461]);
    for len in 0..good.len() {
        with_model(good[..len].to_vec(), |model| {
            // Only the trailing empty arrays and padding may be cut unnoticed.
            assert!(model.is_err() || len + 32 > good.len(), "cut to {len}");
        });
    }
    for bit in 0..good.len() * 8 {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        with_model(bad, |model| {
            if let Ok(model) = model {
                Scan::new().advance(&model, &frame, Sizes::from(40), 300);
            }
        });
    }
    assert!(size_of::<Scan>() <= 4096);
}
