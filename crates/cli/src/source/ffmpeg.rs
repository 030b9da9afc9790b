//! Any video file or address, decoded by the `ffmpeg` program into a y4m pipe.
//!
//! The coded luma is passed on as it is (no range conversion), so that
//! `ffmpeg -i x … -f yuv4mpegpipe - | posewise track -` gives the same results.

use std::ffi::OsString;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Result, anyhow, bail};

use super::address::Address;
use super::patient::Patient;
use super::stream::Source;
use super::y4m::Y4mSource;
use crate::picture::Picture;

/// How long an address may be silent. Source: chosen; cameras need a second or two to begin.
/// `ffmpeg` has such settings too, but names them differently from version to version.
const PATIENCE: Duration = Duration::from_secs(10);

/// Most bytes that are kept of its messages.
const MAX_MESSAGES: u64 = 64 << 10;

/// A running `ffmpeg`.
pub struct FfmpegSource {
    name: String,
    /// Where the input is elsewhere.
    address: Option<Address>,
    child: Child,
    messages: Option<JoinHandle<String>>,
    y4m: Y4mSource,
    frames: u64,
    total: Option<u64>,
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
    /// Starts decoding a file.
    pub fn open(path: &Path) -> Result<Self> {
        // "file:" keeps names with colons or leading dashes from being taken for something else.
        let input = ["-i".into(), file_url(path)];
        let mut source = Self::start(path.display().to_string(), None, input)?;
        source.total = frame_count(path);
        Ok(source)
    }

    /// Starts to decode what an address gives.
    pub fn open_address(address: Address) -> Result<Self> {
        let input: Vec<_> = address.arguments().iter().map(OsString::from).collect();
        Self::start(address.name().to_string(), Some(address), input)
    }

    fn start(
        name: String,
        address: Option<Address>,
        input: impl IntoIterator<Item = OsString>,
    ) -> Result<Self> {
        let mut command = Command::new("ffmpeg");
        command
            .args(["-v", "error", "-nostdin"])
            .args(input)
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
            // What cannot be read of the messages is no reason to fail; only the first is shown.
            let _ = (&mut stderr).take(MAX_MESSAGES).read_to_end(&mut bytes);
            let _ = std::io::copy(&mut stderr, &mut std::io::sink());
            String::from_utf8_lossy(&bytes).into_owned()
        });
        let stdout = child.stdout.take().ok_or_else(|| anyhow!("no pipe"))?;
        let stdout: Box<dyn Read> = match &address {
            Some(_) => Box::new(Patient::new(stdout, PATIENCE)),
            None => Box::new(std::io::BufReader::with_capacity(1 << 20, stdout)),
        };
        match Y4mSource::new(stdout, &name) {
            Ok(y4m) => Ok(FfmpegSource {
                y4m,
                name,
                address,
                child,
                messages: Some(messages),
                frames: 0,
                total: None,
                warning: None,
            }),
            Err(error) => {
                // It has ended by itself, or waits for the other side.
                let _ = child.kill();
                let _ = child.wait();
                let said = first_line(&messages.join().unwrap_or_default());
                match &address {
                    Some(_) if said.is_empty() => Err(error),
                    None if said.is_empty() => bail!("{name}: the video has no frames ({error})"),
                    Some(address) => bail!("cannot read {name}: {}", address.redacted(&said)),
                    None => bail!("cannot decode {name}: {said}"),
                }
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
        if picture.is_err() && self.address.is_some() {
            // It waits for the other side.
            let _ = self.child.kill();
        }
        // The pipe has ended: learn whether ffmpeg was content.
        let status = self.child.wait()?;
        let said = self.messages.take().and_then(|m| m.join().ok());
        let mut said = first_line(&said.unwrap_or_default());
        if let Some(address) = &self.address {
            said = address.redacted(&said);
        }
        if self.frames == 0 || !status.success() {
            let (name, frames) = (&self.name, self.frames);
            match &picture {
                Err(error) if said.is_empty() => said = error.to_string(),
                _ if said.is_empty() => said = "no message".into(),
                _ => {}
            }
            bail!("{name}: ffmpeg stopped after {frames} frames: {said}");
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
        self.total
    }

    fn is_live(&self) -> bool {
        self.address.as_ref().is_some_and(Address::is_live)
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

fn file_url(path: &Path) -> OsString {
    let mut url = OsString::from("file:");
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

/// The first message, without the address in `[mov,mp4 @ 0x5578abcd]`, which is another each time.
fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or("").trim();
    let mut parts = line.split(" @ 0x");
    let mut out = parts.next().unwrap_or("").to_string();
    for part in parts {
        out += part.trim_start_matches(|c: char| c.is_ascii_hexdigit());
    }
    out
}
