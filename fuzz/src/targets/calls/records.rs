//! Records of a person's head and of a driver: saved, spoilt, compared and restored.

use super::World;
use super::arguments::is_good;
use crate::ffi::{identity::*, monitor::*, monitor_types::*, types::*};
use crate::targets::input::Input;
use crate::targets::memory::Guarded;

const IDENTITY: usize = POSEWISE_IDENTITY_RECORD_SIZE as usize;
const DRIVER: usize = POSEWISE_MONITOR_RECORD_SIZE as usize;

/// What is done to a record before it is read.
fn spoil(input: &mut Input<'_>, record: &mut Vec<u8>) {
    let (what, at, byte) = (input.u8(), input.u16() as usize, input.u8());
    match what % 8 {
        0 => record.truncate(at % (record.len() + 1)),
        1 => record.push(byte),
        2 => {
            if let Some(to) = record.get_mut(at) {
                *to ^= byte;
            }
        }
        _ => {}
    }
}

impl World {
    pub(super) fn records(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let before = self.snapshot(slot);
        let place = input.u8();
        let capacity = match input.u8() {
            0..200 => IDENTITY,
            other => usize::from(other),
        };
        let out = Guarded::new(capacity, 0x33);
        let to = match is_good(place) {
            true => out.ptr(),
            false => std::ptr::null_mut(),
        };
        // SAFETY: as long as the capacity says.
        let status = unsafe { posewise_save_identity(tracker, to, capacity) };
        out.check();
        let (saved, sound) = (
            status == POSEWISE_OK,
            is_good(place) && capacity >= IDENTITY,
        );
        assert!(!saved || live && sound);
        assert!(saved || !live || !sound || status == POSEWISE_E_NO_FACE);
        assert!(saved || out.get().iter().all(|byte| *byte == 0x33));
        assert!(
            self.is_as(slot, &before),
            "a tracker is not changed by saving"
        );
        self.log.extend(status.to_le_bytes());
        self.log.extend(out.get());

        let mut record = out.get().to_vec();
        spoil(input, &mut record);
        let untouched = record == out.get();
        let mut likeness = 77;
        // SAFETY: as long as stated.
        let status = unsafe {
            posewise_compare_identity(tracker, record.as_ptr(), record.len(), &mut likeness)
        };
        let is_valid = status == POSEWISE_OK;
        assert!(!is_valid || live && likeness <= POSEWISE_LIKENESS_OTHER);
        assert!(is_valid || likeness == 77);
        assert!(is_valid || !live || !saved || !untouched);
        assert!(
            self.is_as(slot, &before),
            "a tracker is not changed by comparing"
        );
        // SAFETY: as above.
        let restored = unsafe { posewise_restore_identity(tracker, record.as_ptr(), record.len()) };
        assert_eq!(restored, status, "both judge a record alike");
        self.check_status(slot, restored, is_valid, &before);
        self.driver_record(input, slot, pointer);
    }

    fn driver_record(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (monitor, live) = self.watched(slot, pointer);
        let before = self.monitors[slot].memory.get().to_vec();
        let mut record = vec![0x33; DRIVER];
        // SAFETY: as long as stated, here and below.
        let saved = unsafe { posewise_monitor_save(monitor, record.as_mut_ptr(), DRIVER) };
        assert_eq!(saved == POSEWISE_OK, live);
        spoil(input, &mut record);
        let restored = unsafe { posewise_monitor_restore(monitor, record.as_ptr(), record.len()) };
        assert!(restored != POSEWISE_OK || live);
        let same = cfg!(miri) || self.monitors[slot].memory.get() == before;
        assert!(
            restored == POSEWISE_OK || same,
            "a record that is refused has changed it"
        );
        self.log.extend(restored.to_le_bytes());
    }
}
