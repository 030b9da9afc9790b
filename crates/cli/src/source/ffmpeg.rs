//! Any video file, decoded by the `ffmpeg` program into a y4m pipe.
//!
//! The coded luma is passed on as it is (no range conversion), so that
//! `ffmpeg -i x … -f yuv4mpegpipe - | posewise track -` gives the same results.

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

use anyhow::{Result, anyhow, bail};

use super::stream::Source;
use super::y4m::Y4mSource;
use crate::picture::Picture;

/// A running `ffmpeg`.
pub struct FfmpegSource {
    name: String,
    child: Child,
    messages: Option<JoinHandle<String>>,
    y4m: Y4mSource,
    frames: u64,
    warning: Option<String>,
}

/// The message for a program that is not there.
pub fn missing(program: &str, what: &str) -> String {
    format!(
        "the program `{program}` is needed to {what}, and it is not installed \
         (Debian: apt install ffmpeg); .y4m files and folders of pictures need no program"
    )
}

impl FfmpegSource {
    /// Starts decoding.
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        // "file:" keeps names with colons or leading dashes from being taken for something else.
        let mut command = Command::new("ffmpeg");
        command
            .args(["-v", "error", "-nostdin", "-i"])
            .arg(file_url(path))
            .args(["-map", "0:v:0", "-pix_fmt", "yuv420p"])
            .args(["-f", "yuv4mpegpipe", "-"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        // Ctrl-C is for this program, which then reads no further.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound => anyhow!(missing("ffmpeg", &format!("read {name}"))),
            _ => anyhow!("cannot start ffmpeg: {e}"),
        })?;
        let mut stderr = child.stderr.take().ok_or_else(|| anyhow!("no pipe"))?;
        let messages = std::thread::spawn(move || {
            let mut bytes = Vec::new();
            // What cannot be read of the messages is no reason to fail.
            let _ = stderr.read_to_end(&mut bytes);
            String::from_utf8_lossy(&bytes).into_owned()
        });
        let stdout = child.stdout.take().ok_or_else(|| anyhow!("no pipe"))?;
        let stdout = std::io::BufReader::with_capacity(1 << 20, stdout);
        match Y4mSource::new(stdout, &name) {
            Ok(y4m) => Ok(FfmpegSource {
                y4m: y4m.with_total(frame_count(path)),
                name,
                child,
                messages: Some(messages),
                frames: 0,
                warning: None,
            }),
            Err(error) => {
                let _ = child.wait();
                let said = first_line(&messages.join().unwrap_or_default());
                if said.is_empty() {
                    bail!("{name}: the video has no frames ({error})");
                }
                bail!("cannot decode {name}: {said}");
            }
        }
    }
}

impl Source for FfmpegSource {
    fn next(&mut self) -> Result<Option<Picture>> {
        let picture = self.y4m.next();
        if let Ok(Some(_)) = picture {
            self.frames += 1;
            return picture;
        }
        // The pipe has ended: learn whether ffmpeg was content.
        let status = self.child.wait()?;
        let said = self.messages.take().and_then(|m| m.join().ok());
        let said = first_line(&said.unwrap_or_default());
        if self.frames == 0 || !status.success() {
            bail!(
                "{}: ffmpeg stopped after {} frames: {}",
                self.name,
                self.frames,
                if said.is_empty() { "no message" } else { &said }
            );
        }
        if !said.is_empty() {
            self.warning = Some(format!("{}: ffmpeg says: {said}", self.name));
        }
        picture
    }

    fn fps(&self) -> f64 {
        self.y4m.fps()
    }

    fn total(&self) -> Option<u64> {
        self.y4m.total()
    }

    fn warning(&self) -> Option<String> {
        self.warning.clone()
    }
}

impl Drop for FfmpegSource {
    fn drop(&mut self) {
        // Both fail when the program has ended by itself, which is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn file_url(path: &Path) -> std::ffi::OsString {
    let mut url = std::ffi::OsString::from("file:");
    url.push(path);
    url
}

/// Frames as the container states them, for the progress bar; `None` if ffprobe does not know.
fn frame_count(path: &Path) -> Option<u64> {
    let out = Command::new("ffprobe")
        .args(["-v", "error", "-select_streams", "v:0", "-show_entries"])
        .args(["stream=nb_frames", "-of", "csv=p=0"])
        .arg(file_url(path))
        .stdin(Stdio::null())
        .output()
        .ok()?;
    String::from_utf8_lossy(&out.stdout).trim().parse().ok()
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or("").trim().to_string()
}
