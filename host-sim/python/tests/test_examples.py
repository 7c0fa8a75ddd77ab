"""The examples of docs/python.md and the notebook run as they stand."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from unittest import mock

import matplotlib
import matplotlib.pyplot as plt
from drives import FOLDER, LOGS, REPOSITORY, VEHICLE, DriveTest


class Examples(DriveTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        matplotlib.use("agg")
        # They have the names of the documentation.
        cls.folder = FOLDER / "examples"
        cls.folder.mkdir(exist_ok=True)
        for log in LOGS:
            shutil.copy(log, cls.folder)
        shutil.copy(VEHICLE, cls.folder / "vehicle.toml")

    def test_every_example_of_the_documentation_runs(self):
        page = (REPOSITORY / "docs" / "python.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
        self.assertGreaterEqual(len(blocks), 5)
        program = "\n".join(blocks)
        words = [sys.executable, "-W", "error::DeprecationWarning:__main__", "-c", program]
        done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_notebook_draws_a_map(self):
        path = Path(__file__).parents[1] / "examples" / "map.ipynb"
        cells = json.loads(path.read_text())["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        names: dict = {}
        with mock.patch.dict(os.environ, {"ROADGRADE_LOGS": str(self.folder)}):
            for number, text in enumerate(code):
                exec(compile(text, f"{path.name}, cell {number}", "exec"), names)
        plan, profile = names["plan"], names["profile"]
        points = plan.collections[0].get_offsets()
        self.assertEqual(len(points), len(names["cells"]))
        self.assertEqual(len(profile.lines), 1 + len(LOGS))
        picture = FOLDER / "map.png"
        names["figure"].savefig(picture)
        self.assertGreater(picture.stat().st_size, 10_000)
        plt.close("all")
