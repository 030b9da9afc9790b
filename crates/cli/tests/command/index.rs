//! `posewise index` from the outside: tables, manifest, resuming, broken videos, signals.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::common::{arg, csv, gradient_clip, posewise};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::Value;
use sha2::Digest;

/// A rendered head; 20 frames a second.
const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");

/// A folder of videos: two with a face, one of them in a subfolder, one without, a broken one, and
/// what is no video.
fn videos(folder: &Path) {
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    std::fs::copy(DEMO, folder.join("a.y4m.gz")).unwrap();
    std::fs::copy(DEMO, folder.join("sub/b.y4m.gz")).unwrap();
    std::fs::write(folder.join("none.y4m"), gradient_clip(64, 48, 5)).unwrap();
    std::fs::write(folder.join("broken.y4m"), b"YUV4MPEG2 nonsense").unwrap();
    std::fs::write(folder.join("notes.txt"), b"no video").unwrap();
}

/// Exit status, standard output, standard error.
fn index(args: &[&str]) -> (Option<i32>, String, String) {
    let run = posewise().arg("index").args(args).assert();
    let output = run.get_output();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

fn manifest(out: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    let lines = text.lines();
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Every file below a folder, from it, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut folders = vec![folder.to_path_buf()];
    let mut found = Vec::new();
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => found.push(path.strip_prefix(folder).unwrap().to_path_buf()),
            }
        }
    }
    found.sort();
    found
}

#[test]
fn tables_manifest_and_resuming() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, out) = (dir.path().join("videos"), dir.path().join("out"));
    videos(&folder);
    let args = [arg(&folder), "--out", arg(&out)];
    let (status, said, errors) = index(&args);
    assert_eq!(status, Some(1), "a video is broken: {errors}");
    assert!(
        errors.contains("broken.y4m") && errors.contains("1 of 4"),
        "{errors}"
    );
    assert!(said.contains("tracked  3 videos, 245 frames"), "{said}");
    let names = ["a.y4m.gz.parquet", "manifest.jsonl", "none.y4m.parquet"];
    let expected: Vec<PathBuf> = names
        .iter()
        .chain(&["sub/b.y4m.gz.parquet"])
        .map(PathBuf::from)
        .collect();
    assert_eq!(files(&out), expected, "nothing else, nothing half-written");

    let lines = manifest(&out);
    let [a, broken, none, b] = &lines[..] else {
        panic!("four lines: {lines:?}");
    };
    assert_eq!(a["table"], "a.y4m.gz.parquet");
    assert_eq!(a["frames"], 120);
    let span = &a["spans"][0];
    assert!(span["frames"].as_u64().unwrap() > 50, "{a}");
    assert!(span["facing_share"].as_f64().unwrap() > 0.0, "{a}");
    assert_eq!(a["spans"], b["spans"]);
    assert!(broken["error"].as_str().unwrap().contains("broken.y4m"));
    let gap = serde_json::json!([{ "start_s": 0.0, "end_s": 0.2 }]);
    assert_eq!(
        (&none["spans"], &none["gaps"]),
        (&serde_json::json!([]), &gap)
    );

    // Again: what is there stays, what a killed run left goes, other settings make it anew.
    let changed = |path: &str| {
        std::fs::metadata(out.join(path))
            .unwrap()
            .modified()
            .unwrap()
    };
    let before = changed("a.y4m.gz.parquet");
    let left = temporary(&out.join("sub/b.y4m.gz.parquet"));
    std::fs::write(&left, "half").unwrap();
    let (_, said, _) = index(&args);
    assert!(
        said.contains("tracked  0 videos") && said.contains("present  3"),
        "{said}"
    );
    assert_eq!(changed("a.y4m.gz.parquet"), before);
    assert_eq!(files(&out), expected);
    assert_eq!(manifest(&out), lines);
    std::fs::write(folder.join("none.y4m"), gradient_clip(64, 48, 6)).unwrap();
    let (_, said, _) = index(&args);
    assert!(said.contains("tracked  1 videos, 6 frames"), "{said}");
    let (_, said, _) = index(&[&args[..], &["--min-face", "60"]].concat());
    assert!(said.contains("tracked  3 videos"), "{said}");
    let (_, said, _) = index(&[&args[..], &["--min-face", "60", "--gaze"]].concat());
    assert!(said.contains("tracked  3 videos"), "gaze counts: {said}");
    let natural = ["--min-face", "60", "--gaze", "--natural-gaze"];
    let (_, said, _) = index(&[&args[..], &natural].concat());
    assert!(said.contains("tracked  3 videos"), "this too: {said}");
}

/// The name under which process 1 writes a file until it is complete.
fn temporary(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap().as_encoded_bytes();
    let digest = sha2::Sha256::digest(name);
    let mark: String = digest[..8].iter().map(|b| format!("{b:02x}")).collect();
    let ending = path.extension().unwrap().display();
    path.with_file_name(format!(".posewise-1-{mark}.{ending}"))
}

/// Only what a killed run left of these tables is removed.
#[test]
fn files_of_others_stay() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, out) = (dir.path().join("videos"), dir.path().join("out"));
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("a.y4m"), gradient_clip(64, 48, 2)).unwrap();
    std::fs::create_dir_all(out.join("mine")).unwrap();
    let others = [
        ".posewise-notes",
        ".posewise-1-a.csv",
        ".posewise-77-0123456789abcdef.csv",
        "mine/.posewise-1-0123456789abcdef.parquet",
    ];
    for name in others {
        std::fs::write(out.join(name), "kept").unwrap();
    }
    let left = ["a.y4m.parquet", "manifest.jsonl"].map(|name| temporary(&out.join(name)));
    for left in &left {
        std::fs::write(left, "half").unwrap();
    }
    let (status, _, errors) = index(&[arg(&folder), "--out", arg(&out)]);
    assert_eq!(status, Some(0), "{errors}");
    let mut expected: Vec<PathBuf> = others.map(PathBuf::from).to_vec();
    expected.extend(["a.y4m.parquet", "manifest.jsonl"].map(PathBuf::from));
    expected.sort();
    assert_eq!(files(&out), expected);
}

/// Two runs on the same videos write the same, whatever addresses ffmpeg's messages hold.
#[cfg(unix)]
#[test]
fn manifests_of_equal_runs_are_equal() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    let ffmpeg = dir.path().join("ffmpeg");
    let script = "#!/bin/sh\necho \"[mov,mp4 @ 0x5578$$] moov atom not found\" >&2\nexit 1\n";
    std::fs::write(&ffmpeg, script).unwrap();
    std::fs::set_permissions(&ffmpeg, std::fs::Permissions::from_mode(0o755)).unwrap();
    let video = dir.path().join("broken.mp4");
    std::fs::write(&video, "no video").unwrap();
    let paths = std::env::var("PATH").unwrap();
    let lines = ["one", "two"].map(|name| {
        let out = dir.path().join(name);
        let mut command = posewise();
        command.args(["index", arg(&video), "--out", arg(&out)]);
        command.env("PATH", format!("{}:{paths}", dir.path().display()));
        command.assert().code(1);
        manifest(&out)
    });
    assert_eq!(lines[0], lines[1]);
    let said = lines[0][0]["error"].as_str().unwrap();
    assert!(said.contains("[mov,mp4] moov atom not found"), "{said}");
}

/// The numbers are those of `track --csv`, with the model and the settings beside them.
#[test]
fn a_table_has_the_columns_and_rows_of_the_csv() {
    let dir = tempfile::tempdir().unwrap();
    let list = dir.path().join("list.txt");
    std::fs::write(&list, format!("# one\n\n{DEMO}\n{DEMO}\n")).unwrap();
    let out = dir.path().join("out");
    let (status, _, errors) = index(&[arg(&list), "--out", arg(&out), "--quiet"]);
    assert_eq!((status, &*errors), (Some(0), ""));
    let lines = manifest(&out);
    assert_eq!(lines.len(), 1, "named twice, tracked once");
    let table = out.join(lines[0]["table"].as_str().unwrap());
    let reader = SerializedFileReader::new(std::fs::File::open(table).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let entries = metadata.key_value_metadata().unwrap();
    let settings = entries
        .iter()
        .find(|e| e.key == "posewise.settings")
        .unwrap();
    let settings: Value = serde_json::from_str(settings.value.as_ref().unwrap()).unwrap();
    assert_eq!(settings["model_sha256"].as_str().unwrap().len(), 64);

    let csv = csv(DEMO, b"");
    let mut csv = csv.lines();
    let names: Vec<&str> = csv.next().unwrap().split(',').collect();
    let mut rows = 0;
    for (row, line) in reader.get_row_iter(None).unwrap().zip(csv.by_ref()) {
        let row = row.unwrap();
        let columns = row.get_column_iter().zip(&names).zip(line.split(','));
        for (((name, field), expected), text) in columns {
            assert_eq!(name, expected);
            let decimals = text.rsplit_once('.').map_or(0, |(_, part)| part.len());
            let value = match field {
                Field::Str(word) => word.clone(),
                Field::Long(number) => number.to_string(),
                Field::Double(number) => format!("{number:.decimals$}"),
                Field::Float(number) => format!("{:.decimals$}", f64::from(*number)),
                other => panic!("{name}: {other}"),
            };
            assert_eq!(value, text, "{name} of row {rows}");
        }
        rows += 1;
    }
    assert_eq!((rows, csv.next()), (120, None));
}

#[test]
fn wrong_inputs_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let run = |input: &str| index(&[input, "--out", arg(&out)]);
    let empty = dir.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    for (input, word) in [
        ("nowhere", "no such file or folder"),
        (arg(&empty), "has no videos"),
    ] {
        let (status, _, errors) = run(input);
        assert_eq!(status, Some(1));
        assert!(errors.contains(word) && errors.contains(input), "{errors}");
    }
    assert!(!out.exists(), "nothing is made for nothing");
    let list = dir.path().join("list.txt");
    std::fs::write(&list, "x.mp4\n../x.mp4\n").unwrap();
    let (status, _, errors) = run(arg(&list));
    assert_eq!(status, Some(1));
    assert!(errors.contains("the same table"), "{errors}");
    std::fs::create_dir(&out).unwrap();
    let lock = std::fs::File::open(&out).unwrap();
    lock.lock().unwrap();
    let (status, _, errors) = run(DEMO);
    assert!(
        status == Some(1) && errors.contains("another run"),
        "{errors}"
    );
    drop(lock);
    std::fs::write(&list, "x.mp4\n").unwrap();
    let (status, _, errors) = run(arg(&list));
    assert!(status == Some(1) && errors.contains("x.mp4"), "{errors}");
}

/// A signal ends it at once: what is complete stays, what is not leaves nothing.
#[cfg(unix)]
#[test]
fn an_interrupted_run_is_taken_up_again() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, out) = (dir.path().join("videos"), dir.path().join("out"));
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(DEMO, folder.join("a.y4m.gz")).unwrap();
    // Long enough to be interrupted.
    std::fs::write(folder.join("b.y4m"), gradient_clip(320, 240, 2000)).unwrap();
    let args = ["index", arg(&folder), "--out", arg(&out), "--threads", "1"];
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("posewise"))
        .args(args)
        .args(["--quiet"])
        .spawn()
        .unwrap();
    let done = out.join("a.y4m.gz.parquet");
    while !done.exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let pid = child.id().to_string();
    let kill = std::process::Command::new("kill")
        .args(["-INT", &pid])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let names = ["a.y4m.gz.parquet", "manifest.jsonl"].map(PathBuf::from);
    assert_eq!(files(&out), names);
    assert_eq!(manifest(&out).len(), 1);
    std::fs::write(folder.join("b.y4m"), gradient_clip(64, 48, 2)).unwrap();
    let (status, said, _) = index(&args[1..]);
    assert_eq!(status, Some(0));
    assert!(said.contains("tracked  1 videos, 2 frames"), "{said}");
}
