#!/usr/bin/env python3
"""Writes what public face trackers find in clips as tables that posewise-lab compares.

    peers/bin/python benches/peer_tables.py --out TABLES [--openseeface FOLDER] CLIP...
    posewise-lab compare CLIP... --csv mediapipe=TABLES/mediapipe --csv dlib=TABLES/dlib

peers.py says how the environment `peers` is made. TABLES/SYSTEM/CLIP.csv has a row per frame, with
angles and landmarks in the conventions of docs/conventions.md and the processor time of the step. A
table that is there is not made again. The focal length is that of the truth CLIP.csv beside the
clip, if there is one. What is not installed, or not given, is skipped and named.

| system | landmarks | pose |
|---|---|---|
| mediapipe | 68 of the 468 of its face mesh | axes through its mesh: 234 to 454, 10 to 152 |
| dlib | its 68 in the box of its detector | solvePnP of 6 points, as its users do |
| openseeface | its 66; inner and outer corners of its mouth are the same | its own |

MediaPipe's mesh knows no camera: its axes are turned with the line of sight. OpenSeeFace is given
the clip's camera in place of the one that it assumes. The pose that it fits lies behind the camera:
it is reflected to the front, where the line of sight has the other sign. dlib's users start
solvePnP anywhere; here it starts at a head that looks into the camera, which loses fewer faces.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import itertools
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Optional

# Before numpy: it asks all of them for one thread.
from peers import Missing, frames, given, module

import numpy as np  # isort: skip


class Camera(NamedTuple):
    """Focal length and size of the frames [px]."""

    focal: float
    width: int
    height: int

    @property
    def matrix(self) -> np.ndarray:
        centre = (self.width - 1) / 2, (self.height - 1) / 2
        return np.array([[self.focal, 0, centre[0]], [0, self.focal, centre[1]], [0, 0, 1.0]])


# Rotation from head to camera, and 68 landmarks [px].
Found = Optional[tuple[np.ndarray, np.ndarray]]
# Takes a grey frame.
Step = Callable[[np.ndarray], Found]

# Points of the face mesh at the places of iBUG's 68.
MESH = (
    "162 234 93 58 172 136 149 148 152 377 378 365 397 288 323 454 389 "  # jaw
    "71 63 105 66 107 336 296 334 293 301 "  # brows
    "168 197 5 4 75 97 2 326 305 "  # nose
    "33 160 158 133 153 144 362 385 387 263 373 380 "  # eyes
    "61 39 37 0 267 269 291 405 314 17 84 181 "  # outer lips
    "78 82 13 312 308 317 14 87"  # inner lips
)
# Ends of the mesh's horizontal (to the image right) and vertical (down) axis.
ACROSS, DOWN = (234, 454), (10, 152)

# OpenSeeFace's 66 points at the places of iBUG's 68: its mouth has two corners, not four.
LIPS = [*range(48), 58, *range(48, 53), 62, *range(53, 58), 58, 59, 60, 61, 62, 63, 64, 65]

# Landmarks of the six points that dlib's users fit, and their places: x to the image right, y up,
# z towards the camera. The unit does not matter.
SIX = [30, 8, 36, 45, 48, 54]
# Distance of the head at which the fit starts, in their unit.
DISTANCE = 4000.0
SIX_POINTS = np.array(
    [
        [0.0, 0.0, 0.0],
        [0.0, -330.0, -65.0],
        [-225.0, 170.0, -135.0],
        [225.0, 170.0, -135.0],
        [-150.0, -150.0, -125.0],
        [150.0, -150.0, -125.0],
    ]
)


def angles(rotation: np.ndarray) -> tuple[float, float, float]:
    """Yaw, pitch, roll [deg] of R = Ry(-yaw) Rx(-pitch) Rz(roll)."""
    nose = -rotation[:, 2]
    yaw = math.atan2(nose[0], -nose[2])
    pitch = math.asin(max(-1.0, min(1.0, -nose[1])))
    (sy, cy), (sp, cp) = ((math.sin(-a), math.cos(-a)) for a in (yaw, pitch))
    turn = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    nod = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    rest = (turn @ nod).T @ rotation
    return math.degrees(yaw), math.degrees(pitch), math.degrees(math.atan2(rest[1, 0], rest[0, 0]))


def sight(camera: Camera, point: np.ndarray) -> np.ndarray:
    """The shortest rotation from the camera's axis to the line of sight of a point."""
    ray = np.linalg.inv(camera.matrix) @ [point[0], point[1], 1.0]
    axis = np.cross([0, 0, 1.0], ray)
    sine = np.linalg.norm(axis)
    turn = axis / max(sine, 1e-9) * math.atan2(sine, ray[2])
    return module("cv2").Rodrigues(turn)[0]


def mediapipe(_: argparse.Namespace, camera: Camera) -> Step:
    mesh = module("mediapipe").solutions.face_mesh.FaceMesh(max_num_faces=1)
    cv2, chosen = module("cv2"), [int(word) for word in MESH.split()]

    def step(grey: np.ndarray) -> Found:
        faces = mesh.process(cv2.cvtColor(grey, cv2.COLOR_GRAY2RGB)).multi_face_landmarks
        if not faces:
            return None
        size = np.array([camera.width, camera.height, camera.width])
        points = np.array([[p.x, p.y, p.z] for p in faces[0].landmark]) * size
        # Coordinates are shares of the size; here the centre of the first pixel is (0, 0).
        points[:, :2] -= 0.5
        x = points[ACROSS[1]] - points[ACROSS[0]]
        y = points[DOWN[1]] - points[DOWN[0]]
        x /= np.linalg.norm(x)
        y -= x * (x @ y)
        y /= np.linalg.norm(y)
        rotation = np.stack([x, y, np.cross(x, y)], axis=1)
        return sight(camera, points.mean(axis=0)) @ rotation, points[chosen, :2]

    return step


def dlib(_: argparse.Namespace, camera: Camera) -> Step:
    library, cv2 = module("dlib"), module("cv2")
    detector = library.get_frontal_face_detector()
    models = module("face_recognition_models")
    predictor = library.shape_predictor(models.pose_predictor_model_location())

    def step(grey: np.ndarray) -> Found:
        boxes = detector(grey, 0)
        if not boxes:
            return None
        shape = predictor(grey, max(boxes, key=lambda box: box.area()))
        points = np.array([[p.x, p.y] for p in shape.parts()], np.float64)
        start = np.array([math.pi, 0, 0]), np.array([0, 0, DISTANCE])
        found, vector, _ = cv2.solvePnP(
            SIX_POINTS, points[SIX], camera.matrix, None, *start, useExtrinsicGuess=True
        )
        if not found:
            return None
        return cv2.Rodrigues(vector)[0] @ np.diag([1.0, -1, -1]), points

    return step


def openseeface(arguments: argparse.Namespace, camera: Camera) -> Step:
    folder = given(arguments.openseeface, "--openseeface FOLDER").resolve()
    module("onnxruntime")
    cv2 = module("cv2")
    sys.path.insert(0, str(folder))
    tracker = module("tracker").Tracker(
        camera.width,
        camera.height,
        model_type=arguments.openseeface_model,
        max_threads=1,
        max_faces=1,
        silent=True,
        no_gaze=True,
        model_dir=str(folder / "models"),
    )
    # It counts rows first. So its camera's x is down and its y to the right.
    swap = np.array([[0, 1.0, 0], [1, 0, 0], [0, 0, 1]])
    tracker.camera = (swap @ camera.matrix @ swap).astype(np.float32)
    tracker.inverse_camera = np.linalg.inv(tracker.camera)

    def step(grey: np.ndarray) -> Found:
        faces = tracker.predict(np.repeat(grey[:, :, None], 3, axis=2))
        if not faces or not faces[0].success:
            return None
        points = np.array(faces[0].lms)[LIPS, 1::-1]
        rotation = cv2.Rodrigues(np.ravel(faces[0].rotation))[0]
        behind = np.ravel(faces[0].translation)[2] < 0
        if behind:
            rotation = np.diag([-1.0, -1, 1]) @ rotation
        # The model's axes: to the image left, up, towards the camera.
        rotation = -swap @ rotation
        if behind:
            ray = sight(camera, points.mean(axis=0))
            rotation = ray @ ray @ rotation
        return rotation, points

    return step


SYSTEMS: dict[str, Callable[[argparse.Namespace, Camera], Step]] = {
    "mediapipe": mediapipe,
    "dlib": dlib,
    "openseeface": openseeface,
}


def stem(clip: Path) -> Path:
    """Without the ending of a video."""
    name = clip.name.removesuffix(".gz")
    return clip.with_name(name.rpartition(".")[0] or name)


def camera_of(clip: Path, grey: np.ndarray) -> Camera:
    """That of the truth, or one of 60° across."""
    height, width = grey.shape
    truth = Path(f"{stem(clip)}.csv")
    if truth.exists():
        with truth.open(newline="") as file:
            row = next(csv.DictReader(file), {})
        if row.get("fx"):
            return Camera(float(row["fx"]), width, height)
    return Camera(width / 2 / math.tan(math.radians(30)), width, height)


def row_of(number: int, found: Any, milliseconds: float) -> list[str]:
    """One row of a table."""
    values = [0.0] * 139
    if found is not None:
        values = [*angles(found[0]), *found[1].ravel()]
    head = [str(number), str(int(found is not None)), *(f"{v:.4f}" for v in values[:3])]
    return [*head, f"{milliseconds:.4f}", *(f"{v:.3f}" for v in values[3:])]


def write(path: Path, name: str, clip: Path, arguments: argparse.Namespace) -> int:
    """Tracks a clip and gives the number of tracked frames."""
    step: Step | None = None
    head = ["frame", "success", "yaw_deg", "pitch_deg", "roll_deg", "milliseconds"]
    rows = [[*head, *(f"{axis}_{i}" for i in range(68) for axis in "xy")]]
    # Decoded beforehand: threads of the decoder would count as time of the tracker.
    decoded = list(itertools.islice(frames(str(clip)), arguments.frames))
    for number, grey in enumerate(decoded, 1):
        if step is None:
            step = SYSTEMS[name](arguments, camera_of(clip, grey))
        start = time.process_time_ns()
        # Some systems write to the terminal.
        with contextlib.redirect_stdout(io.StringIO()):
            found = step(np.ascontiguousarray(grey))
        rows.append(row_of(number, found, (time.process_time_ns() - start) / 1e6))
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{os.getpid()}")
    with partial.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)
    partial.rename(path)
    return sum(row[1] == "1" for row in rows[1:])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("clips", nargs="+", type=Path, help="videos")
    parser.add_argument("--out", type=Path, required=True, help="folder for the tables")
    parser.add_argument("--system", action="append", choices=SYSTEMS, help="[default: all]")
    parser.add_argument("--frames", type=int, default=sys.maxsize, help="frames at most")
    parser.add_argument("--openseeface", type=Path, help="a checkout of OpenSeeFace")
    parser.add_argument("--openseeface-model", type=int, default=3, help="0..4 [default: 3]")
    arguments = parser.parse_args()

    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    shared = Path(os.path.commonpath([clip.resolve().parent for clip in arguments.clips]))
    for name in arguments.system or SYSTEMS:
        for clip in arguments.clips:
            below = stem(clip.resolve()).relative_to(shared)
            path = Path(f"{arguments.out / name / below}.csv")
            if path.exists():
                continue
            try:
                print(f"{name} {below}: {write(path, name, clip, arguments)} frames tracked")
            except Missing as missing:
                print(f"skipped {name}: {missing}")
                break


if __name__ == "__main__":
    main()
