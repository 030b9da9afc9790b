//! `posewise-lab eval profiles`: stills of profiles on which only the seen half is marked.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use posewise_cli::picture::Picture;
use posewise_cli::source::read_rgb;
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
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, errors, yaw
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

/// One labelled picture.
struct Label {
    image: String,
    is_profile: bool,
    marked: Marked,
    /// Distance from chin to brow \[px\].
    unit: f64,
    /// > 0: to the image right \[deg\].
    geometric_yaw: f64,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let labels = read_labels(&args.csv)?;
    if !args.images.is_dir() {
        bail!("no such folder: {}", args.images.display());
    }
    let outcomes = Stills::new(&args.stills)?.each(&labels, |show, _, label| {
        let picture = Picture::from_rgb(read_rgb(&args.images.join(&label.image))?);
        let fit = show
            .fit(picture, None)
            .with_context(|| label.image.clone())?;
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
    output::print(&report(&kinds, &bands))?;
    if let Some(path) = &args.per_image {
        write_per_image(path, &labels, &outcomes)?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &to_json(args, &kinds, &bands))?;
    }
    Ok(())
}

fn read_labels(path: &Path) -> Result<Vec<Label>> {
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

fn report(kinds: &[(&str, Summary)], bands: &[(&str, Summary)]) -> String {
    let percent = |v: Option<f64>| v.map_or("–".into(), |v| format!("{:.2}", 100.0 * v));
    let degrees = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.1}"));
    let mut out = format!(
        "{:<12}{:>7}{:>9}{:>9}{:>9}{:>9}\n",
        "[%]", "images", "found", "at once", "inner", "jaw"
    );
    for (name, s) in kinds {
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{name:<12}{:>7}{:>9}{:>9}{:>9}{:>9}",
            s.count,
            percent(s.share(s.found)),
            percent(s.share(s.at_once)),
            percent(s.inner),
            percent(s.jaw),
        );
    }
    let _ = writeln!(
        out,
        "{:<12}{:>7}{:>9}{:>9}{:>9}{:>9}{:>11}{:>9}{:>12}",
        "|yaw| [deg]",
        "images",
        "found",
        "at once",
        "inner",
        "jaw",
        "geometric",
        "facing",
        "difference"
    );
    for (name, s) in bands {
        let _ = writeln!(
            out,
            "{name:<12}{:>7}{:>9}{:>9}{:>9}{:>9}{:>11}{:>9}{:>12}",
            s.count,
            percent(s.share(s.found)),
            percent(s.share(s.at_once)),
            percent(s.inner),
            percent(s.jaw),
            degrees(s.geometric_deg),
            degrees(s.facing_deg),
            degrees(s.difference_deg),
        );
    }
    out
}

fn to_json(args: &Args, kinds: &[(&str, Summary)], bands: &[(&str, Summary)]) -> Value {
    let of = |sets: &[(&str, Summary)]| -> Map<String, Value> {
        sets.iter()
            .map(|(name, s)| (name.to_string(), s.json()))
            .collect()
    };
    json!({
        "kinds": of(kinds),
        "yaw_bands": of(bands),
        "steps_after_found": args.stills.steps,
        "min_face_px": args.stills.min_face,
    })
}

fn write_per_image(path: &Path, labels: &[Label], outcomes: &[Outcome]) -> Result<()> {
    let mut out = csv::Writer::from_writer(output::create(path)?);
    let context = || format!("cannot write {}", path.display());
    out.write_record([
        "image",
        "kind",
        "found",
        "at_once",
        "inner",
        "jaw",
        "geometric_yaw_deg",
        "facing_yaw_deg",
    ])
    .with_context(context)?;
    for (label, outcome) in labels.iter().zip(outcomes) {
        let found = outcome.found.as_ref();
        let flag = |is: bool| if is { "1" } else { "0" };
        let number =
            |of: fn(&Found) -> f64| found.map_or(String::new(), |f| format!("{:.5}", of(f)));
        out.write_record([
            label.image.as_str(),
            if outcome.is_profile {
                "profile"
            } else {
                "frontal"
            },
            flag(found.is_some()),
            flag(found.is_some_and(|f| f.is_at_once)),
            &number(|f| f.inner),
            &number(|f| f.jaw),
            &format!("{:.1}", label.geometric_yaw),
            &number(|f| f.facing_yaw),
        ])
        .with_context(context)?;
    }
    out.flush().with_context(context)
}
