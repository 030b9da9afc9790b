"""faces.py VIDEO - tracks each face of the first frame with a tracker of its own.

A tracker that has no face leaves those alone that the others have. ffi-examples/faces.c also says
who has the face where two come to the same one.
"""

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


def step(trackers, results, own, frame, timestamp_us, hint=None):
    """Steps one of the trackers, away from the faces of the others."""
    others = [r.face_box for i, r in results.items() if i != own and r.state == "tracking"]
    has_face = own in results and results[own].state == "tracking"
    trackers[own].set_excluded([] if has_face else others)
    results[own] = trackers[own].step(frame, timestamp_us, hint=hint)


def main():
    trackers, results = [], {}
    for frame, largest in posewise.track(sys.argv[1]):
        timestamp_us = largest.timestamp_us
        if not trackers:
            faces = found(frame)
            print(f"{len(faces)} faces")
            trackers = [posewise.Tracker() for _ in faces]
            for i, face in enumerate(faces):
                hint = (face.face_box, face.yaw_deg, face.roll_deg)
                step(trackers, results, i, frame, timestamp_us, hint)
            continue
        # Those that have a face go first.
        order = sorted(results, key=lambda i: results[i].state != "tracking")
        for i in order:
            step(trackers, results, i, frame, timestamp_us)
    for i, result in sorted(results.items()):
        box = ", ".join(f"{number:.0f}" for number in result.face_box)
        print(f"face {i}: {result.state} at {box}, yaw {result.yaw_deg:.0f}")


if __name__ == "__main__":
    main()
