"""overlay.py VIDEO OUT.mp4 - draws landmarks, axes and angles into a video, with OpenCV."""

import sys

import cv2
import numpy as np

import posewise


def draw(frame, result):
    """Draws a result into its frame."""
    if result.state == "searching":
        return
    for (x, y), confidence in zip(result.landmarks, result.landmark_confidence):
        color = (0, int(255 * confidence), int(255 * (1 - confidence)))
        cv2.circle(frame, (round(float(x)), round(float(y))), 1, color, -1)
    # The camera that the tracker assumes: 60 degrees across.
    height, width = frame.shape[:2]
    focal = width / 2 / np.tan(np.pi / 6)
    camera = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    x, y, z, w = result.rotation.astype(float)
    axes = 60.0 * np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    axes[:, 2] *= -1  # out of the face
    origin = result.translation_mm.astype(float)
    ends = camera @ np.column_stack([origin, origin[:, None] + axes])
    points = (ends[:2] / ends[2]).round().astype(int).T
    for end, color in zip(points[1:], [(60, 60, 255), (60, 220, 60), (255, 120, 80)]):
        cv2.line(frame, points[0].tolist(), end.tolist(), color, 2)
    text = f"{result.yaw_deg:+.0f} {result.pitch_deg:+.0f} {result.roll_deg:+.0f}"
    cv2.putText(frame, text, (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1)


def main():
    video, out = sys.argv[1:]
    rate = cv2.VideoCapture(video).get(cv2.CAP_PROP_FPS) or 30.0
    writer = None
    for frame, result in posewise.track(video):
        draw(frame, result)
        if writer is None:
            size = (frame.shape[1], frame.shape[0])
            writer = cv2.VideoWriter(out, cv2.VideoWriter_fourcc(*"mp4v"), rate, size)
        writer.write(frame)
    if writer is not None:
        writer.release()


if __name__ == "__main__":
    main()
