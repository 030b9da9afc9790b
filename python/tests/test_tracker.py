import ctypes
import struct
import threading
import time

import numpy as np
import pytest

import posewise
from posewise import _layout as layout


def fnv(value, data):
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


def result_bytes(r):
    """What tests/golden.rs hashes of a result."""
    words = [layout.STATES.index(r.state), layout.LOSSES.index(r.loss), r.camera_assumed]
    scalars = [r.confidence, r.yaw_deg, r.pitch_deg, r.roll_deg, r.visible_share]
    points = np.column_stack([r.landmarks, r.landmark_confidence, r.visibility])
    arrays = [
        np.float32(scalars), r.face_box, r.rotation, r.translation_mm, r.eye_open,
        r.rotation_sigma_deg, r.translation_sigma_mm, points, r.points_mm, r.animation,
        np.float32([r.facing_yaw_deg, r.facing_pitch_deg, r.facing_roll_deg, r.focal_px]),
        r.facing_sigma_deg,
    ]
    head = bytes(words) + struct.pack("<qq", r.timestamp_us, r.age_us)
    return head + b"".join(np.ascontiguousarray(a, dtype="<f4").tobytes() for a in arrays)


def test_the_clip_gives_the_same_bits(clip, root):
    frames, frame_us = clip
    tracker = posewise.Tracker()
    value, tracked = 0xCBF29CE484222325, 0
    for i, frame in enumerate(frames):
        result = tracker.step(frame, i * frame_us)
        value = fnv(value, result_bytes(result))
        tracked += result.state == "tracking"
    found = f"{value:016x} {tracked}/{len(frames)} tracked\n"
    assert found == (root / "tests/data/demo.hash").read_text()


def test_a_person_is_remembered(clip):
    frames, frame_us = clip
    first, second = posewise.Tracker(), posewise.Tracker()
    with pytest.raises(posewise.PosewiseError) as fault:
        first.save_identity()
    assert fault.value.name == "E_NO_FACE"
    for i, frame in enumerate(frames[:60]):
        first.step(frame, i * frame_us)
    record = first.save_identity()
    assert len(record) == layout.IDENTITY_RECORD_SIZE <= 512
    second.restore_identity(record)
    assert second.compare_identity(record) == "unknown"
    for i, frame in enumerate(frames[60:]):
        second.step(frame, i * frame_us)
    assert second.compare_identity(record) in ("same", "unknown")
    wrong = bytes([*record[:-1], 1])
    damaged = {
        "E_RECORD_SIZE": record[:-1],
        "E_RECORD": record[1:],
        "E_RECORD_CHECKSUM": wrong,
    }
    for name, given in damaged.items():
        for call in (second.restore_identity, second.compare_identity):
            with pytest.raises(posewise.PosewiseError) as fault:
                call(given)
            assert fault.value.name == name
    with pytest.raises(posewise.PosewiseError) as fault:
        posewise.Tracker("research").restore_identity(record)
    assert fault.value.name == "E_RECORD_MODEL"


def test_results_have_their_shapes(clip):
    tracker = posewise.Tracker("research")
    result = None
    for i, frame in enumerate(clip[0][:10]):
        before, result = result, tracker.step(frame, i * clip[1])
    assert result.state == "tracking" and result.loss == "none"
    assert result.landmarks.shape == (68, 2) and result.points_mm.shape == (68, 3)
    assert result.animation.shape == (29,) and len(posewise.ANIMATION_NAMES) == 29
    # An earlier result stays as it was.
    assert before.timestamp_us == 8 * clip[1]
    assert not np.shares_memory(before.landmarks, result.landmarks)
    assert tracker.smoothed().state == "tracking"
    events, overwritten = tracker.events()
    assert [e.kind for e in events] == ["acquired"] and overwritten == 0
    tracker.reset()
    assert tracker.step(clip[0][0], 0).state in posewise._layout.STATES


@pytest.mark.parametrize("format, channels", [(None, 3), ("RGB3", 3), (None, 4), ("AB24", 4)])
def test_colours(clip, format, channels):
    grey, colour = posewise.Tracker(), posewise.Tracker()
    for i, frame in enumerate(clip[0][:8]):
        a = grey.step(frame, i * clip[1])
        b = colour.step(np.repeat(frame[:, :, None], channels, 2), i * clip[1], format=format)
    assert a.state == b.state == "tracking"
    assert np.abs(a.landmarks - b.landmarks).max() < 1


def test_slices_are_read_in_place(clip):
    whole, part = posewise.Tracker(), posewise.Tracker()
    for i, frame in enumerate(clip[0][:8]):
        large = np.zeros((300, 400), np.uint8)
        large[30:270, 50:370] = frame
        view = large[30:270, 50:370]
        given, pixels = posewise._arguments.frame(view, 0, None, 0, False)
        assert given.data == view.ctypes.data and pixels is view
        a = whole.step(frame, i * clip[1])
        b = part.step(view, i * clip[1])
    assert result_bytes(a) == result_bytes(b)


def test_arrays_without_adjacent_pixels_are_copied(clip):
    frames, frame_us = clip
    one, other = posewise.Tracker(), posewise.Tracker()
    for i, frame in enumerate(frames[:8]):
        a = one.step(np.ascontiguousarray(frame[:, ::-1]), i * frame_us)
        b = other.step(frame[:, ::-1], i * frame_us)
    assert result_bytes(a) == result_bytes(b)
    upside_down = posewise.Tracker()
    upside_down.step(frames[0][::-1], 0)


def test_wrong_frames_are_rejected():
    tracker = posewise.Tracker()
    shapes = [((9,), "u1"), ((4, 4), "f4"), ((4, 4, 5), "u1"), ((0, 4), "u1")]
    for wrong in [np.zeros(shape, kind) for shape, kind in shapes]:
        with pytest.raises(ValueError):
            tracker.step(wrong, 0)
    grey = np.zeros((48, 64), np.uint8)
    with pytest.raises(ValueError):
        tracker.step(grey, 0, format="BGR3")
    tracker.step(grey, 5)
    with pytest.raises(posewise.PosewiseError, match="timestamp"):
        tracker.step(grey, 5)
    with pytest.raises(posewise.PosewiseError):
        tracker.step(grey, 6, rotation_deg=45)
    for setting in ({"min_face_px": 3}, {"min_face_px": 0}, {"smoothing_hz": 0.0}):
        with pytest.raises(posewise.PosewiseError):
            posewise.Tracker(**setting)
    # None is the default, and 0 is 0.
    posewise.Tracker(min_face_px=None, smoothing_beta=0.0)
    with pytest.raises(posewise.PosewiseError):
        tracker.set_excluded([(0, 0, 9, 9)] * 17)


def test_detect_finds_the_face(clip):
    tracker = posewise.Tracker()
    faces = []
    for _ in range(200):
        detected = tracker.detect(clip[0][0])
        faces += detected.faces
        if detected.finished:
            break
    assert detected.finished and len(faces) >= 1
    x, y, width, height = faces[0].face_box
    assert 80 < x + width / 2 < 240 and 60 < y + height / 2 < 180


def test_a_group_gives_a_face_to_one_tracker(clip):
    frames, frame_us = clip
    group, trackers = posewise.Group(), [posewise.Tracker(), posewise.Tracker()]
    for i, frame in enumerate(frames[:8]):
        results = group.step(trackers, frame, i * frame_us)
    assert [result.state for result in results] == ["tracking", "searching"]
    assert results[0].landmarks[:, 0].mean() > 80
    with pytest.raises(posewise.PosewiseError, match="timestamp"):
        group.step(trackers, frames[0], 0)
    for wrong in ([], trackers * 9, [trackers[0]] * 2):
        with pytest.raises(posewise.PosewiseError):
            group.step(wrong, frames[0], 9 * frame_us)
    trackers[0].close()
    with pytest.raises(posewise.PosewiseError):
        group.step(trackers, frames[0], 9 * frame_us)
    with pytest.raises(posewise.PosewiseError):
        posewise.Tracker(network_period=9)


def test_a_hint_and_a_region(clip):
    tracker = posewise.Tracker()
    first = tracker.step(clip[0][0], 0, hint=((110, 100, 90, 90), 0.0, 0.0))
    assert first.state in layout.STATES
    tracker.set_roi((0, 0, 320, 240))
    tracker.set_roi(None)
    narrow = posewise.Tracker(roi=(0, 0, 16, 240))
    for i, frame in enumerate(clip[0][:20]):
        assert narrow.step(frame, i * clip[1]).state == "searching"
    tracker.set_intrinsics((277.0, 277.0, 159.5, 119.5))
    tracker.set_lens(("brown", (0.01, 0.0)))
    tracker.set_lens(None)
    tracker.forget_identity()


def test_two_threads_have_a_tracker_each(clip):
    frames, frame_us = clip
    alone = posewise.Tracker()
    expected = [result_bytes(alone.step(f, i * frame_us)) for i, f in enumerate(frames[:40])]
    found = [[], []]

    def follow(out):
        tracker = posewise.Tracker()
        for i, frame in enumerate(frames[:40]):
            out.append(result_bytes(tracker.step(frame, i * frame_us)))

    threads = [threading.Thread(target=follow, args=(out,)) for out in found]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected, expected]


def test_threads_may_share_a_tracker(clip):
    tracker = posewise.Tracker()
    lock, count, faults = threading.Lock(), iter(range(10**6)), []

    def follow():
        for frame in clip[0][:20]:
            try:
                with lock:
                    now = next(count)
                tracker.step(frame, now * clip[1])
            except posewise.PosewiseError:
                pass  # another thread was quicker with a later frame
            except Exception as fault:
                faults.append(fault)

    threads = [threading.Thread(target=follow) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []


def test_the_gil_is_released():
    """While one thread is in a long step, another one goes on."""
    tracker = posewise.Tracker(scan_budget=10_000_000)
    noise = np.random.default_rng(1).integers(0, 255, (2000, 2000), dtype=np.uint8)
    entered, left = [], []

    def step():
        entered.append(time.perf_counter())
        tracker.step(noise, 0)
        left.append(time.perf_counter())

    thread = threading.Thread(target=step)
    thread.start()
    ticks = []
    while thread.is_alive():
        ticks.append(time.perf_counter())
        time.sleep(0.0005)
    inside = [t for t in ticks if entered[0] < t < left[0]]
    assert len(inside) > 3


def test_the_gaze_is_given_on_request(clip):
    plain, asked = posewise.Tracker(), posewise.Tracker(gaze=True)
    known = 0
    for i, frame in enumerate(clip[0][:40]):
        without, result = (t.step(frame, i * clip[1]) for t in (plain, asked))
        assert result_bytes(without) == result_bytes(result)
        assert "known" not in without.gaze_status
        if result.gaze_status[2] == "known":
            known += 1
            assert np.linalg.norm(result.gaze, axis=1)[2] == pytest.approx(1, abs=1e-5)
            assert result.gaze_sigma_deg[2] > 0
    assert known > 0


def test_the_mesh_has_its_tables(clip):
    tracker = posewise.Tracker()
    with pytest.raises(posewise.PosewiseError) as fault:
        tracker.mesh()
    assert fault.value.name == "E_NO_FACE"
    for i, frame in enumerate(clip[0][:8]):
        result = tracker.step(frame, i * clip[1])
    picture, tables = tracker.mesh(), tracker.mesh_tables()
    count = len(picture.vertices)
    assert 400 < count <= 800 and picture.visibility.shape == (count,)
    assert tables.uvs.shape == (count, 2) and tables.triangles.max() < count
    assert (0 <= tables.uvs).all() and (tables.uvs <= 1).all()
    # Its landmarks lie where the tracker has them, but for the jaw's contour.
    inner = picture.vertices[tables.lines["landmarks"]][17:, :2]
    assert np.abs(inner - result.landmarks[17:]).max() < 3
    assert len(tables.lines) == 8 and all(len(line) > 2 for line in tables.lines.values())
    # The head frame, turned and moved, is the camera's.
    head, camera = tracker.mesh("head").vertices, tracker.mesh("camera").vertices
    assert np.ptp(camera - head, axis=0).max() < 40
    assert np.abs((camera - head).mean(0) - result.translation_mm).max() < 20
    with pytest.raises(ValueError, match="a space is one of picture, camera, head"):
        tracker.mesh("face")


def test_shapes_are_of_the_persons_own_head(clip):
    tracker = posewise.Tracker()
    with pytest.raises(posewise.PosewiseError) as fault:
        tracker.mesh_shape()
    assert fault.value.name == "E_NO_FACE"
    for i, frame in enumerate(clip[0][:8]):
        result = tracker.step(frame, i * clip[1])
    neutral = tracker.mesh_shape()
    assert neutral.shape == tracker.mesh("head").vertices.shape
    moved = {name: tracker.mesh_shape(name) - neutral for name in posewise.ANIMATION_NAMES}
    # Every weight moves something by millimetres; an open jaw moves the chin, vertex 8, down.
    assert all(1 < np.abs(move).max() < 60 for move in moved.values())
    assert moved["jawOpen"][8, 1] > 5
    # The face is the neutral one with its weights, but for what landmarks drew.
    face = neutral + sum(w * m for w, m in zip(result.animation, moved.values()))
    assert np.abs(face - tracker.mesh("head").vertices).mean() < 3
    with pytest.raises(ValueError, match="a shape is one of neutral, browDownLeft"):
        tracker.mesh_shape("jawopen")


def test_structs_are_those_of_c():
    # Sizes on machines with 64-bit pointers; the header's test has the rest.
    sizes = {"Config": 88, "Intrinsics": 16, "Lens": 24, "Landmark": 28, "Event": 40, "Roi": 16}
    assert {name: ctypes.sizeof(getattr(layout, name)) for name in sizes} == sizes
