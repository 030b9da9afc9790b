"""Arguments as the library's structs, checked where C could not tell that they were others."""

from __future__ import annotations

import ctypes
from operator import index
from typing import Any, Optional, Sequence, TypeVar

import numpy as np
import numpy.typing as npt

from . import _layout as layout
from ._fields import Floats
from ._library import sized

Pixels = npt.NDArray[Any]

# What an array is by its kind and number of channels, unless the caller says otherwise.
_DEFAULT_FORMATS = {("u1", 1): "GREY", ("u2", 1): "Y16", ("u1", 3): "BGR3", ("u1", 4): "AR24"}
# Channels and bytes per channel of each format that comes as an array.
_SHAPES = {
    "GREY": (1, 1),
    "Y10": (1, 2),
    "Y16": (1, 2),
    "RGB3": (3, 1),
    "BGR3": (3, 1),
    "YUYV": (2, 1),
    "UYVY": (2, 1),
    **{name: (4, 1) for name in layout.FORMATS if name[0] in "XABR" and name.endswith("24")},
}
_U32 = (0, 2**32 - 1)
_I64 = (-(2**63), 2**63 - 1)
S = TypeVar("S", bound=ctypes.Structure)


def _integer(name: str, value: Any, limits: tuple[int, int]) -> int:
    """An integer of C, in which ctypes would drop the upper bits."""
    number = index(value)
    if not limits[0] <= number <= limits[1]:
        raise ValueError(f"{name} must be {limits[0]}..{limits[1]}, not {number}")
    return number


def u32(name: str, value: Any) -> int:
    """An integer of 32 bits without a sign."""
    return _integer(name, value, _U32)


def i64(name: str, value: Any) -> int:
    """An integer of 64 bits."""
    return _integer(name, value, _I64)


def index_of(name: str, value: Any, words: Sequence[str]) -> int:
    """The number of a word."""
    if value not in words:
        raise ValueError(f"{name} is one of {', '.join(words)}, not {value}")
    return words.index(value)


def several(count: int, name: str, numbers: Sequence[Any]) -> tuple[Any, ...]:
    """Numbers, of which there must be `count`; ctypes would take fewer, and the rest as 0."""
    if len(numbers) != count:
        raise ValueError(f"{name} must have {count} numbers, not {len(numbers)}")
    return tuple(numbers)


def joined(count: int, **lists: Sequence[float]) -> tuple[float, ...]:
    """Lists of `count` numbers each, one after the other."""
    return tuple(n for name, numbers in lists.items() for n in several(count, name, numbers))


def struct(kind: type[S], /, **values: Any) -> S:
    """A struct with these values, and 0 in its other fields."""
    return filled(sized(kind()), **values)


def filled(out: S, /, **values: Any) -> S:
    """A struct in which values that are not None replace those that it has."""
    words = getattr(out, "_words_", {})
    fields: Sequence[tuple[str, Any]] = out._fields_  # type: ignore[assignment]
    for name, type_ in fields:
        value = values.get(name)
        if value is None:
            continue
        if name in words:
            value = index_of(name, value, words[name])
        elif type_ is ctypes.c_uint32:
            value = u32(name, value)
        elif issubclass(type_, ctypes.Array):
            value = type_(*several(type_._length_, name, value))
        setattr(out, name, value)
    return out


def intrinsics(numbers: Sequence[float]) -> layout.Intrinsics:
    """fx, fy, cx, cy [px]."""
    return layout.Intrinsics(*several(4, "intrinsics", numbers))


def lens(model: str, coefficients: Sequence[float]) -> layout.Lens:
    """A lens by its name, with up to five coefficients; the rest are 0."""
    if len(coefficients) > 5:
        raise ValueError(f"a lens has at most 5 coefficients, not {len(coefficients)}")
    five = tuple(coefficients) + (0.0,) * (5 - len(coefficients))
    return layout.Lens(index_of("a lens", model, layout.LENSES), five)


def roi(numbers: Sequence[int]) -> layout.Roi:
    """x, y, width, height [px]."""
    return layout.Roi(*(u32("roi", number) for number in several(4, "roi", numbers)))


def hint(box: Sequence[float], yaw_deg: float, roll_deg: float) -> layout.Hint:
    """Where a face is expected."""
    four = several(4, "the box of a hint", box)
    return struct(layout.Hint, face_box=four, yaw_deg=yaw_deg, roll_deg=roll_deg)


def boxes(rows: Sequence[Sequence[float]]) -> Floats:
    """Rows of x, y, width, height [px]."""
    numbers = np.array(rows, dtype=np.float32)
    if numbers.size == 0:
        return numbers.reshape(0, 4)
    if numbers.ndim != 2 or numbers.shape[1] != 4:
        raise ValueError(f"boxes are rows of 4 numbers, not {numbers.shape}")
    return np.ascontiguousarray(numbers)


def frame(
    array: Pixels, timestamp_us: int, format: Optional[str], rotation_deg: int, mirrored: bool
) -> tuple[layout.Frame, Pixels]:
    """The frame as the library reads it, and the array that holds its pixels."""
    given = sized(layout.Frame())
    given.timestamp_us = i64("timestamp_us", timestamp_us)
    given.rotation_deg = u32("rotation_deg", rotation_deg)
    given.flags = 1 if mirrored else 0
    pixels = np.asarray(array)
    if pixels.ndim == 3 and pixels.shape[2] == 1:
        pixels = pixels[:, :, 0]
    if pixels.ndim not in (2, 3) or pixels.size == 0:
        raise ValueError(f"a frame is (height, width) or (height, width, n), not {pixels.shape}")
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    kind = f"{pixels.dtype.kind}{pixels.dtype.itemsize}"
    name = format or _DEFAULT_FORMATS.get((kind, channels))
    if name not in _SHAPES or (channels, pixels.dtype.itemsize) != _SHAPES[name]:
        raise ValueError(f"{pixels.dtype} with {channels} channels is not a frame of {name}")
    given.format = layout.FORMATS[name]
    given.height = u32("the height", pixels.shape[0])
    given.width = u32("the width", pixels.shape[1])
    pixels = _readable(pixels, channels * pixels.dtype.itemsize)
    row = given.width * channels * pixels.dtype.itemsize
    given.stride = u32("the stride", pixels.strides[0])
    given.data_len = given.stride * (given.height - 1) + row
    given.data = pixels.ctypes.data
    return given, pixels


def _readable(pixels: Pixels, pixel: int) -> Pixels:
    """The same pixels, of these bytes each, so that the library can read them."""
    if pixels.dtype.byteorder == ">":
        pixels = pixels.astype(pixels.dtype.newbyteorder("<"))
    packed = (pixel, pixels.dtype.itemsize)[: pixels.ndim - 1]
    row = pixels.shape[1] * pixel
    if pixels.strides[1:] == packed and row <= pixels.strides[0] <= _U32[1]:
        return pixels
    return np.array(pixels, order="C")
