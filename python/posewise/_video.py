"""Tracks a video or a camera, read by OpenCV or PyAV, whichever is there."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator, Optional, Union

from ._arguments import Pixels
from ._tracker import Result, Tracker


def track(
    video: Union[str, Path, int], tracker: Optional[Tracker] = None
) -> Iterator[tuple[Pixels, Result]]:
    """Yields each frame of a video with its result.

    ``video`` is a file or, with OpenCV, the number of a camera. Frames are BGR with OpenCV and grey
    with PyAV.
    """
    tracker = tracker or Tracker()
    for frame, timestamp_us in _frames(video):
        yield frame, tracker.step(frame, timestamp_us)


def _frames(video: Union[str, Path, int]) -> Iterator[tuple[Pixels, int]]:
    try:
        import cv2
    except ImportError:
        try:
            import av
        except ImportError:
            raise ImportError("track() needs opencv-python-headless or av") from None
        return _with_av(av, str(video))
    return _with_opencv(cv2, video if isinstance(video, int) else str(video))


def _with_opencv(cv2: Any, video: Union[str, int]) -> Iterator[tuple[Pixels, int]]:
    capture = cv2.VideoCapture(video)
    if not capture.isOpened():
        raise OSError(f"cannot open {video}")
    rate = capture.get(cv2.CAP_PROP_FPS) or 30.0
    last = -1
    try:
        while True:
            time_us = round(1000 * capture.get(cv2.CAP_PROP_POS_MSEC))
            read, frame = capture.read()
            if not read:
                return
            # Some files and cameras do not say when a frame was taken.
            last = time_us if time_us > last else last + round(1e6 / rate)
            yield frame, last
    finally:
        capture.release()


def _with_av(av: Any, video: str) -> Iterator[tuple[Pixels, int]]:
    with av.open(video) as container:
        stream = container.streams.video[0]
        last = -1
        for frame in container.decode(stream):
            time_us = last + 1 if frame.time is None else round(1e6 * frame.time)
            last = max(time_us, last + 1)
            yield frame.to_ndarray(format="gray"), last
