//! Output files of `posewise track`: never over an input or each other, whole or not at all, and in
//! order when a signal ends the command.
#![cfg(unix)]

use crate::common::{arg, fails_with, gradient_clip, limited, posewise};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Names in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
    let mut names: Vec<String> = (entries.map(name))
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn inputs_are_not_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let clip = gradient_clip(64, 48, 3);
    std::fs::write(path("clip.y4m"), &clip).unwrap();
    std::fs::hard_link(path("clip.y4m"), path("hard.y4m")).unwrap();
    std::os::unix::fs::symlink(path("clip.y4m"), path("link.y4m")).unwrap();
    std::fs::write(path("model.posewise"), "not touched").unwrap();
    std::fs::create_dir(path("pictures")).unwrap();
    let picture = image::RgbImage::from_pixel(40, 30, image::Rgb([90; 3]));
    picture.save(path("pictures/000001.png")).unwrap();
    let before = std::fs::read(path("pictures/000001.png")).unwrap();

    let (clip_path, pictures) = (path("clip.y4m"), path("pictures"));
    let refused = |input: &str, rest: &[&str]| {
        fails_with(
            &[&["track", input], rest].concat(),
            Vec::new(),
            &["would overwrite"],
        );
    };
    for output in ["clip.y4m", "hard.y4m", "link.y4m", "pictures/../clip.y4m"] {
        for option in ["--overlay", "--csv", "--jsonl"] {
            refused(arg(&clip_path), &[option, arg(&path(output))]);
        }
    }
    let model = path("model.posewise");
    refused(
        arg(&clip_path),
        &["--model", arg(&model), "--csv", arg(&model)],
    );
    refused(arg(&pictures), &["--overlay", arg(&pictures)]);
    refused(
        arg(&pictures),
        &["--csv", arg(&path("pictures/000001.png"))],
    );
    refused(arg(&path("pictures/*.png")), &["--overlay", arg(&pictures)]);
    let picture = path("pictures/000001.png");
    refused(arg(&picture), &["--overlay", arg(&pictures)]);
    let plot = path("pictures/000002.png");
    refused(
        arg(&clip_path),
        &["--plot", arg(&plot), "--overlay", arg(&pictures)],
    );
    let (new, same) = (path("new.csv"), path("pictures/../new.csv"));
    refused(
        arg(&clip_path),
        &["--csv", arg(&new), "--jsonl", arg(&same)],
    );
    refused(arg(&clip_path), &["--csv", "-", "--jsonl", "-"]);
    refused(arg(&clip_path), &[&format!("--log={}", arg(&clip_path))]);

    assert_eq!(std::fs::read(&clip_path).unwrap(), clip);
    assert_eq!(std::fs::read(&model).unwrap(), b"not touched");
    assert_eq!(std::fs::read(path("pictures/000001.png")).unwrap(), before);
    assert!(!new.exists());
}

/// A command that reads y4m from a pipe that stays open.
struct Piped(Child);

impl Piped {
    fn start(arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_posewise"));
        command.args(["track", "-"]).args(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::null());
        Piped(command.stderr(Stdio::null()).spawn().unwrap())
    }

    fn feed(&mut self, bytes: &[u8]) {
        let stdin = self.0.stdin.as_mut().unwrap();
        // The program may have ended before it has read all.
        let _ = stdin.write_all(bytes);
    }

    /// Waits until its first output file is open; signals are handled from then on.
    fn wait_for_output(&mut self, folder: &Path) {
        while !names(folder)
            .iter()
            .any(|name| name.starts_with(".posewise-"))
        {
            assert!(self.0.try_wait().unwrap().is_none());
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
    }

    fn signal(&self, name: &str) {
        let id = self.0.id().to_string();
        assert!(
            Command::new("kill")
                .args([name, &id])
                .status()
                .unwrap()
                .success()
        );
    }
}

/// The header of a clip, and three frames.
fn parts() -> (Vec<u8>, Vec<u8>) {
    let mut header = gradient_clip(64, 48, 3);
    let end = header.iter().position(|b| *b == b'\n').unwrap() + 1;
    let frames = header.split_off(end);
    (header, frames)
}

#[test]
fn a_signal_ends_in_order() {
    let (header, frames) = parts();
    for (name, status) in [("-INT", 130), ("-TERM", 143)] {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        std::fs::write(path("t.csv"), "old").unwrap();
        let (csv, overlay, plot) = (path("t.csv"), path("t.y4m"), path("t.svg"));
        let mut run = Piped::start(&[
            "--csv",
            arg(&csv),
            "--overlay",
            arg(&overlay),
            "--plot",
            arg(&plot),
        ]);
        run.feed(&header);
        run.wait_for_output(dir.path());
        run.signal(name);
        std::thread::sleep(std::time::Duration::from_millis(200));
        assert_eq!(std::fs::read(&csv).unwrap(), b"old", "it is not complete");
        run.feed(&frames);
        assert_eq!(run.0.wait().unwrap().code(), Some(status));
        let rows = std::fs::read_to_string(&csv).unwrap();
        assert_eq!(rows.lines().count(), 1 + 1, "{rows}");
        assert_eq!(names(dir.path()), ["t.csv", "t.svg", "t.y4m"]);
    }
}

#[test]
fn a_second_signal_ends_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let mut run = Piped::start(&["--csv", arg(&dir.path().join("t.csv"))]);
    run.feed(&parts().0);
    run.wait_for_output(dir.path());
    // No frame comes, so the first signal has no effect yet.
    run.signal("-INT");
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert!(run.0.try_wait().unwrap().is_none());
    run.signal("-INT");
    assert_eq!(run.0.wait().unwrap().code(), Some(130));
}

#[test]
fn pipes_with_names_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let pipe = dir.path().join("pipe.y4m");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let to = pipe.clone();
    let writer = std::thread::spawn(move || std::fs::write(to, gradient_clip(64, 48, 3)));
    let run = posewise()
        .args(["track", arg(&pipe), "--csv", "-"])
        .assert();
    let out = run.success().get_output().stdout.clone();
    assert_eq!(String::from_utf8(out).unwrap().lines().count(), 4);
    writer.join().unwrap().unwrap();
}

/// What does not fit leaves what was there, and nothing half-written.
#[test]
fn a_full_disk_replaces_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let clip = path("clip.y4m");
    std::fs::write(&clip, gradient_clip(64, 48, 40)).unwrap();
    for name in ["old.y4m", "old.csv"] {
        std::fs::write(path(name), "old").unwrap();
    }
    // A frame of the overlay has 9 KB, a row of the CSV some 4 KB.
    for (option, name) in [("--overlay", "old.y4m"), ("--csv", "old.csv")] {
        let file = path(name);
        let args = ["track", arg(&clip), option, arg(&file)];
        let run = limited("-f 20").args(args).assert();
        let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert_eq!(run.get_output().status.code(), Some(1), "{name}: {said}");
        assert!(said.contains("cannot write"), "{said}");
        assert_eq!(std::fs::read(&file).unwrap(), b"old", "{name}");
    }
    assert_eq!(names(dir.path()), ["clip.y4m", "old.csv", "old.y4m"]);
}

#[test]
fn pictures_and_the_demo_are_whole_or_not_there() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("pictures");
    std::fs::write(dir.path().join("clip.y4m"), gradient_clip(640, 480, 2)).unwrap();
    std::fs::write(dir.path().join("posewise-demo.csv"), "old").unwrap();
    let mut track = limited("-f 4");
    track.args(["track", "clip.y4m", "--overlay", "pictures"]);
    track.current_dir(dir.path()).assert().code(1);
    assert!(names(&folder).is_empty(), "{:?}", names(&folder));
    let mut demo = limited("-f 4");
    demo.arg("demo").current_dir(dir.path()).assert().code(1);
    let demo = std::fs::read(dir.path().join("posewise-demo.csv")).unwrap();
    assert_eq!(demo, b"old");
    assert_eq!(
        names(dir.path()),
        ["clip.y4m", "pictures", "posewise-demo.csv"]
    );
}

/// Names of any bytes, as long as the system allows.
#[test]
fn every_name_can_be_written() {
    use std::os::unix::ffi::OsStrExt;
    let dir = tempfile::tempdir().unwrap();
    let clip = dir.path().join("clip.y4m");
    std::fs::write(&clip, gradient_clip(64, 48, 3)).unwrap();
    let path = |name: &[u8]| dir.path().join(std::ffi::OsStr::from_bytes(name));
    let (csv, jsonl) = (path(b"t\xff.txt"), path(b"t\xfe.txt"));
    let mut two = posewise();
    two.arg("track").arg(&clip).arg("--csv").arg(&csv);
    two.arg("--jsonl").arg(&jsonl).assert().success();
    let rows = |path: &Path| std::fs::read_to_string(path).unwrap().lines().count();
    assert_eq!((rows(&csv), rows(&jsonl)), (1 + 3, 3));
    let long = path(&[b'x'; 255]);
    let mut one = posewise();
    one.arg("track").arg(&clip).arg("--csv").arg(&long);
    one.assert().success();
    assert_eq!(rows(&long), 1 + 3);
    assert_eq!(names(dir.path()).len(), 4);
}
