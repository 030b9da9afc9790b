//! The table that `posewise track --csv` writes: one row per frame.
//!
//! OpenFace 2's columns, names and units come first, so that scripts for its tables read ours;
//! then what OpenFace does not have. [`COLUMNS`] is the only list: names, units, documentation
//! and values all come from it, and a test compares docs/command-line.md with it.

use std::io::Write;

use anyhow::{Context, Result, anyhow};
use glam::{Mat3, Quat};
use posewise::{ANIMATION_NAMES, EYE_LOOK_NAMES, EyeUnknown, Gaze, State, TrackResult};

use crate::columns::Names::{Animations, List, One, PerLandmark};
use crate::columns::{self, Cell, Column, columns, num};

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

fn landmark(row: &Row<'_>, i: usize) -> posewise::Landmark {
    row.result.landmarks.get(i).copied().unwrap_or_default()
}

fn point(row: &Row<'_>, i: usize, axis: usize) -> Cell {
    let point = row.result.points_mm.get(i).copied().unwrap_or_default();
    num(point[axis], 2)
}

columns! {
    /// Every column, in order.
    pub const COLUMNS: fn(&Row<'_>, usize) -> Cell = |row, i|;
    One("frame"), "", "number of the frame, from 1" => Cell::Number(row.frame as f64, 0);
    One("face_id"), "", "number of the face, from 0" => Cell::Number(row.face_id as f64, 0);
    One("timestamp"), "s", "time of the frame"
        => Cell::Number(row.result.timestamp_us as f64 / 1e6, 6);
    One("confidence"), "0..1", "probability that this is a face and that the fit is right"
        => num(row.result.confidence, 4);
    One("success"), "0 or 1", "1 when the face was fitted on this frame (state tracking)"
        => Cell::Number(f64::from(row.result.state == State::Tracking), 0);
    One("pose_Tx"), "mm", "head position, + to the image right"
        => num(row.result.translation_mm[0], 2);
    One("pose_Ty"), "mm", "head position, + down" => num(row.result.translation_mm[1], 2);
    One("pose_Tz"), "mm", "head position, + away from the camera"
        => num(row.result.translation_mm[2], 2);
    One("pose_Rx"), "rad", "OpenFace's pitch, + is nose down"
        => num(openface_angles(row.result)[0], 5);
    One("pose_Ry"), "rad", "OpenFace's yaw, + is nose to the image left"
        => num(openface_angles(row.result)[1], 5);
    One("pose_Rz"), "rad", "OpenFace's roll, + is clockwise in the image"
        => num(openface_angles(row.result)[2], 5);
    PerLandmark("x"), "px", "landmark in the image, + right" => num(landmark(row, i).x, 3);
    PerLandmark("y"), "px", "landmark in the image, + down" => num(landmark(row, i).y, 3);
    PerLandmark("X"), "mm", "landmark of the 3D face, camera frame" => point(row, i, 0);
    PerLandmark("Y"), "mm", "landmark of the 3D face, camera frame" => point(row, i, 1);
    PerLandmark("Z"), "mm", "landmark of the 3D face, camera frame" => point(row, i, 2);
    One("state"), "word", "`searching`, `tracking` or `coasting`"
        => Cell::Word(row.result.state.name());
    One("yaw_deg"), "deg", "+ turns the face to the image right" => num(row.result.yaw_deg, 3);
    One("pitch_deg"), "deg", "+ turns the face up" => num(row.result.pitch_deg, 3);
    One("roll_deg"), "deg", "+ tilts the head clockwise in the image"
        => num(row.result.roll_deg, 3);
    PerLandmark("c"), "0..1", "confidence: probability of an error below 0.1 inter-ocular distances"
        => num(landmark(row, i).confidence, 3);
    PerLandmark("vis"), "0..1", "visibility: probability that nothing hides the landmark"
        => num(landmark(row, i).visibility, 2);
    One("eye_open_left"), "0..1, −1", "left eye: 0 shut, 1 open, −1 unknown (hidden or too fast)"
        => num(row.result.eye_open[0], 3);
    One("eye_open_right"), "0..1, −1", "right eye, likewise" => num(row.result.eye_open[1], 3);
    Animations, "0..1", "animation weights; all names are listed below"
        => num(row.result.animation.get(i).copied().unwrap_or(0.0), 3);
    One("box_x"), "px", "left edge of the landmarks' box" => num(row.result.face_box[0], 2);
    One("box_y"), "px", "upper edge of the landmarks' box" => num(row.result.face_box[1], 2);
    One("box_w"), "px", "width of the landmarks' box" => num(row.result.face_box[2], 2);
    One("box_h"), "px", "height of the landmarks' box" => num(row.result.face_box[3], 2);
    One("age_us"), "µs", "time since the frame that the fit belongs to; 0 when tracking"
        => Cell::Number(row.result.age_us as f64, 0);
    One("loss"), "word", "`none`, `low-confidence`, `left-frame`, `no-pose`, `excluded`"
        => Cell::Word(row.result.loss.name());
    One("visible_share"), "0..1", "mean visibility of the landmarks"
        => num(row.result.visible_share, 3);
    One("R_sigma_x"), "deg", "standard deviation of the rotation about the camera's x axis"
        => num(row.result.rotation_sigma_deg[0], 3);
    One("R_sigma_y"), "deg", "standard deviation of the rotation about the camera's y axis"
        => num(row.result.rotation_sigma_deg[1], 3);
    One("R_sigma_z"), "deg", "standard deviation of the rotation about the camera's z axis"
        => num(row.result.rotation_sigma_deg[2], 3);
    One("T_sigma_x"), "mm", "standard deviation of pose_Tx"
        => num(row.result.translation_sigma_mm[0], 2);
    One("T_sigma_y"), "mm", "standard deviation of pose_Ty"
        => num(row.result.translation_sigma_mm[1], 2);
    One("T_sigma_z"), "mm", "standard deviation of pose_Tz"
        => num(row.result.translation_sigma_mm[2], 2);
    List(&["gaze_0_x", "gaze_0_y", "gaze_0_z"]),
        "", "gaze of the image left's eye, unit vector, camera frame"
        => num(row.result.eyes.each[1].gaze.camera[i], 4);
    List(&["gaze_1_x", "gaze_1_y", "gaze_1_z"]), "", "gaze of the image right's eye, likewise"
        => num(row.result.eyes.each[0].gaze.camera[i], 4);
    List(&["gaze_angle_x", "gaze_angle_y"]),
        "rad", "gaze of both eyes, + to the image right and down"
        => num(gaze_angles(&row.result.eyes.gaze)[i], 4);
    List(&["gaze_head_x", "gaze_head_y", "gaze_head_z"]),
        "", "gaze of both eyes, unit vector, head frame"
        => num(row.result.eyes.gaze.head[i], 4);
    One("gaze_sigma_deg"), "deg", "standard deviation of the gaze of both eyes"
        => num(row.result.eyes.gaze.sigma_deg, 2);
    One("gaze_status"), "word", "`known`, or why the gaze of both eyes is unknown; it is 0 then"
        => Cell::Word(EyeUnknown::name_of(row.result.eyes.gaze.unknown));
    List(&["eye_open_p_left", "eye_open_p_right"]),
        "0..1, −1", "probability that the eye is open, −1 unknown"
        => num(row.result.eyes.each[i].open, 3);
    List(&["eye_status_left", "eye_status_right"]), "word", "`known`, or why the lids are unknown"
        => Cell::Word(EyeUnknown::name_of(row.result.eyes.each[i].unknown));
    List(&["iris_left_x", "iris_left_y"]),
        "px", "middle of the left iris; of the eye if its gaze is unknown"
        => num(row.result.eyes.each[0].iris[i], 3);
    List(&["iris_right_x", "iris_right_y"]), "px", "middle of the right iris, likewise"
        => num(row.result.eyes.each[1].iris[i], 3);
    One("glasses"), "0..1, −1", "probability of glasses, −1 unknown"
        => num(row.result.eyes.glasses, 3);
    One("dark_glasses"), "0..1, −1", "probability that they are dark, −1 unknown"
        => num(row.result.eyes.dark_glasses, 3);
    List(&EYE_LOOK_NAMES), "0..1", "ARKit's weights of the gaze, 0 where it is unknown"
        => num(row.result.eyes.look[i], 3);
    One("facing_yaw_deg"), "deg", "yaw relative to the line of sight, 0 looks into the lens"
        => num(row.result.facing_yaw_deg, 3);
    One("facing_pitch_deg"), "deg", "pitch relative to the line of sight"
        => num(row.result.facing_pitch_deg, 3);
    One("facing_roll_deg"), "deg", "roll relative to the line of sight"
        => num(row.result.facing_roll_deg, 3);
    List(&["facing_yaw_sigma", "facing_pitch_sigma", "facing_roll_sigma"]),
        "deg", "their standard deviations"
        => num(row.result.facing_sigma_deg[i], 3);
    One("focal_px"), "px", "focal length with which the face was fitted"
        => num(row.result.focal_px, 1);
    One("camera_assumed"), "0 or 1", "1 without intrinsics: 60° across were assumed"
        => Cell::Number(f64::from(u8::from(row.result.camera_assumed)), 0);
}

/// OpenFace's angles of a gaze \[rad\]; 0 where it is unknown.
fn gaze_angles(gaze: &Gaze) -> [f32; 2] {
    let [x, y, z] = gaze.camera;
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

/// All column names, in order.
pub fn names() -> Vec<String> {
    columns::names(COLUMNS)
}

/// All values of one row, in order.
pub fn cells<'a>(row: &'a Row<'_>) -> impl Iterator<Item = Cell> + 'a {
    COLUMNS
        .iter()
        .flat_map(move |column| (0..column.names.count()).map(move |i| (column.value)(row, i)))
}

/// All values of one row as they stand in the table.
pub fn values(row: &Row<'_>) -> Vec<String> {
    cells(row).map(|cell| cell.text()).collect()
}

/// Names of animation weights on one line of the documentation.
const NAMES_PER_LINE: usize = 4;

/// The columns as a Markdown table and the names of the animation weights: what `posewise columns`
/// prints and the docs contain.
pub fn documentation() -> String {
    let mut out = columns::table(COLUMNS);
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
    use posewise::LANDMARKS;

    #[test]
    fn docs_list_the_columns() {
        let docs = include_str!("../../../docs/command-line.md");
        let table = documentation();
        assert!(
            docs.contains(&table),
            "docs/command-line.md must contain this table:\n{table}"
        );
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
        assert_eq!(
            names().len(),
            61 + 7 * LANDMARKS + ANIMATION_NAMES.len() + EYE_LOOK_NAMES.len()
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
