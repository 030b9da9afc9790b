"""The shared library and its functions. ctypes releases the GIL during each call."""

from __future__ import annotations

import ctypes
import platform
from ctypes import POINTER, c_char_p, c_int32, c_int64, c_size_t, c_uint32, c_void_p
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from . import _layout as layout

FOLDER = Path(__file__).parent
lib = ctypes.CDLL(str(FOLDER / "libposewise.so"))

_size_p = POINTER(c_size_t)
_tracker = c_void_p
_group = c_void_p
_monitor = c_void_p
_frame = POINTER(layout.Frame)
_result = POINTER(layout.Result)

# Result and arguments of each function, as in posewise.h.
for _name, _returns, _arguments in [
    ("version", c_uint32, []),
    ("abi", c_uint32, []),
    ("set_cpu", c_int32, [c_uint32]),
    ("strerror", c_char_p, [c_int32]),
    ("config_default", c_int32, [POINTER(layout.Config)]),
    ("memory_size", c_size_t, [c_void_p]),
    ("memory_align", c_size_t, []),
    ("parts", c_uint32, []),
    ("model_check", c_int32, [c_void_p, c_size_t]),
    ("model_info", c_int32, [c_void_p, c_size_t, POINTER(layout.ModelDetails)]),
    (
        "init",
        c_int32,
        [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, POINTER(layout.Config)],
    ),
    ("step", c_int32, [_tracker, _frame, _result]),
    ("step_at", c_int32, [_tracker, _frame, POINTER(layout.Hint), _result]),
    (
        "detect",
        c_int32,
        [_tracker, _frame, POINTER(layout.Face), c_size_t, _size_p, POINTER(c_uint32)],
    ),
    ("set_excluded", c_int32, [_tracker, c_void_p, c_size_t]),
    ("landmarks", c_int32, [_tracker, c_void_p, c_size_t]),
    ("animation", c_int32, [_tracker, c_void_p, c_size_t]),
    ("mesh", c_int32, [_tracker, c_uint32, c_void_p, c_size_t, _size_p]),
    ("mesh_shape", c_int32, [_tracker, c_uint32, c_void_p, c_size_t, _size_p]),
    ("mesh_tables", c_int32, [_tracker, POINTER(layout.MeshTopology)]),
    ("smoothed", c_int32, [_tracker, _result]),
    ("smoothed_landmarks", c_int32, [_tracker, c_void_p, c_size_t]),
    ("smoothed_animation", c_int32, [_tracker, c_void_p, c_size_t]),
    ("animation_name", c_char_p, [c_uint32]),
    ("eye_look_name", c_char_p, [c_uint32]),
    ("events", c_int32, [_tracker, POINTER(layout.Event), c_size_t, _size_p, _size_p]),
    ("reset", c_int32, [_tracker]),
    ("forget_identity", c_int32, [_tracker]),
    ("save_identity", c_int32, [_tracker, c_char_p, c_size_t]),
    ("restore_identity", c_int32, [_tracker, c_char_p, c_size_t]),
    ("compare_identity", c_int32, [_tracker, c_char_p, c_size_t, POINTER(c_uint32)]),
    ("set_intrinsics", c_int32, [_tracker, POINTER(layout.Intrinsics)]),
    ("set_lens", c_int32, [_tracker, POINTER(layout.Lens)]),
    ("set_roi", c_int32, [_tracker, POINTER(layout.Roi)]),
    ("group_memory_size", c_size_t, []),
    ("group_init", c_int32, [c_void_p, c_void_p, c_size_t]),
    ("group_step", c_int32, [_group, POINTER(c_void_p), c_size_t, _frame, _result]),
    ("monitor_config_default", c_int32, [c_uint32, POINTER(layout.MonitorConfig)]),
    ("monitor_memory_size", c_size_t, [c_void_p]),
    (
        "monitor_init",
        c_int32,
        [c_void_p, c_void_p, c_size_t, POINTER(layout.MonitorConfig)],
    ),
    ("monitor_observe", c_int32, [_tracker, POINTER(layout.Observation)]),
    ("monitor_update", c_int32, [_monitor, POINTER(layout.Observation), c_int64]),
    ("monitor_read", c_int32, [_monitor, POINTER(layout.MonitorState)]),
    (
        "monitor_events",
        c_int32,
        [_monitor, POINTER(layout.MonitorEvent), c_size_t, _size_p, _size_p],
    ),
    ("monitor_set_zones", c_int32, [_monitor, POINTER(layout.Zone), c_size_t]),
    ("monitor_forget_driver", c_int32, [_monitor]),
    ("monitor_save", c_int32, [_monitor, c_char_p, c_size_t]),
    ("monitor_restore", c_int32, [_monitor, c_char_p, c_size_t]),
]:
    _function = getattr(lib, f"posewise_{_name}")
    _function.restype = _returns
    _function.argtypes = _arguments

if lib.posewise_abi() != layout.ABI:
    raise ImportError("libposewise.so and _layout.py differ")


#: Version of the library.
VERSION = "{}.{}.{}".format(*lib.posewise_version().to_bytes(3, "big"))


class PosewiseError(Exception):
    """A call that the library rejected.

    ``status`` is the code of posewise.h, and ``name`` its name there, as "E_TIME".
    """

    def __init__(self, status: int, detail: str = "") -> None:
        text = lib.posewise_strerror(status).decode()
        super().__init__(f"{text}: {detail}" if detail else text)
        self.status = status
        self.name = layout.STATUS.get(status, str(status))


def call(name: str, *arguments: Any) -> None:
    """Calls a function that returns a status."""
    status = getattr(lib, f"posewise_{name}")(*arguments)
    if status != 0:
        raise PosewiseError(status)


S = TypeVar("S", bound=ctypes.Structure)


def sized(struct: S) -> S:
    """A struct that says how long it is, as far as it does."""
    if hasattr(struct, "struct_size"):
        struct.struct_size = ctypes.sizeof(struct)
    return struct


def aligned(size: int) -> npt.NDArray[np.uint8]:
    """Zeroed memory at the alignment that the library asks for."""
    align = lib.posewise_memory_align()
    memory = np.zeros(size + align, dtype=np.uint8)
    start = -memory.ctypes.data % align
    # In two steps, because numpy does not move the start of an empty slice.
    return memory[start:][:size]


def _has_dot_products() -> bool:
    """Whether this is an AArch64 that Linux says to have them; other machines need no word."""
    if platform.machine() != "aarch64":
        return False
    getauxval = ctypes.CDLL(None).getauxval
    getauxval.argtypes, getauxval.restype = [ctypes.c_ulong], ctypes.c_ulong
    hardware, dot_products = 16, 1 << 20  # AT_HWCAP, HWCAP_ASIMDDP
    return bool(getauxval(hardware) & dot_products)


call("set_cpu", int(_has_dot_products()))
