//! Rendered samples on disk: one file per seed, appended to, so that an interrupted run resumes
//! where it stopped.
//!
//! Header: magic, seed, fingerprint of the spec. Then records of: length, sizes, truth, luma;
//! little-endian. An incomplete record at the end of the file is dropped and drawn again.

use super::sample::{Renderer, Sample};
use super::spec::SampleSpec;
use anyhow::{Context, Result, ensure};
use glam::{Vec2, Vec3};
use indicatif::{ProgressBar, ProgressStyle};
use posewise::math::HeadAngles;
use posewise::shape::{FITTED, Intrinsics, LANDMARKS};
use rayon::prelude::*;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

const MAGIC: &[u8; 8] = b"PWRENDR1";
const HEADER: u64 = 24;

/// Floats of a record before the visibility flags.
const FLOATS: usize = 2 * LANDMARKS + 3 * LANDMARKS + 3 + 3 + 4 + FITTED;

/// Samples drawn between writes.
const BATCH: usize = 256;

/// Changes when the spec does, as serde writes it (FNV-1a).
fn fingerprint(spec: &SampleSpec) -> u64 {
    let text = serde_json::to_string(spec).expect("a spec is plain numbers");
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ b as u64).wrapping_mul(0x100_0000_01b3)
    })
}

fn header(seed: u64, spec: &SampleSpec) -> [u8; HEADER as usize] {
    let mut out = [0; HEADER as usize];
    out[..8].copy_from_slice(MAGIC);
    out[8..16].copy_from_slice(&seed.to_le_bytes());
    out[16..].copy_from_slice(&fingerprint(spec).to_le_bytes());
    out
}

fn encode(sample: &Sample) -> Vec<u8> {
    let mut floats = Vec::with_capacity(FLOATS);
    sample
        .landmarks
        .iter()
        .for_each(|p| floats.extend(p.to_array()));
    sample
        .points3d
        .iter()
        .for_each(|p| floats.extend(p.to_array()));
    let HeadAngles {
        yaw_deg,
        pitch_deg,
        roll_deg,
    } = sample.angles;
    floats.extend([yaw_deg, pitch_deg, roll_deg]);
    floats.extend(sample.position.to_array());
    let c = sample.camera;
    floats.extend([c.fx, c.fy, c.cx, c.cy]);
    floats.extend(sample.animation);
    let mut body = Vec::new();
    body.extend((sample.width as u16).to_le_bytes());
    body.extend((sample.height as u16).to_le_bytes());
    body.extend(sample.person.to_le_bytes());
    floats.iter().for_each(|f| body.extend(f.to_le_bytes()));
    body.extend(sample.visible.map(u8::from));
    body.extend(&sample.luma);
    record(&body)
}

/// A record of these bytes.
pub(super) fn record(body: &[u8]) -> Vec<u8> {
    [&(body.len() as u32).to_le_bytes(), body].concat()
}

/// Floats that are written one after the other.
pub(super) fn floats(bytes: &[u8]) -> Vec<f32> {
    let each = bytes.as_chunks::<4>().0.iter();
    each.map(|b| f32::from_le_bytes(*b)).collect()
}

fn decode(body: &[u8]) -> Result<Sample> {
    let mut rest = body;
    let mut take = |n: usize| -> Result<&[u8]> {
        let (head, tail) = rest.split_at_checked(n).context("a record is too short")?;
        rest = tail;
        Ok(head)
    };
    let word = |b: &[u8]| u16::from_le_bytes([b[0], b[1]]) as usize;
    let width = word(take(2)?);
    let height = word(take(2)?);
    let person = u32::from_le_bytes(take(4)?.try_into()?);
    let floats = floats(take(4 * FLOATS)?);
    let visible = take(LANDMARKS)?;
    let luma = take(width * height)?.to_vec();
    let (flat, solid) = floats.split_at(2 * LANDMARKS);
    let (solid, tail) = solid.split_at(3 * LANDMARKS);
    Ok(Sample {
        luma,
        width,
        height,
        landmarks: std::array::from_fn(|i| Vec2::new(flat[2 * i], flat[2 * i + 1])),
        visible: std::array::from_fn(|i| visible[i] != 0),
        points3d: std::array::from_fn(|i| Vec3::from_slice(&solid[3 * i..])),
        angles: HeadAngles {
            yaw_deg: tail[0],
            pitch_deg: tail[1],
            roll_deg: tail[2],
        },
        position: Vec3::from_slice(&tail[3..]),
        camera: Intrinsics::new(tail[6], tail[7], tail[8], tail[9]),
        animation: std::array::from_fn(|i| tail[10 + i]),
        person,
    })
}

/// The next record's bytes; `None` at the end or when the record is incomplete.
pub(super) fn next_record(file: &mut impl Read) -> Result<Option<Vec<u8>>> {
    let mut length = [0; 4];
    let mut fill = |bytes: &mut [u8]| match file.read_exact(bytes) {
        Err(e) if e.kind() == ErrorKind::UnexpectedEof => Ok(false),
        other => other.map(|()| true),
    };
    if !fill(&mut length)? {
        return Ok(None);
    }
    let mut body = vec![0; u32::from_le_bytes(length) as usize];
    Ok(fill(&mut body)?.then_some(body))
}

/// Number of complete records that follow, and their length in bytes.
pub(super) fn complete(file: &mut impl Read) -> Result<(u64, u64)> {
    let (mut count, mut length) = (0, 0);
    while let Some(body) = next_record(file)? {
        count += 1;
        length += 4 + body.len() as u64;
    }
    Ok((count, length))
}

/// Number of complete records of a cache and where they end \[bytes\]; none if it has another seed
/// or spec.
fn present(path: &Path, wanted: &[u8]) -> Result<(u64, u64)> {
    let Ok(file) = File::open(path) else {
        return Ok((0, 0));
    };
    let mut file = BufReader::new(file);
    let mut found = [0; HEADER as usize];
    if file.read_exact(&mut found).is_err() || found != wanted {
        return Ok((0, 0));
    }
    let (count, length) = complete(&mut file)?;
    Ok((count, HEADER + length))
}

/// Draws records of these numbers and appends them, some at a time.
pub(super) fn append(
    file: File,
    name: &str,
    numbers: Range<u64>,
    record: impl Fn(u64) -> Vec<u8> + Sync,
) -> Result<()> {
    let mut file = BufWriter::new(file);
    let style = format!("{name:6} {{bar:40}} {{pos}}/{{len}} {{per_sec}} eta {{eta}}");
    let bar = ProgressBar::new(numbers.start.max(numbers.end))
        .with_style(ProgressStyle::with_template(&style)?)
        .with_position(numbers.start);
    let all: Vec<u64> = numbers.collect();
    for some in all.chunks(BATCH) {
        let drawn = some.par_iter().map(|number| record(*number));
        let records: Vec<Vec<u8>> = drawn.inspect(|_| bar.inc(1)).collect();
        records.iter().try_for_each(|r| file.write_all(r))?;
        file.flush()?;
    }
    bar.finish();
    Ok(())
}

/// Fills a cache up to `count` samples (indices 0, 1, …), resuming where an earlier run stopped; a
/// cache of another seed or spec is overwritten. Returns how many samples were drawn now.
pub fn write(
    path: &Path,
    renderer: &Renderer,
    seed: u64,
    count: u64,
    spec: &SampleSpec,
) -> Result<u64> {
    let wanted = header(seed, spec);
    let (start, end) = present(path, &wanted)?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut options = OpenOptions::new();
    let file = options.create(true).write(true).truncate(false).open(path);
    let mut file = file.with_context(|| format!("cannot write {}", path.display()))?;
    file.set_len(end)?;
    file.seek(SeekFrom::Start(end))?;
    if end == 0 {
        file.write_all(&wanted)?;
    }
    append(file, "render", start..count, |index| {
        encode(&renderer.sample(seed, index, spec))
    })?;
    Ok(count.saturating_sub(start))
}

/// A cache being read, sample by sample.
pub struct Samples {
    file: BufReader<File>,
    left: usize,
}

/// Opens a cache; it yields at most `limit` samples.
pub fn open(path: &Path, limit: usize) -> Result<Samples> {
    let file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut file = BufReader::new(file);
    let mut found = [0; HEADER as usize];
    file.read_exact(&mut found)
        .context("the cache has no header")?;
    ensure!(
        found.starts_with(MAGIC),
        "{} is not a cache of renders",
        path.display()
    );
    Ok(Samples { file, left: limit })
}

impl Iterator for Samples {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Result<Sample>> {
        self.left = self.left.checked_sub(1)?;
        let record = next_record(&mut self.file).transpose()?;
        Some(record.and_then(|body| decode(&body)))
    }
}

/// All samples of a cache, at most `limit`.
pub fn read(path: &Path, limit: usize) -> Result<Vec<Sample>> {
    open(path, limit)?.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_round_trip() {
        let sample = Sample {
            luma: (0..12).collect(),
            width: 4,
            height: 3,
            landmarks: std::array::from_fn(|i| Vec2::new(i as f32, -1.5)),
            visible: std::array::from_fn(|i| i % 3 == 0),
            points3d: [Vec3::new(1.0, 2.0, 3.0); LANDMARKS],
            angles: HeadAngles {
                yaw_deg: 30.0,
                pitch_deg: -5.0,
                roll_deg: 2.0,
            },
            position: Vec3::new(0.0, 10.0, 500.0),
            camera: Intrinsics::of_frame(320, 240),
            animation: std::array::from_fn(|i| i as f32 / 24.0),
            person: 77,
        };
        let bytes = encode(&sample);
        let back = decode(&bytes[4..]).unwrap();
        assert_eq!(format!("{back:?}"), format!("{sample:?}"));
        assert!(decode(&bytes[4..bytes.len() - 1]).is_err());
    }
}
