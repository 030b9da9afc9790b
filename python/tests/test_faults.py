"""What a caller can do wrong is said, and does no harm."""

import os
import signal
import threading
import time
import zlib

import numpy as np
import pytest
from numpy.lib.stride_tricks import as_strided

import posewise

GREY = np.zeros((48, 64), np.uint8)


@pytest.mark.parametrize("timestamp_us", [2**63, -(2**63) - 1, 2**64, 10**30])
def test_times_do_not_wrap(timestamp_us):
    tracker = posewise.Tracker()
    with pytest.raises(ValueError, match="timestamp_us must be"):
        tracker.step(GREY, timestamp_us)
    # Nothing was processed, so any time may follow.
    assert tracker.step(GREY, -(2**63)).timestamp_us == -(2**63)
    assert tracker.step(GREY, np.int64(5)).timestamp_us == 5


@pytest.mark.parametrize(
    "setting",
    [{"min_face_px": 2**32 + 40}, {"min_face_px": -1}, {"scan_budget": 2**32 + 1000}],
)
def test_settings_do_not_wrap(setting):
    with pytest.raises(ValueError, match=f"{next(iter(setting))} must be"):
        posewise.Tracker(**setting)
    with pytest.raises(TypeError):
        posewise.Tracker(**dict.fromkeys(setting, 40.5))


def test_regions_and_rotations_do_not_wrap():
    tracker = posewise.Tracker()
    with pytest.raises(ValueError, match="rotation_deg must be"):
        tracker.step(GREY, 0, rotation_deg=2**32 + 90)
    with pytest.raises(ValueError, match="roi must be"):
        tracker.set_roi((2**32, 0, 64, 48))


@pytest.mark.parametrize("shape", [(1, 2**32 + 64), (2**32 + 48, 1)])
def test_sizes_do_not_wrap(shape):
    # It takes one byte; a copy would take 4 GiB.
    frame = as_strided(np.zeros(1, np.uint8), shape, (0, 0))
    with pytest.raises(ValueError, match="must be"):
        posewise.Tracker().step(frame, 0)


def test_rows_may_be_far_apart():
    stride = 2**32 + 64
    # Only what is touched takes memory.
    frame = np.zeros((2, stride), np.uint8)[:, :64]
    frame[1] = 7
    given, pixels = posewise._arguments.frame(frame, 0, None, 0, False)
    assert given.stride == 64 and given.data_len == 128 and (pixels == frame).all()
    one = as_strided(np.zeros(64, np.uint8), (1, 64), (stride, 1))
    given, _ = posewise._arguments.frame(one, 0, None, 0, False)
    assert given.stride == 64 and given.data_len == 64


@pytest.mark.parametrize("numbers", [(500.0, 500.0), (500.0,) * 5, ()])
def test_lists_have_their_lengths(numbers):
    tracker = posewise.Tracker()
    with pytest.raises(ValueError, match="intrinsics must have 4 numbers"):
        tracker.set_intrinsics(numbers)
    with pytest.raises(ValueError, match="intrinsics must have 4 numbers"):
        posewise.Tracker(intrinsics=numbers)
    with pytest.raises(ValueError, match="box of a hint must have 4 numbers"):
        tracker.step(GREY, 0, hint=(numbers, 0.0, 0.0))
    with pytest.raises(ValueError, match="roi must have 4 numbers"):
        tracker.set_roi([int(n) for n in numbers])
    # Two rows of six are no three boxes.
    for boxes in [[(9.0,) * 6] * 2, [(9.0,) * 2] * 2, [9.0] * 4]:
        with pytest.raises(ValueError, match="boxes are rows"):
            tracker.set_excluded(boxes)
    tracker.set_excluded([])


def test_lenses_are_known():
    with pytest.raises(ValueError, match="pinhole, brown, fisheye"):
        posewise.Tracker(intrinsics=(60, 60, 32, 24), lens=("fish-eye", ()))
    with pytest.raises(ValueError, match="at most 5"):
        posewise.Tracker(intrinsics=(60, 60, 32, 24), lens=("brown", (0.0,) * 6))


def wait(child, seconds):
    """The exit status of a child, which is killed if it takes longer."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pid, status = os.waitpid(child, os.WNOHANG)
        if pid:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return "hangs"


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_child_may_be_forked_while_a_thread_steps():
    tracker = posewise.Tracker(scan_budget=10_000_000)
    noise = np.random.default_rng(1).integers(0, 255, (1500, 1500), dtype=np.uint8)
    going, is_over = threading.Event(), threading.Event()

    def steps():
        now = 0
        while not is_over.is_set():
            going.set()
            tracker.step(noise, now)
            now += 1

    thread = threading.Thread(target=steps)
    thread.start()
    going.wait()
    try:
        for _ in range(3):
            time.sleep(0.05)
            child = os.fork()
            if child == 0:
                ok = tracker.step(GREY, 10**9).state == "searching"
                ok = ok and posewise.Tracker().step(GREY, 0).state == "searching"
                os._exit(0 if ok else 1)
            assert wait(child, 30) == 0
    finally:
        is_over.set()
        thread.join()


def test_models_say_their_names_terms_and_faults(tmp_path, root):
    info = posewise.model_info()
    assert (info.name, info.terms) == ("posewise.posewise", "free")
    assert "ALGN" in info.sections and "Trained on" in info.sheet
    assert info.check == "" and info.wrong_section == ""
    assert posewise.model_info("research").name == "research.posewise"
    assert "keyframes" in posewise.PARTS
    whole = bytearray((root / "models/posewise.posewise").read_bytes())
    assert info.length == len(whole)
    # A section of another name, in a file that is whole.
    table = whole.index(b"ALGN")
    whole[table : table + 4] = b"ABCD"
    whole[16:20] = zlib.crc32(whole[64:]).to_bytes(4, "little")
    spoilt = tmp_path / "spoilt.posewise"
    spoilt.write_bytes(whole)
    info = posewise.model_info(spoilt)
    assert (info.name, info.wrong_section) == ("posewise.posewise", "ALGN")
    assert info.check == "the section is missing"
    with pytest.raises(posewise.PosewiseError, match="ALGN: the section is missing"):
        posewise.Tracker(spoilt)
    spoilt.write_bytes(b"")
    assert posewise.model_info(spoilt).check == "truncated"
