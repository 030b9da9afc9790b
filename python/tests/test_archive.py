"""The recipes for archives of video: a cluster, one of whose workers is killed, and a query."""

import os
import runpy
import shutil
import signal

import numpy as np
import pytest
from conftest import write_video

pa = pytest.importorskip("pyarrow", reason="skipped: no pyarrow")
pq = pytest.importorskip("pyarrow.parquet")


@pytest.fixture
def recipe(root, monkeypatch):
    """index_cluster.py as a module, which workers import too."""
    folder = str(root / "python/examples")
    monkeypatch.syspath_prepend(folder)
    path = os.environ.get("PYTHONPATH", "")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([folder, path]))
    import index_cluster

    return index_cluster


def test_columns_are_those_of_the_command(clip, recipe, root, tmp_path):
    video, out = tmp_path / "a.avi", tmp_path / "a.parquet"
    write_video(video, clip[0][:5])
    assert recipe.index(video, out) == 5
    docs = (root / "docs/command-line.md").read_text()
    for name in pq.read_schema(out).names:
        base = name.rstrip("0123456789")
        documented = f"`{base}0`" if base.endswith("_") else f"`{name}`"
        assert documented in docs, name


def test_a_cluster_that_loses_a_worker_gives_the_same_rows(clip, recipe, tmp_path, capfd):
    distributed = pytest.importorskip("distributed", reason="skipped: no dask[distributed]")
    videos, whole, single = (tmp_path / name for name in ("videos", "whole", "single"))
    videos.mkdir()
    for i in range(6):
        write_video(videos / f"{i}.avi", clip[0][4 * i : 4 * i + 60])
    (videos / "broken.avi").write_bytes(b"no video")
    for video in sorted(videos.glob("[0-9].avi")):
        assert recipe.index(video, single / f"{video.name}.parquet") == 60

    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    )
    with cluster, distributed.Client(cluster) as client:
        workers = client.run(os.getpid)
        assert len(workers) == 2
        found = {}
        for video, frames in recipe.index_all(client, videos, whole):
            if not found:
                # One that is busy: all but the first few videos are still to come.
                busy = [w for w, tasks in client.processing().items() if tasks]
                os.kill(workers[busy[0]], signal.SIGKILL)
            found[video.name] = frames
    assert "broken.avi" in found.pop("broken.avi")
    assert found == {f"{i}.avi": 60 for i in range(6)}
    for path in sorted(single.iterdir()):
        assert pq.read_table(whole / path.name).equals(pq.read_table(path)), path.name
    assert sorted(p.name for p in whole.glob("*.parquet")) == sorted(os.listdir(single))

    # Again: nothing is tracked twice.
    before = {p: p.stat().st_mtime_ns for p in whole.glob("*.parquet")}
    assert recipe.index(videos / "0.avi", whole / "0.avi.parquet") == 60
    assert before == {p: p.stat().st_mtime_ns for p in whole.glob("*.parquet")}


def test_the_query_finds_spans_that_face_the_camera(root, tmp_path):
    pytest.importorskip("duckdb", reason="skipped: no duckdb")
    query = runpy.run_path(str(root / "python/examples/facing.py"))
    # Twenty frames a second: away, 2.5 s towards a camera that is to the side, a frame away, 1 s
    # towards it.
    yaw = [40.0] * 10 + [-45.0] * 51 + [40.0] + [-45.0] * 21
    count = len(yaw)
    columns = {
        "timestamp": np.arange(count) / 20,
        "success": np.ones(count, np.int64),
        "yaw_deg": np.array(yaw, np.float32),
        "pitch_deg": np.zeros(count, np.float32),
        "pose_Tx": np.full(count, 500, np.float32),
        "pose_Ty": np.zeros(count, np.float32),
        "pose_Tz": np.full(count, 500, np.float32),
    }
    pq.write_table(pa.table(columns), tmp_path / "a.parquet")
    shutil.copy(tmp_path / "a.parquet", tmp_path / "b.parquet")
    found = query["spans"](tmp_path / "*.parquet")
    assert [(os.path.basename(f), *rest) for f, *rest in found] == [
        ("a.parquet", 0.5, 3.0, 51),
        ("b.parquet", 0.5, 3.0, 51),
    ]
    assert query["spans"](tmp_path / "a.parquet", seconds=0.5)[1][1:] == (3.1, 4.1, 21)
