"""Head pose, 68 landmarks and facial animation from camera frames.

>>> import numpy as np, posewise
>>> tracker = posewise.Tracker()
>>> result = tracker.step(np.zeros((480, 640), np.uint8), timestamp_us=0)
>>> result.state
'searching'

Units, signs and ranges are those of ``posewise.h``: pixels of the upright image, mm in the camera
frame (x right, y down, z away from the camera), degrees. Left and right are the person's own.
"""

from ._arguments import Pixels
from ._fields import (
    Config,
    Event,
    Face,
    MonitorEvent,
    MonitorState,
    Observation,
    Perclos,
)
from ._group import Group
from ._layout import EVENTS, EYES, LOSSES, MONITOR_EVENTS, PRESETS, STATES
from ._library import VERSION as __version__
from ._library import PosewiseError
from ._model import PARTS, ModelInfo, model_info
from ._monitor import Monitor, MonitorConfig, Zone
from ._tracker import (
    ANIMATION_NAMES,
    EYE_LOOK_NAMES,
    FORMATS,
    Detected,
    Mesh,
    MeshTables,
    Result,
    Tracker,
    default_config,
)
from ._video import track

__all__ = [
    "ANIMATION_NAMES",
    "Config",
    "Detected",
    "EVENTS",
    "EYES",
    "EYE_LOOK_NAMES",
    "Event",
    "FORMATS",
    "Face",
    "Group",
    "LOSSES",
    "MONITOR_EVENTS",
    "Mesh",
    "MeshTables",
    "ModelInfo",
    "Monitor",
    "MonitorConfig",
    "MonitorEvent",
    "MonitorState",
    "Observation",
    "PARTS",
    "PRESETS",
    "Perclos",
    "Pixels",
    "PosewiseError",
    "Result",
    "STATES",
    "Tracker",
    "Zone",
    "__version__",
    "default_config",
    "model_info",
    "track",
]
