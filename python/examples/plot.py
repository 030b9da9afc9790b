"""plot.py VIDEO OUT.png - plots angles, eye openness and confidence over time, with matplotlib."""

import sys

import matplotlib
import numpy as np

import posewise

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402


def main():
    video, out = sys.argv[1:]
    results = [r for _, r in posewise.track(video) if r.state == "tracking"]
    seconds = [r.timestamp_us / 1e6 for r in results]
    figure, (angles, shares) = plt.subplots(2, sharex=True, figsize=(8, 6))
    for name in ("yaw", "pitch", "roll"):
        angles.plot(seconds, [getattr(r, f"{name}_deg") for r in results], label=name)
    angles.set_ylabel("angle [deg]")
    eyes = np.array([r.eye_open for r in results]).reshape(-1, 2)
    eyes[eyes < 0] = np.nan  # unknown
    shares.plot(seconds, eyes[:, 0], label="left eye open")
    shares.plot(seconds, eyes[:, 1], label="right eye open")
    shares.plot(seconds, [r.confidence for r in results], label="confidence")
    shares.set_xlabel("time [s]")
    for axes in (angles, shares):
        axes.legend(loc="upper right")
        axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(out)


if __name__ == "__main__":
    main()
