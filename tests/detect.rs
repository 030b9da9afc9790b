//! The scan on a planted pattern: a tiny hand-made model, no training data.

use posewise::detect::{
    Detection, DetectorModel, GRID, Scan, ScanOutcome, Sizes, TAG, local_search,
};
use posewise::image::{Frame, FrameLayout, Rotation};
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
/// Each tree of depth 1 asks one question about it.
const QUESTIONS: [[usize; 4]; 6] = [
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
    // Scale ratio, step, window's side, margin, confirming strength.
    for value in [213u32, 31, 256, 64, 3] {
        w.scalar(value);
    }
    w.scalar(rolls.len() as u32).array(rolls);
    let n = QUESTIONS.len();
    // One ensemble: mirrored or not, depth, trees.
    w.scalar(1u32).scalar(mirrored as u32);
    w.scalar(1u32).scalar(n as u32);
    let pixels = QUESTIONS.as_flattened().as_chunks().0.iter();
    let pixels = pixels.map(|[column, row]| (row * GRID + column) as u16);
    w.array(&pixels.collect::<Vec<_>>());
    w.array(&[10u8; QUESTIONS.len()]);
    w.array([[-100i16, 100]; QUESTIONS.len()].as_flattened());
    w.array(&[1i32, 2, 3, 4, 5, 6].map(|tree| 100 * tree));
    // No refinement.
    w.scalar(0u32).scalar(1u32).scalar(0u32);
    w.array::<u8>(&[]).array::<u8>(&[]).array::<u8>(&[]);
    w.bytes().to_vec()
}

const SIDE: i32 = 160;

/// Uniform, with the pattern at (x, y), turned.
fn picture(x: f32, y: f32, size: f32, roll: f32) -> Vec<u8> {
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

fn sweep(model: &DetectorModel<'_>, frame: &Frame<'_>, budget: u32) -> Option<Detection> {
    let mut scan = Scan::new();
    for _ in 0..1_000_000 {
        match scan.advance(model, frame, Sizes::from(24), budget) {
            ScanOutcome::BudgetSpent => {}
            ScanOutcome::Candidate(found) => return Some(found),
            ScanOutcome::Finished => return None,
        }
    }
    panic!("a sweep ends");
}

/// All candidates that a whole sweep tells, as if a verifier refused each.
fn told(model: &DetectorModel<'_>, frame: &Frame<'_>) -> Vec<Detection> {
    let mut scan = Scan::new();
    let mut told = Vec::new();
    while let ScanOutcome::Candidate(found) = scan.advance(model, frame, Sizes::from(24), u32::MAX)
    {
        told.push(found);
        assert!(told.len() < 100, "each candidate is told once");
    }
    told
}

fn close(found: Option<Detection>, x: f32, y: f32, size: f32) {
    let d = found.expect("the pattern is found");
    let off = ((d.x - x).powi(2) + (d.y - y).powi(2)).sqrt();
    assert!(off < 0.2 * size, "{d:?}");
    assert!((0.7..1.4).contains(&(d.size / size)), "{d:?}");
    assert!(d.score >= 0.0, "{d:?}");
}

#[test]
fn finds_the_pattern_in_slices_of_any_length() {
    let pixels = picture(90.0, 70.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let blank = vec![90; pixels.len()];
    let blank = Frame::new(&layout(), &blank).unwrap();
    with_model(section(false, &[0]), |model| {
        let model = model.expect("a valid model");
        let whole = sweep(&model, &frame, u32::MAX);
        close(whole, 90.0, 70.0, 48.0);
        for budget in [0, 1, 7, 100, 1013] {
            close(sweep(&model, &frame, budget), 90.0, 70.0, 48.0);
        }
        // A slice that sees the whole frame is the whole sweep.
        assert_eq!(sweep(&model, &frame, 1_000_000), whole);
        assert_eq!(sweep(&model, &blank, 100), None);
    });
}

#[test]
fn rolls_and_mirrors_and_frame_layouts() {
    let turned = picture(80.0, 84.0, 60.0, 1.0);
    let frame = Frame::new(&layout(), &turned).unwrap();
    let upright = section(false, &[0]);
    let rolls = section(false, &[0, 10430, -10430]);
    let missed = with_model(upright.clone(), |model| {
        sweep(&model.unwrap(), &frame, u32::MAX)
    });
    with_model(rolls, |model| {
        // Upright candidates come first.
        let all = told(&model.unwrap(), &frame);
        let found = all.into_iter().find(|d| d.roll.abs() > 0.5);
        assert!(found.map(|d| d.score) > missed.map(|d| d.score));
        close(found, 80.0, 84.0, 60.0);
        assert!((found.unwrap().roll - 1.0).abs() < 0.15);
    });
    let pixels = picture(90.0, 70.0, 48.0, 0.0);
    let plain = Frame::new(&layout(), &pixels).unwrap();
    let mirror = FrameLayout {
        mirrored: true,
        ..layout()
    };
    let mirror = Frame::new(&mirror, &pixels).unwrap();
    with_model(upright.clone(), |model| {
        assert_eq!(sweep(&model.unwrap(), &mirror, 1000), None);
    });
    with_model(section(true, &[0]), |model| {
        let model = model.unwrap();
        let a = sweep(&model, &plain, 1000).expect("found");
        let b = sweep(&model, &mirror, 1000).expect("found mirrored");
        // Windows are centred on pixels: their mirror images lie up to one off.
        assert!((a.x + b.x - (SIDE - 1) as f32).abs() <= 0.5, "{a:?} {b:?}");
        assert!((a.y - b.y).abs() <= 0.125, "{a:?} {b:?}");
        assert!((a.size / b.size - 1.0).abs() < 0.005, "{a:?} {b:?}");
        assert!((a.score / b.score - 1.0).abs() < 0.02, "{a:?} {b:?}");
    });
    let half = FrameLayout {
        rotation: Rotation::Half,
        ..layout()
    };
    let reversed: Vec<u8> = pixels.iter().rev().copied().collect();
    let half = Frame::new(&half, &reversed).unwrap();
    with_model(upright.clone(), |model| {
        let model = model.unwrap();
        assert_eq!(sweep(&model, &half, 50), sweep(&model, &plain, 50));
    });
}

#[test]
fn what_moves_is_told_where_it_is() {
    with_model(section(false, &[0]), |model| {
        let model = model.unwrap();
        let mut scan = Scan::new();
        for slice in 0..40 {
            let x = 30.0 + 100.0 * (slice % 10) as f32 / 9.0;
            let pixels = picture(x, 70.0, 48.0, 0.0);
            let frame = Frame::new(&layout(), &pixels).unwrap();
            match scan.advance(&model, &frame, Sizes::from(24), 400) {
                ScanOutcome::BudgetSpent => {}
                ScanOutcome::Candidate(found) => return close(Some(found), x, 70.0, 48.0),
                ScanOutcome::Finished => panic!("missed"),
            }
        }
        panic!("a sweep ends");
    });
}

#[test]
fn searches_near_a_place_only() {
    let pixels = picture(90.0, 70.0, 48.0, 0.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(false, &[0]), |model| {
        let model = model.unwrap();
        let around = |x, y, size| Detection {
            x,
            y,
            size,
            ..Detection::default()
        };
        close(
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
fn broken_sections_are_refused_or_harmless() {
    let pixels = picture(90.0, 70.0, 48.0, 0.0);
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
