//! The head of one frame as Wavefront OBJ.

use std::io::{self, Write};

use posewise::mesh::MeshTopology;

use super::surface::Surface;

/// Writes places \[m\], texture coordinates, normals and triangles.
pub fn write(
    out: &mut dyn Write,
    frame: u64,
    surface: &Surface,
    topology: &MeshTopology<'_>,
) -> io::Result<()> {
    writeln!(
        out,
        "# posewise: the head of frame {frame}; m, y up, z out of the face"
    )?;
    writeln!(out, "o head")?;
    for place in &surface.places {
        writeln!(out, "v {:.6} {:.6} {:.6}", place.x, place.y, place.z)?;
    }
    for [u, v] in topology.uvs {
        writeln!(out, "vt {u:.6} {v:.6}")?;
    }
    for normal in &surface.normals {
        writeln!(out, "vn {:.4} {:.4} {:.4}", normal.x, normal.y, normal.z)?;
    }
    for corners in topology.triangles {
        // Counted from 1.
        let [a, b, c] = corners.map(|corner| u32::from(corner) + 1);
        writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?;
    }
    Ok(())
}
