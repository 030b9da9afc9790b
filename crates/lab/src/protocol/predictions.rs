//! What is compared with the truth: tables of any tracker, or the product's own results.

use crate::compare::{Method, Trackers};
use crate::product::{STILL_FRAMES, read_luma, still};
use crate::tracked::{self, Frame, Tracked};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// What a data set shows.
pub enum Media {
    /// A video file.
    Video(PathBuf),
    /// Pictures that are the frames of a video.
    Frames(Vec<PathBuf>),
    /// One picture.
    Still(PathBuf),
}

/// Where predictions come from.
pub enum Predictions<'a> {
    /// `NAME.csv` in a folder, as `posewise track --csv` writes it.
    Tables(PathBuf),
    /// posewise or a tracker of the thesis runs on the media, of a camera with this focal length
    /// \[px\].
    Tracker(&'a Trackers, Method, Option<f32>),
}

impl Predictions<'_> {
    /// As in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Predictions::Tables(_) => "tables",
            Predictions::Tracker(_, method, _) => method.name(),
        }
    }

    /// By frame. `name` is that of the clip or picture, with the folders that it is in.
    pub fn of(&self, name: &str, media: &Media, frames: usize) -> Result<Vec<Option<Tracked>>> {
        let mut found = match self {
            Predictions::Tables(folder) => {
                let mut rows = tracked::read(&folder.join(format!("{name}.csv")))?;
                let mut found = |frame| rows.remove(&frame)?.tracked;
                (0..frames).map(&mut found).collect()
            }
            Predictions::Tracker(trackers, method, focal) => {
                run(trackers, *method, *focal, media).with_context(|| name.to_string())?
            }
        };
        found.resize(frames, None);
        Ok(found)
    }
}

/// A tracker on a clip or a picture.
fn run(
    trackers: &Trackers,
    method: Method,
    focal: Option<f32>,
    media: &Media,
) -> Result<Vec<Option<Tracked>>> {
    let tracked = |frames: Vec<Frame>| frames.into_iter().map(|f| f.tracked).collect();
    let follow = |paths: &mut dyn Iterator<Item = &PathBuf>| {
        let frames = paths.map(|path| read_luma(path));
        trackers.follow_frames(method, frames, focal)
    };
    match media {
        Media::Still(path) if method == Method::Posewise => {
            Ok(vec![still(&trackers.product().model()?, focal, path)?])
        }
        Media::Still(path) => {
            let frames = follow(&mut std::iter::repeat_n(path, STILL_FRAMES))?;
            Ok(vec![frames.into_iter().last().and_then(|f| f.tracked)])
        }
        Media::Video(path) => Ok(tracked(trackers.follow(method, path, focal)?)),
        Media::Frames(paths) => Ok(tracked(follow(&mut paths.iter())?)),
    }
}

/// All files below a folder with one of these endings (in lower case), by name.
pub fn files(folder: &Path, endings: &[&str]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
        for entry in entries {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = name.to_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The file's path below `folder`, without its ending.
pub fn name_below(folder: &Path, path: &Path) -> String {
    let below = path.strip_prefix(folder).unwrap_or(path);
    below.with_extension("").to_string_lossy().into_owned()
}

/// The first of these endings with which the file beside `path` is there; the first where none is.
pub fn beside(path: &Path, endings: &[&str]) -> PathBuf {
    let mut candidates = endings.iter().map(|ending| path.with_extension(ending));
    let found = candidates.clone().find(|c| c.exists());
    found.or_else(|| candidates.next()).unwrap_or_default()
}
