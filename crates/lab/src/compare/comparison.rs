//! What is compared: clips with truth, and the results of each system on them, which are tracked
//! now or read from where they are kept.

use super::measures::{Row, Sums};
use super::settings::{Method, Settings};
use super::systems::{System, Tables};
use super::trackers::Trackers;
use crate::store::Store;
use crate::tracked::{self, Frame};
use crate::truth::{self, Truth};
use anyhow::{Result, bail, ensure};
use indicatif::ProgressBar;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Options of what is compared.
#[derive(Clone, Debug, clap::Args)]
pub struct Selection {
    /// Clips, each beside its truth: `NAME.mp4` (or .y4m.gz, .y4m) and `NAME.csv`. The focal length
    /// is that of the truth.
    #[arg(required = true)]
    pub clips: Vec<PathBuf>,
    /// Trackers; all without it.
    #[arg(long, value_delimiter = ',')]
    pub methods: Vec<Method>,
    /// Results of another program, as often as wanted: `FOLDER/CLIP.csv` has columns of `posewise
    /// track --csv`.
    #[arg(long, value_name = "NAME=FOLDER")]
    pub csv: Vec<Tables>,
    #[command(flatten)]
    pub settings: Settings,
}

/// A clip with truth.
pub struct Clip {
    /// The video.
    pub path: PathBuf,
    /// The path below the folder that all clips are in, without its ending.
    pub name: String,
    /// By frame.
    pub truth: Vec<Truth>,
}

impl Clip {
    /// The file of the same name beside the clip.
    pub fn beside(&self, ending: &str) -> PathBuf {
        stem(&self.path).with_added_extension(ending)
    }
}

/// Clips and systems, ready to be run.
pub struct Comparison {
    /// The clips.
    pub clips: Vec<Clip>,
    /// The systems.
    pub systems: Vec<System>,
    trackers: Trackers,
    store: Option<Store>,
    focal: Option<f32>,
    limit: usize,
}

impl Comparison {
    /// Reads truths and models. Results are kept in a folder if there is one.
    pub fn new(selection: &Selection, results: Option<&Path>) -> Result<Comparison> {
        let methods = match selection.methods.is_empty() {
            true => Method::ALL.to_vec(),
            false => selection.methods.clone(),
        };
        let settings = &selection.settings;
        let trackers = Trackers::new(settings, &methods)?;
        let mut systems: Vec<System> = methods.into_iter().map(System::Method).collect();
        systems.extend(selection.csv.iter().cloned().map(System::Tables));
        let names: BTreeSet<&str> = systems.iter().map(System::name).collect();
        ensure!(names.len() == systems.len(), "two rows of the same name");
        Ok(Comparison {
            clips: clips(&selection.clips)?,
            systems,
            trackers,
            store: results.map(Store::new),
            focal: settings.product.focal,
            limit: settings.frames.unwrap_or(usize::MAX),
        })
    }

    /// How many there are: each system on each clip.
    pub fn results(&self) -> u64 {
        (self.systems.len() * self.clips.len()) as u64
    }

    /// The frames of a system on a clip: those that are kept, or the clip is tracked.
    pub fn frames(&self, system: &System, clip: &Clip) -> Result<Vec<Frame>> {
        let found = self.kept(system, clip)?;
        found.map_or_else(|| self.track(system, clip), Ok)
    }

    /// The frames of a system on a clip, if they are there.
    fn kept(&self, system: &System, clip: &Clip) -> Result<Option<Vec<Frame>>> {
        let name = &clip.name;
        match (system, &self.store) {
            (System::Tables(tables), _) => {
                let path = tables.folder.join(format!("{name}.csv"));
                let mut rows = tracked::read(&path)?;
                let frames = 0..clip.truth.len().min(self.limit);
                let found = frames.map(|frame| rows.remove(&frame).unwrap_or_default());
                Ok(Some(found.collect()))
            }
            (System::Method(method), Some(store)) => {
                let key = self
                    .trackers
                    .key(*method, &clip.path, self.focal_of(clip))?;
                store.load(&format!("{}/{name}", method.name()), &key)
            }
            (System::Method(_), None) => Ok(None),
        }
    }

    fn track(&self, system: &System, clip: &Clip) -> Result<Vec<Frame>> {
        let System::Method(method) = system else {
            bail!("{} runs elsewhere", system.name());
        };
        let focal = self.focal_of(clip);
        let frames = self.trackers.follow(*method, &clip.path, focal)?;
        if let Some(store) = &self.store {
            let key = self.trackers.key(*method, &clip.path, focal)?;
            store.save(&format!("{}/{}", method.name(), clip.name), &key, &frames)?;
        }
        Ok(frames)
    }

    fn focal_of(&self, clip: &Clip) -> Option<f32> {
        let first = clip.truth.first();
        let stated = first.and_then(|t| t.focal).map(|f| f as f32);
        stated.or(self.focal)
    }

    /// The table; with `each`, a row per clip before that of a system.
    pub fn rows(&self, each: bool) -> Result<Vec<Row>> {
        let progress = ProgressBar::new(self.results());
        let mut rows = Vec::new();
        for system in &self.systems {
            let mut all = Sums::default();
            for clip in &self.clips {
                let frames = self.frames(system, clip)?;
                all.add(&clip.truth, &frames);
                if each {
                    let mut one = Sums::default();
                    one.add(&clip.truth, &frames);
                    rows.push(one.row(system.name(), Some(&clip.name)));
                }
                progress.inc(1);
            }
            rows.push(all.row(system.name(), None));
        }
        progress.finish_and_clear();
        Ok(rows)
    }
}

/// Reads the truths.
fn clips(paths: &[PathBuf]) -> Result<Vec<Clip>> {
    let shared = common_folder(paths);
    let clip = |path: &PathBuf| -> Result<Clip> {
        let truth = stem(path).with_added_extension("csv");
        let below = path.strip_prefix(&shared).unwrap_or(path);
        Ok(Clip {
            name: stem(below).to_string_lossy().into_owned(),
            truth: truth::read(&truth)?,
            path: path.clone(),
        })
    };
    let clips: Vec<Clip> = paths.iter().map(clip).collect::<Result<_>>()?;
    let names: BTreeSet<&str> = clips.iter().map(|c| c.name.as_str()).collect();
    ensure!(names.len() == clips.len(), "a clip is given twice");
    Ok(clips)
}

/// The folder that all are in.
fn common_folder(paths: &[PathBuf]) -> PathBuf {
    let mut folders = paths.iter().filter_map(|path| path.parent());
    let first = folders.next().unwrap_or(Path::new("")).to_path_buf();
    folders.fold(first, |shared, folder| {
        let both = shared.components().zip(folder.components());
        both.take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    })
}

/// Without the ending of a video.
fn stem(clip: &Path) -> PathBuf {
    let name = clip.file_name().unwrap_or_default().to_string_lossy();
    let mut endings = [".y4m.gz", ".y4m", ".mp4", ".avi"].iter();
    let found = endings.find_map(|ending| name.strip_suffix(ending));
    clip.with_file_name(found.unwrap_or(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_below_the_common_folder() {
        let paths = ["/a/s1/yaw.mp4", "/a/s2/yaw.y4m.gz"].map(PathBuf::from);
        assert_eq!(common_folder(&paths), Path::new("/a"));
        assert_eq!(common_folder(&paths[..1]), Path::new("/a/s1"));
        assert_eq!(stem(Path::new("s2/yaw.1.y4m.gz")), Path::new("s2/yaw.1"));
    }
}
