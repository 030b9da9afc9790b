import runpy
import sys

import numpy as np
import pytest
from conftest import write_video

import posewise

cv2 = pytest.importorskip("cv2")


@pytest.fixture
def video(clip, tmp_path):
    write_video(tmp_path / "clip.avi", clip[0][:40])
    return tmp_path / "clip.avi"


def test_track_yields_each_frame(video):
    found = list(posewise.track(video))
    assert len(found) == 40
    assert sum(r.state == "tracking" for _, r in found) >= 34
    times = [r.timestamp_us for _, r in found]
    assert times == sorted(set(times)) and abs(times[-1] - 39 * 50_000) < 1000


def test_pyav_reads_it_where_opencv_is_missing(video, monkeypatch):
    pytest.importorskip("av")
    monkeypatch.setitem(sys.modules, "cv2", None)
    found = list(posewise.track(str(video)))
    assert len(found) == 40 and found[0][0].ndim == 2
    assert sum(r.state == "tracking" for _, r in found) >= 34
    assert abs(found[-1][1].timestamp_us - 39 * 50_000) < 1000


def test_a_missing_video_is_an_error(tmp_path):
    with pytest.raises(OSError):
        next(posewise.track(tmp_path / "none.mp4"))


def run(monkeypatch, root, name, *arguments):
    monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
    runpy.run_path(str(root / "python/examples" / name), run_name="__main__")


def test_the_overlay_example(monkeypatch, root, video, tmp_path):
    out = tmp_path / "out.mp4"
    run(monkeypatch, root, "overlay.py", video, out)
    capture = cv2.VideoCapture(str(out))
    assert int(capture.get(cv2.CAP_PROP_FRAME_COUNT)) == 40


def test_the_plot_example(monkeypatch, root, video, tmp_path):
    pytest.importorskip("matplotlib")
    out = tmp_path / "out.png"
    run(monkeypatch, root, "plot.py", video, out)
    assert out.stat().st_size > 10_000


def test_the_drive_example(monkeypatch, root, video, capsys):
    run(monkeypatch, root, "drive.py", video, "euro-ncap")
    said = capsys.readouterr().out
    assert "blink from 0.4" in said and "P80 over 60 s: " in said


def test_the_camera_example(monkeypatch, root, video, capsys):
    run(monkeypatch, root, "camera.py", video)
    said = capsys.readouterr().out
    assert "terms free" in said and "acquired, none" in said and "\ngaze " in said


def test_the_example_of_several_faces(monkeypatch, root, clip, tmp_path, capsys):
    # The clip twice, side by side and not at the same time of it.
    pairs = [np.hstack([a, b]) for a, b in zip(clip[0][:30], clip[0][20:50])]
    write_video(tmp_path / "two.avi", pairs)
    run(monkeypatch, root, "faces.py", tmp_path / "two.avi")
    said = capsys.readouterr().out
    assert said.startswith("2 faces") and said.count(": tracking at") == 2
