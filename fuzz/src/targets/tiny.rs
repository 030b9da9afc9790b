//! A model of 45 KB that detects faces almost everywhere: every stage of a step runs on any image,
//! a hundred times as often as with a trained model.

use super::memory::Exact;
use posewise::align::{GEOMETRY, GLOBAL, SHAPE_INDEXED, WEIGHT_OUTPUTS};
use posewise::detect::TILE;
use posewise::network::{OP_CONV, OP_INPUT, OP_LINEAR};
use posewise::shape::{ANIMATIONS, FITTED, JAW, LANDMARKS, VIEW_BYTES};
use posewise_format::{ALIGN, HEADER_LEN, SectionWriter, Tag, Value, blob, reseal};
use std::sync::OnceLock;

/// Number of sections of the model.
pub const SECTIONS: usize = 8;

const SIDE: usize = 16;
const CHANNELS: usize = 8;
const RANK: usize = 2;

static MODEL: OnceLock<(Exact, Vec<u8>)> = OnceLock::new();

/// The model, built once.
pub fn model() -> &'static Exact {
    let make = || {
        let blob = build();
        (Exact::of(&blob, ALIGN), blob)
    };
    &MODEL.get_or_init(make).0
}

/// Whether the model is as it was built.
pub fn is_whole() -> bool {
    MODEL.get().is_none_or(|(model, blob)| model.get() == blob)
}

fn build() -> Vec<u8> {
    let sections = [
        face(),
        detector(),
        cascade(),
        ensemble_member(),
        refiners(),
        shape_regression(),
        weights(),
        verifier(),
    ];
    assert_eq!(sections.len(), SECTIONS);
    blob(&sections.map(|w| w.0))
}

/// Corrects the checksum, and the stated length where `length` is set.
pub fn repair(blob: &mut [u8], length: bool) {
    let len = blob.len() as u32;
    if length && blob.len() >= HEADER_LEN {
        blob[12..16].copy_from_slice(&len.to_le_bytes());
    }
    reseal(blob);
}

/// A section being written, with shorter names for the many numbers below.
struct Writer(SectionWriter);

impl Writer {
    fn new(tag: &Tag) -> Self {
        Writer(SectionWriter::new(*tag))
    }

    fn u32(&mut self, value: usize) {
        self.0.scalar(value as u32);
    }

    fn f32(&mut self, value: f32) {
        self.0.scalar(value);
    }

    fn array<T: Value>(&mut self, values: &[T]) {
        self.0.array(values);
    }

    fn i8s(&mut self, len: usize, value: impl Fn(usize) -> i32) {
        self.array(&(0..len).map(|i| value(i) as i8).collect::<Vec<_>>());
    }
}

/// Pseudo-random numbers in −`reach`..=`reach`.
fn noise(index: usize, reach: i32) -> i32 {
    (index as u32 + 1).wrapping_mul(2_654_435_761) as i32 % (reach + 1)
}

/// 68 points on an ellipsoid's front: a jaw, then rows from the brows to the lips \[mm\].
fn points() -> [[f32; 3]; LANDMARKS] {
    std::array::from_fn(|i| {
        let (x, y) = match i.checked_sub(JAW) {
            None => {
                let angle = std::f32::consts::PI * i as f32 / (JAW - 1) as f32;
                (-70.0 * angle.cos(), 90.0 * angle.sin())
            }
            Some(inner) => {
                let (row, column) = (inner / 10, inner % 10);
                (column as f32 * 9.0 - 40.5, row as f32 * 18.0 - 30.0)
            }
        };
        let depth = (1.0 - (x / 80.0f32).powi(2) - (y / 120.0f32).powi(2)).max(0.0);
        [x, y, 40.0 - 80.0 * depth.sqrt()]
    })
}

/// A sheet of vertices after the landmarks, as section `MESH`, which [`model`] lacks.
pub fn mesh() -> SectionWriter {
    const VERTICES: usize = 84;
    let mut w = Writer::new(b"MESH");
    let listed = LANDMARKS + 7 * 3;
    let blocks = VERTICES.div_ceil(8);
    // Every other mode moves each block.
    let moved = vec![0x55u8; blocks * (1 + ANIMATIONS).div_ceil(8)];
    let runs = 4 * moved.len();
    for value in [VERTICES, 1, VERTICES - 2, listed, runs] {
        w.u32(value);
    }
    let mut mean = points().to_vec();
    mean.extend((LANDMARKS..VERTICES).map(|i| [i as f32 - 70.0, -60.0, 20.0]));
    w.array(mean.as_flattened());
    w.array(&[0.02f32]);
    w.array(&[0.1f32; ANIMATIONS]);
    w.array(&moved);
    w.i8s(runs * 24, |i| noise(i, 60));
    w.array(
        &(0..6 * VERTICES)
            .map(|i| (i % LANDMARKS) as u8)
            .collect::<Vec<_>>(),
    );
    w.i8s(6 * VERTICES, |i| noise(i, 64));
    let index = |i: usize| (i % VERTICES) as u16;
    w.array(
        &(0..4 * VERTICES)
            .map(|i| index(i / 4 + i % 4))
            .collect::<Vec<_>>(),
    );
    let corner = |i: usize| index(i / 3 + i % 3);
    w.array(&(0..3 * (VERTICES - 2)).map(corner).collect::<Vec<_>>());
    w.array(&vec![0.5f32; 2 * VERTICES]);
    let mut lengths = [3u16; 8];
    lengths[0] = LANDMARKS as u16;
    w.array(&lengths);
    w.array(&(0..listed).map(index).collect::<Vec<_>>());
    w.0
}

fn face() -> Writer {
    let mut w = Writer::new(b"FACE");
    w.u32(LANDMARKS);
    w.u32(1);
    w.array(&[0u8; JAW]);
    w.array(points().as_flattened());
    w.array(&[0.02]);
    w.i8s(LANDMARKS * 3, |i| noise(i, 100));
    w.array(&[0.1; FITTED]);
    w.i8s(LANDMARKS * FITTED * 3, |i| noise(i, 60));
    let outward: [[f32; 2]; JAW] = std::array::from_fn(|i| {
        let angle = std::f32::consts::PI * i as f32 / (JAW - 1) as f32;
        [-angle.cos(), angle.sin()]
    });
    w.array(outward.as_flattened());
    w.array(&[2.0; LANDMARKS]);
    w.array(&[0.5; FITTED]);
    w.array(&[0x55u8; LANDMARKS * VIEW_BYTES]);
    w
}

/// Three layers and outputs of which nearly all are a hit.
fn detector() -> Writer {
    let mut w = Writer::new(b"DTCT");
    // Smallest and largest face [1/256 px], overlap, least score.
    for value in [24 << 8, 50 << 8, 16, 100] {
        w.u32(value);
    }
    w.array(&[0.1f32, 0.1, 0.1, 0.01, 0.01, 0.01]);
    w.f32(34.0);
    w.u32(5);
    node(&mut w, [OP_INPUT as usize, 1, 1, 0, 0, 1, 0, 0, 0, 1], 0);
    let sides = [64, 32, 16];
    let mut at = TILE * TILE;
    for (k, side) in sides.into_iter().enumerate() {
        let (zero, columns) = if k == 0 { (128, 10) } else { (0, 9 * CHANNELS) };
        let op = OP_CONV as usize;
        node(&mut w, [op, 3, 2, k, 0, CHANNELS, at, zero, 0, 14], columns);
        at += side * side * CHANNELS;
    }
    node(
        &mut w,
        [OP_LINEAR as usize, 1, 1, 3, 0, CHANNELS, at, 0, 0, 14],
        CHANNELS,
    );
    w
}

/// A node with this number of weights for each output.
//  op, kernel, stride, input, other, channels, at, zero_point, pre_shift, post_shift
fn node(w: &mut Writer, numbers: [usize; 10], columns: usize) {
    numbers.into_iter().for_each(|value| w.u32(value));
    let channels = if columns == 0 { 0 } else { CHANNELS };
    w.i8s(columns * channels, |i| noise(i, 40));
    w.array(&vec![900i32; channels]);
    w.array(&vec![600i32; channels]);
}

fn cascade() -> Writer {
    let mut w = Writer::new(b"ALGN");
    w.u32(2); // views
    w.u32(2); // iterations
    let mean = points().map(|[x, y, _]| [x, y]);
    let rotated = points().map(|[x, y, z]| [0.8 * x - 0.6 * z, y]);
    w.array(mean.as_flattened());
    w.array([mean, rotated].as_flattened().as_flattened());
    w.array(&[0.0, 1.0]);
    regressor(&mut w, LANDMARKS, &[GLOBAL, SHAPE_INDEXED]);
    w
}

fn ensemble_member() -> Writer {
    let mut w = Writer::new(b"ENSM");
    regressor(&mut w, LANDMARKS, &[GLOBAL, SHAPE_INDEXED]);
    w
}

fn refiners() -> Writer {
    let mut w = Writer::new(b"RFIN");
    w.u32(2);
    for (mirrored, landmarks) in [(1, 36..42), (0, 48..68)] {
        w.u32(landmarks.len());
        w.u32(mirrored);
        w.array(&landmarks.clone().collect::<Vec<u32>>());
        regressor(&mut w, landmarks.len(), &[GLOBAL | SHAPE_INDEXED]);
    }
    w
}

fn shape_regression() -> Writer {
    let mut w = Writer::new(b"SREG");
    w.i8s((2 * LANDMARKS).pow(2), |i| noise(i, 20));
    w.array(&[1e-4; 2 * LANDMARKS]);
    w.array(&[0.1; 2 * LANDMARKS]);
    w
}

/// What is taken of both refiners, and a network with three hidden values.
fn weights() -> Writer {
    const TAKEN: [usize; 3] = [2, 3, 0];
    const HIDDEN: usize = 3;
    let mut w = Writer::new(b"WGHT");
    let coarse = (SIDE / 4) * (SIDE / 4) * CHANNELS;
    for (taken, points) in TAKEN.into_iter().zip([6, 20, 0]) {
        w.u32(taken);
        w.u32(coarse + points * CHANNELS);
        if taken > 0 {
            w.i8s(taken * (coarse + points * CHANNELS), |i| noise(i, 30));
            w.array(&vec![1e-4f32; taken]);
        }
    }
    let inputs = GEOMETRY + 2 * TAKEN.iter().sum::<usize>();
    w.u32(HIDDEN);
    w.array(&vec![0.1f32; inputs]);
    w.array(&vec![0.5f32; inputs]);
    w.i8s(HIDDEN * inputs, |i| noise(i, 50));
    w.array(&[1e-2f32; HIDDEN]);
    w.array(&[0.1f32; HIDDEN]);
    w.array(&[0.2f32; HIDDEN * WEIGHT_OUTPUTS]);
    w.i8s(WEIGHT_OUTPUTS * inputs, |i| noise(i + 3, 50));
    w.array(&[1e-3f32; WEIGHT_OUTPUTS]);
    w.array(&[0.2f32; WEIGHT_OUTPUTS]);
    w
}

/// A network of two layers, and one head for each of these sources.
fn regressor(w: &mut Writer, points: usize, sources: &[u32]) {
    w.u32(SIDE);
    w.f32(0.08); // crop px per unit
    w.u32(1); // fine map
    w.u32(2); // coarse map
    w.u32(sources.len());
    w.u32(RANK);
    let fine_at = SIDE * SIDE;
    let coarse_at = fine_at + (SIDE / 2) * (SIDE / 2) * CHANNELS;
    w.u32(3);
    node(w, [OP_INPUT as usize, 1, 1, 0, 0, 1, 0, 0, 0, 1], 0);
    for (input, at, columns) in [(0, fine_at, 10), (1, coarse_at, 9 * CHANNELS)] {
        let op = OP_CONV as usize;
        node(w, [op, 3, 2, input, 0, CHANNELS, at, 128, 0, 14], columns);
    }
    for sources in sources {
        let whole = (SIDE / 4) * (SIDE / 4) * CHANNELS * usize::from(sources & GLOBAL != 0);
        let local = points * CHANNELS * usize::from(sources & SHAPE_INDEXED != 0);
        w.u32(*sources as usize);
        w.i8s(RANK * (whole + local), |i| noise(i, 20));
        w.array(&[1e-3; RANK]);
        w.array(&[0.0; RANK]);
        w.i8s(RANK * 2 * points, |i| noise(i, 100));
        w.array(&[1e-3; RANK]);
        w.array(&vec![0.0; 2 * points]);
    }
}

fn verifier() -> Writer {
    let mut w = Writer::new(b"VRFY");
    w.u32(CHANNELS);
    let views = 3; // frontal, and yaw to either side
    w.u32(views);
    for _ in 0..views {
        w.f32(1e-3);
        w.f32(4.0);
        w.i8s(LANDMARKS * CHANNELS, |i| noise(i, 10));
        w.i8s(LANDMARKS * CHANNELS, |i| noise(i + 7, 30));
        w.array(&[1e-3; LANDMARKS]);
        w.array(&[1.0; LANDMARKS]);
        w.array(&[0.3; LANDMARKS]);
        w.i8s(LANDMARKS * CHANNELS, |i| noise(i + 3, 30));
        w.array(&[1e-3; LANDMARKS]);
        w.array(&[0.2; LANDMARKS]);
        w.i8s(LANDMARKS * LANDMARKS, |i| noise(i + 5, 30));
        w.array(&[1e-3; LANDMARKS]);
        w.array(&[0.5; LANDMARKS]);
    }
    w
}
