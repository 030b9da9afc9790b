"""facing.py TABLES - spans of 2 s and more in which somebody faces the camera within 15 degrees.

TABLES is a pattern of Parquet files from `posewise index` or index_cluster.py: 'out/**/*.parquet'.
Needs duckdb. The query alone also runs in DuckDB's own shell.
"""

import sys

import duckdb

QUERY = """
WITH angles AS (
    -- The nose points along (sin yaw cos pitch, -sin pitch, -cos yaw cos pitch); the camera lies
    -- in the direction -(Tx, Ty, Tz) from the head.
    SELECT filename, timestamp, success = 1 AND degrees(acos(greatest(-1, least(1,
        (sin(radians(pitch_deg)) * pose_Ty
         + cos(radians(pitch_deg)) * (cos(radians(yaw_deg)) * pose_Tz
                                      - sin(radians(yaw_deg)) * pose_Tx))
        / greatest(1e-6, sqrt(pose_Tx ** 2 + pose_Ty ** 2 + pose_Tz ** 2)))))) <= $degrees
        AS is_facing
    FROM read_parquet($tables, filename = true)
), runs AS (
    -- Frames in a row that agree have the same difference of two numberings.
    SELECT *, row_number() OVER (PARTITION BY filename ORDER BY timestamp)
        - row_number() OVER (PARTITION BY filename, is_facing ORDER BY timestamp) AS run
    FROM angles
)
SELECT filename, min(timestamp) AS start_s, max(timestamp) AS end_s, count(*) AS frames
FROM runs WHERE is_facing
GROUP BY filename, run HAVING max(timestamp) - min(timestamp) >= $seconds
ORDER BY filename, start_s
"""


def spans(tables, degrees=15.0, seconds=2.0):
    """File, start [s], end [s] and number of frames of each span."""
    values = {"tables": str(tables), "degrees": degrees, "seconds": seconds}
    return duckdb.execute(QUERY, values).fetchall()


def main():
    for filename, start, end, frames in spans(sys.argv[1]):
        print(f"{filename}: {start:.2f} s to {end:.2f} s, {frames} frames")


if __name__ == "__main__":
    main()
