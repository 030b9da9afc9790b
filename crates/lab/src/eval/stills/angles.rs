//! `posewise-lab eval angles`: stills of heads whose yaw and pitch a table gives.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use posewise::TrackResult;
use posewise_cli::parse::within;
use posewise_cli::picture::Picture;
use posewise_cli::source::read_rgb;
use serde_json::{Map, Value, json};

use super::angle_metrics::{
    Angles, Block, Found, Outcome, PITCH_BANDS, PITCH_YAW_DEG, by_pitch, by_yaw,
};
use super::still::{Stills, StillsArgs};
use crate::output;
use crate::table::Table;

/// Options of `posewise-lab eval angles`.
#[derive(clap::Args)]
pub struct Args {
    /// Labels: image,pitch_deg,yaw_deg; with a column identity the people are counted
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// Folder of the pictures that the labels name
    #[arg(long, value_name = "DIR")]
    pub images: PathBuf,
    /// In the labels, yaw > 0 turns the face to the image left
    #[arg(long)]
    pub yaw_left: bool,
    /// Focal length [px] [default: unknown; a field of view of 60° is assumed]
    #[arg(long, value_name = "PX", value_parser = within(1.0_f32, 1e6))]
    pub focal: Option<f32>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per picture: found, angles
    #[arg(long, value_name = "FILE")]
    pub per_image: Option<PathBuf>,
    #[command(flatten)]
    pub stills: StillsArgs,
}

/// One labelled picture.
struct Label {
    image: String,
    /// Empty where the table has no such column.
    identity: String,
    angles: Angles,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let labels = read_labels(args)?;
    if !args.images.is_dir() {
        bail!("no such folder: {}", args.images.display());
    }
    let mut stills = Stills::new(&args.stills)?;
    stills.focal = args.focal;
    let outcomes = stills.each(&labels, |show, _, label| {
        let picture = Picture::from_rgb(read_rgb(&args.images.join(&label.image))?);
        let fit = show
            .fit(picture, None)
            .with_context(|| label.image.clone())?;
        Ok(Outcome {
            label: label.angles,
            found: fit.map(|fit| Found {
                angles: angles_of(&fit.result),
                is_at_once: fit.is_at_once,
            }),
        })
    })?;
    let yaw = PITCH_BANDS.map(|(name, above, to)| {
        let inside = |o: &&Outcome| above < o.label.pitch.abs() && o.label.pitch.abs() <= to;
        (name, by_yaw(outcomes.iter().filter(inside)))
    });
    let ahead = |o: &&Outcome| o.label.yaw.abs() <= PITCH_YAW_DEG;
    let pitch = by_pitch(outcomes.iter().filter(ahead));
    let people: HashSet<&str> = labels.iter().map(|l| l.identity.as_str()).collect();
    let mut out = format!("{} pictures", labels.len());
    if !people.contains("") {
        let _ = write!(out, " of {} people", people.len());
    }
    let camera = args
        .focal
        .map_or("unknown camera".into(), |f| format!("focal length {f} px"));
    let _ = writeln!(out, ", {camera}");
    for (name, block) in &yaw {
        report(&mut out, &format!("|yaw|, |pitch| {name}"), block);
    }
    report(
        &mut out,
        &format!("pitch, |yaw| to {PITCH_YAW_DEG}"),
        &pitch,
    );
    output::print(&out)?;
    if let Some(path) = &args.per_image {
        write_per_image(path, &labels, &outcomes)?;
    }
    if let Some(path) = &args.json {
        let yaw: Map<String, Value> = yaw.iter().map(|(n, b)| (n.to_string(), b.json())).collect();
        let value = json!({
            "pictures": labels.len(),
            "focal_px": args.focal,
            "yaw_by_pitch": yaw,
            "pitch": pitch.json(),
            "steps_after_found": args.stills.steps,
            "min_face_px": args.stills.min_face,
        });
        output::write_json(path, &value)?;
    }
    Ok(())
}

fn read_labels(args: &Args) -> Result<Vec<Label>> {
    let table = Table::read(&args.csv)?;
    let image = table.column("image")?;
    let identity = table.column("identity").ok();
    let (yaw, pitch) = (table.column("yaw_deg")?, table.column("pitch_deg")?);
    let label = |row: usize| {
        let to_right = table.number(row, yaw)?;
        Ok(Label {
            image: table.text(row, image).to_string(),
            identity: identity.map_or("", |at| table.text(row, at)).to_string(),
            angles: Angles {
                yaw: if args.yaw_left { -to_right } else { to_right },
                pitch: table.number(row, pitch)?,
            },
        })
    };
    (0..table.len()).map(label).collect()
}

/// Relative to the line of sight, and along the camera's axes.
fn angles_of(fit: &TrackResult) -> [Angles; 2] {
    [
        (fit.facing_yaw_deg, fit.facing_pitch_deg),
        (fit.yaw_deg, fit.pitch_deg),
    ]
    .map(|(yaw, pitch)| Angles {
        yaw: yaw.into(),
        pitch: pitch.into(),
    })
}

fn report(out: &mut String, title: &str, block: &Block) {
    let degrees = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.1}"));
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "\n{title}\n{:<8}{:>8}{:>9}{:>11}{:>9}{:>8}{:>9}{:>8}",
        "label", "images", "found %", "at once %", "facing", "error", "axis", "error"
    );
    for row in &block.rows {
        let [found, at_once] =
            [row.found, row.at_once].map(|part| 100.0 * part as f64 / row.count.max(1) as f64);
        let _ = write!(
            out,
            "{:<8}{:>8}{found:>9.1}{at_once:>11.1}",
            row.label, row.count
        );
        for angle in row.angles {
            let _ = write!(
                out,
                "{:>9}{:>8}",
                degrees(angle.median),
                degrees(angle.error)
            );
        }
        let _ = writeln!(out);
    }
    let slope = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.3}"));
    let [facing, axis] = block.slopes.map(slope);
    let _ = writeln!(out, "{:<36}{facing:>9}{axis:>17}", "slope");
}

fn write_per_image(path: &Path, labels: &[Label], outcomes: &[Outcome]) -> Result<()> {
    let mut out = csv::Writer::from_writer(output::create(path)?);
    let context = || format!("cannot write {}", path.display());
    out.write_record([
        "image",
        "yaw_deg",
        "pitch_deg",
        "found",
        "at_once",
        "facing_yaw_deg",
        "facing_pitch_deg",
        "axis_yaw_deg",
        "axis_pitch_deg",
    ])
    .with_context(context)?;
    for (label, outcome) in labels.iter().zip(outcomes) {
        let flag = |is: bool| if is { "1" } else { "0" };
        let number = |k: usize, of: fn(&Angles) -> f64| {
            outcome
                .found
                .map_or(String::new(), |f| format!("{:.2}", of(&f.angles[k])))
        };
        out.write_record([
            label.image.as_str(),
            &label.angles.yaw.to_string(),
            &label.angles.pitch.to_string(),
            flag(outcome.found.is_some()),
            flag(outcome.found.is_some_and(|f| f.is_at_once)),
            &number(0, |a| a.yaw),
            &number(0, |a| a.pitch),
            &number(1, |a| a.yaw),
            &number(1, |a| a.pitch),
        ])
        .with_context(context)?;
    }
    out.flush().with_context(context)
}
