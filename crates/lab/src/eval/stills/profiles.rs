//! `posewise-lab eval profiles`: stills of profiles on which only the seen half is marked.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::profile_metrics::{BANDS, Found, Marked, Outcome, Summary, errors, summarize, unit};
use super::still::{Stills, StillsArgs};
use crate::output;
use crate::table::Table;

/// Options of `posewise-lab eval profiles`.
#[derive(clap::Args)]
pub struct Args {
    /// Labels: image,kind,half,yaw_geometric_deg,x0,y0,…,x67,y67; landmarks that are not marked are
    /// empty
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    #[command(flatten)]
    pub stills: StillsArgs,
}

/// One labelled picture.
pub struct Label {
    /// File name.
    pub image: String,
    /// Whether it is called a profile.
    pub is_profile: bool,
    /// The marked landmarks \[px\].
    pub marked: Marked,
    /// Distance from chin to brow \[px\].
    pub unit: f64,
    /// > 0: to the image right \[deg\].
    geometric_yaw: f64,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let labels = read_labels(&args.csv)?;
    let outcomes = Stills::new(&args.stills)?.each(&labels, |show, _, label| {
        let fit = show.fit_file(&args.stills.images, &label.image)?;
        let found = fit.and_then(|fit| {
            let points = fit.result.landmarks.map(|l| [l.x, l.y].map(f64::from));
            let [inner, jaw] = errors(&label.marked, label.unit, &points)?;
            Some(Found {
                inner,
                jaw,
                facing_yaw: fit.result.facing_yaw_deg.into(),
                is_at_once: fit.is_at_once,
            })
        });
        Ok(Outcome {
            is_profile: label.is_profile,
            geometric_yaw: label.geometric_yaw,
            found,
        })
    })?;
    let kinds = ["frontal", "profile"].map(|kind| {
        let of = outcomes
            .iter()
            .filter(|o| o.is_profile == (kind == "profile"));
        (kind, summarize(of))
    });
    let bands = BANDS.map(|(name, from, to)| {
        let inside = |o: &&Outcome| (from..to).contains(&o.geometric_yaw.abs());
        (name, summarize(outcomes.iter().filter(inside)))
    });
    if let Some(path) = &args.stills.per_image {
        output::write_rows(path, labels.iter().zip(&outcomes).map(ImageRow::of))?;
    }
    let of = |sets: &[(&str, Summary)]| -> Map<String, Value> {
        let named = sets.iter().map(|(name, s)| (name.to_string(), json!(s)));
        named.collect()
    };
    let figures = json!({
        "kinds": of(&kinds),
        "yaw_bands": of(&bands),
        "steps_after_found": args.stills.steps,
        "min_face_px": args.stills.min_face,
    });
    output::show(&figures, args.stills.json.as_deref())
}

/// What `--per-image` writes of a picture.
#[derive(Serialize)]
struct ImageRow<'a> {
    image: &'a str,
    kind: &'static str,
    found: u8,
    at_once: u8,
    inner: Option<f64>,
    jaw: Option<f64>,
    geometric_yaw_deg: f64,
    facing_yaw_deg: Option<f64>,
}

impl<'a> ImageRow<'a> {
    fn of((label, outcome): (&'a Label, &Outcome)) -> Self {
        let found = outcome.found.as_ref();
        ImageRow {
            image: &label.image,
            kind: if outcome.is_profile {
                "profile"
            } else {
                "frontal"
            },
            found: found.is_some().into(),
            at_once: found.is_some_and(|f| f.is_at_once).into(),
            inner: found.map(|f| f.inner),
            jaw: found.map(|f| f.jaw),
            geometric_yaw_deg: label.geometric_yaw,
            facing_yaw_deg: found.map(|f| f.facing_yaw),
        }
    }
}

/// Reads a table of labels.
pub fn read_labels(path: &Path) -> Result<Vec<Label>> {
    let table = Table::read(path)?;
    let (image, kind) = (table.column("image")?, table.column("kind")?);
    let yaw = table.column("yaw_geometric_deg")?;
    let (xs, ys) = (table.columns68("x")?, table.columns68("y")?);
    let label = |row: usize| -> Result<Label> {
        let mut marked = [None; 68];
        for (i, mark) in marked.iter_mut().enumerate() {
            if !table.text(row, xs[i]).is_empty() {
                *mark = Some([table.number(row, xs[i])?, table.number(row, ys[i])?]);
            }
        }
        Ok(Label {
            image: table.text(row, image).to_string(),
            is_profile: table.text(row, kind) == "profile",
            unit: unit(&marked).context("chin or brow is not marked")?,
            marked,
            // In the table, yaw > 0 looks to the image left.
            geometric_yaw: -table.number(row, yaw)?,
        })
    };
    let of_row = |row: usize| {
        label(row).with_context(|| format!("{}: {}", path.display(), table.text(row, image)))
    };
    (0..table.len()).map(of_row).collect()
}
