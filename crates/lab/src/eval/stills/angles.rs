//! `posewise-lab eval angles`: stills of heads whose yaw and pitch a table gives.

use std::collections::HashSet;
use std::path::PathBuf;

use anyhow::Result;
use posewise::TrackResult;
use posewise_cli::parse::within;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::angle_metrics::{Angles, Found, Outcome, PITCH_BANDS, PITCH_YAW_DEG, by_pitch, by_yaw};
use super::still::{Stills, StillsArgs};
use crate::output;
use crate::table::Table;

/// Options of `posewise-lab eval angles`.
#[derive(clap::Args)]
pub struct Args {
    /// Labels: image,pitch_deg,yaw_deg; with a column identity the people are counted
    #[arg(long, value_name = "FILE")]
    pub csv: PathBuf,
    /// In the labels, yaw > 0 turns the face to the image left
    #[arg(long)]
    pub yaw_left: bool,
    /// Focal length [px] [default: unknown; a field of view of 60° is assumed]
    #[arg(long, value_name = "PX", value_parser = within(1.0_f32, 1e6))]
    pub focal: Option<f32>,
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
    let mut stills = Stills::new(&args.stills)?;
    stills.focal = args.focal;
    let outcomes = stills.each(&labels, |show, _, label| {
        let fit = show.fit_file(&args.stills.images, &label.image)?;
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
    if let Some(path) = &args.stills.per_image {
        output::write_rows(path, labels.iter().zip(&outcomes).map(ImageRow::of))?;
    }
    let yaw: Map<String, Value> = yaw.iter().map(|(n, b)| (n.to_string(), b.json())).collect();
    let figures = json!({
        "pictures": labels.len(),
        "people": (!people.contains("")).then_some(people.len()),
        "focal_px": args.focal,
        "yaw_by_pitch": yaw,
        "pitch": pitch.json(),
        "steps_after_found": args.stills.steps,
        "min_face_px": args.stills.min_face,
    });
    output::show(&figures, args.stills.json.as_deref())
}

/// What `--per-image` writes of a picture.
#[derive(Serialize)]
struct ImageRow<'a> {
    image: &'a str,
    yaw_deg: f64,
    pitch_deg: f64,
    found: u8,
    at_once: u8,
    facing_yaw_deg: Option<f64>,
    facing_pitch_deg: Option<f64>,
    axis_yaw_deg: Option<f64>,
    axis_pitch_deg: Option<f64>,
}

impl<'a> ImageRow<'a> {
    fn of((label, outcome): (&'a Label, &Outcome)) -> Self {
        let [facing, axis] = [0, 1].map(|k| outcome.found.map(|f| f.angles[k]));
        ImageRow {
            image: &label.image,
            yaw_deg: label.angles.yaw,
            pitch_deg: label.angles.pitch,
            found: outcome.found.is_some().into(),
            at_once: outcome.found.is_some_and(|f| f.is_at_once).into(),
            facing_yaw_deg: facing.map(|a| a.yaw),
            facing_pitch_deg: facing.map(|a| a.pitch),
            axis_yaw_deg: axis.map(|a| a.yaw),
            axis_pitch_deg: axis.map(|a| a.pitch),
        }
    }
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
