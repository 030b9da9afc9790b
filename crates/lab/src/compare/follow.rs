//! A tracker follows a clip, frame by frame.

use super::bayes::Loop;
use super::descriptor::{BLUR_MM, Descriptor};
use super::gaussian::Gaussians;
use super::person::{FaceModel, Person};
use super::picture::Picture;
use super::scorer::{Local, LocalModel, Scorer};
use super::settings::{Method, Settings};
use super::sparse::Sparse;
use super::state::State;
use super::synthesis::samples;
use super::view_based::ViewBased;
use crate::product::Product;
use crate::tracked::{Frame, Tracked};
use crate::video::Video;
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use glam::Vec3;
use posewise::math::head_angles;

/// How a clip is followed.
pub struct Clip<'a> {
    /// The comparator.
    pub method: Method,
    /// Its settings.
    pub settings: &'a Settings,
    /// Finds the landmarks of the first frame.
    pub product: &'a Product,
    /// Focal length \[px\].
    pub focal: Option<f32>,
    /// Most frames.
    pub limit: usize,
}

/// posewise on a clip.
pub fn product(
    product: &Product,
    focal: Option<f32>,
    limit: usize,
    video: &mut Video,
) -> Result<Vec<Frame>> {
    let mut session = product.start_with(focal)?;
    let mut frames = Vec::new();
    while frames.len() < limit
        && let Some(luma) = video.next()?
    {
        let watch = ThreadTime::now();
        let result = session.step(luma)?;
        frames.push(Frame::of(result, milliseconds(&watch)));
    }
    Ok(frames)
}

/// A comparator on a clip. Frames before posewise has found the face are not tracked.
pub fn comparator(clip: &Clip<'_>, model: &FaceModel, video: &mut Video) -> Result<Vec<Frame>> {
    let mut session = clip.product.start_with(clip.focal)?;
    let mut frames = Vec::new();
    let (picture, landmarks) = loop {
        let luma = video.next()?.context("no face in the clip")?;
        let result = session.step(luma)?;
        if Tracked::of(result).is_some() {
            break (Picture::of(luma), result.landmarks.map(|l| [l.x, l.y]));
        }
        frames.push(Frame::default());
    };
    let camera = session.camera(picture.width, picture.height);
    let (person, first) = model.fit(camera, &landmarks)?;
    let mut scorer = scorer(clip, &person, &picture, &first);
    let weight = clip.method.weight();
    let mut tracker = Loop::new(&first, weight, &clip.settings.search);
    frames.push(frame(&person, &first, 0.0));
    while frames.len() < clip.limit
        && let Some(luma) = video.next()?
    {
        let watch = ThreadTime::now();
        let blur = BLUR_MM * person.camera.fx / tracker.state().translation.z;
        let picture = Picture::of(luma).blurred(blur);
        let state = tracker.step(scorer.as_mut(), &picture)?;
        frames.push(frame(&person, &state, milliseconds(&watch)));
    }
    Ok(frames)
}

/// The method's scorer, from views of the first frame.
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
        Method::Sparse => boxed(person, descriptor, Sparse::new(&samples)),
        Method::ViewBased => boxed(person, descriptor, ViewBased::new(samples, settings.views)),
        Method::Gaussian | Method::Posewise => gaussians(None),
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

fn frame(person: &Person<'_>, state: &State, milliseconds: f64) -> Frame {
    let angles = head_angles(&state.rotation);
    let points = |i| person.image(state, i).map(f64::from);
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
