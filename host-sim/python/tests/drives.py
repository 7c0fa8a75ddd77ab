"""Simulated drives, and what the binary makes of them. Tests are given both by the environment."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROADGRADE = os.environ["ROADGRADE"]
REPOSITORY = Path(__file__).parents[3]
SCENARIO = """
[road]
length_m = 8000.0
[[runs]]
name = "monday"
truck = "A"
[[runs]]
name = "tuesday"
truck = "A"
"""
_folder = tempfile.TemporaryDirectory(prefix="roadgrade-python-")
FOLDER = Path(_folder.name)
LOGS = [FOLDER / "monday.log", FOLDER / "tuesday.log"]
VEHICLE = FOLDER / "monday.vehicle.toml"


def roadgrade(*arguments: object) -> "subprocess.CompletedProcess[str]":
    """Runs the binary."""
    words = [ROADGRADE, *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True)


def well(*arguments: object) -> str:
    """Runs the binary, which must succeed; returns what it prints."""
    done = roadgrade(*arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def simulate() -> None:
    """Makes the drives, once for all tests."""
    if not LOGS[0].exists():
        scenario = FOLDER / "scenario.toml"
        scenario.write_text(SCENARIO)
        well("simulate", "--scenario", scenario, "--out", FOLDER)


def columns_of_csv(path: Path) -> "dict[str, list[float | None]]":
    """Returns the columns of a file of numbers; None where a cell is empty."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return {
        name: [float(row[name]) if row[name] else None for row in rows]
        for name in rows[0]
    }


class DriveTest(unittest.TestCase):
    """A test with simulated drives."""

    @classmethod
    def setUpClass(cls) -> None:
        simulate()
