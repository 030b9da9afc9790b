//! Output files of `posewise track`: never over an input or each other, whole or not at all, and in
//! order when a signal ends the command.
#![cfg(unix)]

use crate::common::{arg, fails_with, gradient_clip, posewise};
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
