//! Calls of the functions that change a tracker's settings.

use super::World;
use super::arguments::{boxes, intrinsics, is_good, lens, roi, spoilt};
use crate::ffi::{api::*, types::*};
use crate::targets::input::Input;
use crate::targets::memory::Exact;

impl World {
    pub(super) fn set_intrinsics(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let how = input.u8();
        let (camera, sound) = intrinsics(input);
        let bytes = Exact::new(size_of::<posewise_intrinsics>(), 4, 0);
        // SAFETY: as long as the struct.
        unsafe { bytes.ptr().cast::<posewise_intrinsics>().write(camera) };
        let good = live && (how & 7 == 6 || is_good(how) && sound);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_set_intrinsics(tracker, spoilt(bytes.ptr(), how).cast()) };
        self.check_status(slot, status, good, &before);
    }

    /// With a lens go intrinsics, which are set before.
    pub(super) fn set_lens(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let how = input.u8();
        let (lens, sound) = lens(input);
        let bytes = Exact::new(size_of::<posewise_lens>(), 4, 0);
        // SAFETY: as long as the struct.
        unsafe { bytes.ptr().cast::<posewise_lens>().write(lens) };
        let (fx, fy, cx, cy) = (300.0, 300.0, 20.0, 20.0);
        let camera = posewise_intrinsics { fx, fy, cx, cy };
        // SAFETY: the memory is there.
        let camera_status = unsafe { posewise_set_intrinsics(tracker, &camera) };
        assert_eq!(camera_status == POSEWISE_OK, live);
        let good = live && (how & 7 == 6 || is_good(how) && sound);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_set_lens(tracker, spoilt(bytes.ptr(), how).cast()) };
        self.check_status(slot, status, good, &before);
    }

    pub(super) fn set_roi(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let how = input.u8();
        let (roi, sound) = roi(input);
        let bytes = Exact::new(size_of::<posewise_roi>(), 4, 0);
        // SAFETY: as long as the struct.
        unsafe { bytes.ptr().cast::<[u32; 4]>().write(roi) };
        let good = live && (how & 7 == 6 || is_good(how) && sound);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status = unsafe { posewise_set_roi(tracker, spoilt(bytes.ptr(), how).cast()) };
        if let Some(live) = self.slots[slot].live.as_mut().filter(|_| good) {
            live.roi = if how & 7 == 6 { [0; 4] } else { roi };
        }
        self.check_status(slot, status, good, &before);
    }

    pub(super) fn set_excluded(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let (how, count) = (input.u8(), input.u8() as usize % 20);
        let (boxes, sound) = boxes(input, count);
        let given = Exact::new((count * 16).max(1), 4, 0);
        // SAFETY: as long as the boxes.
        unsafe { (given.ptr().cast::<f32>()).copy_from(boxes.as_ptr(), boxes.len()) };
        let good = live && count <= 16 && (count == 0 || is_good(how) && sound);
        let before = self.snapshot(slot);
        // SAFETY: the memory is there.
        let status =
            unsafe { posewise_set_excluded(tracker, spoilt(given.ptr(), how).cast(), count) };
        self.check_status(slot, status, good, &before);
    }
}
