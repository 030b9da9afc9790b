//! `posewise-lab eval identities`: is a head that was seen before told from others?
//!
//! Each clip is tracked by a tracker of its own, and what was learnt in it is saved. Then each
//! record is compared with what was seen in each other clip, of the same person or of others.

use crate::footage::clip::Clip;
use crate::table::Table;
use crate::{output, video};
use anyhow::{Context, Result, anyhow, ensure};
use posewise::{Config, Intrinsics, Likeness, Model, Tracker};
use posewise_cli::model_file::ModelFile;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Options of `posewise-lab eval identities`.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of `render-u3pt`: folders of clips, of which those of one name show one person
    #[arg(long, value_name = "DIR")]
    pub people: PathBuf,
    /// The model [default: the built-in one]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Most frames of a clip.
const MAX_FRAMES: usize = 3000;
/// Ending of a clip.
const CLIP: &str = ".y4m.gz";
/// Parts of the pairs below which the evidence is printed.
const QUANTILES: [f64; 7] = [0.0, 0.01, 0.05, 0.5, 0.95, 0.99, 1.0];

/// What a tracker knows after a clip.
struct Seen {
    person: String,
    tracker: Box<Tracker>,
    record: Vec<u8>,
}

/// What was said of pairs of a record and a clip.
#[derive(Default)]
struct Said {
    counts: [usize; Likeness::ALL.len()],
    evidence: Vec<f64>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = ModelFile::read(args.model.as_deref())?;
    let model = file.model()?;
    let clips = clips(&args.people)?;
    let seen: Result<Vec<_>> = clips.par_iter().map(|clip| see(&model, clip)).collect();
    let seen: Vec<Seen> = seen?.into_iter().flatten().collect();
    let [mut same, mut other] = [Said::default(), Said::default()];
    for (i, of) in seen.iter().enumerate() {
        for (j, with) in seen.iter().enumerate() {
            if i == j {
                continue;
            }
            let said = match of.person == with.person {
                true => &mut same,
                false => &mut other,
            };
            let tracker = &with.tracker;
            let likeness = tracker.compare_identity(&model, &of.record)?;
            let evidence = tracker.identity_evidence(&model, &of.record)?;
            said.counts[Likeness::ALL
                .iter()
                .position(|l| *l == likeness)
                .expect("all")] += 1;
            said.evidence.push(f64::from(evidence));
        }
    }
    let figures = json!({"clips": clips.len(), "tracked": seen.len(),
        "same person": figures(same), "other people": figures(other)});
    output::show(&figures, args.json.as_deref())
}

/// All clips below a folder.
fn clips(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for kind in std::fs::read_dir(folder).with_context(|| format!("{folder:?}"))? {
        let kind = kind?.path();
        if kind.is_dir() {
            for clip in std::fs::read_dir(kind)? {
                found.push(clip?.path());
            }
        }
    }
    found.retain(|path| path.to_string_lossy().ends_with(CLIP));
    found.sort();
    ensure!(found.len() > 1, "{folder:?} has no folders of clips");
    Ok(found)
}

/// Tracks a clip; nothing where no face was trusted.
fn see(model: &Model<'_>, path: &Path) -> Result<Option<Seen>> {
    let name = path.to_str().context("a path that is no text")?;
    let clip = Clip::open(name, 30.0, MAX_FRAMES)?;
    let truth = Table::read(Path::new(&name.replace(CLIP, ".csv")))?;
    let [fx, fy, cx, cy] = ["fx", "fy", "cx", "cy"].map(|name| {
        let column = truth.column(name)?;
        Ok::<_, anyhow::Error>(truth.number(0, column)? as f32)
    });
    let mut config = Config::default();
    config.intrinsics = Some(Intrinsics::new(fx?, fy?, cx?, cy?));
    let mut tracker = Box::new(Tracker::new(&config).map_err(|e| anyhow!("{e}"))?);
    for (i, luma) in clip.frames.iter().enumerate() {
        let time_us = (i as f64 * 1e6 / clip.fps) as i64;
        let step = tracker.step(model, &video::frame(luma)?, time_us);
        step.map_err(|e| anyhow!("{e}"))?;
    }
    let record = tracker.save_identity(model);
    let person = path.file_name().context("a name")?.to_string_lossy();
    Ok(record.map(|record| Seen {
        person: person.into_owned(),
        tracker,
        record: record.to_vec(),
    }))
}

fn figures(mut said: Said) -> Value {
    said.evidence.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let last = said.evidence.len().saturating_sub(1);
        said.evidence.get((part * last as f64).round() as usize)
    };
    let quantiles: Vec<_> = QUANTILES.iter().map(|part| at(*part)).collect();
    let mut figures = json!({"pairs": said.evidence.len(), "evidence": quantiles});
    for (likeness, count) in Likeness::ALL.iter().zip(said.counts) {
        figures[likeness.name()] = json!(count);
    }
    figures
}
