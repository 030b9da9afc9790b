//! Calls between two frames.

use super::checks::is_in;
use super::session::{Session, new_slot};
use super::video::Picture;
use crate::ffi::{api::*, identity::*, types::*};
use posewise::Distortion;
use std::ptr::null;

impl Session<'_> {
    pub(super) fn call_something(&mut self, index: usize, picture: &Picture) {
        match self.random.below(600) {
            0..4 => self.set_intrinsics(index),
            4..8 => self.set_lens(index),
            8..14 => self.set_roi(index, picture),
            14..20 => self.set_excluded(index),
            20..22 => self.forget(index),
            22..24 => self.reset(index),
            24..34 => self.detect(index, picture),
            34..38 => self.call_wrongly(index, picture),
            40 => {
                self.slots[index].watcher.forget();
                self.tally.count("posewise_monitor_forget_driver");
            }
            41..45 => self.remember(index),
            38..40 => self.slots[index] = new_slot(&mut self.random, self.model, self.fill),
            _ => return,
        }
        self.events(index);
    }

    /// Counts a call; one that failed must have changed nothing.
    fn done(&mut self, index: usize, call: &'static str, status: i32, before: &[u8]) -> bool {
        let same = self.slots[index].tracker.memory().get() == before;
        assert!(status == POSEWISE_OK || same, "{call} changed the tracker");
        self.slots[index].tracker.memory().check();
        self.mix(&status.to_le_bytes());
        self.tally.count(match status {
            POSEWISE_OK => call,
            _ => "other calls refused",
        });
        status == POSEWISE_OK
    }

    fn snapshot(&mut self, index: usize) -> Vec<u8> {
        self.slots[index].tracker.memory().get().to_vec()
    }

    fn set_intrinsics(&mut self, index: usize) {
        let camera = match self.random.once_in(4) {
            true => posewise_intrinsics::default(),
            false => self.camera(),
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_intrinsics(self.slots[index].tracker.ptr(), &camera) };
        if self.done(index, "posewise_set_intrinsics", status, &before) {
            self.slots[index].has_camera = camera.fx != 0.0;
        }
    }

    fn camera(&mut self) -> posewise_intrinsics {
        let camera = self.random.camera(4.0);
        let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy];
        posewise_intrinsics { fx, fy, cx, cy }
    }

    fn set_lens(&mut self, index: usize) {
        let lens = match self.random.lens() {
            Distortion::BrownConrady { k1, k2, p1, p2, k3 } => posewise_lens {
                model: POSEWISE_LENS_BROWN,
                coefficients: [k1, k2, p1, p2, k3],
            },
            Distortion::KannalaBrandt { k1, k2, k3, k4 } => posewise_lens {
                model: POSEWISE_LENS_FISHEYE,
                coefficients: [k1, k2, k3, k4, 0.0],
            },
            _ => posewise_lens::default(),
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_lens(self.slots[index].tracker.ptr(), &lens) };
        let set = self.done(index, "posewise_set_lens", status, &before);
        assert!(self.slots[index].has_camera || !set);
    }

    fn set_roi(&mut self, index: usize, picture: &Picture) {
        let [width, height] = picture.upright();
        let mut part = |whole: u32| self.random.below(whole as usize) as u32;
        let (x, y) = (part(width), part(height));
        let roi = [x, y, 1 + part(width - x), 1 + part(height - y)];
        let [x, y, width, height] = roi;
        let given = posewise_roi {
            x,
            y,
            width,
            height,
        };
        let before = self.snapshot(index);
        // SAFETY: a whole struct.
        let status = unsafe { posewise_set_roi(self.slots[index].tracker.ptr(), &given) };
        assert!(self.done(index, "posewise_set_roi", status, &before));
        self.slots[index].roi = roi;
    }

    /// The boxes of other trackers, and of anything.
    fn set_excluded(&mut self, index: usize) {
        let others = self.slots.iter().enumerate().filter(|(k, _)| *k != index);
        let mut boxes: Vec<[f32; 4]> = others
            .map(|(_, other)| other.face_box)
            .filter(|face_box| face_box[2] >= 1.0)
            .collect();
        if self.random.once_in(3) {
            boxes.push(self.slots[index].face_box); // may be all zero, which is refused
        }
        let before = self.snapshot(index);
        let (tracker, first) = (self.slots[index].tracker.ptr(), boxes.as_ptr().cast());
        // SAFETY: as many boxes as it is told.
        let status = unsafe { posewise_set_excluded(tracker, first, boxes.len()) };
        self.done(index, "posewise_set_excluded", status, &before);
    }

    fn forget(&mut self, index: usize) {
        let before = self.snapshot(index);
        // SAFETY: a live tracker.
        let status = unsafe { posewise_forget_identity(self.slots[index].tracker.ptr()) };
        assert!(self.done(index, "posewise_forget_identity", status, &before));
    }

    /// Saves what was learnt of a head, compares it with that of any tracker, and has that one
    /// guess it.
    fn remember(&mut self, index: usize) {
        let mut record = [0; POSEWISE_IDENTITY_RECORD_SIZE as usize];
        let before = self.snapshot(index);
        let tracker = self.slots[index].tracker.ptr();
        // SAFETY: a live tracker, and a record's bytes.
        let status = unsafe { posewise_save_identity(tracker, record.as_mut_ptr(), record.len()) };
        assert!(self.slots[index].tracker.memory().get() == before);
        if !self.done(index, "posewise_save_identity", status, &before) {
            assert_eq!(status, POSEWISE_E_NO_FACE);
            return;
        }
        self.mix(&record);
        let other = self.random.below(self.slots.len());
        let before = self.snapshot(other);
        let tracker = self.slots[other].tracker.ptr();
        let mut likeness = u32::MAX;
        // SAFETY: as above.
        let status = unsafe {
            posewise_compare_identity(tracker, record.as_ptr(), record.len(), &mut likeness)
        };
        assert!(self.done(other, "posewise_compare_identity", status, &before));
        assert!(likeness <= POSEWISE_LIKENESS_OTHER);
        self.mix(&likeness.to_le_bytes());
        // SAFETY: as above.
        let status = unsafe { posewise_restore_identity(tracker, record.as_ptr(), record.len()) };
        assert!(self.done(other, "posewise_restore_identity", status, &before));
    }

    pub(super) fn reset(&mut self, index: usize) {
        let before = self.snapshot(index);
        // SAFETY: a live tracker.
        let status = unsafe { posewise_reset(self.slots[index].tracker.ptr()) };
        assert!(self.done(index, "posewise_reset", status, &before));
        let slot = &mut self.slots[index];
        slot.state = POSEWISE_SEARCHING;
        slot.last_us = None;
        slot.face_box = [0.0; 4];
        self.events(index);
    }

    fn detect(&mut self, index: usize, picture: &Picture) {
        let before = self.snapshot(index);
        let slot = &mut self.slots[index];
        let fits = is_in(slot.roi, picture.upright());
        // SAFETY: a whole frame.
        let outputs = unsafe { slot.tracker.detect(&picture.frame) };
        let status = outputs.as_ref().err().copied().unwrap_or(POSEWISE_OK);
        let expected = if fits { POSEWISE_OK } else { POSEWISE_E_ROI };
        assert_eq!(status, expected);
        if self.done(index, "posewise_detect", status, &before) {
            let outputs = outputs.expect("as just seen");
            outputs.iter().for_each(|bytes| self.mix(bytes));
            let count = usize::from_ne_bytes(*outputs[1].first_chunk().expect("a length"));
            self.tally.faces += count as u64;
        }
    }

    /// A call that must fail.
    fn call_wrongly(&mut self, index: usize, picture: &Picture) {
        let before = self.snapshot(index);
        let mut frame = picture.frame;
        let expected = match self.random.below(6) {
            0 => {
                frame.width = 0;
                POSEWISE_E_FRAME
            }
            1 => {
                frame.data_len -= 1;
                POSEWISE_E_FRAME
            }
            2 => {
                frame.format ^= 1 << 31;
                POSEWISE_E_FORMAT
            }
            3 => {
                frame.struct_size += 8;
                POSEWISE_E_STRUCT_SIZE
            }
            4 => {
                frame.data = null();
                POSEWISE_E_NULL
            }
            _ => {
                frame.flags = 2;
                POSEWISE_E_FLAGS
            }
        };
        let slot = &mut self.slots[index];
        // SAFETY: the frame is whole, or must not be read.
        let statuses = unsafe {
            let stepped = slot.tracker.step(&frame).map(drop);
            [stepped, slot.tracker.detect(&frame).map(drop)]
        };
        assert_eq!(statuses, [Err(expected); 2]);
        self.done(index, "", expected, &before);
    }
}
