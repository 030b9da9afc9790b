//! Content hashes (SHA-256) of bytes, files and folders, and of options as JSON.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// A SHA-256 hash in hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hash(String);

impl Hash {
    /// Of bytes.
    pub fn of(bytes: &[u8]) -> Hash {
        Hash::finished(Sha256::new_with_prefix(bytes))
    }

    /// Of a file's content.
    pub fn of_file(path: &Path) -> Result<Hash> {
        let mut hasher = Sha256::new();
        let file = File::open(path).with_context(|| format!("reading {}", path.display()))?;
        let mut reader = BufReader::with_capacity(1 << 16, file);
        while let bytes @ [_, ..] = reader.fill_buf()? {
            hasher.update(bytes);
            let count = bytes.len();
            reader.consume(count);
        }
        Ok(Hash::finished(hasher))
    }

    /// Of a JSON value; the order of keys does not matter.
    pub fn of_json(value: &Value) -> Hash {
        Hash::of(canonical(value).to_string().as_bytes())
    }

    /// The first 16 digits, for file names.
    pub fn short(&self) -> &str {
        &self.0[..16]
    }

    fn finished(hasher: Sha256) -> Hash {
        let digits = hasher.finalize();
        Hash(digits.iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// The value with the keys of every object in order: whether `serde_json` keeps the order of
/// insertion depends on features that other crates of a build switch on.
fn canonical(value: &Value) -> Value {
    match value {
        Value::Object(map) => {
            let sorted: BTreeMap<&String, Value> =
                map.iter().map(|(k, v)| (k, canonical(v))).collect();
            Value::Object(sorted.into_iter().map(|(k, v)| (k.clone(), v)).collect())
        }
        Value::Array(values) => values.iter().map(canonical).collect(),
        other => other.clone(),
    }
}

/// What is known of a data file: hashed again when its length or time of change is another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Known {
    bytes: u64,
    modified_ns: u64,
    hash: Hash,
}

/// Hashes of data sets, remembered in a file from one run to the next.
pub struct DataHashes {
    memory: PathBuf,
    known: RefCell<BTreeMap<PathBuf, Known>>,
}

impl DataHashes {
    /// Reads what earlier runs found; an unreadable file counts as none.
    pub fn open(memory: &Path) -> DataHashes {
        let known = std::fs::read(memory).ok();
        let known = known.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        DataHashes {
            memory: memory.to_path_buf(),
            known: RefCell::new(known.unwrap_or_default()),
        }
    }

    /// Of a file's content, or of the names and contents of all files below a folder.
    pub fn of(&self, path: &Path) -> Result<Hash> {
        let hash = self.read(path)?;
        let text = serde_json::to_vec(&*self.known.borrow())?;
        std::fs::write(&self.memory, text)
            .with_context(|| format!("writing {}", self.memory.display()))?;
        Ok(hash)
    }

    fn read(&self, path: &Path) -> Result<Hash> {
        let about = std::fs::metadata(path);
        let about = about.with_context(|| format!("reading {}", path.display()))?;
        if !about.is_dir() {
            return self.of_file(path, &about);
        }
        let entries = std::fs::read_dir(path)?.map(|entry| Ok(entry?.path()));
        let mut paths: Vec<PathBuf> = entries.collect::<Result<_>>()?;
        paths.sort();
        let mut list = String::new();
        for path in paths {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            list += &format!("{name}\0{}\n", self.read(&path)?.0);
        }
        Ok(Hash::of(list.as_bytes()))
    }

    fn of_file(&self, path: &Path, about: &std::fs::Metadata) -> Result<Hash> {
        let modified = about.modified()?.duration_since(UNIX_EPOCH);
        let modified_ns = modified.map_or(0, |time| time.as_nanos() as u64);
        let bytes = about.len();
        let known = self.known.borrow().get(path).cloned();
        if let Some(known) = known
            && (known.bytes, known.modified_ns) == (bytes, modified_ns)
        {
            return Ok(known.hash);
        }
        let hash = Hash::of_file(path)?;
        let known = Known {
            bytes,
            modified_ns,
            hash: hash.clone(),
        };
        self.known.borrow_mut().insert(path.to_path_buf(), known);
        Ok(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn keys_have_no_order_and_values_count() {
        let a: Value = serde_json::from_str(r#"{"b": [1, {"d": 2, "c": 3}], "a": 0.5}"#).unwrap();
        let b: Value = serde_json::from_str(r#"{"a": 0.5, "b": [1, {"c": 3, "d": 2}]}"#).unwrap();
        assert_eq!(Hash::of_json(&a), Hash::of_json(&b));
        assert_ne!(Hash::of_json(&a), Hash::of_json(&json!({"a": 0.5})));
    }

    #[test]
    fn a_known_answer() {
        let digits = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Hash::of(b"abc").0, digits);
    }
}
