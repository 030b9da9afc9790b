//! What the calls for unread events have in common.

use super::memory;
use super::types::posewise_status;
#[cfg(feature = "monitor")]
use crate::monitor::{MONITOR_EVENTS, MonitorEvent, MonitorEventLog};
use crate::track::{EVENTS, Event, EventLog};
use core::mem::size_of;

/// A list of unread events.
pub(super) trait Log {
    type Event;
    /// Events that it keeps.
    const CAPACITY: usize;
    fn unread(&self) -> usize;
    fn pop(&mut self) -> Option<Self::Event>;
    fn take_overwritten(&mut self) -> u32;
}

macro_rules! log {
    ($log:ident of $event:ty, $capacity:expr) => {
        impl Log for $log {
            type Event = $event;
            const CAPACITY: usize = $capacity;

            fn unread(&self) -> usize {
                $log::unread(self)
            }

            fn pop(&mut self) -> Option<$event> {
                $log::pop(self)
            }

            fn take_overwritten(&mut self) -> u32 {
                $log::take_overwritten(self)
            }
        }
    };
}

log!(EventLog of Event, EVENTS);
#[cfg(feature = "monitor")]
log!(MonitorEventLog of MonitorEvent, MONITOR_EVENTS);

/// Where a caller wants its events.
pub(super) struct Places<T> {
    pub out: *mut T,
    /// Events that `out` has room for.
    pub capacity: usize,
    /// Gets how many were written.
    pub count: *mut usize,
    /// Gets how many were overwritten unread.
    pub overwritten: *mut usize,
}

impl<T> Places<T> {
    /// Moves events from the log, which is within the `size` bytes at `block`.
    ///
    /// # Safety
    /// As at the head of memory.rs: `out` has room for `capacity` events.
    pub unsafe fn fill<L: Log, B>(
        self,
        log: &mut L,
        (block, size): (*mut B, usize),
        convert: impl Fn(&L::Event) -> T,
    ) -> Result<(), posewise_status> {
        memory::check_pointer(self.out)?;
        memory::check_pointer(self.count)?;
        memory::check_pointer(self.overwritten)?;
        let most = memory::written::<T>(self.capacity, L::CAPACITY);
        memory::require_disjoint(block, size, self.out, most)?;
        memory::require_disjoint(block, size, self.count, size_of::<usize>())?;
        memory::require_disjoint(block, size, self.overwritten, size_of::<usize>())?;
        let written = self.capacity.min(log.unread());
        let events = core::iter::from_fn(|| log.pop()).map(|event| convert(&event));
        // SAFETY: the caller's contract.
        unsafe {
            memory::write_first(self.out, written, events)?;
            self.count.write(written);
            self.overwritten.write(log.take_overwritten() as usize);
        }
        Ok(())
    }
}
