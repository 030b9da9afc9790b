"""index_cluster.py FOLDER OUT [SCHEDULER] - tracks a folder's videos on a cluster of machines.

Needs dask[distributed], pyarrow, and a folder that all machines share. Without SCHEDULER
(tcp://HOST:8786, see `dask scheduler` and `dask worker`) the workers are processes of this machine.
Each video gives a Parquet file with the columns of `posewise track --csv`. A worker may die at any
time: Dask gives its video to another one, and a file has its name only when it is complete. What is
there is left alone, so the same command goes on where it was stopped.
"""

import os
import socket
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import posewise

ENDINGS = {".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpg", ".ts", ".webm"}


def openface_angles(result):
    """pose_Rx, pose_Ry, pose_Rz [rad]: R = Rx Ry Rz."""
    if result.state == "searching":
        return np.zeros(3, np.float32)
    x, y, z, w = result.rotation
    return np.array(
        [
            np.arctan2(2 * (x * w - y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(np.clip(2 * (x * z + y * w), -1, 1)),
            np.arctan2(2 * (z * w - x * y), 1 - 2 * (y * y + z * z)),
        ],
        np.float32,
    )


def each(name):
    return [f"{name}_{i}" for i in range(68)]


#: Groups of columns: names, type, values.
GROUPS = [
    (["timestamp"], pa.float64(), lambda r: [r.timestamp_us / 1e6]),
    (["confidence"], pa.float32(), lambda r: [r.confidence]),
    (["success"], pa.int64(), lambda r: [int(r.state == "tracking")]),
    (["pose_Tx", "pose_Ty", "pose_Tz"], pa.float32(), lambda r: r.translation_mm),
    (["pose_Rx", "pose_Ry", "pose_Rz"], pa.float32(), openface_angles),
    (each("x") + each("y"), pa.float32(), lambda r: r.landmarks.T.ravel()),
    (each("X") + each("Y") + each("Z"), pa.float32(), lambda r: r.points_mm.T.ravel()),
    (["state"], pa.string(), lambda r: [r.state]),
    (["yaw_deg", "pitch_deg", "roll_deg"], pa.float32(),
     lambda r: [r.yaw_deg, r.pitch_deg, r.roll_deg]),
    (each("c"), pa.float32(), lambda r: r.landmark_confidence),
    (each("vis"), pa.float32(), lambda r: r.visibility),
    (["eye_open_left", "eye_open_right"], pa.float32(), lambda r: r.eye_open),
    (list(posewise.ANIMATION_NAMES), pa.float32(), lambda r: r.animation),
    (["box_x", "box_y", "box_w", "box_h"], pa.float32(), lambda r: r.face_box),
    (["age_us"], pa.int64(), lambda r: [r.age_us]),
    (["loss"], pa.string(), lambda r: [r.loss]),
    (["visible_share"], pa.float32(), lambda r: [r.visible_share]),
    (["R_sigma_x", "R_sigma_y", "R_sigma_z"], pa.float32(), lambda r: r.rotation_sigma_deg),
    (["T_sigma_x", "T_sigma_y", "T_sigma_z"], pa.float32(), lambda r: r.translation_sigma_mm),
    (["facing_yaw_deg", "facing_pitch_deg", "facing_roll_deg"], pa.float32(),
     lambda r: [r.facing_yaw_deg, r.facing_pitch_deg, r.facing_roll_deg]),
    (["facing_yaw_sigma", "facing_pitch_sigma", "facing_roll_sigma"], pa.float32(),
     lambda r: r.facing_sigma_deg),
]


def table(results):
    """The results of a video, in their order."""
    whole = np.arange(1, len(results) + 1)
    columns = {"frame": pa.array(whole), "face_id": pa.array(np.zeros_like(whole))}
    for names, kind, values in GROUPS:
        rows = [values(r) for r in results]
        for i, name in enumerate(names):
            columns[name] = pa.array([row[i] for row in rows], kind)
    return pa.table(columns)


def index(video, out):
    """Tracks one video, on a worker; gives its number of frames, or why there are none."""
    video, out = Path(video), Path(out)
    if out.exists():
        return pq.read_metadata(out).num_rows
    try:
        results = [result for _, result in posewise.track(video)]
    except OSError as error:
        return str(error)
    if not results:
        return f"{video}: no frames"
    out.parent.mkdir(parents=True, exist_ok=True)
    # Of its own for each attempt: a worker that is only believed dead may still write.
    temporary = out.with_name(f".{out.name}.{socket.gethostname()}-{os.getpid()}")
    pq.write_table(table(results), temporary)
    os.replace(temporary, out)
    return len(results)


def index_all(client, folder, out):
    """Yields each video with what `index` gave, in the order in which they are done."""
    from dask.distributed import as_completed

    folder, out = Path(folder), Path(out)
    videos = sorted(p for p in folder.rglob("*") if p.suffix.lower() in ENDINGS)
    futures = {}
    for video in videos:
        to = out / f"{video.relative_to(folder)}.parquet"
        # Three workers may die on a video before it is given up; a video is tracked once.
        future = client.submit(index, str(video), str(to), pure=False, retries=2)
        futures[future] = video
    for future in as_completed(futures):
        error = future.exception()
        yield futures[future], future.result() if error is None else str(error)


def main():
    from dask.distributed import Client, LocalCluster

    folder, out, *scheduler = sys.argv[1:]
    cluster = scheduler[0] if scheduler else LocalCluster(threads_per_worker=1)
    broken = 0
    with Client(cluster) as client:
        for video, found in index_all(client, folder, out):
            broken += isinstance(found, str)
            print(f"{video}: {found if isinstance(found, str) else f'{found} frames'}")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
