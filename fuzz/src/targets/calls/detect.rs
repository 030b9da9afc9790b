//! Calls of `posewise_detect()`.

use super::World;
use super::arguments::{is_good, lay_out, spoilt};
use super::step::{Arguments, Image};
use crate::ffi::api::posewise_detect;
use crate::targets::input::Input;
use crate::targets::outputs::{UNTOUCHED, check_faces, faces_memory};

impl World {
    pub(super) fn detect(&mut self, input: &mut Input<'_>, slot: usize, pointer: u8) {
        let (tracker, live) = self.tracker(slot, pointer);
        let (wrong, how, capacity) = (input.u8(), input.u8(), input.u8() as usize % 20);
        let image = Image::new(input);
        let arguments = Arguments::new(input, wrong, image.frame(0));
        // At most one of the outputs is wrong.
        let hows = [0, 1, 2].map(|output| if how >> 3 & 3 == output { how } else { 0 });
        let good = live
            && arguments.frame_is_good()
            && image.holds(self.roi(slot))
            && hows.iter().all(|how| is_good(*how));
        let given = lay_out(arguments.frame, arguments.frame_size);
        let [out, count, finished] = faces_memory(capacity);
        let before = self.snapshot(slot);
        // SAFETY: everything is as long as stated.
        let status = unsafe {
            posewise_detect(
                tracker,
                spoilt(given.ptr(), arguments.frame_how).cast(),
                spoilt(out.ptr(), hows[0]).cast(),
                capacity,
                spoilt(count.ptr(), hows[1]).cast(),
                spoilt(finished.ptr(), hows[2]).cast(),
            )
        };
        image.check();
        for output in [&out, &count, &finished] {
            output.check();
            let untouched = output.get().iter().all(|b| *b == UNTOUCHED);
            assert!(good || untouched, "a call that failed has written");
        }
        if good {
            check_faces([&out, &count, &finished]);
            for output in [&out, &count, &finished] {
                self.log.extend(output.get());
            }
        }
        self.check_status(slot, status, good, &before);
    }
}
