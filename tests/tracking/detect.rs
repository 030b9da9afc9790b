//! The scan finds a bright square with a small hand-written network.

use posewise::detect::{
    Detection, DetectorModel, Scan, ScanBudget, ScanOutcome, Sizes, TAG, TILE_UNITS, TileMemory,
    local_search,
};
use posewise::image::Crop;
use posewise::network::{
    Activations, KernelName, OP_CONV, OP_INPUT, OP_LINEAR, chosen_kernel, select_kernel,
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

/// Crop and maps of a tile.
struct Memory {
    crop: Box<Crop>,
    maps: Box<Activations>,
}

impl Memory {
    fn new() -> Memory {
        Memory {
            crop: Box::new(Crop::new()),
            maps: Box::new(Activations::new()),
        }
    }

    fn tile(&mut self) -> TileMemory<'_> {
        TileMemory {
            crop: &mut self.crop,
            maps: &mut self.maps,
        }
    }
}

/// The work of a tile.
const ONE_TILE: ScanBudget = ScanBudget::of_tiles(TILE_UNITS);
/// Channels of the maps: those that kernels compute together.
const CHANNELS: usize = 8;
/// Size of a face over the side of the bright square.
const FACE: f32 = 1.5;
/// Sizes of faces in a tile, and the middle one, which all cells report \[tile px\].
const SIZES: [u32; 2] = [20, 47];
const MIDDLE: f32 = 30.0;

/// A network whose maps are means of 3×3 values, three times over, each half as large. A cell's
/// score is how bright its neighbourhood of 15 px is; the other outputs are 0.
fn section() -> Vec<u8> {
    let mut w = SectionWriter::new(TAG);
    w.scalar(256 * SIZES[0]).scalar(256 * SIZES[1]);
    // Overlap; a score of 0 is a hit.
    w.scalar(32u32).scalar(128u32);
    w.array(&[0.1f32, 0.1, 0.1, 0.01, 0.01, 0.01]);
    w.scalar(MIDDLE);
    w.scalar(5u32);
    let places = [0, 16_384, 49_152, 57_344, 59_392];
    //  op, kernel, stride, input, other, channels, at, zero point, shifts before and after
    for value in [u32::from(OP_INPUT), 1, 1, 0, 0, 1, 0, 0, 0, 1] {
        w.scalar(value);
    }
    w.array::<u8>(&[]).array::<u8>(&[]).array::<u8>(&[]);
    // One input channel has nine weights and a tenth of 0.
    for (k, (columns, weight, multiplier)) in [(10, 14, 260), (72, 1, 455), (72, 1, 455)]
        .into_iter()
        .enumerate()
    {
        let zero = if k == 0 { 128 } else { 0 };
        let place = places[k + 1];
        for value in [u32::from(OP_CONV), 3, 2, k as u32, 0, 8, place, zero, 0, 15] {
            w.scalar(value);
        }
        let weights: Vec<i8> = (0..columns * CHANNELS)
            .map(|at| {
                let column = at / (2 * CHANNELS) * 2 + at % 2;
                if column < 9 || k > 0 { weight } else { 0 }
            })
            .collect();
        w.array(&weights)
            .array(&[0i32; CHANNELS])
            .array(&[multiplier; CHANNELS]);
    }
    for value in [u32::from(OP_LINEAR), 1, 1, 3, 0, 8, places[4], 0, 0, 15] {
        w.scalar(value);
    }
    let score: Vec<i8> = (0..64).map(|at| i8::from(at / 2 % CHANNELS == 0)).collect();
    // A neighbourhood of 15 px must be nearly full.
    let mut bias = [0i32; CHANNELS];
    bias[0] = -8 * 110;
    w.array(&score).array(&bias).array(&[4096i32; CHANNELS]);
    w.bytes().to_vec()
}

const SIDE: i32 = 160;

/// A uniform image with the square at (x, y).
fn image(x: f32, y: f32, side: f32) -> Vec<u8> {
    let pixel = |i: i32| {
        let (dx, dy) = ((i % SIDE) as f32 - x, (i / SIDE) as f32 - y);
        if dx.abs().max(dy.abs()) < side / 2.0 {
            200
        } else {
            90
        }
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn layout() -> FrameLayout {
    FrameLayout::grey(SIDE as u32, SIDE as u32)
}

fn first_candidate(model: &DetectorModel<'_>, frame: &Frame<'_>, budget: u32) -> Option<Detection> {
    let (mut scan, mut memory) = (Scan::new(), Memory::new());
    for _ in 0..1_000 {
        let budget = ScanBudget::of_tiles(budget);
        match scan.advance(model, frame, Sizes::from(24), budget, &mut memory.tile()) {
            ScanOutcome::BudgetSpent => {}
            ScanOutcome::Candidate(found) => return Some(found),
            ScanOutcome::Finished => return None,
        }
    }
    panic!("a scan ends");
}

/// All candidates that a scan reports if each is rejected.
fn all_candidates(model: &DetectorModel<'_>, frame: &Frame<'_>) -> Vec<Detection> {
    let (mut scan, mut memory) = (Scan::new(), Memory::new());
    let mut candidates = Vec::new();
    let all = ScanBudget::of_tiles(u32::MAX);
    while let ScanOutcome::Candidate(found) =
        scan.advance(model, frame, Sizes::from(24), all, &mut memory.tile())
    {
        candidates.push(found);
        assert!(candidates.len() < 100, "each candidate is reported once");
    }
    candidates
}

fn assert_close(found: Option<Detection>, x: f32, y: f32, side: f32) {
    let d = found.expect("the square is found");
    let off = ((d.x - x).powi(2) + (d.y - y).powi(2)).sqrt();
    assert!(off < 0.25 * d.size, "{d:?}");
    assert!((0.6..1.7).contains(&(d.size / (FACE * side))), "{d:?}");
    assert!(d.score >= 0.0, "{d:?}");
}

/// Calls of one tile each until the square is reported or the scan ends.
fn calls_in(model: &DetectorModel<'_>, frame: &Frame<'_>, roi: Roi) -> (u32, Option<Detection>) {
    let (mut scan, mut memory, mut calls) = (Scan::new(), Memory::new(), 0);
    loop {
        calls += 1;
        let memory = &mut memory.tile();
        match scan.advance_in(model, frame, roi, Sizes::from(24), ONE_TILE, memory) {
            ScanOutcome::BudgetSpent => {}
            ScanOutcome::Candidate(found) => return (calls, Some(found)),
            ScanOutcome::Finished => return (calls, None),
        }
    }
}

#[test]
fn only_the_region_is_scanned() {
    let pixels = image(120.0, 60.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let around = Roi::new(104, 44, 32, 32);
        let (calls, found) = calls_in(&model, &frame, around);
        assert_close(found, 120.0, 60.0, 48.0);
        assert!(calls <= calls_in(&model, &frame, Roi::whole(&frame)).0);
        // One pixel, at a corner too, is a region.
        for roi in [Roi::new(10, 130, 10, 20), Roi::new(159, 159, 1, 1)] {
            let (calls, found) = calls_in(&model, &frame, roi);
            assert!(found.is_none() && calls <= 5, "{calls} {found:?}");
        }
        // Beyond the frame there is nothing, and no overflow.
        calls_in(&model, &frame, Roi::new(u32::MAX, 9, u32::MAX, 1));
    });
}

#[test]
fn finds_the_square_with_any_budget() {
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let blank = vec![90; pixels.len()];
    let blank = Frame::new(&layout(), &blank).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let whole = first_candidate(&model, &frame, u32::MAX);
        assert_close(whole, 90.0, 70.0, 48.0);
        for budget in [0, 1, 100, TILE_UNITS, 1013] {
            assert_eq!(first_candidate(&model, &frame, budget), whole);
        }
        assert_eq!(first_candidate(&model, &blank, 100), None);
    });
}

#[test]
fn a_call_evaluates_the_tiles_of_its_budget() {
    let blank = vec![90; 1920 * 1080];
    let frame = Frame::new(&FrameLayout::grey(1920, 1080), &blank).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let calls = |budget: u32| {
            let (mut scan, mut memory, mut calls) = (Scan::new(), Memory::new(), 1);
            let sizes = Sizes::from(60);
            let budget = ScanBudget::of_tiles(budget);
            while scan.advance(&model, &frame, sizes, budget, &mut memory.tile())
                == ScanOutcome::BudgetSpent
            {
                calls += 1;
            }
            calls
        };
        // Levels of 640×360, 320×180, 160×90, 80×45 and 40×22 px.
        let tiles = 7 * 4 + 3 * 2 + 2 + 1 + 1;
        assert_eq!(calls(TILE_UNITS), tiles + 1);
        assert_eq!(calls(3 * TILE_UNITS + 1), tiles / 3 + 1);
        assert_eq!(calls(u32::MAX), 1);
    });
}

#[test]
fn each_scan_looks_at_other_sizes() {
    let blank = vec![90; 1920 * 1080];
    let frame = Frame::new(&FrameLayout::grey(1920, 1080), &blank).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let (mut scan, mut memory) = (Scan::new(), Memory::new());
        let mut tiles = |scan: &mut Scan| {
            let (mut tiles, budget) = (0, ScanBudget::of_tiles(TILE_UNITS));
            let sizes = Sizes::from(60);
            while scan.advance(&model, &frame, sizes, budget, &mut memory.tile())
                == ScanOutcome::BudgetSpent
            {
                tiles += 1;
            }
            tiles
        };
        let of_scans: [u32; 10] = core::array::from_fn(|_| tiles(&mut scan));
        let [first, second, third, .., again, _] = of_scans;
        assert!(second < first && first < third, "{of_scans:?}");
        assert_eq!(first, again);
        scan.restart();
        assert_eq!(tiles(&mut scan), first);
    });
}

#[test]
fn candidates_wait_for_their_budget() {
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let (mut scan, mut memory) = (Scan::new(), Memory::new());
        let mut advance = |units: u32, candidate: u32| {
            let budget = ScanBudget {
                units,
                candidate,
                clear: false,
                looks: false,
            };
            let outcome = scan.advance(&model, &frame, Sizes::from(24), budget, &mut memory.tile());
            (outcome, scan.units_left())
        };
        // All tiles are evaluated, but the scan does not end.
        let many = 100 * TILE_UNITS;
        let (outcome, left) = advance(many, many);
        assert_eq!(outcome, ScanOutcome::BudgetSpent);
        assert!(left < many);
        assert_eq!(advance(many, many + 1), (ScanOutcome::BudgetSpent, many));
        let (outcome, left) = advance(2000, 1900);
        let ScanOutcome::Candidate(found) = outcome else {
            panic!("a candidate");
        };
        assert_close(Some(found), 90.0, 70.0, 48.0);
        assert_eq!(left, 2000);
    });
}

#[test]
fn a_higher_threshold_leaves_less() {
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(), |model| {
        let model = model.expect("a valid model");
        let score = first_candidate(&model, &frame, u32::MAX).unwrap().score;
        let probability = |logit: f32| 1.0 / (1.0 + (-logit).exp());
        for (logit, found) in [(score - 0.2, true), (score + 0.2, false)] {
            let model = model.clone().with_threshold(probability(logit));
            let candidate = first_candidate(&model, &frame, u32::MAX);
            assert_eq!(candidate.is_some(), found, "{logit} {score}");
        }
    });
}

#[test]
fn sizes_are_kept() {
    let pixels = image(80.0, 80.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(), |model| {
        let model = model.unwrap();
        let mut memory = Memory::new();
        let mut find = |min_px: i32, max_px: i32| {
            let sizes = Sizes { min_px, max_px };
            let all = ScanBudget::of_tiles(u32::MAX);
            Scan::new().advance(&model, &frame, sizes, all, &mut memory.tile())
        };
        assert!(matches!(find(60, 90), ScanOutcome::Candidate(_)));
        assert_eq!(find(140, 200), ScanOutcome::Finished);
    });
}

#[test]
fn frame_layouts_and_kernels_give_the_same() {
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let mut half = layout();
    half.rotation = Rotation::Half;
    let reversed: Vec<u8> = pixels.iter().rev().copied().collect();
    let half = Frame::new(&half, &reversed).unwrap();
    with_model(section(), |model| {
        let model = model.unwrap();
        let expected = all_candidates(&model, &frame);
        assert!(!expected.is_empty());
        assert_eq!(all_candidates(&model, &half), expected);
        let before = chosen_kernel();
        for kernel in KernelName::ALL.into_iter().filter(|k| k.is_available()) {
            assert!(select_kernel(kernel));
            assert_eq!(all_candidates(&model, &frame), expected, "{kernel:?}");
        }
        select_kernel(before);
    });
}

#[test]
fn a_moving_square_is_reported_where_it_is() {
    with_model(section(), |model| {
        let model = model.unwrap();
        let (mut scan, mut memory) = (Scan::new(), Memory::new());
        for call in 0..40 {
            let x = 40.0 + 80.0 * (call % 10) as f32 / 9.0;
            let pixels = image(x, 70.0, 48.0);
            let frame = Frame::new(&layout(), &pixels).unwrap();
            let (sizes, memory) = (Sizes::from(24), &mut memory.tile());
            match scan.advance(&model, &frame, sizes, ONE_TILE, memory) {
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
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    with_model(section(), |model| {
        let model = model.unwrap();
        let mut memory = Memory::new();
        let mut search = |x: f32, y: f32, size: f32, roll: f32| {
            let expected = Detection {
                x,
                y,
                size,
                roll,
                ..Detection::default()
            };
            local_search(&model, &frame, &expected, &mut memory.tile())
        };
        for roll in [0.0, 1.2, -3.0] {
            let found = search(96.0, 64.0, 72.0, roll);
            assert_close(found, 90.0, 70.0, 48.0);
            assert!(found.is_some_and(|f| (f.roll - roll).abs() < 0.01));
        }
        assert_eq!(search(20.0, 140.0, 72.0, 0.0), None);
        for bad in [f32::NAN, f32::INFINITY, -1.0, 0.0, 1e30] {
            assert_eq!(search(bad, bad, bad, bad), None);
            search(bad, 70.0, 48.0, 0.0);
            search(90.0, 70.0, 72.0, bad);
        }
    });
}

#[test]
fn broken_sections_are_rejected_or_harmless() {
    let pixels = image(90.0, 70.0, 48.0);
    let frame = Frame::new(&layout(), &pixels).unwrap();
    let good = section();
    for len in 0..good.len() {
        with_model(good[..len].to_vec(), |model| {
            assert!(model.is_err(), "cut to {len}")
        });
    }
    let mut memory = Memory::new();
    for bit in 0..good.len() * 8 {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        with_model(bad, |model| {
            if let Ok(model) = model {
                let memory = &mut memory.tile();
                Scan::new().advance(&model, &frame, Sizes::from(60), ONE_TILE, memory);
            }
        });
    }
    assert!(size_of::<Scan>() <= 1600);
}
