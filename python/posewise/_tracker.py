"""The tracker, on numpy arrays."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _layout as layout
from ._arguments import Pixels
from ._fields import Config, Event, Face, Fields, Floats, Observation
from ._handle import Handle
from ._library import call, lib, sized
from ._model import checked, path_of

#: Formats by name, for ``Tracker.step(format=…)``.
FORMATS: dict[str, int] = layout.FORMATS
#: ARKit's weights of the gaze, in the order of Result.eye_look.
EYE_LOOK_NAMES: tuple[str, ...] = tuple(
    lib.posewise_eye_look_name(i).decode() for i in range(layout.EYE_LOOKS)
)
#: ARKit's names of the animation weights, in order.
ANIMATION_NAMES: tuple[str, ...] = tuple(
    lib.posewise_animation_name(i).decode() for i in range(layout.ANIMATIONS)
)
# Most faces of one call of Tracker.detect.
_MOST_FACES = 16


@dataclass(frozen=True)
class Result(Fields):
    """What one frame gave. Arrays belong to the result; the tracker never changes them."""

    #: (68, 2): x, y in the upright image [px]; zeros while searching.
    landmarks: Floats
    #: (68,): probability that the landmark is right.
    landmark_confidence: Floats
    #: (68,): probability that it is visible.
    visibility: Floats
    #: (68, 3): points of the 3D face in the camera frame [mm].
    points_mm: Floats
    #: (29,): animation weights, named by ANIMATION_NAMES.
    animation: Floats


@dataclass(frozen=True)
class Detected:
    """What one call of Tracker.detect found."""

    #: The largest first.
    faces: list[Face]
    #: Whether every place was searched; if not, the next call goes on.
    finished: bool


def default_config() -> Config:
    """The settings of a tracker where none are given."""
    config: Config = Config._of(_defaults())
    return config


def _defaults() -> layout.Config:
    """The same as the library has them, with 0 being 0."""
    out = sized(layout.Config())
    call("config_default", ctypes.byref(out))
    return out


@dataclass(frozen=True)
class Mesh:
    """The dense mesh of a face, from Tracker.mesh()."""

    #: (n, 3): the vertices, in the space that was asked for.
    vertices: Floats
    #: (n,): whether the surface there faces the camera [0..1]. What covers it does not count.
    visibility: Floats


@dataclass(frozen=True)
class MeshTables:
    """How the vertices of a mesh are joined, the same for every face."""

    #: (m, 3): vertices of each triangle, counter-clockwise as seen from outside of the face.
    triangles: npt.NDArray[np.uint16]
    #: (n, 2): place of each vertex in a texture of the face, u to the right, v upwards [0..1].
    uvs: Floats
    #: Vertices of lines by name; "landmarks" are those of iBUG 68. Of a loop the last is joined to
    #: the first.
    lines: dict[layout.MeshLine, npt.NDArray[np.uint16]]


class Tracker(Handle):
    """Follows one face. Several threads may share a tracker: they wait for each other.

    ``model`` is "posewise" (whose sources allow any use: may ship in a product), "research" (whose
    do not), or the path of a ``.posewise`` file. None in any other setting selects its default.
    ``gaze`` looks at the eyes of the face, which takes more time; without it they are "not-seen".
    ``natural_gaze`` does so for a person who looks straight ahead most of the time, as a driver
    does: part of the mean of the gaze in the head frame is taken off it, at most 8 degrees.
    ``roi`` is that of set_roi(). ``network_period`` saves time: the number of
    frames of which one is seen with all networks.
    """

    def __init__(
        self,
        model: Union[str, Path] = "posewise",
        *,
        min_face_px: Optional[int] = None,
        scan_budget: Optional[int] = None,
        smoothing_hz: Optional[float] = None,
        smoothing_beta: Optional[float] = None,
        intrinsics: Optional[Sequence[float]] = None,
        lens: Optional[tuple[layout.LensModel, Sequence[float]]] = None,
        gaze: bool = False,
        natural_gaze: bool = False,
        roi: Optional[tuple[int, int, int, int]] = None,
        network_period: Optional[int] = None,
    ) -> None:
        config = arguments.filled(
            _defaults(),
            min_face_px=min_face_px,
            scan_budget=scan_budget,
            smoothing_hz=smoothing_hz,
            smoothing_beta=smoothing_beta,
            network_period=network_period,
            gaze="natural" if natural_gaze else "on" if gaze else "off",
        )
        if intrinsics is not None:
            config.intrinsics = arguments.intrinsics(intrinsics)
        if lens is not None:
            config.lens = arguments.lens(*lens)
        if roi is not None:
            config.roi = arguments.roi(roi)
        self._model = checked(path_of(model))
        model_at, model_len = self._model.ctypes.data, len(self._model)
        size = lib.posewise_memory_size(None)
        super().__init__("init", size, model_at, model_len, ctypes.byref(config))

    def step(
        self,
        frame: Pixels,
        timestamp_us: int,
        *,
        format: Optional[str] = None,
        rotation_deg: int = 0,
        mirrored: bool = False,
        hint: Optional[tuple[Sequence[float], float, float]] = None,
    ) -> Result:
        """Processes one frame. Timestamps are the camera's [us], and increase.

        ``frame`` is an array of (height, width) in 8-bit or 16-bit grey, or (height, width, 3) in
        BGR as OpenCV has it, or (height, width, 4) in BGRA; ``format`` names others, as "RGB3". It
        is read in place where pixels lie one after the other in each row, and else copied.
        ``hint`` is where a face is expected: box of the landmarks, yaw and roll [deg].
        """
        given, pixels = arguments.frame(frame, timestamp_us, format, rotation_deg, mirrored)
        frame_at = ctypes.byref(given)
        with self._lock:
            if hint is None:
                out = self._read("step", layout.Result, frame_at)
            else:
                hint_at = ctypes.byref(arguments.hint(*hint))
                out = self._read("step_at", layout.Result, frame_at, hint_at)
            del pixels
            return self._whole(out, "landmarks", "animation")

    def smoothed(self) -> Result:
        """The result of the last step, smoothed over time: less jitter, about one frame late."""
        with self._lock:
            out = self._read("smoothed", layout.Result)
            return self._whole(out, "smoothed_landmarks", "smoothed_animation")

    def _whole(self, out: layout.Result, landmarks: str, animation: str) -> Result:
        points = np.empty((layout.LANDMARKS, 7), dtype=np.float32)
        self._call(landmarks, points.ctypes.data, layout.LANDMARKS)
        weights = np.empty(layout.ANIMATIONS, dtype=np.float32)
        self._call(animation, weights.ctypes.data, layout.ANIMATIONS)
        result: Result = Result._of(
            out,
            # As in posewise_landmark: x, y, confidence, visibility, x_mm, y_mm, z_mm.
            landmarks=points[:, 0:2],
            landmark_confidence=points[:, 2],
            visibility=points[:, 3],
            points_mm=points[:, 4:7],
            animation=weights,
        )
        return result

    def mesh(self, space: layout.MeshSpace = "picture") -> Mesh:
        """The dense mesh of the face of the last step.

        ``space`` is "picture" (x, y in px, z in mm along the camera's axis), "camera" or "head"
        (mm). While searching, or with a model without a mesh, it is an error.
        """
        index = arguments.index_of("a space", space, layout.MESH_SPACES)
        points = self._vertices("mesh", index)
        return Mesh(vertices=points[:, :3], visibility=points[:, 3])

    def mesh_shape(self, shape: str = "neutral") -> Floats:
        """The person's own head: vertices in the head frame, (vertices, 3) in mm.

        ``shape`` is "neutral", or one of ANIMATION_NAMES: the neutral face with that weight at 1. A
        face with weights w is neutral + sum of w[i] * (shape i - neutral). The identity is that of
        the last fit, so it outlives the loss of the face. Before the first face, or with a model
        without a mesh, it is an error.
        """
        index = arguments.index_of("a shape", shape, ("neutral", *ANIMATION_NAMES))
        return self._vertices("mesh_shape", index - 1 if index else layout.MESH_NEUTRAL)[:, :3]

    def _vertices(self, name: str, index: int) -> Floats:
        # As in posewise_mesh_vertex: x, y, z, visibility.
        points = np.empty((layout.MESH_VERTICES, 4), dtype=np.float32)
        count = ctypes.c_size_t()
        at, capacity = points.ctypes.data, len(points)
        self._call(name, index, at, capacity, ctypes.byref(count))
        return points[: count.value]

    def mesh_tables(self) -> MeshTables:
        """How the vertices of its mesh are joined."""
        out = self._read("mesh_tables", layout.MeshTopology)

        def copied(at: int, kind: Any, count: int) -> Any:
            return np.ctypeslib.as_array(ctypes.cast(at, ctypes.POINTER(kind)), (count,)).copy()

        lines = copied(out.lines, ctypes.c_uint16, out.line_starts[8])
        ends = zip(layout.MESH_LINES, out.line_starts[:8], out.line_starts[1:])
        return MeshTables(
            triangles=copied(out.triangles, ctypes.c_uint16, 3 * out.triangle_count).reshape(-1, 3),
            uvs=copied(out.uvs, ctypes.c_float, 2 * out.vertex_count).reshape(-1, 2),
            lines={name: lines[start:end] for name, start, end in ends},
        )

    def observation(self) -> Observation:
        """What a driver monitor needs of the last step."""
        seen: Observation = Observation._of(self._read("monitor_observe", layout.Observation))
        return seen

    def detect(
        self,
        frame: Pixels,
        *,
        format: Optional[str] = None,
        rotation_deg: int = 0,
        mirrored: bool = False,
    ) -> Detected:
        """Lists faces of a frame, whatever the tracker does, in calls of bounded work."""
        given, pixels = arguments.frame(frame, 0, format, rotation_deg, mirrored)
        found = (layout.Face * _MOST_FACES)()
        count, finished = ctypes.c_size_t(), ctypes.c_uint32()
        count_at, finished_at = ctypes.byref(count), ctypes.byref(finished)
        self._call("detect", ctypes.byref(given), found, _MOST_FACES, count_at, finished_at)
        del pixels
        return Detected([Face._of(face) for face in found[: count.value]], finished.value == 1)

    def events(self) -> tuple[list[Event], int]:
        """The events that were not read yet, and how many were overwritten unread."""
        events, overwritten = self._events("events", layout.Event, layout.UNREAD_EVENTS)
        return [Event._of(event) for event in events], overwritten

    def set_excluded(self, boxes: Sequence[Sequence[float]]) -> None:
        """Keeps this tracker from faces that others follow: boxes of x, y, width, height [px]."""
        numbers = arguments.boxes(boxes)
        self._call("set_excluded", numbers.ctypes.data, len(numbers))

    def set_roi(self, roi: Optional[tuple[int, int, int, int]]) -> None:
        """Looks for faces in x, y, width, height [px] only; None: the whole frame."""
        given = None if roi is None else ctypes.byref(arguments.roi(roi))
        self._call("set_roi", given)

    def set_intrinsics(self, intrinsics: Optional[Sequence[float]]) -> None:
        """The camera: fx, fy, cx, cy [px]; None: a horizontal field of view of 60 degrees."""
        given = None if intrinsics is None else ctypes.byref(arguments.intrinsics(intrinsics))
        self._call("set_intrinsics", given)

    def set_lens(self, lens: Optional[tuple[layout.LensModel, Sequence[float]]]) -> None:
        """The lens: "brown" or "fisheye" with OpenCV's coefficients; None: none."""
        given = None if lens is None else ctypes.byref(arguments.lens(*lens))
        self._call("set_lens", given)

    def reset(self) -> None:
        """Forgets the face, its identity and the time, as for another video."""
        self._call("reset")

    def forget_identity(self) -> None:
        """Forgets the identity, as when somebody else sits down."""
        self._call("forget_identity")

    def save_identity(self) -> bytes:
        """What was learnt of the person's head, for ``restore_identity`` when the person is back.

        Before the first trusted frame it is an error.
        """
        out = ctypes.create_string_buffer(layout.IDENTITY_RECORD_SIZE)
        self._call("save_identity", out, len(out))
        return out.raw

    def restore_identity(self, record: bytes) -> None:
        """Guesses that this face, and every new one, is that of a record."""
        self._call("restore_identity", bytes(record), len(record))

    def compare_identity(self, record: bytes) -> layout.Likeness:
        """Whether the head has the shape of that of a record: "same", "other" or "unknown".

        It is no identification: two people may have heads of one shape.
        """
        found = ctypes.c_uint32()
        self._call("compare_identity", bytes(record), len(record), ctypes.byref(found))
        return layout.LIKENESSES[found.value]
