//! YUV4MPEG2 from any reader. The luma plane goes to the tracker as it is coded.

use std::cell::Cell;
use std::io::{Cursor, Read};
use std::rc::Rc;

use anyhow::{Result, anyhow, bail};
use posewise::{FrameLayout, MAX_SIDE, PixelFormat};

use super::stream::{Source, timestamp_us};
use crate::parse::MAX_FPS;
use crate::picture::{Chroma, Picture};

/// Longest stream header that the decoder reads \[bytes\].
const MAX_HEADER: usize = 1000;

type Reader = std::io::Chain<Cursor<Vec<u8>>, Counting>;

/// Counts bytes, so that an end inside a frame is distinguished from an end after one: the decoder
/// reports both as end of file.
struct Counting {
    inner: Box<dyn Read>,
    count: Rc<Cell<u64>>,
}

impl Read for Counting {
    fn read(&mut self, buf: &mut [u8]) -> std::io::Result<usize> {
        let got = self.inner.read(buf).map_err(|e| {
            // gzip's "unexpected end" must not pass as the end of the video.
            std::io::Error::new(std::io::ErrorKind::InvalidData, e.to_string())
        })?;
        self.count.set(self.count.get() + got as u64);
        Ok(got)
    }
}

/// A y4m stream.
pub struct Y4mSource {
    decoder: y4m::Decoder<Reader>,
    name: String,
    rate: (u64, u64),
    chroma: Chroma,
    bits: u32,
    full_range: bool,
    frame_len: u64,
    count: Rc<Cell<u64>>,
    index: u64,
    total: Option<u64>,
}

impl Y4mSource {
    /// Reads the stream's header. `name` is for messages.
    pub fn new(reader: impl Read + 'static, name: &str) -> Result<Self> {
        let mut inner: Box<dyn Read> = Box::new(reader);
        let mut header = read_header(&mut inner, name)?;
        let is_mono10 = replace_mono10(&mut header);
        let count = Rc::new(Cell::new(0));
        let reader = Cursor::new(header).chain(Counting {
            inner,
            count: Rc::clone(&count),
        });
        let decoder = y4m::Decoder::new(reader).map_err(|e| match e {
            y4m::Error::UnknownColorspace => anyhow!("{name}: its y4m colour space is not known"),
            e => anyhow!("{name}: bad y4m header: {e}"),
        })?;
        let rate = decoder.get_framerate();
        if rate.num == 0 || rate.den == 0 {
            bail!("{name}: its y4m header gives no frame rate");
        }
        if rate.num as f64 > MAX_FPS * rate.den as f64 {
            bail!(
                "{name}: the frame rate {}:{} of its y4m header is above {MAX_FPS} per second: \
                 timestamps are whole microseconds",
                rate.num,
                rate.den
            );
        }
        let colorspace = decoder.get_colorspace();
        let chroma = chroma_of(colorspace);
        let bits = match is_mono10 {
            true => 10,
            false => colorspace.get_bit_depth() as u32,
        };
        let (width, height) = (decoder.get_width() as u64, decoder.get_height() as u64);
        let chroma_len = match chroma {
            Chroma::None => 0,
            Chroma::Planar { across, down } => {
                2 * width.div_ceil(across.into()) * height.div_ceil(down.into())
            }
        };
        let full_range = String::from_utf8_lossy(decoder.get_raw_params())
            .split(' ')
            .any(|p| p == "XCOLORRANGE=FULL");
        Ok(Y4mSource {
            rate: (rate.num as u64, rate.den as u64),
            chroma,
            bits,
            full_range,
            frame_len: (width * height + chroma_len) * if bits > 8 { 2 } else { 1 },
            decoder,
            name: name.to_string(),
            count,
            index: 0,
            total: None,
        })
    }

    /// Sets the length of an uncompressed file, for the progress bar.
    pub fn with_file_len(mut self, len: Option<u64>) -> Self {
        // "FRAME\n" precedes each frame.
        self.total = len.map(|len| len / (self.frame_len + 6));
        self
    }
}

impl Source for Y4mSource {
    fn next(&mut self) -> Result<Option<Picture>> {
        let before = self.count.get();
        let (width, height) = (self.decoder.get_width(), self.decoder.get_height());
        let number = self.index + 1;
        let frame = match self.decoder.read_frame() {
            Ok(frame) => frame,
            Err(y4m::Error::EOF) if self.count.get() == before => {
                if self.index == 0 {
                    bail!("{}: the video has no frames", self.name);
                }
                return Ok(None);
            }
            Err(y4m::Error::EOF) => bail!("{}: the video ends inside frame {number}", self.name),
            Err(e) => bail!("{}: frame {number} is corrupt: {e}", self.name),
        };
        let planes = [
            frame.get_y_plane(),
            frame.get_u_plane(),
            frame.get_v_plane(),
        ];
        let data = match self.bits {
            8 => planes.concat(),
            bits => planes
                .iter()
                .flat_map(|plane| plane.chunks_exact(2))
                .map(|w| (u16::from_le_bytes([w[0], w[1]]) >> (bits - 8)).min(255) as u8)
                .collect(),
        };
        let timestamp = timestamp_us(self.index, self.rate.0, self.rate.1);
        self.index += 1;
        Ok(Some(Picture {
            layout: FrameLayout::new(PixelFormat::Yu12, width as u32, height as u32),
            data,
            chroma: self.chroma,
            full_range: self.full_range,
            timestamp_us: timestamp,
            focal_px: None,
        }))
    }

    fn fps(&self) -> f64 {
        self.rate.0 as f64 / self.rate.1 as f64
    }

    fn total(&self) -> Option<u64> {
        self.total
    }
}

/// The decoder does not know `Cmono10`, whose frames are laid out as those of `Cmono12`.
fn replace_mono10(header: &mut [u8]) -> bool {
    const MONO10: &[u8] = b" Cmono10";
    let found = header
        .windows(MONO10.len() + 1)
        .position(|w| w.starts_with(MONO10) && w.last().is_some_and(|end| b" \n".contains(end)));
    if let Some(digit) = found.and_then(|at| header.get_mut(at + MONO10.len() - 1)) {
        *digit = b'2';
    }
    found.is_some()
}

fn chroma_of(colorspace: y4m::Colorspace) -> Chroma {
    use y4m::Colorspace as C;
    match colorspace {
        C::Cmono | C::Cmono12 => Chroma::None,
        C::C422 | C::C422p10 | C::C422p12 => Chroma::Planar { across: 2, down: 1 },
        C::C444 | C::C444p10 | C::C444p12 => Chroma::Planar { across: 1, down: 1 },
        _ => Chroma::Planar { across: 2, down: 2 },
    }
}

/// Reads up to the header's line end and checks what the decoder does not: the magic, and a size
/// whose product cannot overflow.
fn read_header(reader: &mut dyn Read, name: &str) -> Result<Vec<u8>> {
    let mut header = Vec::new();
    let mut byte = [0u8];
    while header.len() < MAX_HEADER && header.last() != Some(&b'\n') {
        match reader.read(&mut byte) {
            Ok(0) if header.is_empty() => bail!("{name} is empty"),
            Ok(0) => break,
            Ok(_) => header.push(byte[0]),
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => bail!("cannot read {name}: {e}"),
        }
        if !b"YUV4MPEG2 ".starts_with(&header[..header.len().min(10)]) {
            bail!("{name} is not a y4m video (it does not start with YUV4MPEG2)");
        }
    }
    if header.last() != Some(&b'\n') {
        bail!("{name}: the y4m header has no end");
    }
    let text = String::from_utf8_lossy(&header).into_owned();
    for (key, what) in [('W', "width"), ('H', "height")] {
        let value = text.split([' ', '\n']).skip(1).find(|p| p.starts_with(key));
        let value = value.and_then(|p| p[1..].parse::<u32>().ok());
        if !value.is_some_and(|v| (1..=MAX_SIDE).contains(&v)) {
            bail!("{name}: its y4m header has no {what} from 1 to {MAX_SIDE}");
        }
    }
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Result<Vec<Picture>> {
        let mut source = Y4mSource::new(Cursor::new(bytes.to_vec()), "clip")?;
        let mut out = Vec::new();
        while let Some(p) = source.next()? {
            out.push(p);
        }
        Ok(out)
    }

    #[test]
    fn round_trip_with_the_encoder() {
        let mut bytes = Vec::new();
        let mut encoder = y4m::encode(5, 3, y4m::Ratio::new(25, 1))
            .with_colorspace(y4m::Colorspace::C420jpeg)
            .write_header(&mut bytes)
            .unwrap();
        let luma: Vec<u8> = (0..15).collect();
        for i in 0..3u8 {
            encoder
                .write_frame(&y4m::Frame::new([&luma, &[i; 6], &[128; 6]], None))
                .unwrap();
        }
        let pictures = all(&bytes).unwrap();
        assert_eq!(pictures.len(), 3);
        assert_eq!(pictures[2].timestamp_us, 80_000);
        assert_eq!(pictures[2].data[..15], luma);
        assert_eq!(pictures[2].data[15], 2);
        assert_eq!(pictures[0].frame().unwrap().luma(4, 2), 14);

        let cut = all(&bytes[..bytes.len() - 1]).unwrap_err().to_string();
        assert!(cut.contains("ends inside frame 3"), "{cut}");
    }

    #[test]
    fn ten_and_twelve_bits_are_read() {
        for (colour, levels) in [("mono10", 1023u16), ("mono12", 4095), ("420p10", 1023)] {
            let mut bytes =
                format!("YUV4MPEG2 W2 H2 F1000000:1 C{colour} Ip\nFRAME\n").into_bytes();
            for level in [0, levels / 2, levels, 4] {
                bytes.extend(level.to_le_bytes());
            }
            if colour.starts_with("420") {
                bytes.extend([0, 2, 0, 2]);
            }
            let pictures = all(&bytes).unwrap();
            assert_eq!(pictures.len(), 1, "{colour}");
            assert_eq!(pictures[0].data[..3], [0, 127, 255], "{colour}");
        }
    }

    #[test]
    fn bad_headers_are_named() {
        for (bytes, message) in [
            (&b""[..], "is empty"),
            (b"RIFFxxxx", "not a y4m"),
            (b"YUV4", "no end"),
            (b"YUV4MPEG2 H4 F25:1\n", "width"),
            (b"YUV4MPEG2 W4000000000 H4000000000 F25:1\n", "width"),
            (b"YUV4MPEG2 W4 H4 F0:0\n", "frame rate"),
            (b"YUV4MPEG2 W4 H4 F2000000:1\n", "2000000:1"),
            (b"YUV4MPEG2 W4 H4 F25:1 Cfoo\n", "colour space"),
            (b"YUV4MPEG2 W4 H4 F25:1\n", "no frames"),
            (b"YUV4MPEG2 W4 H4 F25:1\nFRAMX\n", "corrupt"),
        ] {
            let error = all(bytes).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
