//! Regression cascades on RBM features as trackers: alone (thesis 5.1), and followed by SVM
//! templates (5.2). A frame starts from the head of the frame before.

use super::follower::{Follower, Found};
use super::head_cascade::HeadCascade;
use super::person::Person;
use super::state::State;
use super::svm::{REFINEMENT, Templates, picture};
use super::training::Trained;
use crate::video;
use anyhow::Result;
use image::GrayImage;

/// The cascade alone.
pub struct Regressed<'a> {
    person: &'a Person<'a>,
    cascade: &'a HeadCascade,
    state: State,
}

impl<'a> Regressed<'a> {
    /// Behind the first frame.
    pub fn new(person: &'a Person<'a>, first: &State, trained: &'a Trained) -> Result<Self> {
        Ok(Regressed {
            person,
            cascade: trained.cascade()?,
            state: *first,
        })
    }
}

impl Follower for Regressed<'_> {
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
        let frame = video::frame(luma)?;
        let found = self.cascade.run(&frame, &self.person.sketch, &self.state);
        self.state = found.map_or(self.state, |(state, _)| state);
        Ok(Found {
            state: self.state,
            landmarks: found.map(|(_, shape)| shape),
        })
    }
}

/// Cascade, then templates; a face that is lost is matched with keyframes (4.2).
pub struct Hybrid<'a> {
    cascade: Regressed<'a>,
    templates: Templates<'a>,
}

impl<'a> Hybrid<'a> {
    /// From both.
    pub fn new(cascade: Regressed<'a>, templates: Templates<'a>) -> Hybrid<'a> {
        Hybrid {
            cascade,
            templates: templates.behind_cascade(),
        }
    }
}

impl Follower for Hybrid<'_> {
    fn step(&mut self, luma: &GrayImage) -> Result<Found> {
        let frame = video::frame(luma)?;
        let picture = picture(luma);
        let Regressed {
            person, cascade, ..
        } = &self.cascade;
        let find = |templates: &Templates<'_>, start: &State| {
            let found = cascade.run(&frame, &person.sketch, start);
            let found = found.map_or(*start, |(state, _)| state);
            templates.fitted(&picture, &found, REFINEMENT)
        };
        let before = self.cascade.state;
        let state = self.templates.recovered(luma, &picture, &before, find);
        self.templates.stay_at(&state);
        self.cascade.state = state;
        Ok(Found {
            state,
            landmarks: None,
        })
    }
}
