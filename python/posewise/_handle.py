"""What trackers and monitors have in common: memory of their own, and one thread at a time."""

from __future__ import annotations

import ctypes
from typing import Any, TypeVar

from ._forking import new_lock
from ._library import aligned, call, sized

H = TypeVar("H", bound="Handle")


class Handle:
    """An object of the library. Several threads may share one: they wait for each other."""

    def __init__(self, init: str, size: int, *arguments: Any) -> None:
        self._lock = new_lock()
        self._memory = aligned(size)
        self._at = ctypes.c_void_p()
        at = ctypes.byref(self._at)
        call(init, at, self._memory.ctypes.data, len(self._memory), *arguments)

    def close(self) -> None:
        """Gives the memory back. Every later call is a ValueError."""
        with self._lock:
            self._memory = aligned(0)
            self._at = ctypes.c_void_p()

    def __enter__(self: H) -> H:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be pickled")

    def _call(self, name: str, *arguments: Any) -> None:
        with self._lock:
            if not self._at:
                raise ValueError(f"the {type(self).__name__} is closed")
            call(name, self._at, *arguments)

    def _read(self, name: str, kind: type[ctypes.Structure], *arguments: Any) -> Any:
        """What a call writes into a struct that starts with its size."""
        out = sized(kind())
        self._call(name, *arguments, ctypes.byref(out))
        return out

    def _events(self, name: str, kind: type[ctypes.Structure], most: int) -> tuple[list[Any], int]:
        read = (kind * most)()
        count, overwritten = ctypes.c_size_t(), ctypes.c_size_t()
        self._call(name, read, most, ctypes.byref(count), ctypes.byref(overwritten))
        return read[: count.value], overwritten.value
