//! Frames of videos and pictures: the luma that `posewise track` sees.

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;
use posewise::image::{Frame, FrameLayout};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Longest line of a y4m header \[bytes\]; ffmpeg writes below 200.
const HEADER_LIMIT: usize = 4096;

/// Luma of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Luma {
    /// \[px\].
    pub width: usize,
    /// \[px\].
    pub height: usize,
    /// Row by row.
    pub pixels: Vec<u8>,
}

impl Luma {
    /// Reads a picture.
    pub fn read(path: &Path) -> Result<Luma> {
        let picture = image::open(path).with_context(|| path.display().to_string())?;
        let grey = picture.to_luma8();
        Ok(Luma {
            width: grey.width() as usize,
            height: grey.height() as usize,
            pixels: grey.into_raw(),
        })
    }

    /// As the library takes it.
    pub fn frame(&self) -> Result<Frame<'_>> {
        let layout = FrameLayout::grey(self.width as u32, self.height as u32);
        Frame::new(&layout, &self.pixels).map_err(|e| anyhow::anyhow!("{e}"))
    }
}

/// A y4m stream: a file behind gzip, or what the `ffmpeg` program decodes. The coded luma is passed
/// on unchanged, as `posewise track` does.
pub struct Video {
    from: Box<dyn Read>,
    decoder: Option<Child>,
    luma: Luma,
    /// Bytes of a frame after its luma.
    chroma: u64,
}

impl Video {
    /// Opens `.y4m`, `.y4m.gz`, or any file that `ffmpeg` decodes.
    pub fn open(path: &Path) -> Result<Video> {
        let name = path.display().to_string();
        let lower = name.to_lowercase();
        let file = || -> Result<BufReader<File>> {
            Ok(BufReader::new(
                File::open(path).with_context(|| name.clone())?,
            ))
        };
        let (from, decoder): (Box<dyn Read>, _) = if lower.ends_with(".y4m.gz") {
            (Box::new(MultiGzDecoder::new(file()?)), None)
        } else if lower.ends_with(".y4m") {
            (Box::new(file()?), None)
        } else {
            file()?;
            let mut child = Command::new("ffmpeg")
                .args(["-v", "error", "-nostdin", "-i"])
                .arg(path)
                .args(["-map", "0:v:0", "-pix_fmt", "yuv420p"])
                .args(["-f", "yuv4mpegpipe", "-"])
                .stdin(Stdio::null())
                .stdout(Stdio::piped())
                .spawn()
                .context("the ffmpeg program")?;
            let out = child.stdout.take().context("no output of ffmpeg")?;
            (
                Box::new(BufReader::with_capacity(1 << 20, out)),
                Some(child),
            )
        };
        Video::parse(from, decoder).with_context(|| format!("{name}: not a video"))
    }

    fn parse(mut from: Box<dyn Read>, decoder: Option<Child>) -> Result<Video> {
        let header = line(&mut from)?;
        ensure!(header.starts_with("YUV4MPEG2"), "no y4m header");
        let word = |mark: char| header.split(' ').find_map(|w| w.strip_prefix(mark));
        let size = |mark| word(mark).and_then(|w| w.parse::<usize>().ok());
        let (Some(width), Some(height)) = (size('W'), size('H')) else {
            bail!("no size in {header:?}");
        };
        ensure!(
            (1..=16384).contains(&width) && (1..=16384).contains(&height),
            "a frame of {width}×{height}"
        );
        let half = (width.div_ceil(2) * height.div_ceil(2)) as u64;
        let chroma = match word('C').unwrap_or("420") {
            "mono" => 0,
            "420" | "420jpeg" | "420mpeg2" | "420paldv" => 2 * half,
            other => bail!("colour space {other}"),
        };
        Ok(Video {
            from,
            decoder,
            luma: Luma {
                width,
                height,
                pixels: vec![0; width * height],
            },
            chroma,
        })
    }

    /// The next frame, or `None` at the end.
    pub fn next(&mut self) -> Result<Option<&Luma>> {
        if !line(&mut self.from)?.starts_with("FRAME") {
            return Ok(None);
        }
        self.from.read_exact(&mut self.luma.pixels)?;
        let skipped = (&mut self.from).take(self.chroma);
        std::io::copy(&mut { skipped }, &mut std::io::sink())?;
        Ok(Some(&self.luma))
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        if let Some(child) = &mut self.decoder {
            // Both fail when the program has ended by itself, which is fine.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Up to the end of the line, or of the stream.
fn line(from: &mut impl Read) -> Result<String> {
    let mut out = String::new();
    let mut byte = [0];
    while from.read(&mut byte)? == 1 && byte[0] != b'\n' {
        ensure!(out.len() < HEADER_LIMIT, "a line without an end");
        out.push(byte[0] as char);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &'static [u8]) -> Result<Video> {
        Video::parse(Box::new(bytes), None)
    }

    #[test]
    fn luma_of_both_colour_spaces() {
        let mut colour = parse(b"YUV4MPEG2 W2 H2 C420jpeg\nFRAME\n1234uvFRAME\n5678uv").unwrap();
        assert_eq!(colour.next().unwrap().unwrap().pixels, b"1234");
        assert_eq!(colour.next().unwrap().unwrap().pixels, b"5678");
        assert!(colour.next().unwrap().is_none());
        let mut grey = parse(b"YUV4MPEG2 W3 H1 Cmono\nFRAME\nabcFRAME\nde").unwrap();
        assert_eq!(grey.next().unwrap().unwrap().pixels, b"abc");
        assert!(grey.next().is_err(), "a frame that is cut off");
    }

    #[test]
    fn other_headers_are_errors() {
        for bad in [
            &b""[..],
            b"RIFF",
            b"YUV4MPEG2 W0 H2",
            b"YUV4MPEG2 W2 H2 C444",
        ] {
            assert!(parse(bad).is_err());
        }
    }
}
