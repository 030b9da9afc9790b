//! `.npz` arrays, with the half floats and fixed-width strings that `ndarray-npy` does not read.

use anyhow::{Context, Result, bail, ensure};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// An open `.npz` file.
pub struct Npz(zip::ZipArchive<File>);

/// One array as it lies in the file, C order.
pub struct Array {
    descr: String,
    /// Length along each axis.
    pub shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Npz {
    /// Opens the file and reads its directory.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
        let archive = zip::ZipArchive::new(file)
            .with_context(|| format!("{} is not an .npz file", path.display()))?;
        Ok(Npz(archive))
    }

    /// Reads the array of this name.
    pub fn array(&mut self, name: &str) -> Result<Array> {
        let mut bytes = Vec::new();
        self.0
            .by_name(&format!("{name}.npy"))
            .with_context(|| format!("the .npz file has no array {name}"))?
            .read_to_end(&mut bytes)?;
        parse(bytes).with_context(|| format!("array {name}"))
    }
}

/// NPY format 1.0: magic, version, u16 header length, a Python dictionary, the data.
fn parse(mut bytes: Vec<u8>) -> Result<Array> {
    ensure!(bytes.starts_with(b"\x93NUMPY\x01"), "not NPY format 1");
    let len = bytes.get(8..10).context("truncated")?;
    let start = 10 + u16::from_le_bytes([len[0], len[1]]) as usize;
    let header = std::str::from_utf8(bytes.get(10..start).context("truncated")?)?.to_owned();
    ensure!(header.contains("'fortran_order': False"), "Fortran order");
    let between = |from: &str, to: &str| {
        let rest = header.split_once(from).map(|(_, rest)| rest);
        rest.and_then(|rest| rest.split_once(to))
            .map(|(v, _)| v.to_owned())
    };
    let descr = between("'descr': '", "'").context("no descr")?;
    let shape = between("'shape': (", ")").context("no shape")?;
    let shape = shape
        .split(',')
        .map(str::trim)
        .filter(|n| !n.is_empty())
        .map(str::parse)
        .collect::<Result<Vec<usize>, _>>()?;
    bytes.drain(..start);
    Ok(Array {
        descr,
        shape,
        bytes,
    })
}

impl Array {
    fn items<const N: usize>(&self) -> impl Iterator<Item = [u8; N]> + '_ {
        self.bytes
            .chunks_exact(N)
            .map(|c| c.try_into().expect("N bytes"))
    }

    fn checked<T>(&self, values: Vec<T>) -> Result<Vec<T>> {
        ensure!(
            values.len() == self.shape.iter().product::<usize>(),
            "shape and length disagree"
        );
        Ok(values)
    }

    /// All values of a `f2` or `f4` array; they must be finite.
    pub fn floats(&self) -> Result<Vec<f32>> {
        let values: Vec<f32> = match self.descr.as_str() {
            "<f4" => self.items().map(f32::from_le_bytes).collect(),
            "<f2" => self.items().map(|b| half(u16::from_le_bytes(b))).collect(),
            other => bail!("{other} is not a float type known here"),
        };
        ensure!(values.iter().all(|v| v.is_finite()), "not finite");
        self.checked(values)
    }

    /// All values of a non-negative integer array.
    pub fn indices(&self) -> Result<Vec<u32>> {
        self.checked(match self.descr.as_str() {
            "|u1" => self.bytes.iter().map(|b| *b as u32).collect(),
            "<u2" => (self.items())
                .map(|b| u32::from(u16::from_le_bytes(b)))
                .collect(),
            "<i4" => self
                .items()
                .map(|b| Ok(u32::try_from(i32::from_le_bytes(b))?))
                .collect::<Result<_>>()?,
            other => bail!("{other} is not an integer type known here"),
        })
    }

    /// All strings of a `U` array.
    pub fn strings(&self) -> Result<Vec<String>> {
        let width: usize = self
            .descr
            .strip_prefix("<U")
            .context("not a string array")?
            .parse()?;
        let letter = |b: &[u8]| char::from_u32(u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let values = self.bytes.chunks_exact(4 * width.max(1)).map(|item| {
            let letters = item.chunks_exact(4).filter_map(letter);
            letters.take_while(|c| *c != '\0').collect()
        });
        self.checked(values.collect())
    }
}

/// IEEE 754 half precision → single.
fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = ((bits >> 10 & 31) as i32, (bits & 1023) as f32);
    sign * match exponent {
        0 => fraction * 2f32.powi(-24),
        31 => f32::NAN,
        e => (1.0 + fraction / 1024.0) * 2f32.powi(e - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_values() {
        for (bits, value) in [
            (0x3C00, 1.0),
            (0xC000, -2.0),
            (0x3555, 0.333_251_95),
            (1, 5.960_464_5e-8),
        ] {
            assert_eq!(half(bits), value);
        }
    }

    #[test]
    fn header_and_strings() {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        let header = "{'descr': '<U2', 'fortran_order': False, 'shape': (2,), }\n";
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        for c in ['a', 'b', 'c', '\0'] {
            bytes.extend((c as u32).to_le_bytes());
        }
        let array = parse(bytes).unwrap();
        assert_eq!(array.shape, [2]);
        assert_eq!(array.strings().unwrap(), ["ab", "c"]);
        assert!(array.floats().is_err());
    }
}
