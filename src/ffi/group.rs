//! The functions of `include/posewise.h` for groups of trackers. As in `api`, the comments are
//! written for the C reader.

// The contract of all pointers stands at the head of the header and of memory.rs.
#![allow(clippy::missing_safety_doc)]

use super::api::status;
use super::block::{self, BLOCK_SIZE};
use super::convert::{frame_from, result_to, step_error};
use super::memory;
use super::types::*;
use crate::track::{Group, MAX_GROUP, Members, Model, Tracker};
use core::ffi::c_void;
use core::mem::{align_of, size_of};

/// The content of the caller's memory.
#[repr(C, align(64))]
struct GroupBlock {
    magic: u64,
    group: Group,
}

/// Memory of a group \[bytes\].
const GROUP_SIZE: usize = size_of::<GroupBlock>();

/// Distinguishes a block of this build from other memory and from blocks of other layouts.
const MAGIC: u64 =
    u64::from_le_bytes(*b"a group!") ^ (GROUP_SIZE as u64) ^ ((POSEWISE_VERSION as u64) << 40);

const _: () = assert!(align_of::<GroupBlock>() == POSEWISE_ALIGN as usize);
const _: () = assert!(GROUP_SIZE <= POSEWISE_GROUP_SIZE as usize);
const _: () = assert!(MAX_GROUP == POSEWISE_GROUP_TRACKERS as usize);

/// Memory that posewise_group_init() needs \[bytes\], at most POSEWISE_GROUP_SIZE.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_group_memory_size() -> usize {
    GROUP_SIZE
}

/// Creates a group in memory, which must be aligned to POSEWISE_ALIGN and outlive it. Nothing needs
/// to be freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_group_init(
    out: *mut *mut posewise_group,
    memory: *mut c_void,
    memory_len: usize,
) -> posewise_status {
    status(|| {
        memory::check_pointer(out)?;
        memory::check_pointer(memory.cast::<u8>())?;
        memory::check_room(memory, memory_len, GROUP_SIZE)?;
        memory::require_disjoint(memory, GROUP_SIZE, out, size_of::<*mut posewise_group>())?;
        let block = memory.cast::<GroupBlock>();
        // SAFETY: aligned and long enough, as just checked; the magic comes last.
        unsafe {
            (&raw mut (*block).group).write(Group::new());
            (&raw mut (*block).magic).write(MAGIC);
            out.write(memory.cast());
        }
        Ok(())
    })
}

/// Steps several trackers on one frame, so that each follows a face of its own: trackers that have
/// a face go first, and the others find none of these faces. Writes the result of each to out,
/// which has room for count of them, each with its struct_size.
///
/// trackers are those of the steps before, in the same order; those that are added come last. They
/// may have settings of their own, and replace what posewise_set_excluded() said. At most
/// POSEWISE_GROUP_TRACKERS of them.
///
/// They cost less than alone. Noise is measured and new faces are searched for once. Of the faces
/// that are tracked, one is seen with all networks on each frame, by turns; of the others, what the
/// second network of the global stage and the mouth's mirrored run changed when they last ran is
/// taken. On an error all trackers are as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_group_step(
    group: *mut posewise_group,
    trackers: *const *mut posewise_tracker,
    count: usize,
    frame: *const posewise_frame,
    out: *mut posewise_result,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let group_block = unsafe { get_mut(group)? };
        memory::check_pointer(trackers)?;
        if count == 0 || count > MAX_GROUP {
            return Err(POSEWISE_E_GROUP_TRACKERS);
        }
        let trackers = unsafe { core::slice::from_raw_parts(trackers, count) };
        let given = unsafe { memory::read_struct(frame)? };
        let size = unsafe { memory::checked_size(out)? };
        let results = |k: usize| out.wrapping_byte_add(k * size);
        for (k, tracker) in trackers.iter().enumerate() {
            unsafe { block::get(*tracker)? };
            if unsafe { memory::checked_size(results(k))? } != size {
                return Err(POSEWISE_E_STRUCT_SIZE);
            }
            memory::require_disjoint(*tracker, BLOCK_SIZE, out, count * size)?;
            memory::require_disjoint(*tracker, BLOCK_SIZE, group, GROUP_SIZE)?;
            for other in trackers.iter().take(k) {
                memory::require_disjoint(*tracker, BLOCK_SIZE, *other, BLOCK_SIZE)?;
            }
        }
        memory::require_disjoint(group, GROUP_SIZE, out, count * size)?;
        let frame = unsafe { frame_from(&given)? };
        (group_block.group)
            .step_members(&mut Blocks(trackers), &frame, given.timestamp_us)
            .map_err(step_error)?;
        for (k, tracker) in trackers.iter().enumerate() {
            let result = unsafe { block::get(*tracker)? }.tracker.result();
            unsafe { memory::write_struct(results(k), size, &result_to(result)) };
        }
        Ok(())
    })
}

/// Trackers in the caller's memory, which were checked: no two overlap.
struct Blocks<'a>(&'a [*mut posewise_tracker]);

impl Members for Blocks<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn get(&mut self, k: usize) -> Option<(&Model<'_>, &mut Tracker)> {
        // SAFETY: the caller's contract.
        let block = unsafe { block::get_mut(*self.0.get(k)?) }.ok()?;
        Some((&block.model, &mut block.tracker))
    }
}

/// The group, to change; an error unless the pointer is one to a group of this build.
///
/// # Safety
/// As at the head of memory.rs.
unsafe fn get_mut<'a>(group: *mut posewise_group) -> Result<&'a mut GroupBlock, posewise_status> {
    let block = group.cast::<GroupBlock>();
    memory::check_pointer(block)?;
    // SAFETY: non-NULL and aligned. Volatile, because the bytes may never have been written. The
    // magic shows that a group was made here; by the caller's contract no other thread uses it.
    match unsafe { (&raw const (*block).magic).read_volatile() } == MAGIC {
        true => Ok(unsafe { &mut *block }),
        false => Err(POSEWISE_E_GROUP),
    }
}
