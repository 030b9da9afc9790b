//! A tracker follows a clip, frame by frame.

use super::bayes::Loop;
use super::cascade::{Hybrid, Regressed};
use super::descriptor::Descriptor;
use super::face_model::FaceModel;
use super::follower::{ByEnergy, Follower};
use super::gaussian::Gaussians;
use super::keyframes::Keyframes;
use super::person::Person;
use super::picture::Picture;
use super::scorer::{Local, LocalModel, Scorer};
use super::settings::{Method, Settings};
use super::sparse::Sparse;
use super::state::State;
use super::svm::Templates;
use super::synthesis::{first_sample, samples};
use super::training::Trained;
use super::view_based::ViewBased;
use crate::product::Session;
use crate::tracked::{Frame, Tracked};
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use glam::Vec3;
use image::GrayImage;
use posewise::Model;
use posewise::align::Shape;
use posewise::math::head_angles;

/// How a clip is followed.
pub struct Clip<'a> {
    /// The comparator.
    pub method: Method,
    /// Its settings.
    pub settings: &'a Settings,
    /// Finds the landmarks of the first frame.
    pub product: &'a Model<'a>,
    /// What the method has learned beforehand, if it does.
    pub trained: Option<&'a Trained>,
    /// Focal length \[px\].
    pub focal: Option<f32>,
}

/// posewise on a clip.
pub fn product(
    model: &Model<'_>,
    focal: Option<f32>,
    video: impl Iterator<Item = Result<GrayImage>>,
) -> Result<Vec<Frame>> {
    let mut session = Session::new(model, focal)?;
    let step = |luma: Result<GrayImage>| {
        let luma = luma?;
        let watch = ThreadTime::now();
        let result = session.step(&luma)?;
        Ok(Frame::of(result, milliseconds(&watch)))
    };
    video.map(step).collect()
}

/// A comparator on a clip. Frames before posewise has found a face are not tracked.
pub fn comparator(
    clip: &Clip<'_>,
    model: &FaceModel,
    mut video: impl Iterator<Item = Result<GrayImage>>,
) -> Result<Vec<Frame>> {
    let mut session = Session::new(clip.product, clip.focal)?;
    let mut frames = Vec::new();
    let (picture, landmarks) = loop {
        let Some(luma) = video.next() else {
            return Ok(frames);
        };
        let luma = luma?;
        let result = session.step(&luma)?;
        if Tracked::of(result).is_some() {
            break (Picture::of(&luma), result.landmarks.map(|l| [l.x, l.y]));
        }
        frames.push(Frame::default());
    };
    let (person, first) = model.fit(session.camera(), &landmarks)?;
    let mut follower = follower(clip, &person, &picture, &first)?;
    frames.push(frame(&person, &first, None, 0.0));
    for luma in video {
        let luma = luma?;
        let watch = ThreadTime::now();
        let found = follower.step(&luma)?;
        let time = milliseconds(&watch);
        frames.push(frame(&person, &found.state, found.landmarks, time));
    }
    Ok(frames)
}

/// The method behind its first frame.
fn follower<'a>(
    clip: &'a Clip<'_>,
    person: &'a Person<'a>,
    picture: &Picture,
    first: &State,
) -> Result<Box<dyn Follower + 'a>> {
    let trained = || clip.trained.context("the trained parts");
    let keyframes = || {
        let is_wanted = clip.method.matches_keyframes() && !clip.settings.no_keyframes;
        is_wanted.then(|| Keyframes::new(person))
    };
    let templates = || Templates::new(person, first, clip.product, trained()?, keyframes());
    Ok(match clip.method {
        Method::Svm => Box::new(templates()?),
        Method::Cascade => Box::new(Regressed::new(person, first, trained()?)?),
        Method::Hybrid => {
            let cascade = Regressed::new(person, first, trained()?)?;
            Box::new(Hybrid::new(cascade, templates()?))
        }
        _ => Box::new(ByEnergy {
            person,
            tracker: Loop::new(first, clip.method.weight(), &clip.settings.search),
            scorer: scorer(clip, person, picture, first),
            keyframes: keyframes(),
        }),
    })
}

/// The method's energy, from views of the first frame.
fn scorer<'a>(
    clip: &Clip<'_>,
    person: &'a Person<'a>,
    picture: &Picture,
    first: &State,
) -> Box<dyn Scorer + 'a> {
    let settings = clip.settings;
    let descriptor = settings.descriptor;
    let samples = samples(person, picture, first, &settings.grid, descriptor);
    let gaussians = |rates| boxed(person, descriptor, Gaussians::new(&samples, rates));
    match clip.method {
        Method::Adaptive => gaussians(Some(settings.rates)),
        Method::Sparse => {
            let own = first_sample(person, picture, first, descriptor);
            boxed(person, descriptor, Sparse::new(&samples, &own))
        }
        Method::ViewBased => boxed(person, descriptor, ViewBased::new(samples, settings.views)),
        _ => gaussians(None),
    }
}

fn boxed<'a, M: LocalModel + 'a>(
    person: &'a Person<'a>,
    descriptor: Descriptor,
    model: M,
) -> Box<dyn Scorer + 'a> {
    Box::new(Local {
        person,
        descriptor,
        model,
    })
}

/// Processor time of this thread: on a busy machine the clock says little.
fn milliseconds(since: &ThreadTime) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

fn frame(person: &Person<'_>, state: &State, landmarks: Option<Shape>, milliseconds: f64) -> Frame {
    let angles = head_angles(&state.rotation);
    let points = |i: usize| landmarks.map_or_else(|| person.image(state, i), |l| l[i]);
    let points = |i| points(i).map(f64::from);
    Frame {
        tracked: Some(Tracked {
            angles: [angles.yaw_deg, angles.pitch_deg, angles.roll_deg].map(f64::from),
            points: std::array::from_fn(points),
        }),
        translation: Some(Vec3::to_array(&state.translation).map(f64::from)),
        confidence: None,
        milliseconds: Some(milliseconds),
    }
}
