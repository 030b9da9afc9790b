//! Writes the pages' Markdown from the figures of all models.

mod clips;
mod heads;
mod model;
mod photographs;
mod search;
mod sweeps;
mod table;

pub use table::Model;

use anyhow::Result;
use table::{Render, fill, side_by_side};

/// `docs/accuracy.md`.
pub fn accuracy(models: &[Model]) -> Result<String> {
    let tables: [(&str, Render); 27] = [
        ("labels", photographs::labels),
        ("manual", photographs::manual),
        ("automatic", photographs::automatic),
        ("photographs", photographs::photographs),
        ("parts", photographs::parts),
        ("calibration", photographs::calibration),
        ("profiles", heads::profiles),
        ("profile-yaw", heads::profile_yaw),
        ("angles", heads::angles),
        ("slopes", heads::slopes),
        ("pitch", heads::pitch),
        ("turned", photographs::turned),
        ("poor", photographs::poor),
        ("clips", clips::clips),
        ("clip-by-clip", clips::clip_by_clip),
        ("sweeps", sweeps::sweeps),
        ("eyes", clips::eyes),
        ("real-eyes", clips::real_eyes),
        ("stills", clips::stills),
        ("webcams", clips::webcams),
        ("smoothed", clips::smoothed),
        ("recovery", search::recovery),
        ("first-search", search::first_search),
        ("fast", search::fast),
        ("faceless", search::faceless),
        ("departure", search::departure),
        ("cost", search::cost),
    ];
    fill(include_str!("../accuracy.md"), &tables, models)
}

/// Mean angle errors of the rendered clips, below and above 45° of yaw.
fn angle(m: &Model) -> Result<String> {
    let band = |name: &str| m.at(&format!("/clips/pose/yaw_bands/{name}/e_m_deg"));
    Ok(format!(
        "{}°, {}°",
        band("0-45")?.fixed(1),
        band("45-90")?.fixed(1)
    ))
}

/// Frames until a lost face is tracked again.
fn recovery(m: &Model) -> Result<String> {
    let at = |key: &str| m.at(&format!("/lost_and_found/recovery/not_mirrored/{key}"));
    Ok(format!(
        "{}, {}",
        at("median_frames")?.count(),
        at("worst_frames")?.count()
    ))
}

/// Frames that are tracked in pictures without people.
fn faceless(m: &Model) -> Result<String> {
    m.of("/lost_and_found/faceless/0/result", ["tracked", "frames"])
}

/// The table of figures in `README.md`.
pub fn readme(models: &[Model]) -> Result<String> {
    let (set, pictures) = photographs::first_set(models);
    let found =
        |m: &Model| -> Result<String> { Ok(m.at(&format!("{set}/found"))?.percent(1) + " %") };
    let error =
        |m: &Model| -> Result<String> { Ok(m.at(&format!("{set}/nme68_mean"))?.percent(2)) };
    side_by_side(
        models,
        "figure",
        &[
            (pictures, &found),
            (
                "… mean error of 68 landmarks, in % of the distance between the outer eye corners",
                &error,
            ),
            ("168 photographs of profiles: faces found", &|m| {
                Ok(m.at(&format!("{}/found", heads::PROFILES))?.percent(1) + " %")
            }),
            (
                "… mean error of the jaw, in % of the distance from chin to brow",
                &|m| Ok(m.at(&format!("{}/jaw", heads::PROFILES))?.percent(1)),
            ),
            (
                "heads turned by 30°, 60°, 90°: median yaw to the line of sight",
                &heads::medians,
            ),
            ("12 rendered clips, 4,093 frames: tracked", &|m| {
                Ok(m.at("/clips/pose/p_s")?.percent(2) + " %")
            }),
            (
                "… mean error of yaw, pitch and roll, up to 45° of yaw and above",
                &angle,
            ),
            (
                "a lost face comes back: frames until it is tracked, median and worst",
                &recovery,
            ),
            (
                "pictures without people: frames with a tracked face",
                &faceless,
            ),
            ("a tracking step, one thread", &|m| {
                Ok(m.at("/bench/tracking/median_ns")?.over(1e6, 1) + " ms")
            }),
            ("size of the model", &|m| {
                Ok(m.at("/bench/model_bytes")?.over(1024.0, 0) + " KiB")
            }),
        ],
    )
}
