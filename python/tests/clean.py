"""clean.py CLIP.y4m - tracks a clip of grey, with nothing but the wheel and numpy.

It says how many frames have a face, and how many blinks a monitor saw.
"""

import sys
from pathlib import Path

import numpy as np

import posewise

header, rest = Path(sys.argv[1]).read_bytes().split(b"\n", 1)
width, height = (int(word[1:]) for word in header.split()[1:3])
frames = np.frombuffer(rest, dtype=np.uint8).reshape(-1, len("FRAME\n") + width * height)
tracker, monitor = posewise.Tracker(natural_gaze=True), posewise.Monitor()
tracked = 0
for i, frame in enumerate(frames[:, len("FRAME\n") :]):
    result = tracker.step(frame.reshape(height, width), 50_000 * i)
    monitor.update(tracker, result.timestamp_us)
    tracked += result.state == "tracking"
print(tracked, monitor.state().blinks)
