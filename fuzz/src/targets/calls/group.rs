//! Calls of `posewise_group_init()` and `posewise_group_step()`.

use super::arguments::{FRAME, RESULT, is_good, lay_out, spoilt};
use super::step::Image;
use super::{Live, SLOTS, World};
use crate::ffi::{group::*, types::*};
use crate::targets::input::Input;
use crate::targets::memory::Guarded;
use crate::targets::outputs::Outputs;

impl World {
    pub(super) fn init_group(&mut self, input: &mut Input<'_>, pointer: u8) {
        let short = usize::from(input.u8() & 7 == 7);
        let len = self.group.len() - short - usize::from(pointer == 7);
        let good = is_good(pointer) && short == 0;
        let mut out = std::ptr::null_mut();
        let start = spoilt(self.group.ptr(), pointer).cast();
        // SAFETY: as long as stated.
        let status = unsafe { posewise_group_init(&mut out, start, len) };
        assert_eq!(status == POSEWISE_OK, good, "status {status}");
        assert_eq!(out.is_null(), !good);
        self.has_group |= good;
        self.log.extend(status.to_le_bytes());
    }

    pub(super) fn step_group(&mut self, input: &mut Input<'_>, pointer: u8) {
        let (order, late) = (input.u8(), input.u8());
        let count = usize::from(order) % (SLOTS + 2);
        // From any slot on, so that one more than there are is one twice.
        let slots: Vec<usize> = (0..count)
            .map(|k| (k + usize::from(order >> 4)) % SLOTS)
            .collect();
        let live = |slot: &usize| self.slots[*slot].live.as_ref();
        let last = slots.iter().filter_map(live).filter_map(|of| of.last_us);
        let last = last.max().unwrap_or(0);
        let timestamp_us = match late {
            0..200 => last.saturating_add(33_333),
            _ => last.saturating_sub(i64::from(late)),
        };
        let image = Image::new(input);
        let takes = |slot: &usize| {
            live(slot).is_some_and(|of| of.last_us.is_none_or(|last| timestamp_us > last))
                && image.holds(self.roi(*slot))
        };
        let good = self.has_group
            && is_good(pointer)
            && (1..=SLOTS).contains(&count)
            && slots.iter().all(takes);
        let trackers: Vec<*mut posewise_tracker> = slots
            .iter()
            .map(|slot| self.slots[*slot].memory.ptr().cast())
            .chain([std::ptr::null_mut()])
            .collect();
        let mut out = Guarded::new(RESULT as usize * count.max(1), 0x77);
        for result in out.get_mut().chunks_exact_mut(RESULT as usize) {
            result[..4].copy_from_slice(&RESULT.to_ne_bytes());
        }
        let untouched = out.get().to_vec();
        let before: Vec<Vec<u8>> = (0..SLOTS).map(|slot| self.snapshot(slot)).collect();
        let frame = lay_out(image.frame(timestamp_us), FRAME);
        // SAFETY: everything is as long as stated.
        let status = unsafe {
            posewise_group_step(
                spoilt(self.group.ptr(), pointer).cast(),
                trackers.as_ptr(),
                count,
                frame.ptr().cast(),
                out.ptr().cast(),
            )
        };
        assert_eq!(status == POSEWISE_OK, good, "status {status}");
        out.check();
        image.check();
        self.log.extend(status.to_le_bytes());
        if !good {
            assert!(out.get() == untouched, "a step that failed has written");
            assert!((0..SLOTS).all(|slot| self.is_as(slot, &before[slot])));
            return;
        }
        for (slot, result) in slots.iter().zip(out.get().chunks_exact(RESULT as usize)) {
            let outputs = Outputs::of(self.slots[*slot].memory.ptr().cast(), result);
            assert_eq!(outputs.timestamp_us(), timestamp_us);
            self.log.extend(outputs.bytes());
            let roi = self.roi(*slot);
            self.slots[*slot].live = Some(Live {
                last_us: Some(timestamp_us),
                outputs: Some(outputs),
                roi,
            });
        }
    }
}
