//! A small synthetic data set in each layout, with known errors; and corrupted files.

use super::convention::{angles, of_boston, rotation};
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
        let args = Args {
            protocol,
            data: self.0.path().join("data"),
            csv: None,
            results: None,
            shard: None,
            curves: None,
            markup: talking_face::Markup::Xm2vts,
            product: product::Options {
                model: None,
                focal: None,
            },
        };
        report(&args, &Predictions::Tables(self.0.path().join("tables")))
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
fn aflw2000() {
    let set = Set::new();
    let write = |name: &str, yaw: f32| {
        let pose = [0.0, yaw.to_radians(), 0.0, 0.0, 0.0, 0.0, 1.0];
        let points: Vec<f32> = face()
            .iter()
            .flat_map(|[x, y]| [*x as f32, *y as f32, 0.0])
            .collect();
        let arrays: [(&str, [u32; 2], &[f32]); 2] =
            [("Pose_Para", [1, 7], &pose), ("pt3d_68", [3, 68], &points)];
        set.write(&format!("data/{name}.mat"), mat::tests::file(&arrays));
    };
    write("image00002", -40.0);
    write("image00004", 120.0);
    // The set's yaw is to the image left, posewise's to the right.
    set.table("image00002", &[Some(([44.0, 0.0, 0.0], face()))]);
    set.table("image00004", &[None]);
    let text = set.text(Protocol::Aflw2000);
    assert!(
        text.contains("| all | 1 | 100.00 | 4.00 | 0.00 | 0.00 | 1.33 |"),
        "{text}"
    );
    assert!(
        text.contains("| 68 points | 2 | 50.00 | 0.00 | 50.00 | 50.00 |"),
        "{text}"
    );
    assert!(text.contains("yaw 30 to 60° | 1 |"), "{text}");
    set.write("data/image00004.mat", b"MATLAB");
    let error = set.error(Protocol::Aflw2000);
    assert_eq!(error, "image00004.mat: shorter than its header");
}

#[test]
fn biwi() {
    let set = Set::new();
    let pose = |angles: [f64; 3]| {
        let r = rotation(angles).transpose().to_cols_array_2d();
        let rows: String = r
            .iter()
            .map(|[a, b, c]| format!("{a} {b} {c} \n"))
            .collect();
        format!("{rows}\n12.5 -30.1 910.0 \n")
    };
    set.write("data/01/frame_00003_pose.txt", pose([20.0, -10.0, 5.0]));
    set.write("data/01/frame_00004_pose.txt", pose([0.0; 3]));
    set.table(
        "01",
        &[
            Some(([20.0, -10.0, 5.0], face())),
            Some(([0.0, 6.0, 0.0], face())),
        ],
    );
    let text = set.text(Protocol::Biwi);
    assert!(
        text.contains("| 01 | 2 | 100.00 | 0.00 | 3.00 | 0.00 | 1.00 |"),
        "{text}"
    );
    set.write(
        "data/01/frame_00004_pose.txt",
        "1 0 0\n0 1 0\n0 0 2\n\n1 2 3\n",
    );
    let error = set.error(Protocol::Biwi);
    assert_eq!(error, "01/frame_00004_pose.txt, line 5: no rotation");
}

#[test]
fn wflw() {
    let set = Set::new();
    let mut points = [[0.0; 2]; 98];
    (points[60], points[72]) = ([0.0, 0.0], [100.0, 0.0]);
    let points: String = points.iter().map(|[x, y]| format!("{x} {y} ")).collect();
    let line = format!("{points}0 0 100 100 1 0 0 0 1 0 37--Soccer/a.jpg\n");
    set.write("data/list_98pt_rect_attr_test.txt", &line);
    let mut found = [[0.0, 2.0]; 68];
    found[45] = [100.0, 2.0];
    set.table("37--Soccer/a", &[Some(([0.0; 3], found))]);
    let text = set.text(Protocol::Wflw);
    for subset in ["all", "pose", "occlusion"] {
        let row = format!("| {subset} | 1 | 100.00 | 2.00 | 80.00 | 0.00 |");
        assert!(text.contains(&row), "{text}");
    }
    assert!(text.contains("| blur | 0 |"), "{text}");
    set.write("data/list_98pt_rect_attr_test.txt", format!("{line}1 2\n"));
    let error = set.error(Protocol::Wflw);
    let expected = "list_98pt_rect_attr_test.txt, line 2: 2 words, not 206 and a name";
    assert_eq!(error, expected);
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
    assert_eq!(error, "profile/a.csv, line 2: \"x\" is not a number");
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
    let flat: Vec<f32> = face()
        .iter()
        .flat_map(|[x, y]| [*x as f32, *y as f32, 0.0])
        .collect();
    let label = mat::tests::file(&[
        ("Pose_Para", [1, 7], &[0.1; 7]),
        ("pt3d_68", [3, 68], &flat),
    ]);
    let words: String = (0..206).map(|k| format!("{k} ")).collect();
    for _ in 0..2000 {
        let _ = aflw2000::parse(&corrupted(&mut rng, &label));
        let texts = [
            pts(face()),
            "0 0 0 40 0 0 0\n0.03 0 0 40 0 10 -5\n".into(),
            "1 0 0\n0 1 0\n0 0 1\n\n1 2 3\n".into(),
            format!("{words}a.jpg\n"),
        ];
        for (k, good) in texts.iter().enumerate() {
            let Ok(text) = text::Text::parse("t", corrupted(&mut rng, good.as_bytes())) else {
                continue;
            };
            match k {
                0 => drop(ibug::parse(&text)),
                1 => drop(boston::parse(&text)),
                2 => drop(biwi::parse(&text)),
                _ => drop(wflw::parse(&text)),
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
