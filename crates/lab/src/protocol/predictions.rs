//! What is compared with the truth: tables of any tracker, or the product's own results.

use crate::product::{Session, still};
use crate::tracked::{self, Tracked};
use crate::video;
use anyhow::{Context, Result};
use posewise_cli::model_file::ModelFile;
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
pub enum Predictions {
    /// `NAME.csv` in a folder, as `posewise track --csv` writes it.
    Tables(PathBuf),
    /// posewise runs on the media, of a camera with this focal length \[px\].
    Product(ModelFile, Option<f32>),
}

impl Predictions {
    /// By frame. `name` is that of the clip or picture, with the folders that it is in.
    pub fn of(&self, name: &str, media: &Media, frames: usize) -> Result<Vec<Option<Tracked>>> {
        let mut found = match self {
            Predictions::Tables(folder) => {
                let mut rows = tracked::read(&folder.join(format!("{name}.csv")))?;
                let mut found = |frame| rows.remove(&frame)?.tracked;
                (0..frames).map(&mut found).collect()
            }
            Predictions::Product(file, focal) => run(file, *focal, media)?,
        };
        found.resize(frames, None);
        Ok(found)
    }
}

/// posewise on a clip or a picture.
fn run(file: &ModelFile, focal: Option<f32>, media: &Media) -> Result<Vec<Option<Tracked>>> {
    let model = file.model()?;
    let mut session = Session::new(&model, focal)?;
    match media {
        Media::Still(path) => Ok(vec![still(&model, focal, path)?]),
        Media::Video(path) => video::frames(path)?
            .map(|luma| Ok(Tracked::of(session.step(&luma?)?)))
            .collect(),
        Media::Frames(paths) => (paths.iter())
            .map(|path| Ok(Tracked::of(session.step_file(path)?)))
            .collect(),
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
