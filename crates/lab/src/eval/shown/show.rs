//! Pictures from memory shown to a tracker, at a fixed rate.

use anyhow::Result;
use image::GrayImage;
use posewise::{Model, TrackResult};
use posewise_cli::cli::TrackerArgs;
use posewise_cli::picture::Picture;
use posewise_cli::session::Session;

/// A fresh tracker and its clock.
pub struct Show<'m> {
    session: Session<'m>,
    fps: f64,
    shown: u64,
}

impl<'m> Show<'m> {
    /// `live` searches as for a camera unless the settings say otherwise.
    pub fn new(model: &'m Model<'m>, args: &TrackerArgs, live: bool, fps: f64) -> Result<Self> {
        Ok(Show {
            session: Session::new(model, args, live)?,
            fps,
            shown: 0,
        })
    }

    /// The next frame.
    pub fn frame(&mut self, image: &GrayImage) -> Result<&TrackResult> {
        let mut picture = Picture::from_grey(image.clone());
        picture.timestamp_us = (self.shown as f64 * 1e6 / self.fps).round() as i64;
        self.shown += 1;
        self.session.step(&picture)
    }
}
