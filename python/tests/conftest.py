import gzip
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def clip():
    """The demo clip: frames of grey, and the time between them [us]."""
    data = gzip.decompress((ROOT / "tests/data/demo.y4m.gz").read_bytes())
    header, rest = data.split(b"\n", 1)
    width, height = (int(word[1:]) for word in header.split()[1:3])
    frame = len(b"FRAME\n") + width * height
    frames = np.frombuffer(rest, dtype=np.uint8).reshape(-1, frame)
    return frames[:, len(b"FRAME\n") :].reshape(-1, height, width), 50_000


@pytest.fixture
def root():
    return ROOT


def write_video(path, frames):
    cv2 = pytest.importorskip("cv2")
    height, width = frames[0].shape
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 20, (width, height))
    for frame in frames:
        writer.write(np.repeat(frame[:, :, None], 3, 2))
    writer.release()
