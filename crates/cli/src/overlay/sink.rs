//! Where overlay pictures go: a y4m file, a folder of PNGs, or a video through `ffmpeg`.

use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};

use anyhow::{Context, Result, anyhow, bail};
use image::RgbImage;

use crate::destination::{self, Destination};
use crate::output;

/// A place for pictures.
pub struct Overlay {
    /// As given; a folder's pictures are written there.
    path: PathBuf,
    /// The file of a video.
    destination: Option<Destination>,
    fps: f64,
    size: Option<(u32, u32)>,
    sink: Sink,
}

enum Sink {
    /// Opened when the first picture gives the size.
    Later(Kind),
    Folder(u64),
    Y4m(BufWriter<File>),
    Ffmpeg(Child, BufWriter<ChildStdin>),
}

#[derive(Clone, Copy)]
enum Kind {
    Y4m,
    Video,
}

impl Overlay {
    /// Decides by the name: `.y4m`, another extension → video through ffmpeg, none → folder.
    pub fn create(path: &Path, fps: f64) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let sink = if path.is_dir() || extension.is_empty() {
            std::fs::create_dir_all(path)
                .with_context(|| format!("cannot make folder {}", path.display()))?;
            Sink::Folder(0)
        } else if extension.eq_ignore_ascii_case("y4m") {
            Sink::Later(Kind::Y4m)
        } else {
            Sink::Later(Kind::Video)
        };
        let is_folder = matches!(sink, Sink::Folder(_));
        Ok(Overlay {
            path: path.to_path_buf(),
            destination: (!is_folder).then(|| Destination::new(path)),
            fps,
            size: None,
            sink,
        })
    }

    /// Adds a picture. All of a video's must have one size.
    pub fn write(&mut self, image: &RgbImage) -> Result<()> {
        if let Sink::Later(kind) = self.sink {
            self.size = Some(image.dimensions());
            self.sink = match kind {
                Kind::Y4m => self.open_y4m(image.dimensions())?,
                Kind::Video => self.open_ffmpeg(image.dimensions())?,
            };
        }
        if self.size.is_some_and(|size| size != image.dimensions()) {
            bail!("the pictures differ in size: give --overlay a folder instead of a video");
        }
        let name = self.path.display();
        match &mut self.sink {
            Sink::Folder(count) => {
                *count += 1;
                let file = destination::numbered(&self.path, *count);
                save(image, &file)
            }
            Sink::Y4m(out) => {
                let written = (out.write_all(b"FRAME\n"))
                    .and_then(|()| out.write_all(&yuv444(image)))
                    .with_context(|| format!("cannot write {name}"));
                if written.is_err() {
                    // Nothing of it gets its name.
                    self.destination = None;
                }
                written
            }
            Sink::Ffmpeg(_, pipe) => {
                if pipe.write_all(image.as_raw()).is_err() {
                    // The pipe is shut: finish() has ffmpeg's reason.
                    self.close()?;
                    bail!("cannot write {}: ffmpeg ended early", self.path.display());
                }
                Ok(())
            }
            Sink::Later(_) => Ok(()),
        }
    }

    /// Closes the file.
    pub fn finish(mut self) -> Result<()> {
        let is_written = !matches!(self.sink, Sink::Later(_));
        self.close()?;
        match self.destination.take().filter(|_| is_written) {
            Some(destination) => destination.finish(),
            None => Ok(()),
        }
    }

    /// Where a video is written.
    fn file(&self) -> &Path {
        let file = self.destination.as_ref().map(Destination::path);
        file.unwrap_or(&self.path)
    }

    fn close(&mut self) -> Result<()> {
        let name = self.path.display().to_string();
        match std::mem::replace(&mut self.sink, Sink::Folder(0)) {
            Sink::Y4m(mut out) => out.flush().with_context(|| format!("cannot write {name}")),
            Sink::Ffmpeg(mut child, pipe) => {
                drop(pipe);
                let mut said = String::new();
                if let Some(mut stderr) = child.stderr.take() {
                    // What cannot be read of the messages is no reason to fail.
                    let _ = stderr.read_to_string(&mut said);
                }
                if child.wait()?.success() {
                    return Ok(());
                }
                let reason = said.lines().next().unwrap_or("no message");
                bail!("cannot write {name}: ffmpeg says: {reason}")
            }
            Sink::Folder(_) | Sink::Later(_) => Ok(()),
        }
    }

    fn open_y4m(&self, (width, height): (u32, u32)) -> Result<Sink> {
        let name = self.path.display();
        let file = File::create(self.file()).with_context(|| format!("cannot write {name}"))?;
        let mut out = BufWriter::new(file);
        let (num, den) = ratio(self.fps);
        writeln!(
            out,
            "YUV4MPEG2 W{width} H{height} F{num}:{den} Ip A1:1 C444 XCOLORRANGE=FULL"
        )
        .with_context(|| format!("cannot write {name}"))?;
        Ok(Sink::Y4m(out))
    }

    fn open_ffmpeg(&self, (width, height): (u32, u32)) -> Result<Sink> {
        let (num, den) = ratio(self.fps);
        let mut url = std::ffi::OsString::from("file:");
        url.push(self.file());
        let mut command = Command::new("ffmpeg");
        command
            .args(["-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
            .args(["-s", &format!("{width}x{height}")])
            .args(["-r", &format!("{num}/{den}"), "-i", "-"])
            // Common codecs want even sides.
            .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"])
            .args(["-pix_fmt", "yuv420p"])
            .arg(url)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        // Ctrl-C is for this program, which then closes the pipe.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound => anyhow!(
                "the program `ffmpeg` is needed to write {}, and it is not installed \
                     (Debian: apt install ffmpeg); --overlay also writes .y4m and folders of PNGs",
                self.path.display()
            ),
            _ => anyhow!("cannot start ffmpeg: {e}"),
        })?;
        let pipe = child.stdin.take().ok_or_else(|| anyhow!("no pipe"))?;
        let pipe = BufWriter::with_capacity(1 << 20, pipe);
        Ok(Sink::Ffmpeg(child, pipe))
    }
}

/// Writes a picture, which has its name when it is complete.
pub fn save(image: &RgbImage, path: &Path) -> Result<()> {
    let destination = Destination::new(path);
    output::write_png(destination.path(), image)?;
    destination.finish()
}

/// A frame rate as a ratio: whole numbers, the NTSC rates, else thousandths.
fn ratio(fps: f64) -> (u64, u64) {
    for den in [1u64, 1001] {
        let num = fps * den as f64;
        if (num - num.round()).abs() < 1e-6 * num {
            return (num.round() as u64, den);
        }
    }
    ((fps * 1000.0).round().max(1.0) as u64, 1000)
}

/// Planar full-range ITU-R BT.601.
fn yuv444(image: &RgbImage) -> Vec<u8> {
    let plane = |weights: [f32; 3], offset: f32| {
        image.pixels().map(move |p| {
            let sum: f32 =
                p.0.iter()
                    .zip(weights)
                    .map(|(v, w)| f32::from(*v) * w)
                    .sum();
            (sum + offset).round().clamp(0.0, 255.0) as u8
        })
    };
    plane([0.299, 0.587, 0.114], 0.0)
        .chain(plane([-0.168_736, -0.331_264, 0.5], 128.0))
        .chain(plane([0.5, -0.418_688, -0.081_312], 128.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y4m_comes_back_in_colour() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out.y4m");
        let image = RgbImage::from_fn(7, 5, |x, y| {
            image::Rgb([(x * 36) as u8, (y * 60) as u8, 200])
        });
        let mut overlay = Overlay::create(&path, 30_000.0 / 1001.0).unwrap();
        overlay.write(&image).unwrap();
        overlay.write(&image).unwrap();
        assert!(overlay.write(&RgbImage::new(3, 3)).is_err());
        overlay.finish().unwrap();
        let mut source = crate::source::open(path.to_str().unwrap(), 30.0).unwrap();
        assert_eq!(source.total(), Some(2));
        assert!((source.fps() - 29.97).abs() < 0.001);
        let back = source.next().unwrap().unwrap().upright_rgb().unwrap();
        for (a, b) in image.pixels().zip(back.pixels()) {
            for (a, b) in a.0.into_iter().zip(b.0) {
                assert!(a.abs_diff(b) <= 2, "{a} {b}");
            }
        }
        assert!(source.next().unwrap().is_some());
        assert!(source.next().unwrap().is_none());
    }

    #[test]
    fn rates_become_ratios() {
        assert_eq!(ratio(25.0), (25, 1));
        assert_eq!(ratio(30_000.0 / 1001.0), (30_000, 1001));
        assert_eq!(ratio(12.5), (12_500, 1000));
    }
}
