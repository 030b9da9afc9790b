//! Tracks the face in an uncompressed 8-bit video (YUV4MPEG2), from a file or standard input.
//!
//! ```text
//! ffmpeg -i clip.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | cargo run --release --example video
//! ```

use posewise::{ANIMATION_NAMES, Config, Frame, FrameLayout, Model, State, Tracker};
use std::error::Error;
use std::fs::File;
use std::io::{BufReader, Read, stdin};

fn main() -> Result<(), Box<dyn Error>> {
    let input: Box<dyn Read> = match std::env::args_os().nth(1) {
        Some(path) => Box::new(BufReader::new(File::open(path)?)),
        None => Box::new(stdin().lock()),
    };
    let mut video = y4m::decode(input)?;
    if video.get_bit_depth() != 8 {
        return Err("not an 8-bit video".into());
    }
    let layout = FrameLayout::grey(video.get_width() as u32, video.get_height() as u32);
    let rate = video.get_framerate();
    let frame_us = 1_000_000 * rate.den as i64 / rate.num as i64;

    let model = Model::load(posewise::DEFAULT_MODEL)?;
    let mut tracker = Box::new(Tracker::new(&Config::default())?);
    let mut timestamp_us = 0;
    loop {
        let picture = match video.read_frame() {
            Ok(picture) => picture,
            Err(y4m::Error::EOF) => return Ok(()),
            Err(error) => return Err(error.into()),
        };
        let frame = Frame::new(&layout, picture.get_y_plane())?;
        timestamp_us += frame_us;
        let face = tracker.step(&model, &frame, timestamp_us)?;
        if face.state != State::Tracking {
            println!("{timestamp_us} us: {:?}", face.state);
            continue;
        }
        let [yaw, pitch, roll] = [face.yaw_deg, face.pitch_deg, face.roll_deg];
        print!("{timestamp_us} us: yaw {yaw:.1} pitch {pitch:.1} roll {roll:.1} deg");
        for (name, weight) in ANIMATION_NAMES.iter().zip(face.animation) {
            if weight > 0.5 {
                print!(" {name} {weight:.1}");
            }
        }
        println!();
    }
}
