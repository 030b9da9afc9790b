//! The functions of `include/posewise.h` for driver monitoring. As in `api`, the comments are
//! written for the C reader.

// The contract of all pointers stands at the head of the header and of memory.rs.
#![allow(clippy::missing_safety_doc)]

use super::api::status;
use super::block;
use super::events::Places;
use super::identity::record_error;
use super::memory;
use super::monitor_convert::*;
use super::monitor_types::*;
use super::names::{CName, name_at, names_of};
use super::types::*;
use crate::monitor::{MAX_ZONES, Monitor, MonitorConfig, MonitorEventKind, Observation, Zone};
use core::ffi::{c_char, c_void};
use core::mem::{MaybeUninit, align_of, size_of};

/// The content of the caller's memory.
#[repr(C, align(64))]
struct MonitorBlock {
    magic: u64,
    monitor: Monitor,
}

/// Memory of a monitor \[bytes\].
const BLOCK_SIZE: usize = size_of::<MonitorBlock>();

/// Distinguishes a block of this build from other memory and from blocks of other layouts.
const MAGIC: u64 =
    u64::from_le_bytes(*b"monitors") ^ (BLOCK_SIZE as u64) ^ ((POSEWISE_VERSION as u64) << 40);

const _: () = assert!(align_of::<MonitorBlock>() == POSEWISE_ALIGN as usize);
const _: () = assert!(BLOCK_SIZE <= POSEWISE_MONITOR_SIZE as usize);

/// Writes the settings of a preset (POSEWISE_MONITOR_PRESET_*) with their values and
/// POSEWISE_EXACT: what is set to 0 then is 0. As for every struct, out->struct_size must be set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_config_default(
    preset: u32,
    out: *mut posewise_monitor_config,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let size = unsafe { memory::checked_size(out)? };
        let config = monitor_config_to(preset, &preset_from(preset)?.config());
        unsafe { memory::write_struct(out, size, &config) };
        Ok(())
    })
}

/// Memory that posewise_monitor_init() needs for these settings (NULL: defaults) \[bytes\], at most
/// POSEWISE_MONITOR_SIZE; 0 if the settings are invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_memory_size(
    config: *const posewise_monitor_config,
) -> usize {
    // SAFETY: the caller's contract.
    match status(|| unsafe { monitor_config_from(config).map(drop) }) {
        POSEWISE_OK => BLOCK_SIZE,
        _ => 0,
    }
}

/// Checks the settings (NULL: defaults), then creates a monitor of one driver in memory, which must
/// be aligned to POSEWISE_ALIGN and outlive it. Nothing needs to be freed. The monitor needs
/// neither model nor tracker, only observations. Its zones are those of the preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_init(
    out: *mut *mut posewise_monitor,
    memory: *mut c_void,
    memory_len: usize,
    config: *const posewise_monitor_config,
) -> posewise_status {
    status(|| {
        memory::check_pointer(out)?;
        memory::check_pointer(memory.cast::<u8>())?;
        // SAFETY: the caller's contract.
        let (config, preset) = unsafe { monitor_config_from(config)? };
        memory::check_room(memory, memory_len, BLOCK_SIZE)?;
        let out_len = size_of::<*mut posewise_monitor>();
        memory::require_disjoint(memory, BLOCK_SIZE, out, out_len)?;
        // SAFETY: aligned and long enough, as just checked.
        unsafe { place(memory.cast(), &config, preset.zones())? };
        // SAFETY: checked above.
        unsafe { out.write(memory.cast()) };
        Ok(())
    })
}

/// Writes what a monitor needs of the last step of a tracker.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_observe(
    tracker: *const posewise_tracker,
    out: *mut posewise_monitor_observation,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let result = unsafe { block::get(tracker)? }.tracker.result();
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(tracker, block::BLOCK_SIZE, out, size)?;
        let seen = observation_to(&Observation::from(result));
        unsafe { memory::write_struct(out, size, &seen) };
        Ok(())
    })
}

/// Takes one observation at its time \[us\], on any clock. Times may be irregular; frames without a
/// face are observations too, and frames that were dropped need none. A time before the last one
/// means that the clock was set back: closures, yawns and glances end, measures stay, drowsiness
/// and unknown eyes last on. The time of the last observation again is POSEWISE_E_TIME. The work of
/// a call is bounded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_update(
    monitor: *mut posewise_monitor,
    observation: *const posewise_monitor_observation,
    timestamp_us: i64,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let monitor = unsafe { get_mut(monitor)? };
        let seen = observation_from(&unsafe { memory::read_struct(observation)? });
        let updated = monitor.update(&seen, timestamp_us);
        updated.map_err(|_| POSEWISE_E_TIME)
    })
}

/// Writes what the monitor knows after the last observation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_read(
    monitor: *const posewise_monitor,
    out: *mut posewise_monitor_state,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let state = unsafe { get(monitor)? }.state();
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(monitor, BLOCK_SIZE, out, size)?;
        unsafe { memory::write_struct(out, size, &monitor_state_to(&state)) };
        Ok(())
    })
}

/// Takes the unread events out of the monitor's queue, oldest first, and writes the first capacity
/// of them; *count is how many were written. *overwritten is how many were lost since the last
/// call, because more than POSEWISE_MONITOR_EVENTS came unread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_events(
    monitor: *mut posewise_monitor,
    out: *mut posewise_monitor_event,
    capacity: usize,
    count: *mut usize,
    overwritten: *mut usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let log = unsafe { get_mut(monitor)? }.events();
        let places = Places {
            out,
            capacity,
            count,
            overwritten,
        };
        unsafe { places.fill(log, (monitor, BLOCK_SIZE), monitor_event_to) }
    })
}

/// Replaces the zones by `count` others, at most POSEWISE_MONITOR_ZONES; times in zones begin anew.
/// zones may be NULL if count is 0: then no direction is on the road or away from it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_set_zones(
    monitor: *mut posewise_monitor,
    zones: *const posewise_monitor_zone,
    count: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let monitor = unsafe { get_mut(monitor)? };
        if count > MAX_ZONES {
            return Err(POSEWISE_E_MONITOR_ZONES);
        }
        let given: &[posewise_monitor_zone] = if count == 0 {
            &[]
        } else {
            memory::check_pointer(zones)?;
            // SAFETY: non-NULL, aligned, and `count` zones by the caller's contract.
            unsafe { core::slice::from_raw_parts(zones, count) }
        };
        let mut zones = heapless::Vec::<Zone, MAX_ZONES>::new();
        for zone in given {
            // There is room for all of them.
            let _ = zones.push(zone_from(zone)?);
        }
        monitor.set_zones(&zones).map_err(monitor_config_error)
    })
}

/// Another person drives: forgets open eye, natural pose, all measures and the last timestamp, so
/// that the next observation may have any. Settings, zones and unread events stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_forget_driver(
    monitor: *mut posewise_monitor,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        unsafe { get_mut(monitor)? }.forget_driver();
        Ok(())
    })
}

/// Writes what was learnt of the driver, the natural pose and the open eyes, to
/// POSEWISE_MONITOR_RECORD_SIZE bytes, of which there must be as many: keep them while the power is
/// off, for posewise_monitor_restore().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_save(
    monitor: *const posewise_monitor,
    out: *mut u8,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let record = unsafe { get(monitor)? }.save();
        memory::check_pointer(out)?;
        if capacity < record.len() {
            return Err(POSEWISE_E_CAPACITY);
        }
        memory::require_disjoint(monitor, BLOCK_SIZE, out, record.len())?;
        unsafe { out.copy_from_nonoverlapping(record.as_ptr(), record.len()) };
        Ok(())
    })
}

/// Guesses that the driver is the one of a record. What it says counts from the next observation
/// on, is never final, and what is observed replaces it, so that the record of another person does
/// harm for a minute at most. Measures, events and time stay. On an error nothing has changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_monitor_restore(
    monitor: *mut posewise_monitor,
    record: *const u8,
    record_len: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let monitor = unsafe { get_mut(monitor)? };
        let record = unsafe { memory::bytes(record, record_len, POSEWISE_E_RECORD_SIZE)? };
        monitor.restore(record).map_err(record_error)
    })
}

/// Name of a kind of event, as "long-closure". Static; NULL for a kind that the library lacks.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_monitor_event_name(kind: u32) -> *const c_char {
    name_at(&NAMES, kind)
}

/// Builds a monitor at `memory`. By itself, so that its copy is not on the caller's stack.
///
/// # Safety
/// `memory` is aligned to [`POSEWISE_ALIGN`] and has [`BLOCK_SIZE`] writable bytes.
#[inline(never)]
unsafe fn place(
    memory: *mut u8,
    config: &MonitorConfig,
    zones: &[Zone],
) -> Result<(), posewise_status> {
    let block = memory.cast::<MonitorBlock>();
    let monitor = Monitor::with_zones(config, zones).map_err(monitor_config_error)?;
    // SAFETY: by the caller's promise; `MaybeUninit` may hold whatever was there. The magic comes
    // last, when the block is whole.
    unsafe {
        let slot = &mut *(&raw mut (*block).monitor).cast::<MaybeUninit<Monitor>>();
        slot.write(monitor);
        (&raw mut (*block).magic).write(MAGIC);
    }
    Ok(())
}

/// An error unless the pointer is one to a monitor of this build.
///
/// # Safety
/// As at the head of memory.rs.
unsafe fn check_block(
    monitor: *const posewise_monitor,
) -> Result<*const MonitorBlock, posewise_status> {
    let block = monitor.cast::<MonitorBlock>();
    memory::check_pointer(block)?;
    // SAFETY: non-NULL and aligned. Volatile, because the bytes may never have been written.
    if unsafe { (&raw const (*block).magic).read_volatile() } == MAGIC {
        Ok(block)
    } else {
        Err(POSEWISE_E_MONITOR)
    }
}

/// The monitor, to read.
///
/// # Safety
/// As at the head of memory.rs.
unsafe fn get<'a>(monitor: *const posewise_monitor) -> Result<&'a Monitor, posewise_status> {
    // SAFETY: the magic shows that `place` wrote a block here.
    unsafe { Ok(&(*check_block(monitor)?).monitor) }
}

/// The monitor, to change.
///
/// # Safety
/// As at the head of memory.rs.
unsafe fn get_mut<'a>(monitor: *mut posewise_monitor) -> Result<&'a mut Monitor, posewise_status> {
    // SAFETY: the magic shows that `place` wrote a block here; by the caller's contract no other
    // thread uses it.
    unsafe { Ok(&mut (*check_block(monitor)?.cast_mut()).monitor) }
}

static NAMES: [CName; MonitorEventKind::ALL.len()] = names_of!(MonitorEventKind);
