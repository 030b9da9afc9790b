"""The tables of benches/peer_tables.py: angles, lines of sight, columns."""

import csv
import math
import types

import numpy as np
import pytest

pytest.importorskip("cv2")


@pytest.fixture
def tables(root, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "benches"))
    import peer_tables

    return peer_tables


def rotation(yaw, pitch, roll):
    """R = Ry(-yaw) Rx(-pitch) Rz(roll), as docs/conventions.md has it."""
    y, p, r = (math.radians(a) for a in (-yaw, -pitch, roll))
    about_y = [[math.cos(y), 0, math.sin(y)], [0, 1, 0], [-math.sin(y), 0, math.cos(y)]]
    about_x = [[1, 0, 0], [0, math.cos(p), -math.sin(p)], [0, math.sin(p), math.cos(p)]]
    about_z = [[math.cos(r), -math.sin(r), 0], [math.sin(r), math.cos(r), 0], [0, 0, 1]]
    return np.array(about_y) @ about_x @ about_z


@pytest.mark.parametrize("angles", [(90, 0, 0), (-30, 20, 10), (5, -40, -100), (0, 0, 0)])
def test_angles_are_those_of_the_conventions(tables, angles):
    assert tables.angles(rotation(*angles)) == pytest.approx(angles, abs=1e-9)


def test_the_line_of_sight_turns_the_axis(tables):
    camera = tables.Camera(600.0, 641, 481)
    turned = tables.sight(camera, np.array([320 + 600.0, 240.0]))
    assert turned @ [0, 0, 1] == pytest.approx([math.sqrt(0.5), 0, math.sqrt(0.5)])
    assert tables.sight(camera, np.array([320.0, 240.0])) == pytest.approx(np.eye(3))


def test_a_table_has_a_row_per_frame(tables, tmp_path, monkeypatch):
    frames = [np.zeros((4, 6), np.uint8)] * 3
    found = iter([None, (rotation(10, 0, 0), np.arange(136.0).reshape(68, 2)), None])
    monkeypatch.setattr(tables, "frames", lambda _: iter(frames))
    monkeypatch.setitem(tables.SYSTEMS, "test", lambda *_: lambda _: next(found))
    arguments = types.SimpleNamespace(frames=10)
    path = tmp_path / "test/clip.csv"
    assert tables.write(path, "test", tmp_path / "clip.mp4", arguments) == 1
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["success"] for row in rows] == ["0", "1", "0"]
    assert (rows[1]["yaw_deg"], rows[1]["x_67"]) == ("10.0000", "134.000")
    assert all(None not in row.values() and None not in row for row in rows)


def test_the_focal_length_is_that_of_the_truth(tables, tmp_path):
    grey = np.zeros((480, 640), np.uint8)
    clip = tmp_path / "clip.y4m.gz"
    assert tables.camera_of(clip, grey).focal == pytest.approx(640 * 0.8660254)
    (tmp_path / "clip.csv").write_text("frame,fx\n0,600.0\n")
    assert tables.camera_of(clip, grey).focal == 600
