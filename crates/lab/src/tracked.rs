//! What a tracker found in each frame, and its table: columns of `posewise track --csv`.

use crate::table::Table;
use anyhow::{Context, Result, ensure};
use posewise::{State, TrackResult};
use std::collections::BTreeMap;
use std::path::Path;

/// One frame in which the face was tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// Yaw, pitch, roll of docs/conventions.md \[deg\].
    pub angles: [f64; 3],
    /// Landmarks \[px\].
    pub points: [[f64; 2]; 68],
}

/// Probabilities that a tracker gives of its own result.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    /// Of the face.
    pub face: f64,
    /// Of each landmark.
    pub landmarks: [f64; 68],
    /// That each landmark is visible.
    pub visibility: Option<[f64; 68]>,
}

/// One frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// What was found.
    pub tracked: Option<Tracked>,
    /// Position of the head in the camera frame \[mm\].
    pub translation: Option<[f64; 3]>,
    /// Of a tracked frame.
    pub confidence: Option<Confidence>,
    /// Processor time of the step, without decoding \[ms\].
    pub milliseconds: Option<f64>,
}

impl Tracked {
    /// The product's result; `None` unless the face was fitted on that frame.
    pub fn of(result: &TrackResult) -> Option<Tracked> {
        (result.state == State::Tracking).then(|| Tracked {
            angles: [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from),
            points: result.landmarks.map(|l| [l.x, l.y].map(f64::from)),
        })
    }
}

impl Frame {
    /// The product's result.
    pub fn of(result: &TrackResult, milliseconds: f64) -> Frame {
        let tracked = Tracked::of(result);
        let confidence = || Confidence {
            face: f64::from(result.confidence),
            landmarks: result.landmarks.map(|l| f64::from(l.confidence)),
            visibility: Some(result.landmarks.map(|l| f64::from(l.visibility))),
        };
        Frame {
            translation: (tracked.as_ref()).map(|_| result.translation_mm.map(f64::from)),
            confidence: tracked.as_ref().map(|_| confidence()),
            tracked,
            milliseconds: Some(milliseconds),
        }
    }
}

const ANGLES: [&str; 3] = ["yaw_deg", "pitch_deg", "roll_deg"];
const TRANSLATION: [&str; 3] = ["pose_Tx", "pose_Ty", "pose_Tz"];

/// Columns of a table that another program may leave out.
struct Optional {
    translation: Option<[usize; 3]>,
    confidence: Option<(usize, [usize; 68])>,
    visibility: Option<[usize; 68]>,
    milliseconds: Option<usize>,
}

impl Optional {
    fn of(table: &Table) -> Optional {
        let translation: Option<Vec<usize>> = TRANSLATION.iter().map(|n| table.find(n)).collect();
        Optional {
            translation: translation.and_then(|found| found.try_into().ok()),
            confidence: table.find("confidence").zip(table.columns68("c_").ok()),
            visibility: table.columns68("vis_").ok(),
            milliseconds: table.find("milliseconds"),
        }
    }
}

/// Frames by their number from 0. What a row without success holds beside its time is ignored.
pub fn read(path: &Path) -> Result<BTreeMap<usize, Frame>> {
    let table = Table::read(path)?;
    let (frame, success) = (table.column("frame")?, table.column("success")?);
    let mut angles = [0; 3];
    for (column, name) in angles.iter_mut().zip(ANGLES) {
        *column = table.column(name)?;
    }
    let points = table.points(["x_", "y_"])?;
    let optional = Optional::of(&table);
    let mut found = BTreeMap::new();
    for row in 0..table.len() {
        let from_1 = table.number(row, frame)?;
        let shown = path.display();
        ensure!(from_1 >= 1.0, "{shown}: frames count from 1, not {from_1}");
        let mut read = Frame::default();
        if let Some(column) = optional.milliseconds {
            read.milliseconds = table.number_if_any(row, column)?;
        }
        if table.number(row, success)? >= 0.5 {
            read.tracked = Some(Tracked {
                angles: table.numbers(row, angles)?,
                points: table.points_of(row, &points)?,
            });
            let translation = optional.translation.map(|c| table.numbers(row, c));
            read.translation = translation.transpose()?;
            if let Some((face, landmarks)) = optional.confidence {
                read.confidence = Some(Confidence {
                    face: table.number(row, face)?,
                    landmarks: table.numbers(row, landmarks)?,
                    visibility: (optional.visibility)
                        .map(|columns| table.numbers(row, columns))
                        .transpose()?,
                });
            }
        }
        found.insert(from_1 as usize - 1, read);
    }
    Ok(found)
}

/// Writes the columns that any frame has. Numbers have all their digits: a table that is read
/// again holds the same bits.
pub fn write(path: &Path, frames: &[Frame]) -> Result<()> {
    let shown = || path.display().to_string();
    let mut writer = csv::Writer::from_path(path).with_context(shown)?;
    let has_translation = frames.iter().any(|f| f.translation.is_some());
    let has_confidence = frames.iter().any(|f| f.confidence.is_some());
    let visibility = |f: &Frame| f.confidence.as_ref()?.visibility;
    let has_visibility = frames.iter().any(|f| visibility(f).is_some());
    let has_time = frames.iter().any(|f| f.milliseconds.is_some());
    let name = |names: &[&str]| names.iter().map(|n| n.to_string()).collect::<Vec<_>>();
    let mut header = [name(&["frame", "success"]), name(&ANGLES)].concat();
    if has_translation {
        header.extend(name(&TRANSLATION));
    }
    if has_time {
        header.push("milliseconds".into());
    }
    header.extend((0..68).flat_map(|i| [format!("x_{i}"), format!("y_{i}")]));
    if has_confidence {
        header.push("confidence".into());
        header.extend((0..68).map(|i| format!("c_{i}")));
    }
    if has_visibility {
        header.extend((0..68).map(|i| format!("vis_{i}")));
    }
    writer.write_record(&header)?;
    for (number, frame) in frames.iter().enumerate() {
        let tracked = frame.tracked.as_ref();
        let mut row = vec![number as f64 + 1.0, f64::from(u8::from(tracked.is_some()))];
        row.extend(tracked.map_or([0.0; 3], |t| t.angles));
        if has_translation {
            row.extend(frame.translation.unwrap_or_default());
        }
        let mut words: Vec<String> = row.iter().map(f64::to_string).collect();
        if has_time {
            words.push(frame.milliseconds.map_or(String::new(), |t| t.to_string()));
        }
        let points = tracked.map_or([[0.0; 2]; 68], |t| t.points);
        let mut row: Vec<f64> = points.into_iter().flatten().collect();
        if has_confidence {
            let confidence = frame.confidence.as_ref();
            row.push(confidence.map_or(0.0, |c| c.face));
            row.extend(confidence.map_or([0.0; 68], |c| c.landmarks));
        }
        if has_visibility {
            row.extend(visibility(frame).unwrap_or([0.0; 68]));
        }
        words.extend(row.iter().map(f64::to_string));
        writer.write_record(words)?;
    }
    Ok(writer.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_keeps_all_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let third = |i: usize| i as f64 / 3.0 - 7.0;
        let whole = Frame {
            tracked: Some(Tracked {
                angles: [f64::from(0.1_f32), -1.0 / 3.0, 1e-17],
                points: std::array::from_fn(|i| [third(i), -third(i)]),
            }),
            translation: Some([1.0 / 7.0, -2.0, 600.1]),
            confidence: Some(Confidence {
                face: 0.3_f32.into(),
                landmarks: std::array::from_fn(|i| third(i).abs() / 20.0),
                visibility: Some(std::array::from_fn(|i| third(i).abs() / 30.0)),
            }),
            milliseconds: Some(0.123_456),
        };
        let lost = Frame {
            milliseconds: Some(2.5),
            ..Frame::default()
        };
        let all = [whole.clone(), lost, Frame::default()];
        write(&path, &all).unwrap();
        assert_eq!(read(&path).unwrap(), (0..).zip(all).collect());
        let bare = Frame {
            tracked: whole.tracked,
            ..Frame::default()
        };
        write(&path, &[Frame::default(), bare.clone()]).unwrap();
        assert_eq!(read(&path).unwrap()[&1], bare);
    }
}
