"""Road grade of heavy vehicles from recordings of their bus.

    run = roadgrade.estimate("monday.log", "vehicle.toml")
    frame = pyarrow.table(run).to_pandas()

`read_log` and `read_frames` read recordings, `identify` finds the vehicle, `estimate` the grade of a
drive, and `fuse` makes a map of many. Tables, runs and maps have the PyCapsule interface of Arrow, so
pyarrow, polars, pandas, GeoPandas and DuckDB take them without a copy. Messages go to the logger
"roadgrade". Ctrl-C stops long work; other threads go on meanwhile.
"""

from ._native import (
    Error,
    Map,
    Run,
    Table,
    Vehicle,
    __version__,
    estimate,
    fuse,
    identify,
    read_frames,
    read_log,
    read_map,
)

__all__ = [
    "Error",
    "Map",
    "Run",
    "Table",
    "Vehicle",
    "__version__",
    "estimate",
    "fuse",
    "identify",
    "read_frames",
    "read_log",
    "read_map",
]
