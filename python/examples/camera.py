"""camera.py VIDEO - what a program says about its camera, and what it can ask of a tracker."""

import sys

import posewise


def main():
    info = posewise.model_info("posewise")
    print(f"{info.name}: terms {info.terms}, sections {' '.join(info.sections)}")
    print(f"library {posewise.__version__} with {', '.join(posewise.PARTS)}")
    usual = posewise.default_config()
    tracker = posewise.Tracker(
        "posewise",
        min_face_px=usual.min_face_px + 8,
        scan_budget=2 * usual.scan_budget,
        intrinsics=(277.0, 277.0, 159.5, 119.5),
        lens=("brown", (0.01, 0.0)),
        gaze=True,
    )
    # Faces are found in the middle of the picture only.
    tracker.set_roi((40, 20, 240, 200))
    for i, (frame, result) in enumerate(posewise.track(sys.argv[1], tracker)):
        if i == 10:
            # The camera zooms out, somebody else sits down, and faces are found everywhere.
            tracker.set_lens(None)
            tracker.set_intrinsics(None)
            tracker.set_roi(None)
            person = tracker.save_identity()
            tracker.forget_identity()
            # Somebody else looks like the person before, until more is seen.
            tracker.restore_identity(person)
        for event in tracker.events()[0]:
            print(f"{event.timestamp_us} us: {event.kind}, {event.loss}")
    print(f"a head of the same shape as before: {tracker.compare_identity(person)}")
    smooth = tracker.smoothed()
    print(f"yaw {result.yaw_deg:.1f}, smoothed {smooth.yaw_deg:.1f}")
    x, y, z = result.gaze[2]
    sigma = result.gaze_sigma_deg[2]
    print(f"gaze {result.gaze_status[2]}: along {x:.2f} {y:.2f} {z:.2f}, to {sigma:.1f} degrees")
    weights = zip(posewise.ANIMATION_NAMES, result.animation)
    name, weight = max(weights, key=lambda pair: pair[1])
    print(f"{name} {weight:.2f}; {posewise.EYE_LOOK_NAMES[0]} {result.eye_look[0]:.2f}")
    mesh, tables = tracker.mesh("camera"), tracker.mesh_tables()
    print(f"{len(mesh.vertices)} vertices, {len(tables.triangles)} triangles")
    # The person's own head, and how an open jaw changes it: a morph target.
    moved = tracker.mesh_shape("jawOpen") - tracker.mesh_shape()
    print(f"an open jaw moves vertices by up to {abs(moved).max():.0f} mm")
    # For another video.
    tracker.reset()
    tracker.close()


if __name__ == "__main__":
    main()
