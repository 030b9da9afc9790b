//! The table that `posewise track --csv` writes: one row per frame.
//!
//! OpenFace 2's columns, names and units come first, so that scripts for its tables read ours;
//! then what OpenFace does not have. [`COLUMNS`] lists those that have other names than the fields
//! of C, or had a place before the table of fields was; fields that came later follow under their
//! own names, by themselves. A test compares docs/command-line.md with them. The list makes this
//! file longer than others.

use std::io::Write;

use anyhow::{Context, Result, anyhow};
use glam::{Mat3, Quat};
use posewise::eyes::{EYE_LOOK_NAMES, Eye, EyeUnknown, Eyes};
use posewise::{ANIMATION_NAMES, LANDMARKS, Loss, State, TrackResult};

use crate::fields::FIELDS;
use crate::value::{Cell, Field, MaybeGaze, camera, head, num, share, sigma_deg};

/// What one row is made of.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    /// Number of the frame, from 1 as in OpenFace.
    pub frame: u64,
    /// Number of the tracker, from 0.
    pub face_id: usize,
    /// The tracker's result.
    pub result: &'a TrackResult,
}

/// The names of a group of columns.
#[derive(Clone, Copy)]
pub enum Names {
    /// One column.
    One(&'static str),
    /// `name_0` … `name_67`.
    PerLandmark(&'static str),
    /// ARKit's blendshape names.
    Animations,
    /// Several columns.
    List(&'static [&'static str]),
    /// A field under its own name, with its decimals.
    Field(&'static Field, usize),
}

/// A group of columns.
#[derive(Clone, Copy)]
pub struct Column {
    /// Names.
    pub names: Names,
    /// Unit, for the docs.
    pub unit: &'static str,
    /// Meaning, for the docs.
    pub meaning: &'static str,
    /// The value of the group's n-th column.
    pub value: fn(&Row<'_>, usize) -> Cell,
}

type Text = &'static str;
type Value = fn(&Row<'_>, usize) -> Cell;

const fn column(names: Names, unit: Text, meaning: Text, value: Value) -> Column {
    Column {
        names,
        unit,
        meaning,
        value,
    }
}

const fn one(name: Text, unit: Text, meaning: Text, value: Value) -> Column {
    column(Names::One(name), unit, meaning, value)
}

const fn per_landmark(name: Text, unit: Text, meaning: Text, value: Value) -> Column {
    column(Names::PerLandmark(name), unit, meaning, value)
}

const fn list(names: &'static [Text], unit: Text, meaning: Text, value: Value) -> Column {
    column(Names::List(names), unit, meaning, value)
}

fn landmark(row: &Row<'_>, i: usize) -> posewise::Landmark {
    row.result.landmarks.get(i).copied().unwrap_or_default()
}

fn point(row: &Row<'_>, i: usize, axis: usize) -> Cell {
    let point = row.result.points_mm.get(i).copied().unwrap_or_default();
    num(point[axis], 2)
}

/// Every column, in order.
pub const COLUMNS: &[Column] = &[
    one("frame", "", "number of the frame, from 1", |r, _| {
        Cell::Number(r.frame as f64, 0)
    }),
    one("face_id", "", "number of the face, from 0", |r, _| {
        Cell::Number(r.face_id as f64, 0)
    }),
    one("timestamp", "s", "time of the frame", |r, _| {
        Cell::Number(r.result.timestamp_us as f64 / 1e6, 6)
    }),
    one(
        "confidence",
        "0..1",
        "probability that this is a face and that the fit is right",
        |r, _| num(r.result.confidence, 4),
    ),
    one(
        "success",
        "0 or 1",
        "1 when the face was fitted on this frame (state tracking)",
        |r, _| Cell::Number(f64::from(r.result.state == State::Tracking), 0),
    ),
    one(
        "pose_Tx",
        "mm",
        "head position, + to the image right",
        |r, _| num(r.result.translation_mm[0], 2),
    ),
    one("pose_Ty", "mm", "head position, + down", |r, _| {
        num(r.result.translation_mm[1], 2)
    }),
    one(
        "pose_Tz",
        "mm",
        "head position, + away from the camera",
        |r, _| num(r.result.translation_mm[2], 2),
    ),
    one(
        "pose_Rx",
        "rad",
        "OpenFace's pitch, + is nose down",
        |r, _| num(openface_angles(r.result)[0], 5),
    ),
    one(
        "pose_Ry",
        "rad",
        "OpenFace's yaw, + is nose to the image left",
        |r, _| num(openface_angles(r.result)[1], 5),
    ),
    one(
        "pose_Rz",
        "rad",
        "OpenFace's roll, + is clockwise in the image",
        |r, _| num(openface_angles(r.result)[2], 5),
    ),
    per_landmark("x", "px", "landmark in the image, + right", |r, i| {
        num(landmark(r, i).x, 3)
    }),
    per_landmark("y", "px", "landmark in the image, + down", |r, i| {
        num(landmark(r, i).y, 3)
    }),
    per_landmark(
        "X",
        "mm",
        "landmark of the 3D face, camera frame",
        |r, i| point(r, i, 0),
    ),
    per_landmark(
        "Y",
        "mm",
        "landmark of the 3D face, camera frame",
        |r, i| point(r, i, 1),
    ),
    per_landmark(
        "Z",
        "mm",
        "landmark of the 3D face, camera frame",
        |r, i| point(r, i, 2),
    ),
    one(
        "state",
        "word",
        "`searching`, `tracking` or `coasting`",
        |r, _| Cell::Word(r.result.state.name()),
    ),
    one(
        "yaw_deg",
        "deg",
        "+ turns the face to the image right",
        |r, _| num(r.result.yaw_deg, 3),
    ),
    one("pitch_deg", "deg", "+ turns the face up", |r, _| {
        num(r.result.pitch_deg, 3)
    }),
    one(
        "roll_deg",
        "deg",
        "+ tilts the head clockwise in the image",
        |r, _| num(r.result.roll_deg, 3),
    ),
    per_landmark(
        "c",
        "0..1",
        "confidence: probability of an error below 0.1 inter-ocular distances",
        |r, i| num(landmark(r, i).confidence, 3),
    ),
    per_landmark(
        "vis",
        "0..1",
        "visibility: probability that nothing hides the landmark",
        |r, i| num(landmark(r, i).visibility, 2),
    ),
    one(
        "eye_open_left",
        "0..1, −1",
        "left eye: 0 shut, 1 open, −1 unknown (hidden or too fast)",
        |r, _| num(share(r.result, r.result.eye_open[0]), 3),
    ),
    one(
        "eye_open_right",
        "0..1, −1",
        "right eye, likewise",
        |r, _| num(share(r.result, r.result.eye_open[1]), 3),
    ),
    Column {
        names: Names::Animations,
        unit: "0..1",
        meaning: "animation weights; all names are listed below",
        value: |r, i| num(r.result.animation.get(i).copied().unwrap_or(0.0), 3),
    },
    one("box_x", "px", "left edge of the landmarks' box", |r, _| {
        num(r.result.face_box[0], 2)
    }),
    one("box_y", "px", "upper edge of the landmarks' box", |r, _| {
        num(r.result.face_box[1], 2)
    }),
    one("box_w", "px", "width of the landmarks' box", |r, _| {
        num(r.result.face_box[2], 2)
    }),
    one("box_h", "px", "height of the landmarks' box", |r, _| {
        num(r.result.face_box[3], 2)
    }),
    one(
        "age_us",
        "µs",
        "time since the frame that the fit belongs to; 0 when tracking",
        |r, _| Cell::Number(r.result.age_us as f64, 0),
    ),
    one(
        "loss",
        "word",
        "`none`, `low-confidence`, `left-frame`, `no-pose`, `excluded`",
        |r, _| Cell::Word(Loss::name_of(r.result.loss)),
    ),
    one(
        "visible_share",
        "0..1",
        "mean visibility of the landmarks",
        |r, _| num(r.result.visible_share, 3),
    ),
    one(
        "R_sigma_x",
        "deg",
        "standard deviation of the rotation about the camera's x axis",
        |r, _| num(r.result.rotation_sigma_deg[0], 3),
    ),
    one(
        "R_sigma_y",
        "deg",
        "standard deviation of the rotation about the camera's y axis",
        |r, _| num(r.result.rotation_sigma_deg[1], 3),
    ),
    one(
        "R_sigma_z",
        "deg",
        "standard deviation of the rotation about the camera's z axis",
        |r, _| num(r.result.rotation_sigma_deg[2], 3),
    ),
    one(
        "T_sigma_x",
        "mm",
        "standard deviation of pose_Tx",
        |r, _| num(r.result.translation_sigma_mm[0], 2),
    ),
    one(
        "T_sigma_y",
        "mm",
        "standard deviation of pose_Ty",
        |r, _| num(r.result.translation_sigma_mm[1], 2),
    ),
    one(
        "T_sigma_z",
        "mm",
        "standard deviation of pose_Tz",
        |r, _| num(r.result.translation_sigma_mm[2], 2),
    ),
    list(
        &["gaze_0_x", "gaze_0_y", "gaze_0_z"],
        "",
        "gaze of the image left's eye, unit vector, camera frame",
        |r, i| num(camera(right_eye(r).gaze)[i], 4),
    ),
    list(
        &["gaze_1_x", "gaze_1_y", "gaze_1_z"],
        "",
        "gaze of the image right's eye, likewise",
        |r, i| num(camera(left_eye(r).gaze)[i], 4),
    ),
    list(
        &["gaze_angle_x", "gaze_angle_y"],
        "rad",
        "gaze of both eyes, + to the image right and down",
        |r, i| num(gaze_angles(r.result.eyes.gaze)[i], 4),
    ),
    list(
        &["gaze_head_x", "gaze_head_y", "gaze_head_z"],
        "",
        "gaze of both eyes, unit vector, head frame",
        |r, i| num(head(r.result.eyes.gaze)[i], 4),
    ),
    one(
        "gaze_sigma_deg",
        "deg",
        "standard deviation of the gaze of both eyes",
        |r, _| num(sigma_deg(r.result.eyes.gaze), 2),
    ),
    one(
        "gaze_status",
        "word",
        "`known`, or why the gaze of both eyes is unknown; it is 0 then",
        |r, _| Cell::Word(EyeUnknown::name_of(r.result.eyes.gaze)),
    ),
    list(
        &["eye_open_p_left", "eye_open_p_right"],
        "0..1, −1",
        "probability that the eye is open, −1 unknown",
        |r, i| num(share(r.result, r.result.eyes.each[i].open.ok()), 3),
    ),
    list(
        &["eye_status_left", "eye_status_right"],
        "word",
        "`known`, or why the lids are unknown",
        |r, i| Cell::Word(EyeUnknown::name_of(r.result.eyes.each[i].open)),
    ),
    list(
        &["iris_left_x", "iris_left_y"],
        "px",
        "middle of the left iris; of the eye if its gaze is unknown",
        |r, i| num(r.result.eyes.each[0].iris[i], 3),
    ),
    list(
        &["iris_right_x", "iris_right_y"],
        "px",
        "middle of the right iris, likewise",
        |r, i| num(r.result.eyes.each[1].iris[i], 3),
    ),
    one(
        "glasses",
        "0..1, −1",
        "probability of glasses, −1 unknown",
        |r, _| num(share(r.result, r.result.eyes.glasses), 3),
    ),
    one(
        "dark_glasses",
        "0..1, −1",
        "probability that they are dark, −1 unknown",
        |r, _| num(share(r.result, r.result.eyes.dark_glasses), 3),
    ),
    list(
        &EYE_LOOK_NAMES,
        "0..1",
        "ARKit's weights of the gaze, 0 where it is unknown",
        |r, i| num(r.result.eyes.look[i], 3),
    ),
    one(
        "facing_yaw_deg",
        "deg",
        "yaw relative to the line of sight, 0 looks into the lens",
        |r, _| num(r.result.facing_yaw_deg, 3),
    ),
    one(
        "facing_pitch_deg",
        "deg",
        "pitch relative to the line of sight",
        |r, _| num(r.result.facing_pitch_deg, 3),
    ),
    one(
        "facing_roll_deg",
        "deg",
        "roll relative to the line of sight",
        |r, _| num(r.result.facing_roll_deg, 3),
    ),
    list(
        &[
            "facing_yaw_sigma",
            "facing_pitch_sigma",
            "facing_roll_sigma",
        ],
        "deg",
        "their standard deviations",
        |r, i| num(r.result.facing_sigma_deg[i], 3),
    ),
    one(
        "focal_px",
        "px",
        "focal length with which the face was fitted",
        |r, _| num(r.result.focal_px, 1),
    ),
    one(
        "camera_assumed",
        "0 or 1",
        "1 without intrinsics: 60° across were assumed",
        |r, _| Cell::Number(f64::from(u8::from(r.result.camera_assumed)), 0),
    ),
];

fn left_eye<'a>(row: &Row<'a>) -> &'a Eye {
    let Eyes {
        each: [left, _], ..
    } = &row.result.eyes;
    left
}

fn right_eye<'a>(row: &Row<'a>) -> &'a Eye {
    let Eyes {
        each: [_, right], ..
    } = &row.result.eyes;
    right
}

/// OpenFace's angles of a gaze \[rad\]; 0 where it is unknown.
fn gaze_angles(gaze: MaybeGaze) -> [f32; 2] {
    let [x, y, z] = camera(gaze);
    match z < 0.0 {
        true => [x.atan2(-z), y.atan2(-z)],
        false => [0.0; 2],
    }
}

/// OpenFace 2's angles \[rad\]: the same camera axes (x right, y down, z away) and a head that
/// looks straight into the camera at zero, but `R = Rx·Ry·Rz` with textbook rotations, so Rx > 0
/// is nose down, Ry > 0 nose to the image left, Rz > 0 clockwise. While searching, zeros.
pub fn openface_angles(result: &TrackResult) -> [f32; 3] {
    let rotation = Quat::from_array(result.rotation);
    if rotation.length_squared() < 0.25 {
        return [0.0; 3];
    }
    let r = Mat3::from_quat(rotation.normalize());
    [
        (-r.z_axis.y).atan2(r.z_axis.z),
        r.z_axis.x.clamp(-1.0, 1.0).asin(),
        (-r.y_axis.x).atan2(r.x_axis.x),
    ]
}

/// [`COLUMNS`], and one for each field that came later.
fn columns() -> impl Iterator<Item = Column> {
    let later = FIELDS.iter().filter_map(|field| {
        let column = field.column.as_ref()?;
        Some(Column {
            names: Names::Field(field, column.decimals),
            unit: column.unit,
            meaning: column.meaning,
            value: |_, _| Cell::Number(0.0, 0), // the field has it
        })
    });
    COLUMNS.iter().copied().chain(later)
}

impl Column {
    /// How many columns it is.
    fn count(&self) -> usize {
        match self.names {
            Names::One(_) => 1,
            Names::PerLandmark(_) => LANDMARKS,
            Names::Animations => ANIMATION_NAMES.len(),
            Names::List(names) => names.len(),
            Names::Field(field, _) => field.count,
        }
    }

    /// The value of its nth column.
    fn cell(&self, row: &Row<'_>, nth: usize) -> Cell {
        match self.names {
            Names::Field(field, decimals) => (field.value)(row.result).cell(nth, decimals),
            _ => (self.value)(row, nth),
        }
    }
}

/// The names of a field's columns.
fn names_of(field: &Field) -> Vec<String> {
    match field.count {
        1 => vec![field.name.to_string()],
        count => (0..count).map(|i| format!("{}_{i}", field.name)).collect(),
    }
}

/// All column names, in order.
pub fn names() -> Vec<String> {
    columns()
        .flat_map(|column| match column.names {
            Names::One(name) => vec![name.to_string()],
            Names::PerLandmark(name) => (0..LANDMARKS).map(|i| format!("{name}_{i}")).collect(),
            Names::Animations => ANIMATION_NAMES.map(String::from).to_vec(),
            Names::List(names) => names.iter().map(|name| name.to_string()).collect(),
            Names::Field(field, _) => names_of(field),
        })
        .collect()
}

/// All values of one row, in order.
pub fn cells<'a>(row: &'a Row<'_>) -> impl Iterator<Item = Cell> + 'a {
    columns().flat_map(move |column| (0..column.count()).map(move |i| column.cell(row, i)))
}

/// All values of one row as they stand in the table.
pub fn values(row: &Row<'_>) -> Vec<String> {
    cells(row).map(|cell| cell.text()).collect()
}

fn is_long(column: &Column) -> bool {
    matches!(column.names, Names::List(names) if names.len() > 3)
}

/// Names of animation weights on one line of the documentation.
const NAMES_PER_LINE: usize = 4;

/// The columns as a Markdown table and the names of the animation weights: what `posewise columns`
/// prints and the docs contain.
pub fn documentation() -> String {
    let mut out = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for column in columns() {
        let name = match column.names {
            Names::One(name) => format!("`{name}`"),
            Names::PerLandmark(name) => format!("`{name}_0` … `{name}_67`"),
            Names::Animations => {
                let (first, last) = (ANIMATION_NAMES.first(), ANIMATION_NAMES.last());
                format!("`{}` … `{}`", first.unwrap_or(&""), last.unwrap_or(&""))
            }
            Names::List([first, .., last]) if is_long(&column) => {
                format!("`{first}` … `{last}`")
            }
            Names::List(names) => {
                let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
                names.join(", ")
            }
            Names::Field(field, _) => format!("`{}`", names_of(field).join("`, `")),
        };
        out += &format!("| {name} | {} | {} |\n", column.unit, column.meaning);
    }
    out += "\nThe animation weights, in order, under ARKit's blendshape names:\n";
    for line in ANIMATION_NAMES.chunks(NAMES_PER_LINE) {
        let names: Vec<String> = line.iter().map(|name| format!("`{name}`")).collect();
        out += &format!("\n{},", names.join(", "));
    }
    out.trim_end_matches(',').to_string() + ".\n"
}

/// Writes the table.
pub struct CsvWriter<W: Write> {
    out: csv::Writer<W>,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the header: the columns of the tracker, then others.
    pub fn new(out: W, more: &[String]) -> Result<Self> {
        let mut out = csv::Writer::from_writer(out);
        let names = [&names()[..], more].concat();
        out.write_record(names).context("cannot write the CSV")?;
        Ok(CsvWriter { out })
    }

    /// Writes one row, with the values of the other columns.
    pub fn write(&mut self, row: &Row<'_>, more: &[String]) -> Result<()> {
        self.out
            .write_record([&values(row)[..], more].concat())
            .context("cannot write the CSV")
    }

    /// Where everything was written to.
    pub fn into_inner(self) -> Result<W> {
        let inner = self.out.into_inner();
        inner.map_err(|e| anyhow!("cannot write the CSV: {}", e.error()))
    }

    /// Hands everything on to the file.
    pub fn flush(&mut self) -> Result<()> {
        self.out.flush().context("cannot write the CSV")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::EulerRot;
    use std::path::Path;

    #[test]
    fn docs_list_the_columns() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/command-line.md");
        let docs = std::fs::read_to_string(&page)
            .expect("a page")
            .replace('\r', "");
        let table = documentation();
        if std::env::var_os("POSEWISE_BLESS").is_some() {
            let (before, rest) = docs.split_once("| `frame` |").expect("the columns");
            let (_, after) = rest.split_once("\n\n").expect("an end of the columns");
            let (_, rows) = table.split_once("| `frame` |").expect("the columns");
            let (rows, _) = rows.split_once("\n\n").expect("an end of the columns");
            let blessed = format!("{before}| `frame` |{rows}\n\n{after}");
            std::fs::write(&page, blessed).expect("docs/ is writable");
        } else {
            assert!(
                docs.contains(&table),
                "docs/command-line.md lacks this table; POSEWISE_BLESS=1 writes it:\n{table}"
            );
        }
        assert!(table.lines().all(|line| line.chars().count() <= 100));
    }

    #[test]
    fn rows_are_as_long_as_the_header() {
        let result = TrackResult::default();
        let row = Row {
            frame: 1,
            face_id: 0,
            result: &result,
        };
        assert_eq!(names().len(), values(&row).len());
        let later = FIELDS.iter().filter(|field| field.column.is_some());
        let later: usize = later.map(|field| field.count).sum();
        assert_eq!(
            names().len(),
            61 + 7 * LANDMARKS + ANIMATION_NAMES.len() + EYE_LOOK_NAMES.len() + later
        );
    }

    #[test]
    fn openface_signs_by_hand() {
        let angles = |yaw_deg: f32, pitch_deg: f32, roll_deg: f32| {
            let [yaw, pitch, roll] = [yaw_deg, pitch_deg, roll_deg].map(f32::to_radians);
            let rotation = Quat::from_euler(EulerRot::YXZ, -yaw, -pitch, roll);
            let mut result = TrackResult::default();
            result.rotation = rotation.to_array();
            openface_angles(&result).map(|a| a.to_degrees().round() as i32)
        };
        assert_eq!(angles(30., 0., 0.), [0, -30, 0], "nose to the image right");
        assert_eq!(angles(0., 20., 0.), [-20, 0, 0], "nose up");
        assert_eq!(angles(0., 0., 10.), [0, 0, 10], "clockwise");
        assert_eq!(openface_angles(&TrackResult::default()), [0.0; 3]);
    }
}
