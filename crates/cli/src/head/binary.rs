//! The binary part of a glTF file: numbers one after the other, and the descriptions of where they
//! lie (buffer views and accessors).

use serde_json::{Value, json};

/// Component types.
const UNSIGNED_SHORT: u32 = 5123;
const FLOAT: u32 = 5126;

/// What numbers are for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// Attributes of vertices.
    Vertices = 34962,
    /// Indices of triangles.
    Indices = 34963,
    /// Keyframes, which no graphics card reads.
    Keys = 0,
}

/// The binary part, and what describes it.
#[derive(Default)]
pub struct Binary {
    /// Little-endian; every list begins at a multiple of four.
    pub bytes: Vec<u8>,
    /// As glTF has them.
    pub views: Vec<Value>,
    /// As glTF has them.
    pub accessors: Vec<Value>,
}

impl Binary {
    /// Adds vectors; returns the index of their accessor.
    pub fn vectors<const N: usize>(&mut self, of: Use, vectors: &[[f32; N]]) -> usize {
        let kind = format!("VEC{N}");
        self.floats(of, &kind, vectors.len(), vectors.as_flattened())
    }

    /// As [`Binary::vectors`], with the least and the largest number of each component, which
    /// places must have.
    pub fn bounded<const N: usize>(&mut self, of: Use, vectors: &[[f32; N]]) -> usize {
        let index = self.vectors(of, vectors);
        self.bound(index, vectors);
        index
    }

    /// Adds single numbers.
    pub fn scalars(&mut self, of: Use, numbers: &[f32]) -> usize {
        self.floats(of, "SCALAR", numbers.len(), numbers)
    }

    /// Adds times, which have bounds too.
    pub fn times(&mut self, times: &[f32]) -> usize {
        let index = self.scalars(Use::Keys, times);
        let times: Vec<[f32; 1]> = times.iter().map(|time| [*time]).collect();
        self.bound(index, &times);
        index
    }

    /// Adds the corners of triangles.
    pub fn triangles(&mut self, triangles: &[[u16; 3]]) -> usize {
        let indices = triangles.as_flattened();
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes());
        self.add(Use::Indices, UNSIGNED_SHORT, "SCALAR", indices.len(), bytes)
    }

    fn floats(&mut self, of: Use, kind: &str, count: usize, numbers: &[f32]) -> usize {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
        self.add(of, FLOAT, kind, count, bytes)
    }

    fn add(
        &mut self,
        of: Use,
        component: u32,
        kind: &str,
        count: usize,
        bytes: impl Iterator<Item = u8>,
    ) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": length });
        if of != Use::Keys {
            view["target"] = (of as u32).into();
        }
        self.accessors.push(json!({
            "bufferView": self.views.len(),
            "componentType": component,
            "count": count,
            "type": kind,
        }));
        self.views.push(view);
        self.accessors.len() - 1
    }

    fn bound<const N: usize>(&mut self, index: usize, vectors: &[[f32; N]]) {
        let fold = |start: f32, pick: fn(f32, f32) -> f32| {
            let fold = |bound: [f32; N], vector: &[f32; N]| {
                std::array::from_fn(|i| pick(bound[i], vector[i]))
            };
            vectors.iter().fold([start; N], fold).to_vec()
        };
        self.accessors[index]["min"] = fold(f32::INFINITY, f32::min).into();
        self.accessors[index]["max"] = fold(f32::NEG_INFINITY, f32::max).into();
    }
}
