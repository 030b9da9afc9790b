//! Results in a folder, a table per unit of work, so that a run resumes and shards of it are put
//! together.
//!
//! `UNIT.csv` is the table, `UNIT.json` the key: everything that the result depends on. Both are
//! written under another name and then renamed, the key last: a result is there, and whole, once
//! its key is.

use crate::tracked::{self, Frame};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A checksum in hexadecimal digits, for keys.
pub fn sum(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A folder of results.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// In this folder, which is made once something is saved.
    pub fn new(folder: &Path) -> Store {
        Store {
            folder: folder.into(),
        }
    }

    fn path(&self, unit: &str, ending: &str) -> PathBuf {
        self.folder.join(format!("{unit}.{ending}"))
    }

    /// The frames of a unit, if it is there. A result with another key is an error.
    pub fn load(&self, unit: &str, key: &Value) -> Result<Option<Vec<Frame>>> {
        let path = self.path(unit, "json");
        let shown = || path.display().to_string();
        if !path.exists() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).with_context(shown)?;
        let found: Value = serde_json::from_str(&text).with_context(shown)?;
        // Numbers of a file may differ in their last bit from those that were written to it.
        let key = serde_json::from_str(&serde_json::to_string(key)?)?;
        if let Some(name) = difference(&found, &key) {
            bail!(
                "{}: a result with another {name}; name another folder",
                path.display()
            );
        }
        let frames = tracked::read(&self.path(unit, "csv"))?;
        Ok(Some(frames.into_values().collect()))
    }

    /// Saves the frames of a unit.
    pub fn save(&self, unit: &str, key: &Value, frames: &[Frame]) -> Result<()> {
        let [csv, json] = ["csv", "json"].map(|ending| self.path(unit, ending));
        let folder = csv.parent().unwrap_or(&self.folder);
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        // Two processes with the same unit do not write into one file.
        let partial = |path: &Path| path.with_added_extension(std::process::id().to_string());
        tracked::write(&partial(&csv), frames)?;
        std::fs::rename(partial(&csv), &csv)?;
        std::fs::write(partial(&json), serde_json::to_string_pretty(key)?)?;
        std::fs::rename(partial(&json), &json)?;
        Ok(())
    }
}

/// The first thing in which two keys differ.
fn difference(a: &Value, b: &Value) -> Option<String> {
    if let (Value::Object(a), Value::Object(b)) = (a, b) {
        let mut names = a.keys().chain(b.keys());
        return names.find_map(|name| {
            let [a, b] = [a, b].map(|object| object.get(name).unwrap_or(&Value::Null));
            difference(a, b).map(|inner| match inner.is_empty() {
                true => name.clone(),
                false => format!("{name}.{inner}"),
            })
        });
    }
    (a != b).then(String::new)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn results_are_found_by_their_key() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path());
        let key = |step: f64| json!({"clip": "abc", "settings": {"grid": {"step": step}}});
        assert_eq!(store.load("sparse/a", &key(0.1)).unwrap(), None);
        let frames = vec![Frame::default(); 3];
        store.save("sparse/a", &key(0.1), &frames).unwrap();
        assert_eq!(store.load("sparse/a", &key(0.1)).unwrap(), Some(frames));
        let error = store.load("sparse/a", &key(0.2)).unwrap_err().to_string();
        assert!(error.contains("another settings.grid.step"), "{error}");
        // A process that was stopped leaves a table without its key.
        std::fs::remove_file(folder.path().join("sparse/a.json")).unwrap();
        assert_eq!(store.load("sparse/a", &key(0.1)).unwrap(), None);
    }
}
