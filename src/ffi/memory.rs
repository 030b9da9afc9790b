//! Pointer work of the C ABI: copies structs that may grow, reads and writes arrays.
//!
//! The caller's contract, which no function can check, is that of the header: a non-NULL pointer
//! points to as many readable (outputs: writable) bytes as its `struct_size` or length states, no
//! other thread writes them during the call, and the model outlives its trackers.

use super::gates;
use super::monitor_types::{
    posewise_monitor_config, posewise_monitor_observation, posewise_monitor_state,
};
use super::types::*;
use core::ffi::c_void;
use core::mem::{MaybeUninit, align_of, size_of};

/// A struct that starts with `struct_size` and may grow at its end.
///
/// # Safety
/// The type is `repr(C)`, without padding, starts with a `u32`, and every bit pattern is valid.
pub(super) unsafe trait Growing: Copy {
    /// Its sizes in the headers of earlier releases \[bytes\]; where the struct has grown, a
    /// release adds the old size here. No other size is believed, but for that of `Self`: what a
    /// caller forgot to set is any number, and outputs of that length would be written.
    const EARLIER_SIZES: &'static [usize];
}

// SAFETY: `repr(C)` and free of padding (asserted in layout.rs), plain numbers and pointers only.
unsafe impl Growing for posewise_config {
    // 40: before `lens`; 64: before `gaze`; 68: before `roi`; 84: before `network_period`.
    const EARLIER_SIZES: &'static [usize] = &[40, 64, 68, 84];
}
// SAFETY: as above.
unsafe impl Growing for posewise_frame {
    const EARLIER_SIZES: &'static [usize] = &[];
}
// SAFETY: as above.
unsafe impl Growing for posewise_hint {
    const EARLIER_SIZES: &'static [usize] = &[];
}
// SAFETY: as above.
unsafe impl Growing for posewise_model_details {
    const EARLIER_SIZES: &'static [usize] = &[];
}
// SAFETY: as above.
unsafe impl Growing for posewise_result {
    // 128: before `eye_open_probability`; 304: before `facing_angle_deg`.
    const EARLIER_SIZES: &'static [usize] = &[128, 304];
}
// SAFETY: as above.
unsafe impl Growing for posewise_mesh_topology {
    const EARLIER_SIZES: &'static [usize] = &[];
}

// SAFETY: as above.
unsafe impl Growing for posewise_monitor_config {
    const EARLIER_SIZES: &'static [usize] = &[];
}
// SAFETY: as above.
unsafe impl Growing for posewise_monitor_observation {
    const EARLIER_SIZES: &'static [usize] = &[];
}
// SAFETY: as above.
unsafe impl Growing for posewise_monitor_state {
    const EARLIER_SIZES: &'static [usize] = &[];
}

/// An error unless the pointer is non-NULL and aligned for `T`.
pub(super) fn check_pointer<T>(pointer: *const T) -> Result<(), posewise_status> {
    if pointer.is_null() {
        return Err(POSEWISE_E_NULL);
    }
    if !gates::is_aligned(pointer as usize, align_of::<T>()) {
        return Err(POSEWISE_E_POINTER_ALIGN);
    }
    Ok(())
}

/// `POSEWISE_E_MEMORY` unless a block of `need` bytes can be placed at the start of a memory.
pub(super) fn check_room(
    memory: *mut c_void,
    len: usize,
    need: usize,
) -> Result<(), posewise_status> {
    match gates::holds(memory as usize, len, need, POSEWISE_ALIGN as usize) {
        true => Ok(()),
        false => Err(POSEWISE_E_MEMORY),
    }
}

/// Bytes of the first `capacity` items of at most `most` \[bytes\].
pub(super) const fn written<T>(capacity: usize, most: usize) -> usize {
    gates::written(capacity, most, size_of::<T>())
}

/// `POSEWISE_E_OVERLAP` if two blocks of memory share a byte; lengths are in bytes.
pub(super) fn require_disjoint<A, B>(
    a: *const A,
    a_len: usize,
    b: *const B,
    b_len: usize,
) -> Result<(), posewise_status> {
    match gates::share_a_byte(a as usize, a_len, b as usize, b_len) {
        true => Err(POSEWISE_E_OVERLAP),
        false => Ok(()),
    }
}

/// Checks the pointer, reads the `struct_size` that it points to, and checks that a header had it.
///
/// # Safety
/// As at the file's head.
pub(super) unsafe fn checked_size<T: Growing>(pointer: *const T) -> Result<usize, posewise_status> {
    check_pointer(pointer)?;
    // SAFETY: non-NULL and aligned for T, which starts with this u32.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    if size == size_of::<T>() || T::EARLIER_SIZES.contains(&size) {
        Ok(size)
    } else {
        Err(POSEWISE_E_STRUCT_SIZE)
    }
}

/// Reads a struct of this or an earlier header: missing fields read as 0.
///
/// # Safety
/// As at the file's head.
pub(super) unsafe fn read_struct<T: Growing>(from: *const T) -> Result<T, posewise_status> {
    // SAFETY: the caller's contract is passed on.
    let size = unsafe { checked_size(from)? };
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: both sides have `size` ≤ size_of T bytes, and all-zero is a valid T.
    unsafe {
        from.cast::<u8>()
            .copy_to_nonoverlapping(value.as_mut_ptr().cast(), size);
        Ok(value.assume_init())
    }
}

/// Writes the fields of `value` that the caller's struct of `size` bytes has, and keeps its
/// `struct_size`.
///
/// # Safety
/// `size` is what [`checked_size`] gave for `to`.
pub(super) unsafe fn write_struct<T: Growing>(to: *mut T, size: usize, value: &T) {
    const HEAD: usize = size_of::<u32>();
    // SAFETY: both sides have `size` bytes, more than HEAD.
    unsafe {
        let from = core::ptr::from_ref(value).cast::<u8>().add(HEAD);
        let to = to.cast::<u8>().add(HEAD);
        to.copy_from_nonoverlapping(from, size - HEAD);
    }
}

/// Writes the first `capacity` values, or fewer if there are fewer.
///
/// # Safety
/// As at the file's head: `to` has room for `capacity` values.
pub(super) unsafe fn write_first<T>(
    to: *mut T,
    capacity: usize,
    values: impl Iterator<Item = T>,
) -> Result<(), posewise_status> {
    check_pointer(to)?;
    for (i, value) in values.take(capacity).enumerate() {
        // SAFETY: i < capacity.
        unsafe { to.add(i).write(value) };
    }
    Ok(())
}

/// The caller's bytes as a slice; `too_long` if that length cannot exist.
///
/// # Safety
/// As at the file's head; the bytes live for `'a`.
pub(super) unsafe fn bytes<'a>(
    data: *const u8,
    len: usize,
    too_long: posewise_status,
) -> Result<&'a [u8], posewise_status> {
    check_pointer(data)?;
    if !gates::can_be(data as usize, len) {
        return Err(too_long);
    }
    // SAFETY: non-NULL, `len` readable bytes by the caller's contract, not wrapping around.
    Ok(unsafe { core::slice::from_raw_parts(data, len) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `posewise_config` of a hypothetical later header.
    #[repr(C)]
    #[derive(Clone, Copy)]
    struct Later {
        config: posewise_config,
        more: u32,
        last: u32,
    }
    // SAFETY: `repr(C)`, no padding, plain numbers.
    unsafe impl Growing for Later {
        const EARLIER_SIZES: &'static [usize] = &[size_of::<posewise_config>()];
    }

    const NOW: usize = size_of::<posewise_config>();

    fn later(struct_size: usize, more: u32) -> Later {
        let config = posewise_config {
            struct_size: struct_size as u32,
            min_face_px: 50,
            ..Default::default()
        };
        Later {
            config,
            more,
            last: 0,
        }
    }

    #[test]
    fn short_structs_are_extended_with_zeros() {
        let old = later(NOW, 7);
        // SAFETY: a live struct.
        let read = unsafe { read_struct(&old) }.unwrap();
        assert_eq!((read.config.min_face_px, read.more), (50, 0));
        // SAFETY: a live struct, of which only the first bytes may be written.
        let mut out = later(NOW, 9);
        unsafe { write_struct(&mut out, NOW, &later(NOW + 8, 1)) };
        assert_eq!((out.config.struct_size as usize, out.more), (NOW, 9));
    }

    /// What a struct of each size reads and writes, through a pointer to just that many bytes: Miri
    /// sees a byte too many.
    fn check_copies<T: Growing>() {
        let now = size_of::<T>();
        for &size in T::EARLIER_SIZES.iter().chain([&now]) {
            assert!(size.is_multiple_of(4) && (8..=now).contains(&size));
            // Aligned as the structs are, and large enough for each.
            let mut memory = [0u64; 128];
            // SAFETY: numbers are bytes.
            let (_, bytes, _) = unsafe { memory.align_to_mut::<u8>() };
            let block = bytes[..size].as_mut_ptr();
            // SAFETY: a block of `size` bytes; both structs are read as the bytes that they are.
            unsafe {
                for i in 4..size {
                    block.add(i).write(i as u8 | 1);
                }
                block.cast::<u32>().write(size as u32);
                let read = read_struct(block.cast_const().cast::<T>()).unwrap();
                let read = core::slice::from_raw_parts((&raw const read).cast::<u8>(), now);
                let given = core::slice::from_raw_parts(block, size);
                assert_eq!(read[..size], *given);
                assert!(read[size..].iter().all(|byte| *byte == 0));

                let zero = MaybeUninit::<T>::zeroed().assume_init();
                assert_eq!(checked_size(block.cast_const().cast::<T>()), Ok(size));
                write_struct(block.cast::<T>(), size, &zero);
                assert_eq!(block.cast::<u32>().read() as usize, size);
                assert!((4..size).all(|i| block.add(i).read() == 0));
            }
        }
    }

    /// Calls a function for each struct that grows.
    macro_rules! for_each_struct {
        ($check:ident) => {
            $check::<posewise_config>();
            $check::<posewise_frame>();
            $check::<posewise_hint>();
            $check::<posewise_model_details>();
            $check::<posewise_result>();
            $check::<posewise_mesh_topology>();
            $check::<posewise_monitor_config>();
            $check::<posewise_monitor_observation>();
            $check::<posewise_monitor_state>();
        };
    }

    #[test]
    fn structs_of_every_size_are_copied_whole() {
        for_each_struct!(check_copies);
    }

    /// The sizes that are believed, of all that a caller can state.
    fn check_sizes<T: Growing>() {
        // Only `struct_size` is read where it is refused, and here nothing else where it is not.
        let mut given = MaybeUninit::<T>::zeroed();
        for size in 0..=u32::MAX {
            // SAFETY: the struct starts with this number.
            let known = unsafe {
                given.as_mut_ptr().cast::<u32>().write(size);
                checked_size(given.as_ptr()).is_ok()
            };
            let size = size as usize;
            let is_known = size == size_of::<T>() || T::EARLIER_SIZES.contains(&size);
            assert_eq!(known, is_known, "{size}");
        }
    }

    #[test]
    #[ignore = "tries four billion sizes of each struct: .ci/nightly"]
    fn no_other_size_is_believed() {
        for_each_struct!(check_sizes);
    }

    #[test]
    fn settings_of_the_first_header_are_read() {
        let old = posewise_config {
            struct_size: 40,
            min_face_px: 50,
            lens: posewise_lens {
                model: 99,
                ..Default::default()
            },
            ..Default::default()
        };
        // SAFETY: a live struct.
        let read = unsafe { read_struct(&old) }.unwrap();
        assert_eq!((read.min_face_px, read.lens.model), (50, 0));
    }

    #[test]
    fn sizes_that_no_header_had_are_rejected() {
        let others = [0, 4, 40, 68, NOW - 1, NOW + 1, NOW + 7, NOW + 9, 4096, 4097];
        for size in others.into_iter().chain([u32::MAX as usize]) {
            // SAFETY: nothing beyond `struct_size` is read.
            assert!(unsafe { read_struct(&later(size, 0)) }.is_err(), "{size}");
        }
        // SAFETY: NULL and misaligned pointers are not followed.
        unsafe {
            assert!(checked_size::<posewise_config>(core::ptr::null()).is_err());
            assert!(checked_size::<posewise_config>(core::ptr::without_provenance(2)).is_err());
        }
    }
}
