#!/usr/bin/env python3
"""Compares the scan of a whole frame with pico's: CPU time and recall on the same frames.

    python3 -m venv peers && peers/bin/pip install numpy pillow ./python
    peers/bin/python benches/scan.py --pico PICO --csv DATA/faces300w/dev.csv \
        --images DATA/faces300w/dev --backgrounds DATA/backgrounds

Each frame is a natural photograph with one labelled face somewhere in it, of 60 px (the longer side
of the box around its landmarks) or more, or with none. Both systems look for faces from 60 px on,
in turns, on one core; posewise in one call (`posewise_detect` with a large scan_budget). A face is
found where the middle of a box is within a third of its size from the middle of the landmarks; any
other box is false. `--pico` is a checkout of nenadmarkus/pico.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import statistics
import time
from pathlib import Path

import numpy as np
import posewise
from peers import MIN_FACE, Box, pico_detector
from PIL import Image

# Largest face of a frame [px].
MAX_FACE = 240
# Part of a face's size by which the middle of its box may be off.
NEAR = 1 / 3


class Scene:
    """A frame, and the middle and size of its face, if it has one [px]."""

    def __init__(self, frame: np.ndarray, face: tuple[float, float, float] | None) -> None:
        self.frame, self.face = frame, face

    def count(self, boxes: list[Box]) -> tuple[bool, int]:
        """Whether a box is at the face, and how many are elsewhere."""
        if self.face is None:
            return False, len(boxes)
        x, y, size = self.face
        far = [np.hypot(left + w / 2 - x, top + h / 2 - y) for left, top, w, h in boxes]
        near = [distance <= NEAR * size for distance in far]
        return any(near), near.count(False)


def opened(path: Path, width: int, height: int) -> Image.Image:
    """The middle of a picture, scaled so that it covers a frame."""
    picture = Image.open(path).convert("L")
    scale = max(width / picture.width, height / picture.height)
    size = (round(picture.width * scale) + 1, round(picture.height * scale) + 1)
    picture = picture.resize(size, Image.Resampling.BILINEAR)
    left, top = (picture.width - width) // 2, (picture.height - height) // 2
    return picture.crop((left, top, left + width, top + height))


class Scenes:
    """Draws frames."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        self.width, self.height = map(int, arguments.size.split("x"))
        self.random = random.Random(arguments.seed)
        self.images: Path = arguments.images
        with arguments.csv.open(newline="") as file:
            rows = csv.DictReader(file)
            self.labels = [
                (row["image"], np.array([[float(row[f"{a}{k}"]) for a in "xy"] for k in range(68)]))
                for row in rows
            ]
        people = arguments.backgrounds / "with-people.txt"
        listed = set(people.read_text().split()) if people.exists() else set()
        pictures = sorted(p for p in arguments.backgrounds.iterdir() if p.suffix != ".txt")
        self.backgrounds = [p for p in pictures if p.name not in listed]

    def draw(self, with_face: bool) -> Scene:
        frame = opened(self.random.choice(self.backgrounds), self.width, self.height)
        if not with_face:
            return Scene(np.ascontiguousarray(frame), None)
        name, points = self.random.choice(self.labels)
        low, high = points.min(0), points.max(0)
        size = MIN_FACE * (MAX_FACE / MIN_FACE) ** self.random.random()
        scale = size / (high - low).max()
        picture = Image.open(self.images / name).convert("L")
        scaled = (max(round(picture.width * scale), 1), max(round(picture.height * scale), 1))
        picture = picture.resize(scaled, Image.Resampling.BILINEAR)
        sides = (self.width, self.height)
        # All of the face is in the frame; of the picture around it perhaps not.
        at = [self.random.uniform(-low[k], sides[k] / scale - high[k]) * scale for k in (0, 1)]
        at = [round(v) for v in at]
        frame.paste(picture, (at[0], at[1]))
        x, y = points.mean(0) * scale + at
        return Scene(np.ascontiguousarray(frame), (x, y, size))


class Own:
    """posewise's scan of a whole frame."""

    def __init__(self) -> None:
        self.tracker = posewise.Tracker(min_face_px=MIN_FACE, scan_budget=10_000_000)

    def __call__(self, frame: np.ndarray) -> list[Box]:
        while True:
            detected = self.tracker.detect(frame)
            if detected.finished:
                return [tuple(face.face_box) for face in detected.faces]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--pico", type=Path, required=True, help="a checkout of pico")
    parser.add_argument("--csv", type=Path, required=True, help="labels: image,x0,y0,…,y67")
    parser.add_argument("--images", type=Path, required=True, help="folder of their pictures")
    parser.add_argument("--backgrounds", type=Path, required=True, help="pictures without people")
    parser.add_argument("--size", default="640x480", help="WIDTHxHEIGHT [default: 640x480]")
    parser.add_argument("--frames", type=int, default=300, help="of each kind [default: 300]")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()

    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    systems = {"posewise": Own(), "pico": pico_detector(arguments)}
    scenes = Scenes(arguments)
    for kind, with_face in (("with a face", True), ("without", False)):
        cpu: dict[str, list[float]] = {name: [] for name in systems}
        found, false = dict.fromkeys(systems, 0), dict.fromkeys(systems, 0)
        for _ in range(arguments.frames):
            scene = scenes.draw(with_face)
            for name, system in systems.items():
                start = time.process_time_ns()
                boxes = system(scene.frame)
                cpu[name].append((time.process_time_ns() - start) / 1e6)
                is_found, elsewhere = scene.count(boxes)
                found[name] += is_found
                false[name] += elsewhere
        own = statistics.mean(cpu["posewise"])
        for name, times in cpu.items():
            mean, median = statistics.mean(times), statistics.median(times)
            share = f"found {100 * found[name] / arguments.frames:.1f} %, " if with_face else ""
            print(
                f"{arguments.frames} frames {kind}: {name}: mean {mean:.2f} ms, median {median:.2f}"
                f" ms, posewise over it {own / mean:.2f}, {share}{false[name]} false"
            )


if __name__ == "__main__":
    main()
