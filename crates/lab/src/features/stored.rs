//! How matrices are stored, for serde.

use faer::Mat;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// Rows, columns, numbers row by row.
type Stored = (usize, usize, Vec<f32>);

/// Writes a matrix.
pub fn serialize<S: Serializer>(matrix: &Mat<f32>, to: S) -> Result<S::Ok, S::Error> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let numbers = (0..rows * columns).map(|k| matrix[(k / columns, k % columns)]);
    let stored: Stored = (rows, columns, numbers.collect());
    stored.serialize(to)
}

/// Reads a matrix.
pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Mat<f32>, D::Error> {
    let (rows, columns, numbers) = Stored::deserialize(from)?;
    if numbers.len() != rows * columns {
        return Err(D::Error::custom("a matrix of another size"));
    }
    Ok(Mat::from_fn(rows, columns, |i, j| numbers[i * columns + j]))
}
