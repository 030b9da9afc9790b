//! The functions of `include/posewise.h` that name values and weights. As in `api`, the comments
//! are written for the C reader. The names are those of the crate's types, which the command writes
//! too; JavaScript and Python have the same, as tests compare.

use crate::shape::ANIMATION_NAMES;
use crate::track::{EYE_LOOK_NAMES, EventKind, EyeUnknown, Loss, State};
use core::ffi::c_char;

/// Name of a POSEWISE_SEARCHING, _TRACKING or _COASTING, as "tracking". Static; NULL for a state
/// that the library lacks.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_state_name(state: u32) -> *const c_char {
    name_at(&STATES, state)
}

/// Name of a POSEWISE_LOSS_*, as "low-confidence". Static; NULL for a reason that the library
/// lacks.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_loss_name(loss: u32) -> *const c_char {
    name_at(&LOSSES, loss)
}

/// Name of a POSEWISE_EVENT_*, as "filter-on". Static; NULL for a kind that the library lacks.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_event_name(kind: u32) -> *const c_char {
    name_at(&EVENTS, kind)
}

/// Name of a POSEWISE_EYE_*, as "dark-glasses". Static; NULL for a value that the library lacks.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_eye_status_name(eye: u32) -> *const c_char {
    name_at(&EYES, eye)
}

/// Name of a weight of posewise_animation(), a POSEWISE_ANIMATION_*: ARKit's name of the
/// blendshape, as "jawOpen". Static; NULL from POSEWISE_ANIMATIONS on.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_animation_name(index: u32) -> *const c_char {
    name_at(&ANIMATIONS, index)
}

/// Name of a weight of posewise_result.eye_look, a POSEWISE_EYE_LOOK_*: ARKit's name of the
/// blendshape, as "eyeLookUpLeft". Static; NULL from POSEWISE_EYE_LOOKS on.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_eye_look_name(index: u32) -> *const c_char {
    name_at(&EYE_LOOKS, index)
}

/// Capacity for the longest name and its NUL \[bytes\].
const NAME_LEN: usize = 24;

/// A name, NUL-terminated.
pub(super) type CName = [u8; NAME_LEN];

/// The names of all values of an enum, as C reads them.
macro_rules! names_of {
    ($kind:ident) => {{
        let mut names = [""; $kind::ALL.len()];
        let mut i = 0;
        while i < names.len() {
            names[i] = $kind::ALL[i].name();
            i += 1;
        }
        super::names::c_names(names)
    }};
}

#[cfg(feature = "monitor")]
pub(super) use names_of;

static STATES: [CName; State::ALL.len()] = names_of!(State);
static EVENTS: [CName; EventKind::ALL.len()] = names_of!(EventKind);

/// POSEWISE_LOSS_NONE is first.
static LOSSES: [CName; Loss::ALL.len() + 1] = {
    let mut names = ["none"; Loss::ALL.len() + 1];
    let mut i = 1;
    while i < names.len() {
        names[i] = Loss::ALL[i - 1].name();
        i += 1;
    }
    c_names(names)
};

/// POSEWISE_EYE_KNOWN is second.
static EYES: [CName; EyeUnknown::ALL.len() + 1] = {
    let mut names = ["known"; EyeUnknown::ALL.len() + 1];
    names[0] = EyeUnknown::ALL[0].name();
    let mut i = 2;
    while i < names.len() {
        names[i] = EyeUnknown::ALL[i - 1].name();
        i += 1;
    }
    c_names(names)
};

static ANIMATIONS: [CName; ANIMATION_NAMES.len()] = c_names(ANIMATION_NAMES);
static EYE_LOOKS: [CName; EYE_LOOK_NAMES.len()] = c_names(EYE_LOOK_NAMES);

/// Names as C reads them.
pub(super) const fn c_names<const N: usize>(names: [&str; N]) -> [CName; N] {
    let mut out = [[0; NAME_LEN]; N];
    let mut i = 0;
    while i < N {
        let name = names[i].as_bytes();
        assert!(name.len() < NAME_LEN);
        let mut j = 0;
        while j < name.len() {
            out[i][j] = name[j];
            j += 1;
        }
        i += 1;
    }
    out
}

/// A name, or NULL.
pub(super) fn name_at(names: &'static [CName], index: u32) -> *const c_char {
    match names.get(index as usize) {
        Some(name) => name.as_ptr().cast(),
        None => core::ptr::null(),
    }
}
