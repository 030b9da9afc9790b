//! Clips of `posewise-lab sweeps`: heads of many kinds to full profile, and covered faces.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use serde_json::{Map, Value};

use super::bench::{Bench, Clip};

/// Kinds of clips in which nothing covers the face; the others are named by what covers it.
const OPEN: [&str; 3] = ["yaw", "pitch", "candide"];

/// `eval pose` of each kind of clips, of all in which nothing covers the face (`heads`), and of all
/// others (`covered`).
pub fn sweeps(bench: &Bench) -> Result<Value> {
    let mut kinds: BTreeMap<&str, Vec<&Clip>> = BTreeMap::new();
    for clip in &bench.sweeps {
        let focal = ["--focal", &clip.focal];
        bench.programs.track(&clip.video, &focal, &clip.csv)?;
        let kind = kind(&clip.name);
        let group = if OPEN.contains(&kind) {
            "heads"
        } else {
            "covered"
        };
        for key in [kind, group] {
            kinds.entry(key).or_default().push(clip);
        }
    }
    let mut out = Map::new();
    for (key, clips) in kinds {
        let pairs: Vec<(&Path, &Path)> = clips.iter().map(|c| (&*c.truth, &*c.csv)).collect();
        let mut pose = bench.compare("pose", &pairs)?;
        if let Value::Object(map) = &mut pose {
            map.remove("clips");
        }
        out.insert(key.into(), pose);
    }
    Ok(out.into())
}

/// The name of a clip without its number.
fn kind(name: &str) -> &str {
    name.trim_end_matches(|c: char| c.is_ascii_digit())
        .trim_end_matches('-')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clips_are_grouped_by_name() {
        assert_eq!(
            (kind("yaw-16"), kind("hand-on-eyes-02")),
            ("yaw", "hand-on-eyes")
        );
    }
}
