//! One face, or several with a tracker each ([`Group`]).

use std::time::{Duration, Instant};

use anyhow::Result;
use posewise::{EventLog, Group, Intrinsics, Model, Roi, State, TrackResult};

use crate::cli::TrackerArgs;
use crate::monitor::Turn;
use crate::picture::Picture;
use crate::session::{Session, in_words};

/// A result and the number of its tracker.
pub struct Face {
    /// From 0.
    pub id: usize,
    /// Of the last step, smoothed if that is wanted.
    pub result: TrackResult,
}

/// Trackers for several faces.
pub struct Faces<'m> {
    model: &'m Model<'m>,
    sessions: Vec<Session<'m>>,
    group: Group,
    /// Time spent in steps of the group.
    busy: Duration,
}

impl<'m> Faces<'m> {
    /// A group of `count` trackers.
    pub fn new(
        count: usize,
        model: &'m Model<'m>,
        args: &TrackerArgs,
        live: bool,
        roi: Option<Roi>,
    ) -> Result<Self> {
        let session = |_| -> Result<Session<'m>> {
            let mut session = Session::new(model, args, live)?;
            session.set_roi(roi)?;
            Ok(session)
        };
        Ok(Faces {
            model,
            sessions: (0..count.max(1)).map(session).collect::<Result<_>>()?,
            group: Group::new(),
            busy: Duration::ZERO,
        })
    }

    /// One frame: a single tracker's result, or those that have a face.
    pub fn step(&mut self, picture: &Picture) -> Result<Vec<Face>> {
        if let [session] = &mut self.sessions[..] {
            let result = *session.step(picture)?;
            return Ok(vec![Face { id: 0, result }]);
        }
        let frame = picture.frame()?;
        let mut trackers = Vec::new();
        for session in &mut self.sessions {
            trackers.push(session.ready(&frame, picture.focal_px)?);
        }
        let start = Instant::now();
        let stepped = (self.group).step(self.model, &mut trackers, &frame, picture.timestamp_us);
        self.busy += start.elapsed();
        stepped.map_err(|e| in_words(e, &frame))?;
        // A face is shown once: a tracker that slid onto another one's gives it back next time.
        let shown = self.sessions.iter().enumerate().filter(|(id, session)| {
            session.result().state != State::Searching && self.group.is_own(*id)
        });
        Ok(shown
            .map(|(id, session)| Face {
                id,
                result: *session.shown(),
            })
            .collect())
    }

    /// Turns the tracker of face 0 to the driver or back. A region that was asked for stays.
    pub fn turn(&mut self, turn: Turn, asked: Option<Roi>) -> Result<()> {
        self.sessions[0].turn(turn, asked)
    }

    /// The events of each tracker that were not written yet, with its number where there are
    /// several.
    pub fn events(&mut self) -> impl Iterator<Item = (Option<usize>, &mut EventLog)> {
        let several = self.sessions.len() > 1;
        let sessions = self.sessions.iter_mut().enumerate();
        sessions.map(move |(id, session)| (several.then_some(id), session.events()))
    }

    /// The tracker of face 0.
    pub fn first(&self) -> &Session<'m> {
        &self.sessions[0]
    }

    /// The camera that the trackers assume for the current frame.
    pub fn intrinsics(&self) -> Intrinsics {
        self.sessions[0].intrinsics()
    }

    /// Time spent in steps.
    pub fn busy(&self) -> Duration {
        let alone = self.sessions.iter().map(|session| session.busy);
        alone.sum::<Duration>() + self.busy
    }
}
