//! What several tests need: paths, the demo clip.
#![allow(dead_code)] // each test uses its part

pub mod c;
pub mod java;
pub mod random;
pub mod scenes;
pub mod skip;
pub mod watch;

use posewise::{Config, Frame, FrameLayout, Model, Tracker};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder of this test's own.
pub fn scratch(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&path).expect("target/ is writable");
    path
}

/// Fails when docs/memory.md, in the row that starts so, states a figure that is off by more than
/// the given part of it.
pub fn check_documented(row: &str, measured: usize, part: f64) {
    check_page("docs/memory.md", row, measured, part);
}

/// As [`check_documented`], in any page.
pub fn check_page(page: &str, row: &str, measured: usize, part: f64) {
    let figure = xtask::figures::documented(page, row);
    let figure = figure.unwrap_or_else(|error| panic!("{error:#}"));
    assert!(
        (measured as f64 - figure).abs() <= part * figure,
        "{page} says {figure} in the row '{row}', measured: {measured}"
    );
}

/// A video in memory: 8-bit luma, one frame after the other.
pub struct Clip {
    /// As the y4m file has it, chroma and all.
    pub y4m: Vec<u8>,
    pub width: usize,
    pub height: usize,
    /// Microseconds from frame to frame.
    pub frame_us: f64,
    pub luma: Vec<Vec<u8>>,
}

/// The clip in the repository: a rendered head that turns.
pub fn demo() -> &'static Clip {
    static DEMO: OnceLock<Clip> = OnceLock::new();
    let path = root().join("tests/data/demo.y4m.gz");
    DEMO.get_or_init(|| unpacked(&path).expect("tests/data/demo.y4m.gz"))
}

impl Clip {
    /// A frame, by its number from 0.
    pub fn frame(&self, n: usize) -> Frame<'_> {
        grey(self.width, self.height, &self.luma[n])
    }

    /// When it was taken \[µs\].
    pub fn time_us(&self, n: usize) -> i64 {
        (n as f64 * self.frame_us) as i64
    }
}

/// Grey pixels as a frame.
pub fn grey(width: usize, height: usize, luma: &[u8]) -> Frame<'_> {
    let layout = FrameLayout::grey(width as u32, height as u32);
    Frame::new(&layout, luma).expect("a frame")
}

/// The default model.
pub fn model() -> Model<'static> {
    Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid")
}

/// A new tracker.
pub fn tracker(config: &Config) -> Box<Tracker> {
    Box::new(Tracker::new(config).expect("valid settings"))
}

/// A clip of y4m behind gzip, if it is there.
pub fn unpacked(path: &Path) -> Option<Clip> {
    let packed = std::fs::read(path).ok()?;
    let mut y4m = Vec::new();
    flate2::read::MultiGzDecoder::new(&packed[..])
        .read_to_end(&mut y4m)
        .expect("a whole clip");
    Some(parse(y4m))
}

/// Splits a y4m file of 4:2:0 or mono into frames of luma.
fn parse(y4m: Vec<u8>) -> Clip {
    let line_end = |at: usize| at + y4m[at..].iter().position(|b| *b == b'\n').expect("a line");
    let header_end = line_end(0);
    let header = std::str::from_utf8(&y4m[..header_end]).expect("ASCII");
    assert!(header.starts_with("YUV4MPEG2 "), "{header}");
    let word = |key| {
        header
            .split(' ')
            .skip(1)
            .find_map(|w: &str| w.strip_prefix(key))
    };
    let number = |key| {
        word(key)
            .and_then(|w| w.parse::<usize>().ok())
            .expect("a number")
    };
    let (width, height) = (number('W'), number('H'));
    let (num, den) = word('F')
        .and_then(|f| f.split_once(':'))
        .expect("a frame rate");
    let rate: f64 = num.parse::<f64>().expect("a rate") / den.parse::<f64>().expect("a rate");
    let chroma = match word('C').unwrap_or("420") {
        "mono" => 0,
        colour if colour.starts_with("420") => 2 * width.div_ceil(2) * height.div_ceil(2),
        colour => panic!("{colour} is not read here"),
    };
    let mut luma = Vec::new();
    let mut at = header_end + 1;
    while at < y4m.len() {
        let start = line_end(at) + 1;
        luma.push(y4m[start..start + width * height].to_vec());
        at = start + width * height + chroma;
    }
    Clip {
        width,
        height,
        frame_us: 1e6 / rate,
        luma,
        y4m,
    }
}
