//! The clip that the benchmarks track.

use std::io::Read;

/// Width, height and luma of the demo clip's frames.
pub fn clip() -> (usize, usize, Vec<Vec<u8>>) {
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
