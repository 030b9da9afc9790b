//! The videos that are indexed: those of a folder and its subfolders, or of a list.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::bounded;
use crate::destination::Destination;

/// Endings of names that are videos.
const EXTENSIONS: [&str; 20] = [
    "3gp", "asf", "avi", "flv", "gif", "m2ts", "m4v", "mjpeg", "mkv", "mov", "mp4", "mpeg", "mpg",
    "mts", "mxf", "ogv", "ts", "webm", "wmv", "y4m",
];
/// Added to the name of a video for that of its table.
const TABLE: &str = "parquet";

/// Largest list \[MB\].
const MOST_MB: u64 = 64;

/// A video and where its table goes.
#[derive(Debug)]
pub struct Video {
    pub path: PathBuf,
    pub table: PathBuf,
}

/// All videos of INPUT, in the order of their names or of the list.
pub fn find(input: &Path, out: &Path) -> Result<Vec<Video>> {
    let found = std::fs::metadata(input);
    let found = found.with_context(|| format!("no such file or folder: {}", input.display()))?;
    let (paths, base) = match found.is_dir() {
        true => (walk(input, out)?, input),
        false => (listed(input)?, Path::new("")),
    };
    if paths.is_empty() {
        let endings = EXTENSIONS.join(", ");
        bail!("{} has no videos ({endings})", input.display());
    }
    let mut seen: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut videos = Vec::new();
    for path in paths {
        let table = out.join(table_name(path.strip_prefix(base).unwrap_or(&path)));
        match seen.insert(table.clone(), path.clone()) {
            // A list may name a video twice.
            Some(other) if other == path => continue,
            Some(other) => bail!(
                "{} and {} would have the same table {}",
                other.display(),
                path.display(),
                table.display()
            ),
            None => videos.push(Video { path, table }),
        }
    }
    Ok(videos)
}

/// The folder's videos; the folder of tables is left out.
fn walk(folder: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let out = std::fs::canonicalize(out).ok();
    let mut found = files(folder, &|folder| {
        out.is_none() || std::fs::canonicalize(folder).ok() != out
    })?;
    found.retain(|path| is_video(path) && path.is_file());
    found.sort();
    Ok(found)
}

/// All files of a folder and of the subfolders that are wanted. Links to folders are not followed.
fn files(folder: &Path, wanted: &dyn Fn(&Path) -> bool) -> Result<Vec<PathBuf>> {
    let mut folders = vec![folder.to_path_buf()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        let cannot = || format!("cannot list folder {}", folder.display());
        for entry in std::fs::read_dir(&folder).with_context(cannot)? {
            let entry = entry.with_context(cannot)?;
            match entry.file_type().with_context(cannot)?.is_dir() {
                true if wanted(&entry.path()) => folders.push(entry.path()),
                true => {}
                false => found.push(entry.path()),
            }
        }
    }
    Ok(found)
}

/// Removes what killed runs began of these files, and nothing else.
pub fn remove_leftovers<'a>(written: impl Iterator<Item = &'a Path>) -> Result<()> {
    let mut by_folder: HashMap<&Path, Vec<&Path>> = HashMap::new();
    for path in written {
        by_folder
            .entry(path.parent().unwrap_or(path))
            .or_default()
            .push(path);
    }
    for (folder, written) in by_folder {
        // A folder that is not there yet has none.
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let file = entry.path();
            if written
                .iter()
                .any(|path| Destination::is_temporary(&file, path))
            {
                std::fs::remove_file(&file)
                    .with_context(|| format!("cannot remove {}", file.display()))?;
            }
        }
    }
    Ok(())
}

/// One path a line, from the current folder; empty lines and those after # are left out.
fn listed(list: &Path) -> Result<Vec<PathBuf>> {
    if is_video(list) {
        return Ok(vec![list.to_path_buf()]);
    }
    let text = bounded::read_text("list", list, MOST_MB)?;
    let lines = text.lines().map(str::trim);
    Ok(lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(PathBuf::from)
        .collect())
}

fn is_video(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    let name = name.to_string_lossy().to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    // Hidden files are those of other programs.
    let ending = name.rsplit_once('.').filter(|(stem, _)| !stem.is_empty());
    !name.starts_with('.') && ending.is_some_and(|(_, ending)| EXTENSIONS.contains(&ending))
}

/// The video's path without what leads out of the folder of tables.
fn table_name(path: &Path) -> PathBuf {
    let parts = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name),
        _ => None,
    });
    let mut name = parts.collect::<PathBuf>().into_os_string();
    name.push(format!(".{TABLE}"));
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_stay_in_the_folder() {
        for (path, table) in [
            ("a/b.mp4", "a/b.mp4.parquet"),
            ("/a/b.mp4", "a/b.mp4.parquet"),
            ("../../b.mp4", "b.mp4.parquet"),
        ] {
            assert_eq!(table_name(Path::new(path)), Path::new(table));
        }
        assert!(is_video(Path::new("x/A.MP4")) && is_video(Path::new("b.y4m.gz")));
        assert!(!is_video(Path::new(".b.mp4")) && !is_video(Path::new("list.txt")));
    }
}
