//! The functions of `include/posewise.h` for the dense mesh. As in `api`, the comments are written
//! for the C reader.

// The contract of all pointers stands at the head of the header and of memory.rs.
#![allow(clippy::missing_safety_doc)]

use super::api::status;
use super::block::{self, BLOCK_SIZE, Block};
use super::memory;
use super::types::*;
use core::mem::size_of;

/// Writes the vertices of the dense mesh of the face of the last step, in a space
/// (POSEWISE_MESH_SPACE_*), and their number: vertex_count of posewise_mesh_tables(). While
/// coasting they are those of the last fit. Near landmarks that were seen, the mesh lies where
/// these do. Nothing is computed without the call, whose work is bounded. Fails with
/// POSEWISE_E_MESH_SPACE, POSEWISE_E_MESH, POSEWISE_E_NO_FACE while searching, and
/// POSEWISE_E_CAPACITY where there is room for fewer vertices than the mesh has, of which there are
/// at most POSEWISE_MESH_VERTICES.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_mesh(
    tracker: *const posewise_tracker,
    space: u32,
    out: *mut posewise_mesh_vertex,
    capacity: usize,
    count: *mut usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get(tracker)? };
        let capacity = checked_capacity(tracker, out, capacity, count)?;
        if space > POSEWISE_MESH_SPACE_HEAD {
            return Err(POSEWISE_E_MESH_SPACE);
        }
        unsafe { count.write(write(block, space, out, capacity)?) };
        Ok(())
    })
}

/// Writes the vertices of the person's own head in the head frame \[mm\], and their number as
/// posewise_mesh() does: with POSEWISE_MESH_NEUTRAL the neutral face, with a POSEWISE_ANIMATION_*
/// that face with this weight at 1. A face with any weights is the neutral one plus each weight
/// times what its shape differs by: morph targets. The identity is that of the last fit, so it
/// outlives the loss of the face; it gets better while the face is tracked. Until the first trusted
/// frame, and after posewise_forget_identity(), it is the mean head. Pose and landmarks play no
/// part, and visibility is 1. Fails with POSEWISE_E_MESH_SHAPE, POSEWISE_E_MESH,
/// POSEWISE_E_CAPACITY, and POSEWISE_E_NO_FACE where no face was tracked since posewise_init() or
/// posewise_reset().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_mesh_shape(
    tracker: *const posewise_tracker,
    shape: u32,
    out: *mut posewise_mesh_vertex,
    capacity: usize,
    count: *mut usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get(tracker)? };
        let capacity = checked_capacity(tracker, out, capacity, count)?;
        if shape >= POSEWISE_ANIMATIONS && shape != POSEWISE_MESH_NEUTRAL {
            return Err(POSEWISE_E_MESH_SHAPE);
        }
        unsafe { count.write(write_shape(block, shape, out, capacity)?) };
        Ok(())
    })
}

/// Checks the outputs of a mesh; returns for how many vertices there is room, at most as many as a
/// mesh can have.
fn checked_capacity(
    tracker: *const posewise_tracker,
    out: *mut posewise_mesh_vertex,
    capacity: usize,
    count: *mut usize,
) -> Result<usize, posewise_status> {
    memory::check_pointer(out)?;
    memory::check_pointer(count)?;
    let capacity = capacity.min(POSEWISE_MESH_VERTICES as usize);
    let bytes = memory::written::<posewise_mesh_vertex>(capacity, capacity);
    memory::require_disjoint(tracker, BLOCK_SIZE, out, bytes)?;
    memory::require_disjoint(tracker, BLOCK_SIZE, count, size_of::<usize>())?;
    memory::require_disjoint(out, bytes, count, size_of::<usize>())?;
    Ok(capacity)
}

/// Writes how the vertices of the mesh are joined, and where they lie in a texture. The tables lie
/// in the model, and are the same for every face. POSEWISE_E_MESH: the model has no mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_mesh_tables(
    tracker: *const posewise_tracker,
    out: *mut posewise_mesh_topology,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get(tracker)? };
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(tracker, BLOCK_SIZE, out, size)?;
        let topology = tables(block).ok_or(POSEWISE_E_MESH)?;
        unsafe { memory::write_struct(out, size, &topology) };
        Ok(())
    })
}

/// Writes the vertices; returns their number.
///
/// # Safety
/// `out` is aligned and has room for `capacity` items.
#[cfg(not(feature = "mesh"))]
unsafe fn write(
    _: &Block,
    _: u32,
    _: *mut posewise_mesh_vertex,
    _: usize,
) -> Result<usize, posewise_status> {
    Err(POSEWISE_E_MESH)
}

/// Writes the vertices of a shape; returns their number.
///
/// # Safety
/// As [`write`].
#[cfg(not(feature = "mesh"))]
unsafe fn write_shape(
    _: &Block,
    _: u32,
    _: *mut posewise_mesh_vertex,
    _: usize,
) -> Result<usize, posewise_status> {
    Err(POSEWISE_E_MESH)
}

#[cfg(not(feature = "mesh"))]
fn tables(_: &Block) -> Option<posewise_mesh_topology> {
    None
}

#[cfg(feature = "mesh")]
use with_mesh::{tables, write, write_shape};

#[cfg(feature = "mesh")]
mod with_mesh {
    use super::*;
    use crate::shape::{MAX_VERTICES, MeshLine, MeshVertex};
    use crate::track::{MeshError, MeshShape, MeshSpace};
    use core::mem::{align_of, offset_of};

    const _: () = assert!(POSEWISE_MESH_VERTICES as usize == MAX_VERTICES);
    const _: () = assert!(POSEWISE_MESH_LINES as usize == MeshLine::ALL.len());

    // A caller's vertices are written as those of the library.
    const _: () = {
        assert!(size_of::<MeshVertex>() == size_of::<posewise_mesh_vertex>());
        assert!(align_of::<MeshVertex>() == align_of::<posewise_mesh_vertex>());
        assert!(offset_of!(MeshVertex, x) == offset_of!(posewise_mesh_vertex, x));
        assert!(offset_of!(MeshVertex, y) == offset_of!(posewise_mesh_vertex, y));
        assert!(offset_of!(MeshVertex, z) == offset_of!(posewise_mesh_vertex, z));
        assert!(offset_of!(MeshVertex, visibility) == offset_of!(posewise_mesh_vertex, visibility));
    };

    /// Writes the vertices; returns their number.
    ///
    /// # Safety
    /// `out` is aligned and has room for `capacity` items.
    pub(super) unsafe fn write(
        block: &Block,
        space: u32,
        out: *mut posewise_mesh_vertex,
        capacity: usize,
    ) -> Result<usize, posewise_status> {
        let (tracker, model) = (&block.tracker, &block.model);
        let space = match space {
            POSEWISE_MESH_SPACE_PICTURE => MeshSpace::Picture,
            POSEWISE_MESH_SPACE_CAMERA => MeshSpace::Camera,
            _ => MeshSpace::Head,
        };
        let vertices = tracker.mesh_vertices(model).map_err(error_of)?;
        // SAFETY: the caller's promise.
        let out = unsafe { cleared(out, vertices, capacity)? };
        tracker.mesh(model, space, out).map_err(error_of)
    }

    /// Writes the vertices of a shape; returns their number.
    ///
    /// # Safety
    /// As [`write`].
    pub(super) unsafe fn write_shape(
        block: &Block,
        shape: u32,
        out: *mut posewise_mesh_vertex,
        capacity: usize,
    ) -> Result<usize, posewise_status> {
        let (tracker, model) = (&block.tracker, &block.model);
        let shape = match shape {
            POSEWISE_MESH_NEUTRAL => MeshShape::Neutral,
            index => MeshShape::Animation(index as usize),
        };
        let vertices = tracker.mesh_shape_vertices(model).map_err(error_of)?;
        // SAFETY: the caller's promise.
        let out = unsafe { cleared(out, vertices, capacity)? };
        tracker.mesh_shape(model, shape, out).map_err(error_of)
    }

    /// The caller's vertices, if there is room for these.
    ///
    /// # Safety
    /// `out` is aligned and has room for `capacity` items.
    unsafe fn cleared<'o>(
        out: *mut posewise_mesh_vertex,
        vertices: usize,
        capacity: usize,
    ) -> Result<&'o mut [MeshVertex], posewise_status> {
        if vertices > capacity {
            return Err(POSEWISE_E_CAPACITY);
        }
        let out = out.cast::<MeshVertex>();
        // SAFETY: there is room by the caller's promise; zero is a valid vertex.
        unsafe {
            out.write_bytes(0, vertices);
            Ok(core::slice::from_raw_parts_mut(out, vertices))
        }
    }

    fn error_of(error: MeshError) -> posewise_status {
        match error {
            MeshError::NoMesh => POSEWISE_E_MESH,
            MeshError::NoFace => POSEWISE_E_NO_FACE,
            MeshError::Shape => POSEWISE_E_MESH_SHAPE,
            MeshError::Capacity { .. } => POSEWISE_E_CAPACITY,
        }
    }

    pub(super) fn tables(block: &Block) -> Option<posewise_mesh_topology> {
        let topology = block.model.mesh_topology()?;
        let (lines, lengths) = topology.lines();
        let mut line_starts = [0; MeshLine::ALL.len() + 1];
        let mut end = 0;
        for (start, length) in line_starts.iter_mut().skip(1).zip(lengths) {
            end += u32::from(*length);
            *start = end;
        }
        Some(posewise_mesh_topology {
            struct_size: 0,
            vertex_count: topology.vertices as u32,
            triangle_count: topology.triangles.len() as u32,
            line_starts,
            triangles: topology.triangles.as_ptr().cast(),
            uvs: topology.uvs.as_ptr().cast(),
            lines: lines.as_ptr(),
        })
    }
}
