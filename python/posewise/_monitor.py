"""The driver monitor."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Optional, Sequence, Union

from . import _arguments as arguments
from . import _layout as layout
from ._fields import MonitorConfig as Settings
from ._fields import MonitorEvent, MonitorState, Observation
from ._handle import Handle
from ._library import call, lib, sized
from ._tracker import Tracker


@dataclass(frozen=True)
class Zone:
    """Where a driver may look. Where zones overlap, the first one counts.

    Made by angles(), box() or plane(). ``grace_us`` is the time of a stay that does not count as
    away [us]; 0xFFFFFFFF: none of it does.
    """

    #: "angles", "box" or "plane".
    kind: layout.ZoneKind
    #: As the kind says.
    numbers: tuple[float, ...]
    #: Whether it is the road. What is not the road is away from it.
    is_road: bool = False
    #: Time of a stay that does not count as away [us].
    grace_us: int = 0

    @classmethod
    def angles(
        cls,
        yaw_deg: Sequence[float],
        pitch_deg: Sequence[float],
        *,
        is_road: bool = False,
        grace_us: int = 0,
    ) -> Zone:
        """Least and largest yaw and pitch from the direction of the road, within -180..180."""
        numbers = arguments.joined(2, yaw_deg=yaw_deg, pitch_deg=pitch_deg)
        return cls("angles", numbers, is_road, grace_us)

    @classmethod
    def box(
        cls,
        min_mm: Sequence[float],
        max_mm: Sequence[float],
        *,
        is_road: bool = False,
        grace_us: int = 0,
    ) -> Zone:
        """A box along the axes of the camera frame, within -20000..20000 mm."""
        return cls("box", arguments.joined(3, min_mm=min_mm, max_mm=max_mm), is_road, grace_us)

    @classmethod
    def plane(
        cls,
        centre_mm: Sequence[float],
        half_u_mm: Sequence[float],
        half_v_mm: Sequence[float],
        *,
        is_road: bool = False,
        grace_us: int = 0,
    ) -> Zone:
        """The parallelogram centre +- u +- v in the camera frame, within -20000..20000 mm."""
        numbers = arguments.joined(
            3, centre_mm=centre_mm, half_u_mm=half_u_mm, half_v_mm=half_v_mm
        )
        return cls("plane", numbers, is_road, grace_us)


@dataclass(frozen=True)
class MonitorConfig(Settings):
    """Settings of a driver monitor: those of a preset, but for what is given."""

    def __post_init__(self) -> None:
        for name, value in vars(Settings._of(_preset(self.preset))).items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, value)


def _preset(name: layout.Preset) -> layout.MonitorConfig:
    """The settings of a preset, in which 0 is 0."""
    out = sized(layout.MonitorConfig())
    number = arguments.index_of("a preset", name, layout.PRESETS)
    call("monitor_config_default", number, ctypes.byref(out))
    return out


class Monitor(Handle):
    """Watches one driver through the results of a tracker: eyes, PERCLOS, yawns, nods, glances.

    ``config`` is the name of a preset, or settings. ``zones`` replace those of the preset. What it
    measures, and what it is not, is in docs/driver-monitor.md of the repository.
    """

    def __init__(
        self,
        config: Union[layout.Preset, MonitorConfig] = "general",
        *,
        zones: Optional[Sequence[Zone]] = None,
    ) -> None:
        if not isinstance(config, MonitorConfig):
            config = MonitorConfig(config)
        given = arguments.filled(_preset(config.preset), **vars(config))
        given.flags |= layout.FIXED_POSE if config.fixed_pose else 0
        size = lib.posewise_monitor_memory_size(None)
        super().__init__("monitor_init", size, ctypes.byref(given))
        if zones is not None:
            self.set_zones(zones)

    def update(self, seen: Union[Tracker, Observation], timestamp_us: int) -> None:
        """Takes the last step of a tracker, or an observation from elsewhere, at its time [us].

        Frames without a face are observations too; frames that were dropped need none. A time
        before the last one means that the clock was set back; the same time is an error.
        """
        if isinstance(seen, Tracker):
            seen = seen.observation()
        given = arguments.struct(layout.Observation, **vars(seen))
        now = arguments.i64("timestamp_us", timestamp_us)
        self._call("monitor_update", ctypes.byref(given), now)

    def state(self) -> MonitorState:
        """What it knows after the last observation."""
        state: MonitorState = MonitorState._of(self._read("monitor_read", layout.MonitorState))
        return state

    def events(self) -> tuple[list[MonitorEvent], int]:
        """The events that were not read yet, and how many were overwritten unread."""
        events, overwritten = self._events(
            "monitor_events", layout.MonitorEvent, layout.UNREAD_MONITOR_EVENTS
        )
        return [MonitorEvent._of(event) for event in events], overwritten

    def set_zones(self, zones: Sequence[Zone]) -> None:
        """Replaces the zones; times in zones begin anew. Without any, nothing is away."""
        given = [
            arguments.struct(
                layout.Zone,
                kind=zone.kind,
                flags=layout.ROAD if zone.is_road else 0,
                grace_us=zone.grace_us,
                numbers=tuple(zone.numbers) + (0.0,) * (9 - len(zone.numbers)),
            )
            for zone in zones
        ]
        self._call("monitor_set_zones", (layout.Zone * len(given))(*given), len(given))

    def forget_driver(self) -> None:
        """Another person drives: forgets what it learnt and measured, and the time."""
        self._call("monitor_forget_driver")

    def save(self) -> bytes:
        """What was learnt of the driver, for ``restore`` on the next drive."""
        out = ctypes.create_string_buffer(layout.MONITOR_RECORD_SIZE)
        self._call("monitor_save", out, len(out))
        return out.raw

    def restore(self, record: bytes) -> None:
        """Guesses that the driver is the one of a record, until it has observed enough."""
        self._call("monitor_restore", bytes(record), len(record))
