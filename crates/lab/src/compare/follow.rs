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
use crate::tracked::Tracked;
use crate::video::Video;
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use glam::Vec3;
use posewise::math::head_angles;
use std::path::Path;

/// One frame.
pub struct Frame {
    /// What was found.
    pub tracked: Option<Tracked>,
    /// Position of the head in the camera frame \[mm\].
    pub translation: [f64; 3],
    /// Processor time of the step, without decoding \[ms\].
    pub milliseconds: f64,
}

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
        frames.push(Frame {
            milliseconds: milliseconds(&watch),
            tracked: Tracked::of(result),
            translation: result.translation_mm.map(f64::from),
        });
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
        frames.push(Frame {
            tracked: None,
            translation: [0.0; 3],
            milliseconds: 0.0,
        });
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
        translation: Vec3::to_array(&state.translation).map(f64::from),
        milliseconds,
    }
}

/// Writes a table with the columns of `posewise track --csv` that are known.
pub fn write(path: &Path, frames: &[Frame]) -> Result<()> {
    let shown = || path.display().to_string();
    let mut writer = csv::Writer::from_path(path).with_context(shown)?;
    let names = "frame success yaw_deg pitch_deg roll_deg pose_Tx pose_Ty pose_Tz milliseconds";
    let mut header: Vec<String> = names.split(' ').map(String::from).collect();
    header.extend((0..68).flat_map(|i| [format!("x_{i}"), format!("y_{i}")]));
    writer.write_record(&header)?;
    for (number, frame) in frames.iter().enumerate() {
        let tracked = frame.tracked.as_ref();
        let angles = tracked.map_or([0.0; 3], |t| t.angles);
        let points = tracked.map_or([[0.0; 2]; 68], |t| t.points);
        let mut row = vec![
            (number + 1).to_string(),
            u8::from(tracked.is_some()).to_string(),
        ];
        let values = angles.into_iter().chain(frame.translation);
        let values = values
            .chain([frame.milliseconds])
            .chain(points.into_iter().flatten());
        row.extend(values.map(|v| format!("{v:.4}")));
        writer.write_record(&row)?;
    }
    Ok(writer.flush()?)
}
