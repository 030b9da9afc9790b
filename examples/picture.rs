//! Prints the head pose and the landmarks of the face in a picture.
//!
//! ```text
//! cargo run --release --example picture face.png
//! ```

use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("usage: picture FILE")?;
    let picture = image::open(path)?.into_luma8();
    let layout = FrameLayout::grey(picture.width(), picture.height());
    let frame = Frame::new(&layout, &picture)?;

    let model = Model::load(posewise::DEFAULT_MODEL)?;
    let mut config = Config::default();
    config.scan_budget = 10_000_000; // one step may scan the whole picture
    let mut tracker = Box::new(Tracker::new(&config)?);

    // The first steps find the face, the next ones improve the fit.
    for step in 1..=5 {
        tracker.step(&model, &frame, step * 33_333)?;
    }
    let face = tracker.result();
    if face.state != State::Tracking {
        return Err("no face found".into());
    }
    let [yaw, pitch, roll] = [face.yaw_deg, face.pitch_deg, face.roll_deg];
    println!("yaw {yaw:.1} pitch {pitch:.1} roll {roll:.1} deg");
    println!("translation {:.0?} mm", face.translation_mm);
    for (i, point) in face.landmarks.iter().enumerate() {
        println!("landmark {i}: {:.1} {:.1} px", point.x, point.y);
    }
    Ok(())
}
