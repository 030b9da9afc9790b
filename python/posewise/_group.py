"""Several trackers on the same frames."""

from __future__ import annotations

import ctypes
from contextlib import ExitStack
from typing import Optional, Sequence

from . import _arguments as arguments
from . import _layout as layout
from ._arguments import Pixels
from ._handle import Handle
from ._library import lib, sized
from ._tracker import Result, Tracker


class Group(Handle):
    """Steps several trackers, so that each follows a face of its own, for less than alone."""

    def __init__(self) -> None:
        super().__init__("group_init", lib.posewise_group_memory_size())

    def step(
        self,
        trackers: Sequence[Tracker],
        frame: Pixels,
        timestamp_us: int,
        *,
        format: Optional[str] = None,
        rotation_deg: int = 0,
        mirrored: bool = False,
    ) -> list[Result]:
        """Processes one frame; the result of each tracker. The frame is as for Tracker.step.

        The trackers are those of the steps before, in the same order; those that are added come
        last. They replace what Tracker.set_excluded() said.
        """
        given, pixels = arguments.frame(frame, timestamp_us, format, rotation_deg, mirrored)
        count = len(trackers)
        # One more, because C has no empty arrays.
        pointers = (ctypes.c_void_p * (count + 1))()
        results = (layout.Result * (count + 1))()
        for result in results:
            sized(result)
        with ExitStack() as locks:
            # In one order, so that two groups with the same trackers do not wait for each other.
            for tracker in sorted(trackers, key=id):
                locks.enter_context(tracker._lock)
            for k, tracker in enumerate(trackers):
                pointers[k] = tracker._at
            self._call("group_step", pointers, count, ctypes.byref(given), results)
            del pixels
            whole = zip(trackers, results)
            return [t._whole(r, "landmarks", "animation") for t, r in whole]
