from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypedDict, final

__all__ = [
    "Error",
    "Run",
    "estimate",
    "Map",
    "fuse",
    "read_map",
    "Vehicle",
    "identify",
    "read_frames",
    "read_log",
    "Table",
    "__version__",
]

_Path = str | PathLike[str]

__version__: str

class Error(Exception):
    """An input cannot be used. The text names the file, the line if there is one, and what was
    expected."""

    path: Path | None
    """The file."""
    line: int | None
    """Its line, from 1."""

class _Value(TypedDict):
    key: str
    value: float
    sigma: float
    origin: str

class _Unknown(TypedDict):
    what: str
    advice: str

class _Warning(TypedDict):
    code: str
    message: str
    advice: str

@final
class Table:
    """Columns of numbers, texts and geometries, for any library that reads Arrow."""

    @property
    def column_names(self) -> list[str]: ...
    @property
    def num_rows(self) -> int: ...
    @property
    def metadata(self) -> dict[str, str]: ...
    def __len__(self) -> int: ...
    def __arrow_c_schema__(self) -> object: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

@final
class Vehicle:
    """A vehicle: its parameters, and where they come from if it was identified."""

    @staticmethod
    def read(path: _Path) -> Vehicle: ...
    @staticmethod
    def from_dict(tables: dict[str, Any]) -> Vehicle: ...
    @property
    def name(self) -> str: ...
    @property
    def toml(self) -> str: ...
    @property
    def values(self) -> list[_Value]: ...
    @property
    def unknown(self) -> list[_Unknown]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def save(self, path: _Path) -> None: ...

@final
class Run:
    """A run: one drive with its grade. It is itself a table of its cells."""

    @property
    def cells(self) -> Table: ...
    @property
    def verdict(self) -> str: ...
    @property
    def counters(self) -> dict[str, int]: ...
    @property
    def warnings(self) -> list[_Warning]: ...
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def vehicle(self) -> Vehicle: ...
    def save(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

@final
class Map:
    """A map of grades. It is itself a table of its cells."""

    @property
    def cells(self) -> Table: ...
    def save(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

def read_log(
    log: _Path,
    *,
    strict: bool = False,
    interfaces: Sequence[str] | None = None,
    ignore: Sequence[str] | None = None,
    dbc: _Path | None = None,
    signals: _Path | None = None,
) -> Table:
    """Read the signals of a log: one row for each time, one column for each signal that occurs."""

def read_frames(
    log: _Path, *, strict: bool = False, interfaces: Sequence[str] | None = None
) -> Table:
    """Read the frames of a log as they were on the bus, in the order of time."""

def identify(
    logs: _Path | Sequence[_Path],
    *,
    like: _Path | None = None,
    tuning: _Path | None = None,
    strict: bool = False,
    interfaces: Sequence[str] | None = None,
    ignore: Sequence[str] | None = None,
    dbc: _Path | None = None,
    signals: _Path | None = None,
) -> Vehicle:
    """Identify the vehicle that these logs ask for."""

def estimate(
    log: _Path | Sequence[_Path],
    vehicle: Vehicle | dict[str, Any] | _Path | None = None,
    *,
    day: str | None = None,
    map: _Path | None = None,
    tuning: _Path | None = None,
    double: bool = False,
    strict: bool = False,
    interfaces: Sequence[str] | None = None,
    ignore: Sequence[str] | None = None,
    dbc: _Path | None = None,
    signals: _Path | None = None,
) -> Run:
    """Estimate the grade of one recorded drive."""

def fuse(
    runs: _Path | Run | Sequence[_Path | Run],
    *,
    road: _Path | None = None,
    sessions: Mapping[str, _Path | Run | Sequence[_Path | Run]] | None = None,
    strict: bool = False,
) -> Map:
    """Fuse runs into a map."""

def read_map(path: _Path) -> Map:
    """Read a map: CSV, Parquet, or packed as vehicles have it."""
