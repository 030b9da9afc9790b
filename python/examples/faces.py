"""faces.py VIDEO - tracks each face of the first frame with a tracker of its own."""

import sys

import posewise


def found(frame):
    """The faces of a frame, the largest first."""
    finder, faces, finished = posewise.Tracker(), [], False
    while not finished:
        # A later call may find a face again.
        finder.set_excluded([face.face_box for face in faces])
        detected = finder.detect(frame)
        faces += detected.faces
        finished = detected.finished
    return sorted(faces, key=lambda face: -face.face_box[2] * face.face_box[3])


def main():
    group, trackers, results = posewise.Group(), [], []
    for frame, largest in posewise.track(sys.argv[1]):
        timestamp_us = largest.timestamp_us
        if trackers:
            results = group.step(trackers, frame, timestamp_us)
            continue
        for face in found(frame):
            trackers.append(posewise.Tracker())
            hint = (face.face_box, face.yaw_deg, face.roll_deg)
            results.append(trackers[-1].step(frame, timestamp_us, hint=hint))
        print(f"{len(trackers)} faces")
    for i, result in enumerate(results):
        box = ", ".join(f"{number:.0f}" for number in result.face_box)
        print(f"face {i}: {result.state} at {box}, yaw {result.yaw_deg:.0f}")


if __name__ == "__main__":
    main()
