#!/usr/bin/env python3
"""Times posewise and public face trackers on the same frames, in turns, on one core.

    python3 -m venv peers && peers/bin/pip install mediapipe==0.10.14 'numpy<2' \
        'opencv-contrib-python<4.12' dlib-bin face_recognition_models onnxruntime ./python
    peers/bin/python benches/peers.py VIDEO

Each frame is given to every system before the next one is read, so that all see the same noise of
the machine; the caches hold another system's data then, unless --warm is given. A line has the
median wall time and the median CPU time of a frame, the ratio of the latter to posewise's, and in
how many frames a face was found. What is not installed, or not given, is skipped and named. Without
VIDEO the clip of the repository is shown.

| system | needs |
|---|---|
| posewise | the wheel of python/ |
| mediapipe: face mesh, tracking | mediapipe==0.10.14, which holds its models |
| dlib detector; dlib landmarks in a known box | dlib-bin, face_recognition_models |
| opencv: Haar cascade | mediapipe brings OpenCV with its cascades |
| pfld: landmarks in a known box | --pfld FILE.onnx (AnthonyF333/PFLD_GhostOne), onnxruntime |
| openseeface: tracking | --openseeface FOLDER (emilianavt/OpenSeeFace), onnxruntime |
| pico: detector | --pico FOLDER (nenadmarkus/pico), a C compiler |
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import gzip
import importlib
import io
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

# Before any of them is loaded: one thread each.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"
os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
os.environ.setdefault("GLOG_minloglevel", "3")

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
# Smallest face that detectors look for, as posewise's default [px].
MIN_FACE = 60

# From this score on a detection of pico counts.
PICO_SCORE = 5

# Left, top, width and height [px].
Box = tuple[float, float, float, float]
# Takes a grey frame and the box of the face (left, top, width, height [px]), which systems without
# a detector of their own are given; returns whether there is a face.
Step = Callable[[np.ndarray, "tuple[int, int, int, int] | None"], bool]


class Missing(Exception):
    """What a system lacks."""


def module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Missing(f"no Python module {error.name or name}") from error


def given(path: Path | None, option: str) -> Path:
    if path is None:
        raise Missing(f"no {option}")
    if not path.exists():
        raise Missing(f"{option}: {path} does not exist")
    return path


class Posewise:
    """Tracks; its box is what the systems without a detector get."""

    def __init__(self) -> None:
        self.tracker = module("posewise").Tracker(min_face_px=MIN_FACE)
        self.time_us = 0
        self.box: tuple[int, int, int, int] | None = None

    def __call__(self, grey: np.ndarray, _box: object) -> bool:
        self.time_us += 33_333
        result = self.tracker.step(grey, self.time_us)
        found = result.state == "tracking"
        self.box = tuple(int(v) for v in result.face_box) if found else None  # type: ignore
        return found


def mediapipe(_: argparse.Namespace) -> Step:
    solutions, cv2 = module("mediapipe").solutions, module("cv2")
    mesh = solutions.face_mesh.FaceMesh(max_num_faces=1)

    def step(grey: np.ndarray, _box: object) -> bool:
        rgb = cv2.cvtColor(grey, cv2.COLOR_GRAY2RGB)
        return mesh.process(rgb).multi_face_landmarks is not None

    return step


def dlib_detector(_: argparse.Namespace) -> Step:
    detector = module("dlib").get_frontal_face_detector()
    return lambda grey, _box: len(detector(grey, 0)) > 0


def dlib_landmarks(_: argparse.Namespace) -> Step:
    dlib, models = module("dlib"), module("face_recognition_models")
    predictor = dlib.shape_predictor(models.pose_predictor_model_location())

    def step(grey: np.ndarray, box: tuple[int, int, int, int] | None) -> bool:
        if box is None:
            return False
        x, y, w, h = box
        return predictor(grey, dlib.rectangle(x, y, x + w, y + h)).num_parts == 68

    return step


def haar(_: argparse.Namespace) -> Step:
    cv2 = module("cv2")
    cv2.setNumThreads(1)
    path = Path(cv2.data.haarcascades) / "haarcascade_frontalface_default.xml"
    if not hasattr(cv2, "CascadeClassifier") or not path.exists():
        raise Missing("this OpenCV has no Haar cascades")
    cascade = cv2.CascadeClassifier(str(path))
    return lambda grey, _box: len(cascade.detectMultiScale(grey, minSize=(MIN_FACE, MIN_FACE))) > 0


def session(path: Path) -> Any:
    onnxruntime = module("onnxruntime")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])


def pfld(arguments: argparse.Namespace) -> Step:
    network, cv2 = session(given(arguments.pfld, "--pfld FILE.onnx")), module("cv2")
    name = network.get_inputs()[0].name

    def step(grey: np.ndarray, box: tuple[int, int, int, int] | None) -> bool:
        if box is None:
            return False
        x, y, w, h = box
        side = int(1.2 * max(w, h))
        left, top = max(0, x + w // 2 - side // 2), max(0, y + h // 2 - side // 2)
        crop = cv2.resize(grey[top : top + side, left : left + side], (112, 112))
        picture = np.repeat(crop[None, None].astype(np.float32) / 255, 3, axis=1)
        return network.run(None, {name: picture})[0].size >= 2 * 68

    return step


def openseeface(arguments: argparse.Namespace) -> Step:
    folder = given(arguments.openseeface, "--openseeface FOLDER")
    module("onnxruntime"), module("cv2")
    sys.path.insert(0, str(folder))
    tracker: list[Any] = []

    def step(grey: np.ndarray, _box: object) -> bool:
        if not tracker:
            height, width = grey.shape
            tracker.append(
                module("tracker").Tracker(
                    width,
                    height,
                    model_type=arguments.openseeface_model,
                    max_threads=1,
                    max_faces=1,
                    silent=True,
                    no_gaze=True,
                    model_dir=str(folder / "models"),
                )
            )
        bgr = np.repeat(grey[:, :, None], 3, axis=2)
        return len(tracker[0].predict(bgr)) > 0

    return step


def pico_detector(arguments: argparse.Namespace) -> Callable[[np.ndarray], list[Box]]:
    """pico's detector of faces from MIN_FACE on, as in its own samples: boxes of raw detections."""
    runtime = given(arguments.pico, "--pico FOLDER") / "rnt"
    library = Path(tempfile.mkdtemp()) / "pico.so"
    compiler = os.environ.get("CC", "cc")
    source = str(runtime / "picornt.c")
    try:
        flags = ["-O3", "-shared", "-fPIC", source, "-lm", "-o", library]
        subprocess.run([compiler, *flags], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise Missing(f"pico does not compile: {error}") from error
    find = ctypes.CDLL(str(library)).find_objects
    cascade = ctypes.create_string_buffer((runtime / "cascades" / "facefinder").read_bytes())
    found = (ctypes.c_float * (4 * 1024))()
    real = ctypes.c_float

    def detect(grey: np.ndarray) -> list[Box]:
        height, width = grey.shape
        pixels = grey.ctypes.data_as(ctypes.c_void_p)
        sizes = (real(1.1), real(0.1), real(MIN_FACE), real(1000))
        count = find(found, 1024, cascade, real(0), pixels, height, width, grey.strides[0], *sizes)
        # Row, column, diameter and score of each.
        of_all = [found[4 * i : 4 * i + 4] for i in range(count)]
        return [(x - d / 2, y - d / 2, d, d) for y, x, d, score in of_all if score > PICO_SCORE]

    return detect


def pico(arguments: argparse.Namespace) -> Step:
    detect = pico_detector(arguments)
    return lambda grey, _box: len(detect(grey)) > 0


PEERS: dict[str, Callable[[argparse.Namespace], Step]] = {
    "mediapipe": mediapipe,
    "dlib detector": dlib_detector,
    "dlib landmarks": dlib_landmarks,
    "opencv haar": haar,
    "pfld": pfld,
    "openseeface": openseeface,
    "pico": pico,
}


def frames(video: str | None) -> Iterator[np.ndarray]:
    """Grey frames: of the clip of the repository, of another y4m, or of what OpenCV reads."""
    path = Path(video) if video else ROOT / "tests/data/demo.y4m.gz"
    if path.suffix in (".y4m", ".gz"):
        data = path.read_bytes()
        stream = io.BytesIO(gzip.decompress(data) if path.suffix == ".gz" else data)
        header = stream.readline().split()
        words = {word[:1]: word[1:] for word in header[1:]}
        width, height = int(words[b"W"]), int(words[b"H"])
        chroma = 0 if words.get(b"C", b"420").startswith(b"mono") else width * height // 2
        while stream.readline():
            luma = np.frombuffer(stream.read(width * height), np.uint8)
            stream.read(chroma)
            yield luma.reshape(height, width)
        return
    cv2 = module("cv2")
    capture = cv2.VideoCapture(str(path))
    while True:
        more, picture = capture.read()
        if not more:
            return
        yield cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)


class Times:
    """Wall and CPU times of one system [ms]."""

    def __init__(self, step: Step) -> None:
        self.step = step
        self.wall: list[float] = []
        self.cpu: list[float] = []
        self.found = 0

    def take(
        self, grey: np.ndarray, box: tuple[int, int, int, int] | None, warm: bool
    ) -> None:
        # Some systems write to the terminal.
        with contextlib.redirect_stdout(io.StringIO()):
            if warm:
                self.step(grey, box)
            wall, cpu = time.perf_counter_ns(), time.process_time_ns()
            found = self.step(grey, box)
            self.cpu.append((time.process_time_ns() - cpu) / 1e6)
            self.wall.append((time.perf_counter_ns() - wall) / 1e6)
        self.found += bool(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("video", nargs="?", help="a video [default: the clip of the repository]")
    parser.add_argument("--frames", type=int, default=120, help="frames at most [default: 120]")
    parser.add_argument("--size", help="WIDTHxHEIGHT to which frames are scaled, by OpenCV")
    parser.add_argument(
        "--warm", action="store_true", help="give each frame twice in a row, and time the second"
    )
    parser.add_argument("--pfld", type=Path, help="a PFLD network of 112×112 px, .onnx")
    parser.add_argument("--openseeface", type=Path, help="a checkout of OpenSeeFace")
    parser.add_argument("--openseeface-model", type=int, default=3, help="0..4 [default: 3]")
    parser.add_argument("--pico", type=Path, help="a checkout of pico")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    arguments = parser.parse_args()

    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    own = Posewise()
    systems = {"posewise": Times(own)}
    skipped: dict[str, str] = {}
    for name, make in PEERS.items():
        try:
            systems[name] = Times(make(arguments))
        except Missing as missing:
            skipped[name] = str(missing)
    for count, grey in enumerate(frames(arguments.video)):
        if count == arguments.frames:
            break
        if arguments.size:
            width, height = map(int, arguments.size.split("x"))
            grey = module("cv2").resize(grey, (width, height))
        grey = np.ascontiguousarray(grey)
        for name, times in list(systems.items()):
            try:
                times.take(grey, own.box, arguments.warm)
            except Exception as error:  # one system must not end the others' measurement
                skipped[name] = f"{type(error).__name__}: {error}"
                del systems[name]
    report(systems, skipped, arguments.json)


def report(systems: dict[str, Times], skipped: dict[str, str], path: Path | None) -> None:
    median = statistics.median
    base = median(systems["posewise"].cpu)
    rows = {
        name: {
            "wall_ms": median(times.wall),
            "cpu_ms": median(times.cpu),
            "over_posewise": median(times.cpu) / base,
            "found": times.found,
            "frames": len(times.wall),
        }
        for name, times in systems.items()
    }
    print(f"{'system':<16}{'wall [ms]':>11}{'CPU [ms]':>11}{'ratio':>9}{'found':>12}")
    for name, row in rows.items():
        found = f"{row['found']}/{row['frames']}"
        print(
            f"{name:<16}{row['wall_ms']:>11.2f}{row['cpu_ms']:>11.2f}"
            f"{row['over_posewise']:>8.1f}×{found:>12}"
        )
    for name, reason in skipped.items():
        print(f"skipped {name}: {reason}")
    if path:
        path.write_text(json.dumps({"systems": rows, "skipped": skipped}, indent=2) + "\n")


if __name__ == "__main__":
    main()
