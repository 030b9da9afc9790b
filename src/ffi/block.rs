//! The tracker and its model in the caller's memory.

use super::convert::{config_error, load};
use super::memory::check_pointer;
use super::types::*;
use crate::track::{Config, Model, Tracker};
use core::mem::{MaybeUninit, align_of, size_of};

/// The content of the caller's memory.
#[repr(C, align(64))]
pub(super) struct Block {
    magic: u64,
    pub(super) model: Model<'static>,
    pub(super) tracker: Tracker,
}

/// Memory of a tracker \[bytes\].
pub(super) const BLOCK_SIZE: usize = size_of::<Block>();

/// Distinguishes a block of this build from other memory and from blocks of other layouts.
const MAGIC: u64 = u64::from_le_bytes(*b"posewise")
    ^ (BLOCK_SIZE as u64)
    ^ ((POSEWISE_VERSION as u64) << 40)
    ^ (align_of::<Tracker>() as u64) << 32;

const _: () = assert!(align_of::<Block>() == POSEWISE_ALIGN as usize);
const _: () = assert!(
    BLOCK_SIZE <= POSEWISE_MEMORY_SIZE as usize,
    "raise POSEWISE_MEMORY_SIZE in ffi/types.rs"
);

/// Builds a tracker at `memory`, which is untouched if the settings or the model are wrong.
///
/// # Safety
/// `memory` is aligned to [`POSEWISE_ALIGN`] and has [`BLOCK_SIZE`] writable bytes.
pub(super) unsafe fn place(
    memory: *mut u8,
    model: &'static [u8],
    config: &Config,
) -> Result<(), posewise_status> {
    config.check().map_err(config_error)?;
    let block = memory.cast::<Block>();
    // SAFETY: by the caller's promise, here and below; `MaybeUninit` may hold whatever was there.
    load_into(unsafe { &mut *(&raw mut (*block).model).cast() }, model)?;
    let slot = unsafe { &mut *(&raw mut (*block).tracker).cast::<MaybeUninit<Tracker>>() };
    Tracker::init_in(slot, config).map_err(config_error)?;
    // SAFETY: as above; the magic comes last, when the block is whole.
    unsafe { (&raw mut (*block).magic).write(MAGIC) };
    Ok(())
}

/// Loads a model into the block. By itself, because a model by value on the caller's stack would
/// come on top of what loading takes.
#[inline(never)]
fn load_into(
    slot: &mut MaybeUninit<Model<'static>>,
    model: &'static [u8],
) -> Result<(), posewise_status> {
    slot.write(load(model)?);
    Ok(())
}

/// An error unless the pointer is one to a tracker of this build.
///
/// # Safety
/// As at the head of memory.rs.
unsafe fn check_block(tracker: *const posewise_tracker) -> Result<*const Block, posewise_status> {
    let block = tracker.cast::<Block>();
    check_pointer(block)?;
    // SAFETY: non-NULL and aligned. Volatile, because the bytes may never have been written.
    if unsafe { (&raw const (*block).magic).read_volatile() } == MAGIC {
        Ok(block)
    } else {
        Err(POSEWISE_E_TRACKER)
    }
}

/// The block of a tracker, to read.
///
/// # Safety
/// As at the head of memory.rs.
pub(super) unsafe fn get<'a>(
    tracker: *const posewise_tracker,
) -> Result<&'a Block, posewise_status> {
    // SAFETY: the magic shows that `place` wrote a block here.
    unsafe { Ok(&*check_block(tracker)?) }
}

/// The block of a tracker, to change.
///
/// # Safety
/// As at the head of memory.rs.
pub(super) unsafe fn get_mut<'a>(
    tracker: *mut posewise_tracker,
) -> Result<&'a mut Block, posewise_status> {
    // SAFETY: the magic shows that `place` wrote a block here; by the caller's contract no other
    // thread uses it.
    unsafe { Ok(&mut *check_block(tracker)?.cast_mut()) }
}
