//! Arguments that may be wrong, and whether they are.

use crate::ffi::types::*;
use crate::targets::input::Input;
use crate::targets::memory::Exact;

pub(super) const CONFIG: u32 = size_of::<posewise_config>() as u32;
pub(super) const FRAME: u32 = size_of::<posewise_frame>() as u32;
pub(super) const HINT: u32 = size_of::<posewise_hint>() as u32;
pub(super) const RESULT: u32 = size_of::<posewise_result>() as u32;

/// A pointer that may be wrong: to the memory, NULL, or off by one.
pub(super) fn spoilt(pointer: *mut u8, how: u8) -> *mut u8 {
    match how & 7 {
        6 => std::ptr::null_mut(),
        7 => pointer.wrapping_add(1),
        _ => pointer,
    }
}

/// Whether [`spoilt`] leaves a pointer right.
pub(super) fn is_good(how: u8) -> bool {
    how & 7 < 6
}

/// The size that a struct states: mostly the right one, `own`, the only one that is accepted.
pub(super) fn stated(input: &mut Input<'_>, own: u32) -> u32 {
    match input.u8() {
        0..192 => own,
        192..208 => own + 16,
        208..224 => own - 8,
        224..232 => 4096,
        232..240 => own + 1,
        240..248 => 0,
        // Not a size in an earlier header, of which the whole struct would have to be there.
        _ => match input.u32() {
            40 | 64 | 68 | 128 => 41,
            size => size,
        },
    }
}

/// A struct in memory that states a size. Where the size is wrong, only the size itself is in
/// memory.
pub(super) fn lay_out<T: Copy>(value: T, size: u32) -> Exact {
    let own = size_of::<T>();
    let mut memory = match size as usize == own {
        true => Exact::new(own, 8, 0),
        false => Exact::new(4, 8, 0),
    };
    if memory.get().len() >= own {
        // SAFETY: as long as the struct, as just checked.
        unsafe { memory.ptr().cast::<T>().write(value) };
    }
    memory.get_mut()[..4].copy_from_slice(&size.to_ne_bytes());
    memory
}

/// A float, often an extreme one.
pub(super) fn number(input: &mut Input<'_>) -> f32 {
    match input.u8() {
        0 => 0.0,
        1 => f32::NAN,
        2 => f32::INFINITY,
        3 => f32::MAX,
        4 => f32::MIN_POSITIVE,
        5 => -1.0,
        6 => f32::from_bits(1),
        7 => input.f32(),
        other => other as f32 * 4.0,
    }
}

/// A camera, and whether it is valid.
pub(super) fn intrinsics(input: &mut Input<'_>) -> (posewise_intrinsics, bool) {
    let mut next = || number(input);
    let [fx, fy, cx, cy] = [next(), next(), next(), next()];
    let all = [fx, fy, cx, cy];
    let default = all.iter().all(|v| *v == 0.0);
    let focal = 1.0..=1e6;
    let valid = focal.contains(&fx)
        && focal.contains(&fy)
        && (0.1..=10.0).contains(&(fy / fx))
        && cx.abs() <= 1e5
        && cy.abs() <= 1e5;
    (posewise_intrinsics { fx, fy, cx, cy }, default || valid)
}

/// Boxes, and whether they are valid.
pub(super) fn boxes(input: &mut Input<'_>, count: usize) -> (Vec<f32>, bool) {
    let numbers: Vec<f32> = (0..4 * count).map(|_| number(input)).collect();
    let valid = numbers.chunks_exact(4).all(|b| {
        let longer = b[2].max(b[3]);
        b[2] > 0.0
            && b[3] > 0.0
            && (1.0..=32_768.0).contains(&longer)
            && b[0].abs() <= 65_536.0
            && b[1].abs() <= 65_536.0
    });
    (numbers, valid)
}

/// A hint in memory, and whether it is valid. One of four has any numbers, the others a box in or
/// near the images.
pub(super) fn hint(input: &mut Input<'_>) -> (Exact, bool) {
    let struct_size = stated(input, HINT);
    let any = input.u8() < 64;
    let mut next = || match any {
        true => number(input),
        false => input.u8() as f32 / 2.0,
    };
    let face_box = [next(), next(), 16.0 + next(), next()];
    let (yaw_deg, roll_deg) = (next() - 60.0, next() - 60.0);
    let [x, y, width, height] = face_box;
    let valid = struct_size == HINT
        && width > 0.0
        && height > 0.0
        && (16.0..=32_768.0).contains(&width.max(height))
        && x.abs() <= 65_536.0
        && y.abs() <= 65_536.0
        && yaw_deg.abs() <= 180.0
        && roll_deg.abs() <= 360.0;
    let hint = posewise_hint {
        struct_size,
        face_box,
        yaw_deg,
        roll_deg,
    };
    (lay_out(hint, struct_size), valid)
}

/// A region of interest, x, y, width, height, and whether it is valid.
pub(super) fn roi(input: &mut Input<'_>) -> ([u32; 4], bool) {
    let mut next = || match input.u8() {
        255 => input.u32(),
        254 => u32::MAX,
        253 => 16_384,
        small => small as u32 / 4,
    };
    let [x, y, width, height] = [next(), next(), next(), next()];
    let ends = |from: u32, length: u32| from as u64 + length as u64 <= 16_384;
    let is_whole = [x, y, width, height] == [0; 4];
    let valid = width > 0 && height > 0 && ends(x, width) && ends(y, height);
    ([x, y, width, height], is_whole || valid)
}

/// A lens, and whether it is valid.
pub(super) fn lens(input: &mut Input<'_>) -> (posewise_lens, bool) {
    let model = input.u8() as u32 % 4;
    let mut coefficients = [0; 5].map(|_| match number(input) {
        // Far below 0 the picture turns back near the axis.
        low if low < -1.0 => -1.0,
        other => other,
    });
    if model == POSEWISE_LENS_FISHEYE && input.u8() < 192 {
        coefficients[4] = 0.0;
    }
    let [a, b, c, d, e] = coefficients;
    let within = |values: &[f32], most: f32| values.iter().all(|v| v.abs() <= most);
    let valid = match model {
        POSEWISE_LENS_PINHOLE => coefficients == [0.0; 5],
        POSEWISE_LENS_BROWN => within(&[a, b, e], 1e4) && within(&[c, d], 0.1),
        POSEWISE_LENS_FISHEYE => within(&[a, b, c, d], 10.0) && e == 0.0,
        _ => false,
    };
    let lens = posewise_lens {
        model,
        coefficients,
    };
    (lens, valid)
}

/// Settings in memory, and whether they are valid.
pub(super) fn config(input: &mut Input<'_>) -> (Exact, bool) {
    let struct_size = stated(input, CONFIG);
    let bits = input.u8();
    let flags = (bits == 255) as u32;
    let (min_face_px, scan_budget) = match bits & 3 {
        0 => (0, 0),
        1 => (24, 100 + input.u16() as u32 % 8000),
        2 => (input.u16() as u32, input.u16() as u32 % 8000),
        _ => (4096, 10_000_001),
    };
    let (intrinsics, camera) = match bits & 4 {
        0 => (posewise_intrinsics::default(), true),
        _ => intrinsics(input),
    };
    let (lens, lens_good) = match bits & 8 {
        0 => (posewise_lens::default(), true),
        _ => lens(input),
    };
    let has_camera = [intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy] != [0.0; 4];
    let lens_good = lens_good && (has_camera || lens.model == POSEWISE_LENS_PINHOLE);
    let (smoothing_hz, smoothing_beta) = match bits & 0xF0 {
        0x10 => (0.01, 1000.0),
        0x20 => (2.5, 0.0),
        0x30 => (f32::NAN, 1.0),
        0x40 => (1.0, -1.0),
        _ => (0.0, 0.0),
    };
    let gaze = [0, 1, 2, 3][input.u8() as usize & 3];
    let valid = struct_size == CONFIG
        && flags == 0
        && gaze < 3
        && (min_face_px == 0 || (24..=4096).contains(&min_face_px))
        && (scan_budget == 0 || (100..=10_000_000).contains(&scan_budget))
        && camera
        && lens_good
        && !matches!(bits & 0xF0, 0x30 | 0x40);
    let config = posewise_config {
        struct_size,
        flags,
        min_face_px,
        scan_budget,
        intrinsics,
        smoothing_hz,
        smoothing_beta,
        lens,
        gaze,
        ..Default::default()
    };
    (lay_out(config, struct_size), valid)
}
