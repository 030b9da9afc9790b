//! Runs the programs that are measured, and reads what they write.

use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

/// The built programs, the model that they are given, and a folder for what they write.
pub struct Programs {
    folder: PathBuf,
    model: PathBuf,
    /// Tables and JSON of the programs.
    pub scratch: PathBuf,
    /// Of the programs and the model.
    pub fingerprint: u64,
}

impl Programs {
    /// Builds the programs (their packages and names), and copies them and the model to the folder,
    /// so that they do not change while the source is worked on.
    pub fn build(
        root: &Path,
        model: &Path,
        scratch: PathBuf,
        programs: &[(&str, &str)],
    ) -> Result<Self> {
        let mut cargo = Command::new("cargo");
        cargo.args(["build", "--release"]);
        for (package, _) in programs {
            cargo.args(["-p", package]);
        }
        succeed(cargo.current_dir(root))?;
        let target = std::env::var_os("CARGO_TARGET_DIR");
        let built = target
            .map_or_else(|| root.join("target"), PathBuf::from)
            .join("release");
        let mut hasher = DefaultHasher::new();
        let folder = scratch.join("programs");
        std::fs::create_dir_all(&folder)?;
        for (_, name) in programs {
            let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
            // A copy that still runs cannot be written to, but it can be replaced.
            let copy = folder.join(&name);
            if copy.exists() {
                std::fs::remove_file(&copy)?;
            }
            std::fs::copy(built.join(&name), &copy).context(name)?;
            std::fs::read(&copy)?.hash(&mut hasher);
        }
        let copy = scratch.join("measured.posewise");
        std::fs::copy(model, &copy).with_context(|| model.display().to_string())?;
        std::fs::read(&copy)?.hash(&mut hasher);
        Ok(Self {
            fingerprint: hasher.finish(),
            folder,
            model: copy,
            scratch,
        })
    }

    /// The JSON that `PROGRAM ARGS --json FILE` writes. Without `model` the program measures tables
    /// that were written before.
    pub fn json<A: AsRef<OsStr>>(&self, program: &str, args: &[A], model: bool) -> Result<Value> {
        let file = self.scratch.join("result.json");
        let mut command = Command::new(self.folder.join(program));
        command.args(args).arg("--json").arg(&file);
        if model {
            command.arg("--model").arg(&self.model);
        }
        succeed(command.stdout(Stdio::null()))?;
        let text = std::fs::read_to_string(&file)?;
        Ok(without_paths(serde_json::from_str(&text)?))
    }

    /// Tracks an input, with these further arguments; the table of frames.
    pub fn track<A: AsRef<OsStr>>(&self, input: &Path, args: &[A], csv: &Path) -> Result<Table> {
        succeed(self.tracker(args, csv).arg(input))?;
        Table::read(csv)
    }

    /// Tracks what ffmpeg makes of a clip by these arguments.
    pub fn track_filtered(&self, clip: &Path, ffmpeg: &[&str], args: &[&str]) -> Result<Table> {
        let mut decoder = Command::new("ffmpeg");
        decoder.args(["-v", "error", "-i"]).arg(clip).args(ffmpeg);
        decoder.args(["-strict", "-1", "-f", "yuv4mpegpipe", "-"]);
        let mut running = decoder.stdout(Stdio::piped()).spawn().context("ffmpeg")?;
        let csv = self.scratch.join("filtered.csv");
        let pipe = running.stdout.take().context("ffmpeg has no output")?;
        succeed(self.tracker(args, &csv).arg("-").stdin(pipe))?;
        ensure!(
            running.wait()?.success(),
            "ffmpeg failed on {}",
            clip.display()
        );
        Table::read(&csv)
    }

    fn tracker<A: AsRef<OsStr>>(&self, args: &[A], csv: &Path) -> Command {
        let mut command = Command::new(self.folder.join("posewise"));
        command.arg("track").arg("--quiet").args(args);
        command
            .arg("--csv")
            .arg(csv)
            .arg("--model")
            .arg(&self.model);
        command
    }
}

/// Runs a program to its end; a failure is an error that names it.
pub fn succeed(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot run {command:?}"))?;
    if !status.success() {
        bail!("{command:?}: {status}");
    }
    Ok(())
}

/// A table of numbers with named columns; words count as 0.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a CSV file with a header.
    pub fn read(path: &Path) -> Result<Self> {
        let mut reader = csv::Reader::from_path(path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let names = reader.headers()?.iter().map(String::from).collect();
        let numbers =
            |row: csv::StringRecord| row.iter().map(|c| c.parse().unwrap_or(0.0)).collect();
        let rows: Result<_, _> = reader.records().map(|row| row.map(numbers)).collect();
        Ok(Self { names, rows: rows? })
    }

    /// The values of one column.
    pub fn column(&self, name: &str) -> Result<Vec<f64>> {
        let at = self.names.iter().position(|n| n == name);
        let at = at.with_context(|| format!("no column {name}"))?;
        Ok(self.rows.iter().map(|row| row[at]).collect())
    }

    /// How many frames there are, and in how many of them the face was tracked.
    pub fn tracked(&self) -> Result<(usize, usize)> {
        let success = self.column("success")?;
        Ok((success.len(), success.iter().filter(|s| **s > 0.5).count()))
    }
}

/// Reduces paths to the name of the file, so that figures do not depend on where the data lie, and
/// numbers to six significant digits.
fn without_paths(value: Value) -> Value {
    let name = |text: String| text.rsplit('/').next().unwrap_or_default().to_string();
    match value {
        Value::String(text) => name(text).into(),
        Value::Array(list) => list.into_iter().map(without_paths).collect(),
        Value::Object(map) => {
            let entries = map
                .into_iter()
                .map(|(key, v)| (name(key), without_paths(v)));
            entries.collect::<serde_json::Map<_, _>>().into()
        }
        Value::Number(n) if n.is_f64() => rounded(n.as_f64().unwrap_or_default()).into(),
        other => other,
    }
}

fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn paths_and_long_numbers_are_shortened() {
        let value = json!({"/data/a.csv": [0.123456789, 7, "x/y.png"], "b": null});
        let short = json!({"a.csv": [0.123457, 7, "y.png"], "b": null});
        assert_eq!(without_paths(value), short);
    }
}
