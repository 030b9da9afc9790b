"""Head pose, 68 landmarks and facial animation from camera frames.

>>> import numpy as np, posewise
>>> tracker = posewise.Tracker()
>>> result = tracker.step(np.zeros((480, 640), np.uint8), timestamp_us=0)
>>> result.state
'searching'

Units, signs and ranges are those of ``posewise.h``: pixels of the upright image, mm in the camera
frame (x right, y down, z away from the camera), degrees. Left and right are the person's own.
"""

from ._library import PosewiseError
from ._layout import EVENTS, EYES, LOSSES, STATES
from ._model import PARTS, ModelInfo, model_info
from ._tracker import (
    ANIMATION_NAMES,
    EYE_LOOK_NAMES,
    FORMATS,
    Detected,
    Event,
    Face,
    Result,
    Tracker,
)
from ._video import track

__all__ = [
    "ANIMATION_NAMES",
    "EYE_LOOK_NAMES",
    "EVENTS",
    "EYES",
    "Detected",
    "Event",
    "FORMATS",
    "Face",
    "LOSSES",
    "ModelInfo",
    "PARTS",
    "PosewiseError",
    "Result",
    "STATES",
    "Tracker",
    "model_info",
    "track",
]
__version__ = "0.1.0"
