//! A small synthetic data set in each layout, with known errors; and corrupted files.

use super::convention::{angles, of_boston};
use super::*;
use crate::tracked;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

/// 68 points with eyes 60 px apart.
fn face() -> [[f64; 2]; 68] {
    std::array::from_fn(|i| match i {
        36 => [70.0, 100.0],
        45 => [130.0, 100.0],
        _ => [
            60.0 + 1.3 * i as f64,
            80.0 + 7.0 * (i as f64).sin().abs() * i as f64,
        ],
    })
}

fn shifted(points: [[f64; 2]; 68], by: f64) -> [[f64; 2]; 68] {
    points.map(|[x, y]| [x + by, y])
}

/// Angles and points of a frame.
type Row = ([f64; 3], [[f64; 2]; 68]);

/// A folder of data and tables.
struct Set(TempDir);

impl Set {
    fn new() -> Set {
        Set(TempDir::new().unwrap())
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    /// A table of `posewise track --csv`; `None` is a frame that was not tracked.
    fn table(&self, name: &str, frames: &[Option<Row>]) {
        let mut text = String::from("frame,success,yaw_deg,pitch_deg,roll_deg");
        (0..68).for_each(|i| text += &format!(",x_{i},y_{i}"));
        for (k, frame) in frames.iter().enumerate() {
            let (angles, points) = frame.unwrap_or(([0.0; 3], [[0.0; 2]; 68]));
            let values = angles.into_iter().chain(points.into_iter().flatten());
            text += &format!("\n{},{}", k + 1, u8::from(frame.is_some()));
            values.for_each(|v| text += &format!(",{v}"));
        }
        self.write(&format!("tables/{name}.csv"), text);
    }

    fn run(&self, protocol: Protocol) -> Result<report::Report> {
        let data = self.0.path().join("data");
        let tables = Predictions::Tables(self.0.path().join("tables"));
        report(protocol, &data, talking_face::Markup::Xm2vts, &[tables])
    }

    /// The text of a report without error.
    fn text(&self, protocol: Protocol) -> String {
        self.run(protocol).unwrap().text
    }

    /// The error, from which the temporary folder is cut.
    fn error(&self, protocol: Protocol) -> String {
        let error = format!("{:#}", self.run(protocol).err().expect("an error"));
        let data = self.0.path().join("data");
        error.replace(&format!("{}/", data.display()), "")
    }
}

fn pts(points: [[f64; 2]; 68]) -> String {
    let lines: String = points.iter().map(|[x, y]| format!("{x} {y}\n")).collect();
    format!("version: 1\nn_points:  68\n{{\n{lines}}}\n")
}

#[test]
fn boston() {
    let set = Set::new();
    let rows = "0 0 0 40 0 0 0\n0.03 0 0 40 0 10 -5\n0.06 0 0 40 0 20 -5\n";
    set.write("data/uniform-light/jam1.dat", rows);
    let frame = |yaw| {
        let [y, pitch, roll] = angles(&of_boston([0.0, yaw, -5.0]));
        Some(([y + 3.0, pitch, roll], face()))
    };
    set.table("uniform-light/jam1", &[frame(10.0), frame(20.0)]);
    let text = set.text(Protocol::Buft);
    assert!(
        text.contains("| uniform-light/jam1 | 2 | 100.00 | 3.00 | 0.00 | 0.00 |"),
        "{text}"
    );
    assert!(
        text.contains("| all | 2 | 100.00 | 0.00 | 0.00 | 0.00 |"),
        "relative: {text}"
    );
    set.write(
        "data/uniform-light/jam1.dat",
        "0 0 0 40 0 0 0\n0.03 0 0 40 0 up 0\n",
    );
    let error = set.error(Protocol::Buft);
    assert_eq!(
        error,
        "uniform-light/jam1.dat, line 2: \"up\" is not a number"
    );
}

#[test]
fn ibug_300w() {
    let set = Set::new();
    set.write("data/a.pts", pts(face()));
    set.write("data/lfpw/b.pts", pts(face()));
    // The files count from 1, and these landmarks are 3 px from the labels: 5 % of 60 px.
    set.table(
        "a",
        &[Some((
            [0.0; 3],
            shifted(face(), 2.0).map(|[x, y]| [x, y - 1.0]),
        ))],
    );
    set.table("lfpw/b", &[None]);
    let report = set.run(Protocol::Ibug).unwrap();
    let text = &report.text;
    let row = "| 68 points, outer eye corners | 2 | 50.00 | 5.00 | 18.75 | 50.00 |";
    assert!(text.contains(row), "{text}");
    assert_eq!(report.curves.len(), 4);
    set.write("data/a.pts", pts(face()).replace("}\n", ""));
    assert!(
        set.error(Protocol::Ibug)
            .starts_with("a.pts, line 71: no }")
    );
}

#[test]
fn talking_face() {
    let set = Set::new();
    let mut label = [[0.0; 2]; 68];
    // Eyes of XM2VTS are 27 to 36; the outer corner at the image left is 27, and 36 of 300-W.
    label[27] = [70.0, 100.0];
    for k in 0..2 {
        set.write(&format!("data/franck_0000{k}.pts"), pts(label));
    }
    let mut found = [[0.0; 2]; 68];
    found[36] = [70.0, 112.0];
    set.table("franck", &[Some(([0.0; 3], found)), None]);
    let text = set.text(Protocol::TalkingFace);
    // 12 px at one of twelve points: √(144/12).
    assert!(text.contains("| 12 | 2 | 50.00 | 3.46 | 3.46 |"), "{text}");
    assert!(text.contains("| 25 | 2 | 50.00 | 2.40 | 2.40 |"), "{text}");
    set.write(
        "data/franck_00001.pts",
        "version: 1\nn_points: 1\n{\n1 2\n}\n",
    );
    let error = set.error(Protocol::TalkingFace);
    assert_eq!(error, "franck_00001.pts, line 5: 1 points in place of 68");
}

#[test]
fn subsets() {
    let set = Set::new();
    let mut truth = String::from("frame,yaw,pitch,roll,in_frame");
    (0..68).for_each(|i| truth += &format!(",x{i},y{i}"));
    for in_frame in ["1.0", "1.0", "0.2"] {
        truth += &format!("\n0,30,0,0,{in_frame}");
        (0..68).for_each(|_| truth += ",1,1");
    }
    set.write("data/profile/a.csv", &truth);
    set.table("profile/a", &[Some(([18.0, 0.0, 0.0], face())), None, None]);
    let report = set.run(Protocol::Subsets).unwrap();
    let text = &report.text;
    assert!(
        text.contains("| profile | 2 | 50.00 | 12.00 | 0.00 | 0.00 | 4.00 |"),
        "{text}"
    );
    assert!(
        text.contains("| profile | 0.00 | 50.00 | 50.00 |"),
        "{text}"
    );
    assert_eq!(report.curves[0].0, "profile");
    set.write("data/profile/a.csv", truth.replacen("\n0,30", "\n0,x", 1));
    let error = set.error(Protocol::Subsets);
    assert_eq!(error, "profile/a.csv, line 2: yaw is \"x\", not a number");
}

#[test]
fn pointing04() {
    let set = Set::new();
    let mut labels = String::from("image,identity,series,pitch_deg,yaw_deg");
    let marks = [[0, 0], [0, 45], [0, 90], [0, -90], [15, 0], [-15, 0]];
    for [pitch, yaw] in marks {
        labels += &format!("\n{pitch}{yaw}.jpg,01,1,{pitch},{yaw}");
    }
    set.write("data/labels.csv", &labels);
    // Off by 3° in all pictures, and by 30° more in the profiles.
    let shown = |angles: [[f64; 2]; 3]| -> Vec<Option<Row>> {
        let all = angles.iter().flat_map(|a| std::iter::repeat_n(*a, 5));
        all.map(|[yaw, pitch]| Some(([yaw + 3.0, pitch, 0.0], face())))
            .collect()
    };
    // In the labels, yaw > 0 is to the image left.
    set.table(
        "01-1/left",
        &shown([[0.0, 0.0], [-45.0, 0.0], [-60.0, 0.0]]),
    );
    set.table(
        "01-1/right",
        &shown([[0.0, 0.0], [60.0, 0.0], [0.0; 2]])[..10],
    );
    set.table("01-1/up", &shown([[0.0, 0.0], [0.0, 15.0], [0.0; 2]])[..10]);
    set.table("01-1/down", &[None, None]);
    let text = set.text(Protocol::Pointing04);
    for row in [
        "| tables | yaw to 45° | 1 | 100.00 | 100.00 | 0.00 | 0.00 | 0.00 | 0.00 |",
        "| tables | yaw from 60° | 2 | 100.00 | 100.00 | 30.00 | 0.00 | 0.00 | 10.00 |",
        "| tables | pitch | 2 | 50.00 | 50.00 | 0.00 | 0.",
    ] {
        assert!(text.contains(row), "{text}");
    }
    set.write(
        "data/labels.csv",
        labels.replace("00.jpg,01,1,0,0", "00.jpg,01,1,0,5"),
    );
    assert!(
        set.error(Protocol::Pointing04)
            .ends_with("no frontal picture of 01-1")
    );
}

#[test]
fn cfp() {
    let set = Set::new();
    let mut labels = String::from("image,identity,kind,half,yaw_geometric_deg");
    (0..68).for_each(|i| labels += &format!(",x{i},y{i}"));
    for (image, kind) in [("a.jpg", "frontal"), ("b.jpg", "profile")] {
        labels += &format!("\n{image},1,{kind},left,0");
        for ([x, y], i) in face().iter().zip(0..) {
            // Half of the face; the chin is 50 px below the brow.
            labels += &match i {
                8 => format!(",{x},150"),
                19 => format!(",{x},100"),
                30 => format!(",{x},{y}"),
                _ => ",,".into(),
            };
        }
    }
    set.write("data/dev.csv", labels);
    let mut found = face();
    let x8 = found[8][0];
    found[8] = [x8, 150.0];
    found[19][1] = 100.0;
    let unit = (found[8][0] - found[19][0]).hypot(50.0);
    set.table("a", &[Some(([0.0; 3], shifted(found, 0.02 * unit)))]);
    set.table("b", &[None]);
    let text = set.text(Protocol::Cfp);
    assert!(
        text.contains("| tables | frontal | 1 | 100.00 | 2.00 | 2.00 |"),
        "{text}"
    );
    assert!(
        text.contains("| tables | profile | 1 | 0.00 | – | – |"),
        "{text}"
    );
}

#[test]
fn a_missing_table_is_an_error() {
    let set = Set::new();
    set.write("data/a.pts", pts(face()));
    assert!(set.error(Protocol::Ibug).contains("tables/a.csv"));
    std::fs::remove_file(set.0.path().join("data/a.pts")).unwrap();
    assert!(set.error(Protocol::Ibug).starts_with("no .pts files"));
}

/// Bytes with a few of them changed, removed or repeated.
fn corrupted(rng: &mut ChaCha8Rng, bytes: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..rng.random_range(1..6) {
        let at = rng.random_range(0..out.len().max(1));
        match rng.random_range(0..4) {
            0 if !out.is_empty() => out[at] = rng.random(),
            1 if !out.is_empty() => out[at] ^= 1 << rng.random_range(0..8),
            2 => out.truncate(at),
            _ => out.extend_from_within(at.min(out.len())..),
        }
        out.truncate(1 << 16);
    }
    out
}

#[test]
fn corrupted_files_are_errors_or_values_but_never_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..2000 {
        let texts = [pts(face()), "0 0 0 40 0 0 0\n0.03 0 0 40 0 10 -5\n".into()];
        for (k, good) in texts.iter().enumerate() {
            let Ok(text) = text::Text::parse("t", corrupted(&mut rng, good.as_bytes())) else {
                continue;
            };
            match k {
                0 => drop(ibug::parse(&text)),
                _ => drop(boston::parse(&text)),
            }
        }
    }
}

#[test]
fn corrupted_tables_are_errors_or_values_but_never_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let set = Set::new();
    set.table("a", &[Some(([1.0, 2.0, 3.0], face())), None]);
    let path = set.0.path().join("tables/a.csv");
    let good = std::fs::read(&path).unwrap();
    for _ in 0..500 {
        std::fs::write(&path, corrupted(&mut rng, &good)).unwrap();
        let _ = tracked::read(&path);
        let _ = crate::truth::read(&path);
    }
}
