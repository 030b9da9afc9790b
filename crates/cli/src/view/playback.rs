//! Frames at the rate at which they were taken. Files begin again at their end.

use anyhow::Result;
use posewise::Rotation;

use crate::cli::ViewArgs;
use crate::picture::Picture;
use crate::source::{self, Source};
use crate::streams::Pace;

/// A source that is played.
pub struct Playback<'a> {
    args: &'a ViewArgs,
    rotation: Rotation,
    source: Box<dyn Source>,
    /// Recorded frames are delayed; others come when they come.
    pace: Option<Pace>,
    /// Added to the source's times, which begin again with it \[µs\].
    offset_us: i64,
    last_us: Option<i64>,
}

impl<'a> Playback<'a> {
    /// Opens INPUT.
    pub fn open(args: &'a ViewArgs) -> Result<Self> {
        let source = source::open(&args.input, args.frame.fps)?;
        let is_recorded = args.input != "-" && !source.is_live();
        Ok(Playback {
            args,
            rotation: args.frame.rotation(),
            source,
            pace: is_recorded.then(Pace::default),
            offset_us: 0,
            last_us: None,
        })
    }

    /// Whether frames come as they are taken.
    pub fn is_live(&self) -> bool {
        self.pace.is_none()
    }

    /// The next frame, when it is due; `None` at the end of what cannot begin again.
    pub fn next(&mut self) -> Result<Option<Picture>> {
        let mut next = self.source.next()?;
        if next.is_none() && !self.args.once && self.pace.is_some() {
            self.source = source::open(&self.args.input, self.args.frame.fps)?;
            next = self.source.next()?;
            if let (Some(picture), Some(last_us)) = (&next, self.last_us) {
                let frame_us = (1e6 / self.source.fps()).max(1.0) as i64;
                self.offset_us = last_us + frame_us - picture.timestamp_us;
            }
        }
        let Some(mut picture) = next else {
            return Ok(None);
        };
        picture.timestamp_us += self.offset_us;
        self.last_us = Some(picture.timestamp_us);
        picture.layout.rotation = self.rotation;
        picture.layout.mirrored = self.args.frame.mirror;
        if let Some(pace) = &mut self.pace {
            pace.wait(picture.timestamp_us);
        }
        Ok(Some(picture))
    }
}
