//! MATLAB's `.mat` files of version 5, little-endian: the numeric arrays at their top level.
//!
//! A file is 128 bytes of header, then elements: a type and a size of 4 bytes each, the data, and
//! padding to 8 bytes. An element of type 15 is another one behind zlib. An element of type 14 is
//! an array: flags, sizes, name, numbers.

use anyhow::{Context, Result, bail, ensure};
use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::Read;

/// Bytes before the first element.
const HEADER: usize = 128;
/// Largest element after inflation \[bytes\]; those of 300W-LP have below a megabyte.
const INFLATED: u64 = 64 << 20;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// A numeric array, column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Rows, columns, and further sizes.
    pub sizes: Vec<usize>,
    /// Real parts.
    pub values: Vec<f64>,
}

/// Arrays by name. What is no numeric array is left out.
pub fn parse(bytes: &[u8]) -> Result<BTreeMap<String, Array>> {
    let header = bytes.get(..HEADER).context("shorter than its header")?;
    ensure!(
        header.ends_with(b"\x00\x01IM"),
        "no little-endian MAT file of version 5"
    );
    let mut arrays = BTreeMap::new();
    let mut rest = &bytes[HEADER..];
    while !rest.is_empty() {
        let (kind, data) = element(&mut rest)?;
        let mut inflated = Vec::new();
        let (kind, data) = match kind {
            COMPRESSED => {
                let mut inner = ZlibDecoder::new(data).take(INFLATED);
                inner.read_to_end(&mut inflated).context("broken zlib")?;
                element(&mut inflated.as_slice()).map(|(kind, data)| (kind, data.to_vec()))?
            }
            kind => (kind, data.to_vec()),
        };
        if kind == MATRIX
            && let Some((name, array)) = array(&data)?
        {
            arrays.insert(name, array);
        }
    }
    Ok(arrays)
}

/// Type and data of the next element, which is taken off.
fn element<'a>(rest: &mut &'a [u8]) -> Result<(u32, &'a [u8])> {
    let (tag, after) = rest.split_at_checked(8).context("an element is cut off")?;
    let word = |at: usize| u32::from_le_bytes([tag[at], tag[at + 1], tag[at + 2], tag[at + 3]]);
    let small = word(0) >> 16;
    if small != 0 {
        // Up to four bytes stand in the tag itself.
        let data = tag[4..].get(..small as usize).context("a wrong size")?;
        *rest = after;
        return Ok((word(0) & 0xffff, data));
    }
    let size = word(4) as usize;
    let data = after.get(..size).context("an element is cut off")?;
    // The last element, and one behind zlib, may lack its padding.
    let padded = match word(0) {
        COMPRESSED => size,
        _ => size.next_multiple_of(8).min(after.len()),
    };
    *rest = &after[padded..];
    Ok((word(0), data))
}

/// Name and numbers; `None` where it is no real numeric array.
fn array(mut data: &[u8]) -> Result<Option<(String, Array)>> {
    let (_, flags) = element(&mut data)?;
    let class = *flags.first().context("an array without flags")?;
    // 6 is double, 7 single, 8 to 15 are integers; the others are cells, structures, texts.
    if !(6..=15).contains(&class) {
        return Ok(None);
    }
    let (kind, sizes) = element(&mut data)?;
    let sizes = numbers(kind, sizes)?;
    ensure!(
        sizes.iter().all(|s| (0.0..=1e9).contains(s)),
        "sizes of an array out of range"
    );
    let sizes: Vec<usize> = sizes.into_iter().map(|s| s as usize).collect();
    let (_, name) = element(&mut data)?;
    let name = String::from_utf8_lossy(name).into_owned();
    let (kind, values) = element(&mut data)?;
    let values = numbers(kind, values)?;
    let count = sizes.iter().try_fold(1usize, |n, s| n.checked_mul(*s));
    ensure!(
        count == Some(values.len()),
        "{name}: {} numbers for sizes {sizes:?}",
        values.len()
    );
    Ok(Some((name, Array { sizes, values })))
}

/// Numbers of a storage type, which may be narrower than the array's class.
fn numbers(kind: u32, data: &[u8]) -> Result<Vec<f64>> {
    /// `data` in pieces of `N` bytes.
    fn each<const N: usize>(data: &[u8], read: fn([u8; N]) -> f64) -> Result<Vec<f64>> {
        let (pieces, rest) = data.as_chunks();
        ensure!(rest.is_empty(), "numbers are cut off");
        Ok(pieces.iter().map(|piece| read(*piece)).collect())
    }
    match kind {
        1 => each(data, |b: [u8; 1]| f64::from(i8::from_le_bytes(b))),
        2 => each(data, |b: [u8; 1]| f64::from(u8::from_le_bytes(b))),
        3 => each(data, |b| f64::from(i16::from_le_bytes(b))),
        4 => each(data, |b| f64::from(u16::from_le_bytes(b))),
        5 => each(data, |b| f64::from(i32::from_le_bytes(b))),
        6 => each(data, |b| f64::from(u32::from_le_bytes(b))),
        7 => each(data, |b| f64::from(f32::from_le_bytes(b))),
        9 => each(data, f64::from_le_bytes),
        12 => each(data, |b| i64::from_le_bytes(b) as f64),
        13 => each(data, |b| u64::from_le_bytes(b) as f64),
        other => bail!("numbers of unknown type {other}"),
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::Write;

    /// An element with its padding.
    fn written(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut out = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        out.extend(data);
        out.resize(out.len().next_multiple_of(8), 0);
        out
    }

    /// A file of single-precision arrays, behind zlib as MATLAB writes them.
    pub fn file(arrays: &[(&str, [u32; 2], &[f32])]) -> Vec<u8> {
        let mut out = vec![b' '; HEADER - 4];
        out.extend(b"\x00\x01IM");
        for (name, sizes, values) in arrays {
            let mut inner = written(6, &[7, 0, 0, 0, 0, 0, 0, 0]);
            inner.extend(written(5, &sizes.map(u32::to_le_bytes).concat()));
            inner.extend(written(1, name.as_bytes()));
            let values: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            inner.extend(written(7, &values));
            let mut zlib = ZlibEncoder::new(Vec::new(), Compression::default());
            zlib.write_all(&written(MATRIX, &inner)).unwrap();
            let zlib = zlib.finish().unwrap();
            out.extend([COMPRESSED.to_le_bytes(), (zlib.len() as u32).to_le_bytes()].concat());
            out.extend(zlib);
        }
        out
    }

    #[test]
    fn arrays_by_name() {
        let bytes = file(&[
            ("a", [1, 3], &[1.0, 2.0, 3.0]),
            ("longer", [2, 1], &[4.0, 5.0]),
        ]);
        let arrays = parse(&bytes).unwrap();
        assert_eq!(arrays["a"].values, [1.0, 2.0, 3.0]);
        assert_eq!(arrays["longer"].sizes, [2, 1]);
        assert!(parse(&bytes[..HEADER]).unwrap().is_empty());
        assert!(parse(&bytes[..bytes.len() - 3]).is_err(), "cut off");
        assert!(parse(&bytes[1..]).is_err(), "no header");
    }
}
