//! `posewise-lab eval people`: whether faces are found as often, and landmarks as exactly, on
//! people of each sex, age and skin, in good and in poor light.
//!
//! MakeHuman's people, that no training has seen, as photographs mostly show them, where hair and
//! turn leave most of the face to be seen. Each picture is a still for a new tracker. Their labels
//! are the head's vertices, alike for all groups; whether people of all groups are rendered as
//! faithfully, figures of renders cannot say.

use super::still::{Showing, Stills};
use crate::eval::{camera, on_renders};
use crate::output;
use anyhow::{Context, Result};
use image::GrayImage;
use posewise_cli::picture::Picture;
use posewise_metrics::landmarks::{INNER, distance, nme_percent};
use posewise_metrics::{mean, median};
use posewise_train::render::makehuman::Groups;
use posewise_train::render::sample::Rendered;
use posewise_train::render::{self, Kind, SampleSpec};
use serde_json::{Map, Value, json};

/// Options of `posewise-lab eval people`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub on: on_renders::Args,
    /// Pictures
    #[arg(long, default_value_t = 3000)]
    pub count: u64,
    /// Seed of people and pictures; no training has it
    #[arg(long, default_value_t = 5151)]
    pub seed: u64,
}

/// Narrowest face searched for \[px\].
const MIN_FACE_PX: u32 = 40;
/// Albedo below which skin is dark, and from which it is light.
const DARK: f32 = 0.17;
const LIGHT: f32 = 0.36;
/// Least share of the inner landmarks that is seen.
const SEEN: f32 = 0.7;
/// The poor camera: that of a dim room in accuracy.md.
const DIM: camera::Args = camera::Args {
    gain: 0.15,
    noise: 3.0,
    ..camera::GOOD
};

fn spec() -> SampleSpec {
    SampleSpec {
        face_px: (60.0, 150.0),
        yaw_deg: 45.0,
        defects: 0.5,
        makehuman: 1.0,
        panoramas: render::PANORAMAS,
        everyday: 1.0,
        ..SampleSpec::default()
    }
}

/// A picture's groups, and in good and in poor light the error \[% of the distance between the
/// outer eye corners\] where the face is found.
struct Measured {
    groups: Groups,
    errors: [Option<f64>; 2],
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let stills = Stills::of(args.on.file()?, MIN_FACE_PX, 1, 0)?;
    let renderer = args.on.renderer(args.seed, Kind::Plain)?;
    let indices: Vec<u64> = (0..args.count).collect();
    let measured = stills.each(&indices, |show, _, index| {
        measure(show, renderer.render(args.seed, *index, &spec()), *index)
    })?;
    let measured: Vec<Measured> = measured.into_iter().flatten().collect();
    let tone = |groups: &Groups| match groups.skin {
        ..DARK => "dark skin",
        ..LIGHT => "medium skin",
        _ => "light skin",
    };
    type Key<'a> = &'a dyn Fn(&Groups) -> &'static str;
    let keys: [Key<'_>; 5] = [&|_| "all", &|g| g.people, &|g| g.sex, &|g| g.age, &tone];
    let mut figures = Map::new();
    for key in keys {
        let mut names: Vec<_> = measured.iter().map(|m| key(&m.groups)).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let of: Vec<_> = measured.iter().filter(|m| key(&m.groups) == name).collect();
            figures.insert(name.to_owned(), figures_of(&of));
        }
    }
    output::show(&Value::Object(figures), args.on.json.as_deref())
}

/// One picture; `None` where too little of the face is seen.
fn measure(show: &Showing<'_>, rendered: Rendered, index: u64) -> Result<Option<Measured>> {
    let sample = rendered.sample;
    let inner = &sample.visible[INNER..];
    let seen = inner.iter().filter(|seen| **seen).count();
    if (seen as f32) < SEEN * inner.len() as f32 {
        return Ok(None);
    }
    let truth = sample.landmarks.map(|p| p.to_array());
    let unit = distance(truth[36], truth[45]);
    let luma = GrayImage::from_raw(sample.width as u32, sample.height as u32, sample.luma);
    let luma = luma.context("a whole picture")?;
    let mut errors = [None; 2];
    for (error, seen) in errors.iter_mut().zip([camera::GOOD, DIM]) {
        let seen = camera::through(&seen, luma.clone(), index);
        let fit = show.fit(Picture::from_grey(seen), None)?;
        *error = fit.map(|fit| {
            let found = fit
                .result
                .landmarks
                .map(|landmark| [landmark.x, landmark.y]);
            f64::from(nme_percent(truth.into_iter().zip(found), unit))
        });
    }
    let groups = rendered.groups.context("all heads are MakeHuman's")?;
    Ok(Some(Measured { groups, errors }))
}

fn figures_of(measured: &[&Measured]) -> Value {
    let of = |k: usize| {
        let errors: Vec<f64> = measured.iter().filter_map(|m| m.errors[k]).collect();
        let found = 100.0 * errors.len() as f64 / measured.len() as f64;
        (found, mean(&errors), median(&errors))
    };
    let (good, poor) = (of(0), of(1));
    json!({
        "count": measured.len(),
        "found_percent": good.0, "nme_percent": good.1, "nme_median_percent": good.2,
        "dim_found_percent": poor.0, "dim_nme_percent": poor.1,
    })
}
