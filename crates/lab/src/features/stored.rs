//! How matrices and shapes are stored, for serde.

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

/// The same for a shape.
pub mod shape {
    use posewise::align::Shape;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    /// Writes a shape.
    pub fn serialize<S: Serializer>(shape: &Shape, to: S) -> Result<S::Ok, S::Error> {
        shape.as_slice().serialize(to)
    }

    /// Reads a shape.
    pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Shape, D::Error> {
        let points = Vec::<[f32; 2]>::deserialize(from)?;
        let shape = points.try_into();
        shape.map_err(|_| D::Error::custom("a shape of 68 points"))
    }
}
