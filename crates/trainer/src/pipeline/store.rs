//! Where outputs of stages are kept: a folder for each, with a manifest once it is complete.

use super::hash::{DataHashes, Hash};
use super::stage::{Manifest, Stage};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest.json";

/// The folder of all outputs.
pub struct Store {
    folder: PathBuf,
    data: DataHashes,
}

/// A complete output.
#[derive(Clone, Debug)]
pub struct Output {
    folder: PathBuf,
    manifest: Manifest,
}

impl Output {
    /// Where one of its files is.
    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// The content hash of one of its files.
    pub fn hash(&self, file: &str) -> Result<Hash> {
        let hash = self.manifest.outputs.get(file);
        let missing = || format!("stage {} makes no {file}", self.manifest.stage);
        hash.cloned().with_context(missing)
    }

    /// The content of one of its files.
    pub fn read(&self, file: &str) -> Result<Vec<u8>> {
        let path = self.path(file);
        std::fs::read(&path).with_context(|| format!("reading {}", path.display()))
    }
}

impl Store {
    /// Opens the folder, which is made where there is none.
    pub fn open(folder: &Path) -> Result<Store> {
        std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
        Ok(Store {
            folder: folder.to_path_buf(),
            data: DataHashes::open(&folder.join("data-hashes.json")),
        })
    }

    /// The content hash of a data set: a file or a folder.
    pub fn data(&self, path: &Path) -> Result<Hash> {
        self.data.of(path)
    }

    /// The stage's output: as it is kept, or made by `make`, which writes `files` into the folder
    /// that it is given. What an interrupted run left in that folder (checkpoints) is still there
    /// when the stage is made again. An output that is not what its manifest says is removed and
    /// made anew.
    pub fn make(
        &self,
        stage: &Stage,
        files: &[&str],
        make: impl FnOnce(&Path) -> Result<()>,
    ) -> Result<Output> {
        let folder = self.folder.join(stage.folder());
        if folder.join(MANIFEST).exists() {
            match kept(&folder, stage, files) {
                Ok(output) => {
                    println!("{}: from {}", stage.name(), folder.display());
                    return Ok(output);
                }
                Err(error) => {
                    println!("{}: made anew, {error:#}", stage.name());
                    std::fs::remove_dir_all(&folder)?;
                }
            }
        }
        std::fs::create_dir_all(&folder)?;
        println!("{}: making {}", stage.name(), folder.display());
        make(&folder).with_context(|| format!("stage {}", stage.name()))?;
        let manifest = stage.manifest(hashes(&folder, files)?);
        let whole = serde_json::to_vec_pretty(&manifest)?;
        let part = folder.join("manifest.part");
        std::fs::write(&part, whole)?;
        std::fs::rename(&part, folder.join(MANIFEST))?;
        Ok(Output { folder, manifest })
    }
}

fn hashes(folder: &Path, files: &[&str]) -> Result<BTreeMap<String, Hash>> {
    let hash = |file: &&str| Ok((file.to_string(), Hash::of_file(&folder.join(file))?));
    files.iter().map(hash).collect()
}

/// The output in a folder, if it is whole and of this stage.
fn kept(folder: &Path, stage: &Stage, files: &[&str]) -> Result<Output> {
    let bytes = std::fs::read(folder.join(MANIFEST))?;
    let manifest: Manifest = serde_json::from_slice(&bytes).context("the manifest is damaged")?;
    ensure!(manifest.key == stage.key(), "it is another stage's");
    let present = hashes(folder, files)?;
    ensure!(manifest.outputs == present, "its files are damaged");
    Ok(Output {
        folder: folder.to_path_buf(),
        manifest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;
    use serde::Serialize;
    use std::cell::Cell;

    #[derive(Serialize)]
    struct Options {
        seed: u64,
    }

    /// The same options after their field was renamed.
    #[derive(Serialize)]
    struct Renamed {
        #[serde(rename = "seed")]
        random_seed: u64,
    }

    /// Two stages on a data set, the second on the output of the first, and one on another data
    /// set.
    struct Fake {
        folder: tempfile::TempDir,
        runs: [Cell<usize>; 3],
    }

    impl Fake {
        fn new() -> Fake {
            let fake = Fake {
                folder: tempfile::tempdir().unwrap(),
                runs: Default::default(),
            };
            std::fs::create_dir(fake.at("pictures")).unwrap();
            fake.write("pictures/a.txt", "a");
            fake.write("other.txt", "o");
            fake
        }

        fn at(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn write(&self, name: &str, text: &str) {
            std::fs::write(self.at(name), text).unwrap();
        }

        fn run(&self, options: &impl Serialize) -> [Output; 3] {
            let store = Store::open(&self.at("cache")).unwrap();
            let data = |name: &str| store.data(&self.at(name)).unwrap();
            let make = |index: usize, stage: &Stage, text: String| {
                let write = |folder: &Path| {
                    self.runs[index].set(self.runs[index].get() + 1);
                    Ok(std::fs::write(folder.join("out"), &text)?)
                };
                store.make(stage, &["out"], write).unwrap()
            };
            let first = Stage::new("first", 1).input("pictures", data("pictures"));
            let first = first.options(options).unwrap();
            let key = first.key();
            let first = make(0, &first, format!("first of {}", key.short()));
            let second = Stage::new("second", 1).input("first", first.hash("out").unwrap());
            let second = make(1, &second, "second".into());
            let apart = Stage::new("apart", 1).input("other", data("other.txt"));
            [first, second, make(2, &apart, "apart".into())]
        }

        fn runs(&self) -> [usize; 3] {
            self.runs.each_ref().map(Cell::get)
        }
    }

    #[test]
    fn a_second_run_makes_nothing() {
        let fake = Fake::new();
        fake.run(&Options { seed: 1 });
        let [first, ..] = fake.run(&Options { seed: 1 });
        assert_eq!(fake.runs(), [1, 1, 1]);
        assert!(first.read("out").unwrap().starts_with(b"first of"));
        assert!(first.hash("nothing").is_err());
    }

    #[test]
    fn a_changed_data_set_makes_what_depends_on_it() {
        let fake = Fake::new();
        fake.run(&Options { seed: 1 });
        fake.write("pictures/b.txt", "b");
        fake.run(&Options { seed: 1 });
        assert_eq!(fake.runs(), [2, 2, 1]);
        fake.write("pictures/b.txt", "longer");
        fake.run(&Options { seed: 1 });
        assert_eq!(fake.runs(), [3, 3, 1]);
    }

    #[test]
    fn a_changed_option_makes_what_depends_on_it() {
        let fake = Fake::new();
        fake.run(&Options { seed: 1 });
        fake.run(&Options { seed: 2 });
        assert_eq!(fake.runs(), [2, 2, 1]);
        // Both outputs are kept.
        fake.run(&Options { seed: 1 });
        assert_eq!(fake.runs(), [2, 2, 1]);
    }

    #[test]
    fn a_renamed_field_makes_nothing() {
        let fake = Fake::new();
        fake.run(&Options { seed: 1 });
        fake.run(&Renamed { random_seed: 1 });
        assert_eq!(fake.runs(), [1, 1, 1]);
    }

    #[test]
    fn a_damaged_output_is_made_anew() {
        let fake = Fake::new();
        let [first, second, _] = fake.run(&Options { seed: 1 });
        std::fs::write(first.path("out"), "damaged").unwrap();
        std::fs::write(second.path(MANIFEST), "{").unwrap();
        let [first, ..] = fake.run(&Options { seed: 1 });
        assert_eq!(fake.runs(), [2, 2, 1]);
        assert!(first.read("out").unwrap().starts_with(b"first of"));
    }

    #[test]
    fn an_interrupted_run_goes_on() {
        let fake = Fake::new();
        let store = Store::open(&fake.at("cache")).unwrap();
        let stage = Stage::new("long", 1);
        let interrupted = store.make(&stage, &["out"], |folder| {
            std::fs::write(folder.join("checkpoint"), "half")?;
            bail!("interrupted")
        });
        assert!(interrupted.is_err());
        let output = store.make(&stage, &["out"], |folder| {
            let half = std::fs::read_to_string(folder.join("checkpoint"))?;
            Ok(std::fs::write(folder.join("out"), half + " and whole")?)
        });
        assert_eq!(output.unwrap().read("out").unwrap(), b"half and whole");
    }

    #[test]
    fn another_version_is_another_output() {
        let [a, b] = [1, 2].map(|version| Stage::new("stage", version).key());
        assert_ne!(a, b);
    }
}
