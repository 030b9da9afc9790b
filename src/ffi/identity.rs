//! The functions of `include/posewise.h` that remember a person's head. As in `api`, the comments
//! are written for the C reader.

// The contract of all pointers stands at the head of the header and of memory.rs.
#![allow(clippy::missing_safety_doc)]

use super::api::status;
use super::block::{self, BLOCK_SIZE};
use super::memory;
use super::types::*;
use crate::record::RecordError;
use crate::shape::{IDENTITY_RECORD_BYTES, Likeness};
use core::mem::size_of;

const _: () = assert!(POSEWISE_IDENTITY_RECORD_SIZE as usize == IDENTITY_RECORD_BYTES);
const _: () = {
    assert!(Likeness::ALL.len() == 3);
    assert!(matches!(
        Likeness::ALL[POSEWISE_LIKENESS_SAME as usize],
        Likeness::Same
    ));
    assert!(matches!(
        Likeness::ALL[POSEWISE_LIKENESS_OTHER as usize],
        Likeness::Other
    ));
};

/// Writes what was learnt of the person's head to POSEWISE_IDENTITY_RECORD_SIZE bytes, of which
/// there must be as many: keep them while the power is off, for posewise_restore_identity() and
/// posewise_compare_identity(). Fails with POSEWISE_E_NO_FACE before the first trusted frame since
/// posewise_init() or posewise_reset(), and with POSEWISE_E_CAPACITY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_save_identity(
    tracker: *const posewise_tracker,
    out: *mut u8,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get(tracker)? };
        memory::check_pointer(out)?;
        if capacity < IDENTITY_RECORD_BYTES {
            return Err(POSEWISE_E_CAPACITY);
        }
        memory::require_disjoint(tracker, BLOCK_SIZE, out, IDENTITY_RECORD_BYTES)?;
        let record = block.tracker.save_identity(&block.model);
        let record = record.ok_or(POSEWISE_E_NO_FACE)?;
        unsafe { out.copy_from_nonoverlapping(record.as_ptr(), record.len()) };
        Ok(())
    })
}

/// Guesses that the tracked face, and every new one until posewise_forget_identity() or
/// posewise_reset(), is that of a record, so that its head is there from the first frame on. What
/// is seen replaces the guess: of the record of another person less than a tenth is left after 200
/// trusted frames. A record of another program version is read, or is POSEWISE_E_RECORD_VERSION;
/// one that was made with a model of another 3D face is POSEWISE_E_RECORD_MODEL. On an error
/// nothing has changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_restore_identity(
    tracker: *mut posewise_tracker,
    record: *const u8,
    record_len: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get_mut(tracker)? };
        let record = unsafe { memory::bytes(record, record_len, POSEWISE_E_RECORD_SIZE)? };
        memory::require_disjoint(tracker, BLOCK_SIZE, record.as_ptr(), record.len())?;
        let restored = block.tracker.restore_identity(&block.model, record);
        restored.map_err(record_error)
    })
}

/// Writes whether the head that was tracked last has the shape of that of a record
/// (POSEWISE_LIKENESS_*), by what was seen of it: what was guessed by posewise_restore_identity()
/// plays no part. It is unknown until twelve trusted frames were seen. It is no identification: two
/// people may have heads of one shape. How often it is wrong is in docs/driver-monitor.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_compare_identity(
    tracker: *const posewise_tracker,
    record: *const u8,
    record_len: usize,
    likeness: *mut u32,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get(tracker)? };
        let record = unsafe { memory::bytes(record, record_len, POSEWISE_E_RECORD_SIZE)? };
        memory::check_pointer(likeness)?;
        memory::require_disjoint(tracker, BLOCK_SIZE, likeness, size_of::<u32>())?;
        let compared = block.tracker.compare_identity(&block.model, record);
        let found = match compared.map_err(record_error)? {
            Likeness::Unknown => POSEWISE_LIKENESS_UNKNOWN,
            Likeness::Same => POSEWISE_LIKENESS_SAME,
            Likeness::Other => POSEWISE_LIKENESS_OTHER,
        };
        unsafe { likeness.write(found) };
        Ok(())
    })
}

/// The status of a record that is refused.
pub(super) fn record_error(error: RecordError) -> posewise_status {
    match error {
        RecordError::Kind => POSEWISE_E_RECORD,
        RecordError::Size => POSEWISE_E_RECORD_SIZE,
        RecordError::Version => POSEWISE_E_RECORD_VERSION,
        RecordError::Checksum => POSEWISE_E_RECORD_CHECKSUM,
        RecordError::Model => POSEWISE_E_RECORD_MODEL,
    }
}
