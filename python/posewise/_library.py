"""The shared library and its functions. ctypes releases the GIL during each call."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char_p, c_float, c_int32, c_size_t, c_uint32, c_void_p
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _layout as layout

FOLDER = Path(__file__).parent
lib = ctypes.CDLL(str(FOLDER / "libposewise.so"))

_size_p = POINTER(c_size_t)
_tracker = c_void_p
_frame = POINTER(layout.Frame)
_result = POINTER(layout.Result)

# Result and arguments of each function, as in posewise.h.
for _name, _returns, _arguments in [
    ("abi", c_uint32, []),
    ("strerror", c_char_p, [c_int32]),
    ("memory_size", c_size_t, [c_void_p]),
    ("parts", c_uint32, []),
    ("model_check", c_int32, [c_void_p, c_size_t]),
    ("model_info", c_int32, [c_void_p, c_size_t, POINTER(layout.Model_details)]),
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
    ("smoothed", c_int32, [_tracker, _result]),
    ("smoothed_landmarks", c_int32, [_tracker, c_void_p, c_size_t]),
    ("smoothed_animation", c_int32, [_tracker, c_void_p, c_size_t]),
    ("animation_name", c_char_p, [c_uint32]),
    ("eye_look_name", c_char_p, [c_uint32]),
    ("events", c_int32, [_tracker, POINTER(layout.Event), c_size_t, _size_p, _size_p]),
    ("reset", c_int32, [_tracker]),
    ("forget_identity", c_int32, [_tracker]),
    ("set_intrinsics", c_int32, [_tracker, POINTER(layout.Intrinsics)]),
    ("set_lens", c_int32, [_tracker, POINTER(layout.Lens)]),
    ("set_roi", c_int32, [_tracker, POINTER(layout.Roi)]),
]:
    _function = getattr(lib, f"posewise_{_name}")
    _function.restype = _returns
    _function.argtypes = _arguments

if lib.posewise_abi() != layout.ABI:
    raise ImportError("libposewise.so and _layout.py differ")


class PosewiseError(Exception):
    """A call that the library rejected. ``status`` is the code of posewise.h."""

    def __init__(self, status: int, detail: str = "") -> None:
        text = lib.posewise_strerror(status).decode()
        super().__init__(f"{text}: {detail}" if detail else text)
        self.status = status


def call(name: str, *arguments: Any) -> None:
    """Calls a function that returns a status."""
    status = getattr(lib, f"posewise_{name}")(*arguments)
    if status != 0:
        raise PosewiseError(status)


def aligned(size: int) -> npt.NDArray[np.uint8]:
    """Zeroed memory at the alignment that the library asks for."""
    memory = np.zeros(size + layout.ALIGN, dtype=np.uint8)
    start = -memory.ctypes.data % layout.ALIGN
    # In two steps, because numpy does not move the start of an empty slice.
    return memory[start:][:size]
